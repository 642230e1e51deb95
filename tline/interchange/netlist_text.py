"""SPICE netlists from scenes, so that other programs can run them."""

import re
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from passivity import RationalFunction
from tline.errors import InputError
from tline.interchange.elements import NOMINAL
from tline.interchange.spice_source import spice_waveform
from tline.scene.characteristic import Diode
from tline.scene.load import Link, Matched, NoFlow, Short
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Multiport, Transformer
from tline.scene.rational import RationalImpedance, Resistor
from tline.scene.refuse import refuse_coupled
from tline.scene.scene import Scene
from tline.words.wording import place


class Names:
    """Words of a netlist for the names of a scene: these where they are words, and numbered ones elsewhere."""

    def __init__(self, scene: Scene):
        joined = [*(line.nodes for line in scene.lines.values()), *(nodes for _, nodes in scene.between)]
        nodes = list(dict.fromkeys(at for each in joined for at in each))
        self.used = {"0", "gnd"}
        self.node = {at: self._word(at, f"n{k}") for k, at in enumerate(nodes, 1)}
        self.comments = [f"* node {word} is {at!r}" for at, word in self.node.items() if word != at]
        self.used = set()

    def element(self, letter: str, name: str) -> str:
        """A name for an element that begins with its letter, used for the first time."""
        return self._word(letter + re.sub(r"\W", "_", name, flags=re.ASCII), letter)

    def _word(self, wanted: str, other: str) -> str:
        """Return `wanted` if it is an unused word; else `other` with a number that makes it unused."""
        word, k = (wanted if re.fullmatch(r"[A-Za-z_]\w*", wanted, re.ASCII) else other), 2
        free = word
        while free.lower() in self.used:
            free, k = f"{word}_{k}", k + 1
        self.used.add(free.lower())
        return free


def as_load(impedance: RationalFunction) -> dict[str, Any]:
    """A load of that impedance as in a scene file: R, L and C in series or side by side where it is that."""
    impedance = impedance.reduced()
    if impedance.degree == 0:
        return {"kind": "resistor", "resistance": float(impedance.at_zero())}
    p, q = impedance.numerator, impedance.denominator
    series, parallel = _parts(p, q), _parts(q, p)
    if series:
        keys = ("inductance", "resistance", "capacitance")
        values = [series[0], series[1], 1 / series[2] if series[2] else Fraction(0)]
    elif parallel:
        keys = ("capacitance", "resistance", "inductance")
        values = [parallel[0], *(1 / part if part else Fraction(0) for part in parallel[1:])]
    else:
        return {"kind": "impedance", "numerator": [str(a) for a in p], "denominator": [str(a) for a in q]}
    given = {key: float(value) for key, value in zip(keys, values, strict=True) if value}
    order = ("resistance", "inductance", "capacitance")
    return {"kind": "series" if series else "parallel"} | {key: given[key] for key in order if key in given}


def _parts(p: Sequence[Fraction], q: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction] | None:
    """a, b, c of p/q = a s + b + c/s, all at least zero; None if it is not that."""
    power = len(q) - 1
    if power > 1 or any(q[1:]) or len(p) > power + 2:
        return None
    a, b, c = [Fraction(0)] * (3 - len(p) - (power == 0)) + [x / q[0] for x in p] + [Fraction(0)] * (power == 0)
    return (a, b, c) if min(a, b, c) >= 0 else None


LARGEST = 1e12  # condition number of 1 + S, beyond which there is no admittance
SMALLEST_ADMITTANCE = 1e-15  # of the largest admittance; less is none


def diode_cards(element: Diode, name: str, nodes: list[str], names: Names) -> list[str]:
    """The element and its model; its temperature is part of the emission coefficient."""
    card, model = names.element("D", name), names.element("M", name)
    emission = float(element.emission) * float(element.temperature) / NOMINAL
    return [f"{card} {' '.join(nodes)} {model}", f".model {model} D(IS={float(element.saturation)!r} N={emission!r})"]


def multiport_cards(link: Link, name: str, names: Names) -> list[str]:
    """Cards of a multiport: E, F and V of a transformer, two G of a gyrator, E and R, L and K, G of a junction."""
    where, nodes = place("links", name), [names.node[at] for at in link.nodes]
    grounded = not isinstance(link, Multiport) or link.is_grounded
    ports = [f"{at} 0" for at in nodes] if grounded else [" ".join(nodes[:2]), " ".join(nodes[2:])]
    match link:
        case Transformer():
            return _transformer(float(link.ratio), name, ports, names)
        case Gyrator():
            turned = 1 / float(link.resistance)
            return _conductances(np.array([[0.0, turned], [-turned, 0.0]]), name, ports, names)
        case ControlledSource():
            return _controlled_source(link, name, ports, names)
        case CoupledInductors():
            return _coupled_inductors(link, name, ports, names)
        case Junction():
            return _conductances(_admittance(link, where), name, ports, names)
    raise InputError(
        where, f"a {type(link).model_fields['kind'].default} has no counterpart in a netlist", "a linear multiport"
    )


