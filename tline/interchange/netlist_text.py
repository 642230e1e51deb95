"""SPICE netlists from scenes, so that other programs can run them."""

from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.as_load import as_load
from tline.interchange.diode import diode_cards
from tline.interchange.multiports_text import multiport_cards
from tline.interchange.spice_names import Names
from tline.interchange.spice_waveform import spice_waveform
from tline.scene.characteristic import Diode
from tline.scene.coupled import refuse_coupled
from tline.scene.load import Matched, NoFlow, Resistor, Short
from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.words.wording import place

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
