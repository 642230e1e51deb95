"""A scene in many copies: topology and waveforms are shared, numbers vary; all of them as arrays over the copies."""

from collections.abc import Mapping
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.load import Matched, NoFlow, Reservoir, Resistor, Short
from tline.scene.rational import Parallel, Series
from tline.scene.refuse import refuse_cavities
from tline.solver.description.description import Description
from tline.solver.description.given import Scene, Shape
from tline.solver.description.load_step import StateSpace
from tline.solver.description.nodes import UNIT, Node, lowered
from tline.solver.description.slab import WHOLE, common_parts
from tline.words.wording import place

Floats = NDArray[np.float64]
WHAT = "a scene of single lossless lines, resistances, R, L and C, from rest, for many runs"
ELEMENTS = ("resistance", "inductance", "capacitance")
MOST_UNITS = 1000  # in the shortest delay


class NodeOfCopies(NamedTuple):
    """A node in all copies."""

    ends: list[int]
    weights: Floats  # (ends, copies) share of an arriving wave in the Thévenin wave
    drives: list[tuple[Shape, Floats]]  # waveforms, and their shares (copies,) of the Thévenin wave
    load: StateSpace | None = None  # None where nothing has a state


class Copies(NamedTuple):
    """A scene in N copies; L lines."""

    unit: Floats  # (N,) the common measure of a copy's delays, s
    delay: NDArray[np.int64]  # (L,) delays in units, the same in all copies
    z0: Floats  # (L, N)
    junctions: list[NodeOfCopies]


def copies_of(description: Description, vary: Mapping[str, Floats]) -> Copies:
    """Return all copies of a scene; for arguments and errors see `tline.solver.many.runs`."""
    scene, count = description.scene, len(next(iter(vary.values())))
    numbers = {where: vary.get(where, np.full(count, value)) for where, value in variable(scene).items()}
    z0, delays = (
        np.array([numbers[place("lines", name, key)] for name in description.lines]) for key in ("z0", "delay")
    )
    shortest = int(delays[:, 0].argmin())
    ratios = delays / delays[shortest]
    ratio = ratios[:, :1]
    apart = np.flatnonzero((np.abs(ratios - ratio) > WHOLE * ratio).any(axis=0))
    if len(apart):
        problem = f"the delays of copy {apart[0]} are not in the proportion of those of copy 0"
        raise InputError("lines", problem, "all delays multiplied by the same number, copy by copy")
    parts = common_parts(tuple(ratio[:, 0].tolist()), 1.0, MOST_UNITS)
    if not parts:
        expected = f"whole multiples of a part of the shortest, at most a {MOST_UNITS}th"
        raise InputError("lines", "their delays have no common measure", expected)
    delay = np.round(ratio[:, 0] * parts).astype(np.int64)
    junctions = [_junction(node, z0, numbers) for node in description.nodes.values() if node.ends]
    return Copies(delays[shortest] / parts, delay, z0, junctions)


def _refuse(scene: Scene) -> None:
    if scene.start != "rest":
        raise InputError("start", "many runs begin at rest", "'rest'", f"'{scene.start}'")
    for key in ("order", "slab"):
        if getattr(scene.solver, key) is not None:
            raise InputError(place("solver", key), "many runs choose order and slabs themselves", "a tolerance")
    refuse_cavities(scene.lines, "many runs")
    for where, _ in scene.between:
        raise InputError(where, "stands between two nodes", WHAT)
    for name, line in scene.lines.items():
        if isinstance(line, Coupled) or line.losses is not None:
            problem = "has coupled conductors" if isinstance(line, Coupled) else "has losses"
            raise InputError(place("lines", name), problem, WHAT)
    states: set[str] = set()
    for name, load in scene.loads.items():
        if not isinstance(load, NoFlow | Short | Reservoir | Matched | Resistor | Series | Parallel):
            raise InputError(place("loads", name), f"a load of kind '{load.kind}'", WHAT)
        if isinstance(load, Series | Parallel) and load.ratio.degree:
            if load.at in states:
                raise InputError(place("loads", name), f"a second L or C at node '{load.at}'", "one load with a state")
            states.add(load.at)
            height, path = scene.heights.get(load.at), load.ratio.at_zero()
            if height and height.above_level and load.inductance is not None and path != inf:
                problem = f"lets a steady flow out through an inductance below the highest node, at '{load.at}'"
                raise InputError(place("loads", name), problem, WHAT)