def _transformer(ratio: float, name: str, ports: list[str], names: Names) -> list[str]:
    """u₁ = n u₂, and n times the current into the first port comes out of the second."""
    (first, low), second = ports[0].split(), ports[1]
    E, V, F = (names.element(letter, name) for letter in "EVF")
    inner, turned = f"{V}.x", " ".join(reversed(second.split()))
    return [f"{E} {inner} {low} {second} {ratio!r}", f"{V} {first} {inner} DC 0", f"{F} {turned} {V} {ratio!r}"]


def _controlled_source(link: ControlledSource, name: str, ports: list[str], names: Names) -> list[str]:
    control, out = ports
    if link.transconductance is not None:
        return [f"{names.element('G', name)} {out} {control} {float(link.transconductance)!r}"]
    E, gain, resistance = names.element("E", name), float(link.gain or 0), float(link.resistance or 0)
    if not resistance:
        return [f"{E} {out} {control} {gain!r}"]
    inner, (plus, minus) = f"{E}.x", out.split()
    return [f"{E} {inner} {minus} {control} {gain!r}", f"{names.element('R', name)} {inner} {plus} {resistance!r}"]


def _coupled_inductors(link: CoupledInductors, name: str, ports: list[str], names: Names) -> list[str]:
    windings, k = [names.element("L", name) for _ in ports], float(link.coupling)
    cards = [f"{L} {port} {float(x)!r}" for L, port, x in zip(windings, ports, link.inductance, strict=True)]
    return [*cards, f"{names.element('K', name)} {' '.join(windings)} {k!r}"] if k else cards


def _admittance(link: Junction, where: str) -> NDArray:
    """Y = (1 + S)^-1 (1 - S)/z0, so that i = Y u; Pozar, Microwave Engineering, 4th ed., section 4.3."""
    S, one = np.array(link.scattering, float), np.eye(len(link.nodes))
    if np.linalg.cond(one + S) > LARGEST:
        raise InputError(where, "has no admittance matrix, which a netlist needs", "1 + S that can be inverted")
    return np.linalg.solve(one + S, one - S) / float(link.z0)


def _conductances(Y: NDArray, name: str, ports: list[str], names: Names) -> list[str]:
    """G across each port for each voltage that commands its current."""
    return [
        f"{names.element('G', name)} {ports[i]} {ports[j]} {float(Y[i, j])!r}"
        for i, j in np.argwhere(np.abs(Y) > SMALLEST_ADMITTANCE * np.abs(Y).max())
    ]


SECTIONS = {"title", "medium", "t_end", "start", "solver", "lines", "sources", "loads", "links", "probes", "measures"}
STEPS = 20  # in the shortest delay
LETTERS = {"resistance": "R", "inductance": "L", "capacitance": "C"}


def spice_text(scene: Scene, rise: float | None = None, step: float | None = None) -> str:
    """A scene as SPICE netlist: T and O elements, sources behind resistors, R, L and C, K, E, F and G for multiports.

    Parameters
    ----------
    scene : Scene
        Electrical; lines without losses or with a resistance, open, matched or shorted ends, R, L and C at
        nodes and between them, linear multiports, probes at nodes; measures are left out.
    rise : float, optional
        Time that a jump takes in the netlist, s; without it jumps are refused, for SPICE has none.
    step : float, optional
        Longest time step that the netlist asks for, s; a twentieth of the shortest delay if not given.

    Raises
    ------
    InputError
        Naming the element that no netlist of that kind has.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="9 ns", probes={"far": {"at": "far"}},
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}},
    ...     loads={"end": {"at": "far", "kind": "parallel", "resistance": 100, "capacitance": "4 pF"}},
    ... )
    >>> print(spice_text(scene), end="")
    * a scene of tline
    Tcable near 0 far 0 Z0=50.0 TD=1e-09
    Vs Vs.s 0 DC 1.0
    Rs Vs.s near 25.0
    Rend far 0 100.0
    Cend far 0 4e-12
    .save v(far)
    .tran 5e-11 9e-09 0 5e-11 uic
    .end
    """
    if scene.medium != "electrical":
        raise InputError("medium", "a netlist is electrical", "'electrical'", f"'{scene.medium}'")
    for section in scene.table().keys() - SECTIONS:
        raise InputError(section, "has no counterpart in a netlist")
    refuse_coupled(scene.lines, "a netlist of tline")
    names = Names(scene)
    cards = [f"* {' '.join(scene.title.split()) or 'a scene of tline'}", *names.comments]
    for name in scene.lines:
        cards += _line(scene, name, names)
    for name in scene.sources:
        cards += _source(scene, name, names, rise)
    for name in scene.loads:
        cards += _load(scene, name, names)
    for name, link in scene.links.items():
        nodes = [names.node[at] for at in link.nodes]
        match link:
            case Diode():
                cards += diode_cards(link, name, nodes, names)
            case RationalImpedance():
                cards += _elements(as_load(link.rational()), name, nodes, names, place("links", name))
            case _:
                cards += multiport_cards(link, name, names)
    for name, probe in scene.probes.items():
        if probe.at is None:
            raise InputError(place("probes", name), "stands within a line, and a netlist knows nodes only", "at = …")
    step = float(step) if step else min(line.parameters.delay or 0.0 for line in scene.lines.values()) / STEPS
    probed = " ".join(dict.fromkeys(f"v({names.node[probe.at]})" for probe in scene.probes.values() if probe.at))
    start = "" if scene.start == "steady" else " uic"
    cards += [f".save {probed}", f".tran {step!r} {float(scene.t_end)!r} 0 {step!r}{start}", ".end"]
    return "\n".join(cards) + "\n"


