"""What copies of a scene have that no formula tells for all at once: laws, and waveforms with numbers that vary."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import changed, parts_of
from tline.scene.law import NonLinear
from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before
from tline.solver.description.given import Scene, Shape
from tline.solver.description.nodes import UNIT
from tline.words.wording import place

Floats = NDArray[np.float64]
WHAT = "a scene of single lossless lines, resistances, R, L and C, and elements without a state, for many runs"
Varying = Shape | NDArray  # a waveform, or that of each copy


class LawOfCopies(NamedTuple):
    """A non-linear element without a state, from a node to the reference or to a held effort, in all copies."""

    unit: str  # in the kernel
    sign: float  # 1 if its flow counts out of the node, else -1
    beyond: Shape | None  # effort at its other end
    constants: Floats  # (copies, constants)
    control: Varying


def within_element(scene: Scene, path: str) -> bool:
    """Whether a number stands in a non-linear element, or is a source's value or in its waveform."""
    section, *keys = parts_of(path)
    element = getattr(scene, section, {}).get(keys[0]) if section in ("loads", "links", "sources") and keys else None
    return isinstance(element, NonLinear) or (section == "sources" and keys[1:2] == ["value"])


def scenes_of(scene: Scene, vary: Mapping[str, Floats], copies: int) -> tuple[list[Scene], NDArray]:
    """The scene of each copy with what varies within its elements, and whether these numbers fit there.

    It is one scene where nothing does.
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
            except InputError:  # which a run of its own tells
                known[values] = None
        found.append(known[values])
    return [each or scene for each in found], np.array([each is not None for each in found])


def for_each(objects: Sequence[Any], make: Callable[[Any], Any]) -> list[Any]:
    """What is made of each object; those that copies share are asked once."""
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
    """The law at each node that has one; those that copies cannot have are refused."""
    found: dict[str, LawOfCopies] = {}
    placed = {place(*at): at for at in description.laws}
    own = description.own | {place(*at) for at in description.scene.composed}
    for element in description.elements:
        where, (section, name) = element.where, placed[element.where]
        free = [node for node in element.nodes if description.nodes[node].held is None]
        if len(free) > 1:
            raise InputError(where, "stands between two nodes", WHAT)
        if element.kind.fills or element.kind.states or element.governor is not None or where in own:
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