def variable(scene: Scene) -> dict[str, float]:
    """All numbers of a scene that may vary, by place; raise an error for scenes that cannot be run in copies."""
    _refuse(scene)
    found: dict[str, float] = {}
    for name, line in scene.lines.items():
        found[place("lines", name, "z0")] = line.parameters.z0
        found[place("lines", name, "delay")] = line.parameters.delay or 0.0
    for section, elements in (("loads", scene.loads), ("sources", scene.sources)):
        for name, element in elements.items():
            given = {key: getattr(element, key, None) for key in ELEMENTS}
            found |= {place(section, name, key): float(value) for key, value in given.items() if value}
    return found


def parallel(z: Floats, inductance: Floats | None, capacitance: Floats | None) -> StateSpace:
    """L and C side by side, R being part of z.

    Impedances, H and F are positive, shape (copies,); states are u, and z times the inductor's flow.

    Examples
    --------
    >>> parallel(np.array([50.0]), None, np.array([2e-3])).A.tolist()  # -1/(z C)
    [[[-10.0]]]
    """
    zero, one = np.zeros_like(z), np.ones_like(z)
    back = zero if inductance is None else z / inductance
    if capacitance is None:
        return _stacked([[-back]], [back], [-one], one)
    rate = 1 / (z * capacitance)
    if inductance is None:
        return _stacked([[-rate]], [rate], [one], zero)
    return _stacked([[-rate, -rate], [back, zero]], [rate, zero], [one, zero], zero)


def series(z: Floats, resistance: Floats | float, inductance: Floats | None, capacitance: Floats | None) -> StateSpace:
    """R, L and C one after the other; states are z times the flow, and the capacitor's effort.

    Examples
    --------
    >>> series(np.array([50.0]), 30.0, np.array([4.0]), None).A.tolist()  # -(R + z)/L
    [[[-20.0]]]
    """
    zero, one, total = np.zeros_like(z), np.ones_like(z), resistance + z
    if inductance is None:
        assert capacitance is not None
        rate = 1 / (total * capacitance)
        return _stacked([[-rate]], [rate], [z / total], 1 - z / total)
    rate, back = total / inductance, z / inductance
    if capacitance is None:
        return _stacked([[-rate]], [back], [-one], one)
    return _stacked([[-rate, -back], [1 / (z * capacitance), zero]], [back, zero], [-one, zero], one)


def _stacked(A: list[list[Floats]], b: list[Floats], c: list[Floats], d: Floats) -> StateSpace:
    """State space from a node's Thévenin wave to its effort; the copies are the first axis."""
    return StateSpace(*(np.moveaxis(np.array(part), -1, 0) for part in (A, [[row] for row in b], [c], [[d]])))


def _junction(node: Node, z0: Floats, numbers: Mapping[str, Floats]) -> NodeOfCopies:
    """A node in all copies; `numbers` are those of lines, sources and loads, by place."""
    own = 1 / z0[np.array(node.ends) // 2]
    if node.held is not None:
        return NodeOfCopies(node.ends, 0.0 * own, [(node.held, np.ones(z0.shape[1]))])
    total, to_air = own.sum(axis=0), np.zeros(z0.shape[1])
    flows: list[tuple[Shape, Floats | float]] = []
    dynamic: tuple[Series | Parallel, Floats | None, Floats | None, Floats | None] | None = None
    for where, load in node.loads.items():
        R, L, C = (numbers.get(f"{where}.{element}") for element in ELEMENTS)
        if L is not None or C is not None:
            assert isinstance(load, Series | Parallel)
            dynamic = load, R, L, C
        if isinstance(load, Matched):
            to_air = to_air + own[0]
        elif R is not None and not (isinstance(load, Series) and dynamic and dynamic[0] is load):
            to_air = to_air + 1 / R
    for where, source in node.sources.items():
        R = numbers.get(f"{where}.resistance")
        conductance = 0.0 if R is None else 1 / R
        if source.is_effort:
            total = total + conductance
            flows.append((lowered(source.value, node.height.level), conductance))
        else:
            to_air = to_air + conductance
            flows.append((source.value, 1.0))
    if node.above_level and np.any(to_air):
        flows.append((UNIT, node.above_level * to_air))
    z = 1 / (total + to_air)
    found = NodeOfCopies(node.ends, own * z, [(waveform, factor * z) for waveform, factor in flows])
    if dynamic is None:
        return found
    load, R, L, C = dynamic
    through = parallel(z, L, C) if isinstance(load, Parallel) else series(z, 0.0 if R is None else R, L, C)
    return found._replace(load=through)
