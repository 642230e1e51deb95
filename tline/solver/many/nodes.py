"""The nodes of a scene in many copies: shares of waves, drives, loads with a state, as arrays over the copies.

Laws, and waveforms with numbers that vary, are made copy by copy.
"""

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import changed, parts_of
from tline.scene.law import NonLinear
from tline.scene.load import Matched
from tline.scene.rational import Parallel, Series
from tline.solver.description.circuit import StateSpace
from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before
from tline.solver.description.given import Scene, Shape
from tline.solver.description.nodes import UNIT, Node, lowered
from tline.words.wording import place

Floats = NDArray[np.float64]
WHAT = "a scene of single lossless lines, resistances, R, L and C, and elements without a state, for many runs"
ELEMENTS = ("resistance", "inductance", "capacitance")
Varying = Shape | NDArray  # a waveform, or that of each copy


class LawOfCopies(NamedTuple):
    """A non-linear element without a state, from a node to the reference or to a held effort, in all copies."""

    unit: str  # in the kernel
    sign: float  # 1 if its flow counts out of the node, else -1
    beyond: Shape | None  # effort at its other end
    constants: Floats  # (copies, constants)
    control: Varying


def within_element(scene: Scene, path: str) -> bool:
    """Whether a number belongs to a non-linear element, or to a source's value or waveform."""
    section, *keys = parts_of(path)
    element = getattr(scene, section, {}).get(keys[0]) if section in ("loads", "links", "sources") and keys else None
    return isinstance(element, NonLinear) or (section == "sources" and keys[1:2] == ["value"])


def scenes_of(scene: Scene, vary: Mapping[str, Floats], copies: int) -> tuple[list[Scene], NDArray]:
    """Return the scene of each copy with the varying numbers of its elements, and whether these fit there.

    One scene is returned if none of these vary.
    """
    own = {path: values for path, values in vary.items() if within_element(scene, path)}
    if not own:
        return [scene], np.ones(copies, bool)
    known: dict[tuple[float, ...], Scene | None] = {}
    found = []
    for values in zip(*(column.tolist() for column in own.values()), strict=True):
        if values not in known:
            try:
                known[values] = changed(scene, dict(zip(own, values, strict=True)))
            except InputError:  # a run of its own reports the error
                known[values] = None
        found.append(known[values])
    return [each or scene for each in found], np.array([each is not None for each in found])


def for_each(objects: Sequence[Any], make: Callable[[Any], Any]) -> list[Any]:
    """Return `make` of each object, called once for an object that copies share."""
    made: dict[int, Any] = {}
    for one in objects:
        if id(one) not in made:
            made[id(one)] = make(one)
    return [made[id(one)] for one in objects]


def varying(shapes: Sequence[Shape]) -> Varying:
    """One waveform if all are alike, else those of each copy."""
    first = shapes[0]
    if all(each is first or (type(each) is type(first) and vars(each) == vars(first)) for each in shapes):
        return first
    found = np.empty(len(shapes), object)
    found[:] = shapes
    return found


def value_before(waveform: Varying) -> NDArray | float:
    """Value immediately before t = 0, of each copy where they differ."""
    if isinstance(waveform, Shape):
        return just_before(waveform)
    return np.array([just_before(each) for each in waveform])


def value(waveform: Varying, t: Floats, inside: Floats) -> NDArray:
    """Values at instants of batches of copies, which are the first axis and the last."""
    if isinstance(waveform, Shape):
        return waveform.value(t, inside)
    found = np.empty(t.shape)
    for (batch, copy), own in np.ndenumerate(waveform):
        found[batch, ..., copy] = own.value(t[batch, ..., copy], inside[batch, ..., copy])
    return found