def _line(scene: Scene, name: str, names: Names) -> list[str]:
    line, where = scene.single_lines[name], place("lines", name)
    (i, j), z0, delay = (names.node[at] for at in line.nodes), line.parameters.z0, line.parameters.delay or 0.0
    if line.losses is None:
        return [f"{names.element('T', name)} {i} 0 {j} 0 Z0={z0!r} TD={delay!r}"]
    if line.losses.constant is None:
        raise InputError(where, "no element of a netlist has losses that change with frequency", "resistance alone")
    resistance, conductance = line.losses.constant
    if conductance:
        raise InputError(where, "no element of a netlist has a conductance beside an inductance", "resistance alone")
    length = line.losses.exact.length
    element, model = names.element("O", name), names.element("M", name)
    values = f"r={resistance!r} l={z0 * delay / length!r} c={delay / (z0 * length)!r} len={length!r}"
    return [f"{element} {i} 0 {j} 0 {model}", f".model {model} ltra({values})"]


def _source(scene: Scene, name: str, names: Names, rise: float | None) -> list[str]:
    source = scene.sources[name]
    where, (node, minus) = place("sources", name), (names.node[at] if at else "0" for at in source.terminals)
    value = spice_waveform(source.value, scene, where, rise)
    resistance = None if source.resistance is None else float(source.resistance)
    if not source.is_effort:
        beside = [] if resistance in (None, np.inf) else [f"{names.element('R', name)} {node} {minus} {resistance!r}"]
        return [f"{names.element('I', name)} {minus} {node} {value}", *beside]
    card = names.element("V", name)
    if not resistance:
        return [f"{card} {node} {minus} {value}"]
    if resistance == np.inf:
        return []
    inner = f"{card}.s"
    return [f"{card} {inner} {minus} {value}", f"{names.element('R', name)} {inner} {node} {resistance!r}"]


def _load(scene: Scene, name: str, names: Names) -> list[str]:
    load, where = scene.loads[name], place("loads", name)
    node = names.node[load.at]
    match load:
        case NoFlow():
            return []
        case Short():
            return [f"{names.element('V', name)} {node} 0 DC 0"]
        case Matched():
            z0 = next(line.parameters.z0 for line in scene.lines.values() if load.at in line.nodes)
            return [f"{names.element('R', name)} {node} 0 {z0!r}"]
        case Resistor() if load.resistance == 0:
            return [f"{names.element('V', name)} {node} 0 DC 0"]
        case Resistor() if load.resistance == np.inf:
            return []
        case Resistor():
            return [f"{names.element('R', name)} {node} 0 {float(load.resistance)!r}"]
        case Diode():
            return diode_cards(load, name, ["0", node] if getattr(load, "reverse", False) else [node, "0"], names)
        case RationalImpedance() if not load.rational().is_zero and not load.rational().is_infinite:
            return _elements(as_load(load.rational()), name, [node, "0"], names, where)
    raise InputError(where, f"a {load.kind} has no counterpart in a netlist", "R, L and C")


def _elements(table: dict[str, Any], name: str, ends: list[str], names: Names, where: str) -> list[str]:
    """R, L and C of an impedance that is made of them."""
    parts = [(names.element(letter, name), table[key]) for key, letter in LETTERS.items() if key in table]
    if not parts or min(value for _, value in parts) <= 0:
        raise InputError(where, "its impedance is not R, L and C in series or side by side", "kind = 'series' or so")
    if table["kind"] != "series":
        return [f"{element} {' '.join(ends)} {value!r}" for element, value in parts]
    nodes = [ends[0], *(f"{element}.x" for element, _ in parts[1:]), ends[1]]
    return [f"{element} {i} {j} {value!r}" for (element, value), i, j in zip(parts, nodes, nodes[1:], strict=False)]
