"""Non-linear elements as arrays for the kernel; switches and valves that move at an instant, as laws."""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.scene.load import Switch
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import Shape, just_before, varies
from tline.solver.description.given import ElementLaw, Straight, Tabled, kinds_numbered
from tline.solver.description.groups import Group
from tline.solver.kernel.network import Laws, Tools
from tline.solver.radau import Basis, basis, gauss
from tline.words.wording import place

MOVING = 3  # states of an opening that moves
SHORT = 1e-10  # of the impedance that a switch sees: the resistance of one that has none
LINEAR = (0.0, 3.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0)  # constants of the table i = e


@lru_cache
def tools_of(basis: Basis) -> Any:
    """The matrices of a basis, packed: `Tools`."""
    return pack(Tools(basis.c, basis.to_points, basis.to_legendre, basis.A, np.array(gauss(basis.s))))


def laws_of(
    groups: Sequence[Group], impedances: Sequence[float], first_row: int, first_state: int
) -> tuple[Laws, list[Shape]]:
    """Arrays of the laws of groups, independent of the slabs' order and width, and the shapes of their openings.

    Each law is behind an impedance; excitation rows and states are numbered from the given ones on.
    """
    excitations: list[Shape] = []
    rows, controls, states, moving = [], [], [], []
    place_of: dict[str | None, int] = {node.name: k for group in groups for k, node in enumerate(group.nodes)}
    place_of[None] = -1
    flat = [element for group in groups for element in group.elements]
    for element in flat:
        factor = element.law.factor
        rows.append(first_row + len(excitations) if varies(factor) else -1)
        controls.append(element.control)
        excitations += [factor] if factor is not None and varies(factor) else []
        states.append(first_state if element.kind.states else -1)
        first_state += element.kind.states
        moving.append(first_state if element.governor is not None else -1)
        first_state += MOVING if element.governor is not None else 0
    constants = [element.constants for element in flat]
    begins = np.cumsum([0, *map(len, constants)])[:-1]
    places = [
        begin + len(e.law.constants) if e.governor is not None else -1 for e, begin in zip(flat, begins, strict=True)
    ]
    laws = Laws(
        first=np.cumsum([0, *(len(group.elements) for group in groups)]),
        kind=np.array([element.kind.number for element in flat], int),
        states=np.array([element.kind.states for element in flat], int),
        from_node=np.array([place_of[e.from_node] for e in flat], int),
        to_node=np.array([place_of[e.to_node] for e in flat], int),
        excitation_row=np.array(rows, int),
        control=np.array(controls, float),
        at=begins,
        constants=np.concatenate([np.empty(0), *constants]),
        state_at=np.array(states, int),
        governor=np.array(places, int),
        governor_state=np.array(moving, int),
        governed=np.array([any(e.governor is not None for e in group.elements) for group in groups], bool),
        source_impedance=np.array(impedances, float),
        record_row=np.full(len(flat), -1),
        before=np.zeros(len(flat)),
        impedance=np.array([0.0 if n.held is not None else 1 / n.total for group in groups for n in group.nodes]),
        pocket=np.concatenate([np.zeros(0, bool), *(group.pockets for group in groups)]),
        pockets=np.array([group.pockets.any() for group in groups], bool),
        effort=np.zeros(sum(len(group.nodes) for group in groups)),
        tools=tools_of(basis(1)),
        step=0.0,
    )
    return laws, excitations


def units_of_laws(laws: Laws) -> list[str]:
    """Units in the kernel that tell the flows of these."""
    return [kind.unit for kind in kinds_numbered(laws.kind.tolist())]


def started(
    laws: Laws,
    elements: Sequence[PlacedLaw],
    effort: Mapping[str, float],
    through: Mapping[str, float],
    openings: Mapping[str, float],
) -> Laws:
    """Set laws to their state before t = 0.

    That sets the waves into elements, from efforts at their nodes and flows through them, and set points that keep
    the initial value.
    """
    constants = laws.constants.copy()
    for element, at in zip(elements, laws.governor, strict=True):
        there = [effort.get(element.from_node or "", 0.0), effort.get(element.to_node or "", 0.0)]
        for k, now in enumerate((*there, through.get(element.where, 0.0)) if at >= 0 else ()):
            if np.isnan(constants[at + 2 * k + 1]):
                constants[at + 2 * k + 1] = now
    across = [effort.get(e.from_node or "", 0.0) - effort.get(e.to_node or "", 0.0) for e in elements]
    flows = [through.get(e.where, 0.0) for e in elements]
    for element, at, drop, flow in zip(elements, laws.at, across, flows, strict=True):
        own = slice(at, at + len(element.law.constants))
        constants[own] = element.kind.begun(constants[own], drop, flow)
    laws = opened(laws, elements, openings)._replace(constants=constants)
    return laws._replace(before=np.array(across) + laws.source_impedance * np.array(flows))


def opened(laws: Laws, elements: Sequence[PlacedLaw], openings: Mapping[str, float]) -> Laws:
    """Set the openings of self-acting elements, by place."""
    each = zip(elements, laws.control, strict=True)
    return laws._replace(
        control=np.array([e.share(openings[e.where]) if e.governor is not None else now for e, now in each], float)
    )


def with_basis(laws: Laws, order: Basis, h: float, record_row: NDArray) -> Laws:
    """Set the order and width of slabs, and the rows of the record."""
    return laws._replace(tools=tools_of(order), step=h, record_row=record_row)


def states_of(elements: list[PlacedLaw], effort: dict[str, float], openings: Mapping[str, float]) -> NDArray:
    """States of the elements that have one, in equilibrium with the efforts of their nodes; and openings that move."""
    states: list[float] = []
    for element in elements:
        u = effort[element.nodes[0]]
        try:
            states += element.kind.at_rest(element.constants, u, element.control)
        except InputError as error:
            raise InputError(element.where, error.problem, got=f"{u - element.above_level:.6g} Pa") from None
        if element.governor is not None:
            states += [openings[element.where], 0.0, 0.0]
    return np.array(states, float)


def switches_of(description: Description) -> Iterator[PlacedLaw]:
    """Switches of a scene at nodes whose effort is not held."""
    for at, one in description.scene.placed:
        if not isinstance(one, Switch):
            continue
        ends = one.terminals
        free = [node for node in ends if node is not None and description.nodes[node].held is None]
        if free:
            impedance = max(1 / description.nodes[node].total for node in free)
            before, after = (1 / max(float(r), SHORT * impedance) for r in (one.before, one.after))
            moving = Straight(np.array([float(one.time)]), np.array([before, after]), np.zeros(2))
            law = ElementLaw(Tabled.name, LINEAR, moving)  # type: ignore[arg-type]
            level = description.nodes[free[0]].above_level if ends[1] is None else 0.0
            yield PlacedLaw(place(*at), law, *ends, above_level=level, control=just_before(moving))
