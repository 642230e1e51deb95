"""The non-linear elements of a scene as arrays for the kernel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.law import Law
from tline.scene.scene import Scene
from tline.scene.shape import Constant
from tline.scene.waveform import Shape
from tline.solver.assembly.network import Laws, tools_of
from tline.solver.description.excitation import just_before
from tline.solver.description.nodes import Node
from tline.solver.radau import Basis, basis
from tline.wording import place

STATES = {"gas": 1, "tank": 1, "rotor": 1, "vapour": 1, "air": 2}
KINDS = ("quadratic", "pump", "relief", "leak", "demand", "diode", "table", *STATES, "own")
BREAKING = {"vapour", "air"}  # kinds that send fronts at instants of their own, which are not followed


class Element(NamedTuple):
    """A law between two nodes, or a node and the reference (None)."""

    where: str
    law: Law
    one: str | None
    other: str | None
    above_level: float = 0.0  # of a node that it leads from to the open air; of one that it leads to, less than zero

    @property
    def constants(self) -> tuple[float, ...]:
        """Of its law; the first, from which efforts count, at its height."""
        first, *rest = self.law.constants
        return (first + self.above_level, *rest)

    @property
    def nodes(self) -> list[str]:
        """Those that it is at."""
        return [node for node in (self.one, self.other) if node is not None]


def elements_of(scene: Scene, nodes: dict[str, Node]) -> list[Element]:
    """Those elements of a scene that are seen by anything: not those between efforts that are held."""
    found = []
    for (part, name), law in scene.laws.items():
        ends = scene.links[name].nodes if part == "links" else (scene.loads[name].at, None)
        if any(node is not None and nodes[node].held is None for node in ends):
            one, other = reversed(ends) if law.reverse else ends
            found.append(Element(place(part, name), law, one, other, _height(nodes, one, other)))
    return found


def _height(nodes: dict[str, Node], one: str | None, other: str | None) -> float:
    if one is not None and other is not None:
        return 0.0
    return nodes[one].above_level if one is not None else -nodes[other or ""].above_level


def laws_of(
    elements: list[list[Element]], names: list[list[str]], nodes: dict[str, Node], first_row: int, first_state: int
) -> tuple[Laws, list[Shape]]:
    """Elements by group as arrays, without the slabs' order and width; and what scales them over time.

    Parameters
    ----------
    names : list of lists of str
        Nodes of each group.
    first_row, first_state : int
        Numbers of the first drive row and of the first state.
    """
    drives: list[Shape] = []
    rows, factors, states, seen = [], [], [], []
    place_of = {name: k for group in names for k, name in enumerate(group)}
    impedance = {name: _impedance(node) for name, node in nodes.items()}
    largest = max([z for z in impedance.values() if z > 0], default=1.0)
    flat = [element for group in elements for element in group]
    for element in flat:
        factor = element.law.factor
        varies = factor is not None and not isinstance(factor, Constant)
        rows.append(first_row + len(drives) if varies else -1)
        factors.append(1.0 if factor is None else just_before(factor))
        drives += [factor] if factor is not None and varies else []
        states.append(first_state if element.law.kind in STATES else -1)
        first_state += STATES.get(element.law.kind, 0)
        seen.append(sum(max(impedance[node], 0.0) for node in element.nodes) or largest)
    constants = [element.constants for element in flat]
    laws = Laws(
        first=np.cumsum([0, *map(len, elements)]),
        kind=np.array([KINDS.index(element.law.kind) for element in flat], int),
        one=np.array([-1 if e.one is None else place_of[e.one] for e in flat], int),
        other=np.array([-1 if e.other is None else place_of[e.other] for e in flat], int),
        drive_row=np.array(rows, int),
        factor=np.array(factors, float),
        at=np.cumsum([0, *map(len, constants)])[:-1],
        constants=np.concatenate([np.empty(0), *constants]),
        state_at=np.array(states, int),
        seen=np.array(seen, float),
        impedance=np.array(list(impedance.values())),
        tools=tools_of(basis(1)),
        step=0.0,
    )
    return laws, drives


def with_basis(laws: Laws, order: Basis, h: float) -> Laws:
    """The same for slabs of that order and width."""
    return laws._replace(tools=tools_of(order), step=h)


def states_of(elements: list[Element], effort: dict[str, float]) -> NDArray:
    """States of the elements that have one, in equilibrium with the efforts of their nodes.

    Raises
    ------
    InputError
        A pressure is below what the gas in a vessel can have.
    """
    states = []
    for element in elements:
        kind, constants = element.law.kind, element.constants
        u = effort[element.nodes[0]]
        gauge = f"{u - element.above_level:.6g} Pa"
        if kind == "gas":
            above, outside, n = u - constants[0], constants[2], constants[4]
            if above <= -outside:
                raise InputError(element.where, "no state at rest: the pressure is below vacuum", got=gauge)
            states.append(-np.log1p(above / outside) / n)
        elif kind == "tank":
            states.append(u - constants[0])
        elif kind == "rotor":
            states.append(1.0)
        elif kind == "vapour":
            if u < constants[0]:
                raise InputError(element.where, "no state at rest: the liquid boils", got=gauge)
            states.append(0.0)
        elif kind == "air":
            if u < constants[0]:
                raise InputError(element.where, "no state at rest: it draws air", got=gauge)
            states += [0.0, 0.0]
    return np.array(states, float)


def _impedance(node: Node) -> float:
    if node.held is not None:
        return 0.0
    return -1.0 if node.dead else 1 / node.total