def laws_by_node(description: Description, scenes: Sequence[Scene], copies: int) -> dict[str, LawOfCopies]:
    """Return the law at each node that has one; raise an error for laws that copies cannot have."""
    found: dict[str, LawOfCopies] = {}
    placed = {place(*at): at for at in description.laws}
    own = description.own | {place(*at) for at in description.scene.composed}
    for element in description.elements:
        where, (section, name) = element.where, placed[element.where]
        free = [node for node in element.nodes if description.nodes[node].held is None]
        if len(free) > 1:
            raise InputError(where, "stands between two nodes", WHAT)
        if element.kind.states or element.governor is not None or where in own:
            raise InputError(where, "keeps a state, or is made of others", WHAT)
        (node,) = free
        if node in found or not description.nodes[node].ends:
            raise InputError(where, f"stands beside another at node '{node}', or without a line", WHAT)
        laws = for_each([getattr(scene, section)[name] for scene in scenes], lambda one: one.law())
        constants = [element._replace(law=law).constants for law in laws]
        if any(law.kind != element.law.kind or law.reverse != element.law.reverse for law in laws):
            raise InputError(where, "is of another kind in some copies", WHAT)
        if problem := next(filter(None, (element.kind.source(law.constants) for law in laws)), ""):
            raise InputError(where, problem, WHAT)
        sign, other = (1.0, element.to_node) if element.from_node == node else (-1.0, element.from_node)
        control = varying([law.factor or UNIT for law in laws])
        beyond = description.nodes[other].held if other is not None else None
        of_copies = np.broadcast_to(constants, (copies, len(constants[0])))
        found[node] = LawOfCopies(element.kind.unit, sign, beyond, of_copies, control)
    return found


def parallel(z: Floats, inductance: Floats | None, capacitance: Floats | None) -> StateSpace:
    """L and C side by side, R being part of z.

    Impedances, H and F are positive, shape (copies,); states are u, and z times the inductor's flow.
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
    """R, L and C one after the other; states are z times the flow, and the capacitor's effort."""
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


class NodeOfCopies(NamedTuple):
    """A node in all copies."""

    ends: list[int]
    weights: Floats  # (ends, copies) share of an arriving wave in the Thévenin wave
    drives: list[tuple[Varying, Floats]]  # waveforms, and their shares (copies,) of the Thévenin wave
    load: StateSpace | None = None  # None where nothing has a state
    law: LawOfCopies | None = None
    conductance: Floats | None = None  # (copies,) of all but lines; None where the effort is held
    impedance: Floats = np.empty(0)  # (copies,) behind the Thévenin wave; none where the effort is held


def junction_of(node: Node, z0: Floats, numbers: Mapping[str, Floats], scenes: Sequence[Scene]) -> NodeOfCopies:
    """A node in all copies, without its law; `numbers` are those of lines, sources and linear loads, by place."""
    own = 1 / z0[np.array(node.ends) // 2]
    if node.held is not None:
        held = node.held
        for where, source in node.sources.items():
            if source.is_effort and source.conductance == inf:
                held = _prescribed(where, scenes, node.height.level)
        return NodeOfCopies(node.ends, 0.0 * own, [(held, np.ones(z0.shape[1]))])
    total, to_air = np.zeros(z0.shape[1]), np.zeros(z0.shape[1])
    flows: list[tuple[Varying, Floats | float]] = []
    dynamic: tuple[Series | Parallel, Floats | None, Floats | None, Floats | None] | None = None
    for where, load in node.loads.items():
        if isinstance(load, NonLinear):
            continue
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
            flows.append((_prescribed(where, scenes, node.height.level), conductance))
        else:
            to_air = to_air + conductance
            flows.append((_prescribed(where, scenes, 0.0), 1.0))
    if node.above_level and np.any(to_air):
        flows.append((UNIT, node.above_level * to_air))
    conducted = total + to_air
    z = 1 / (own.sum(axis=0) + conducted)
    drives = [(waveform, factor * z) for waveform, factor in flows]
    found = NodeOfCopies(node.ends, own * z, drives, conductance=conducted, impedance=z)
    if dynamic is None:
        return found
    load, R, L, C = dynamic
    through = parallel(z, L, C) if isinstance(load, Parallel) else series(z, 0.0 if R is None else R, L, C)
    return found._replace(load=through)


def _prescribed(where: str, scenes: Sequence[Scene], level: float) -> Varying:
    """Value prescribed by a source in each copy, less the level."""
    sources = [scene.sources[parts_of(where)[1]] for scene in scenes]
    return varying(for_each(sources, lambda source: lowered(source.value, level)))
