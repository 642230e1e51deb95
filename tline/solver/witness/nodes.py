"""Balances of flow at the nodes of a scene, from the equations of the elements there as a textbook writes them.

Nothing here depends on slabs, waves, kinks, or the solver's treatment of laws in circuits: the scene is the only
input that both share.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.given import ElementLaw, Multiport, Ratio, Shape, Source, Volume

MOST_NODES, MOST_ENDS = 6, 4  # nodes that are checked, and line ends at each of them
Flow = Callable[[NDArray, NDArray], NDArray]  # at instants and efforts across


Equation = Flow | Ratio | Volume  # a ratio: den(D) e = num(D) i, with D the derivative


def equation_of(element: Any) -> Equation | None:
    """Return the equation of a load or link; None if it is unknown or its flow does not follow from its effort."""
    kind, law = element.kind, getattr(element, "law", None)
    if kind in ("open", "closed"):
        return lambda t, e: 0.0 * e
    if kind in ("switch", "valve"):
        before, after, instant = float(element.before), float(element.after), float(element.time)
        return (lambda t, e: e / np.where(t < instant, before, after)) if before and after else None
    if kind in ("inductor", "capacitor", "series", "parallel", "impedance") and element.ratio.degree:
        large = max(abs(number) for side in element.ratio for number in side) > 10**300
        return None if large else element.ratio
    if kind in ("resistor", "inductor", "capacitor", "series", "parallel", "impedance"):
        r = float(element.resistance) if kind == "resistor" else element.ratio.at_zero()
        return (lambda t, e: e / r) if r else None
    return None if law is None else _of_law(law())


def over_time(shape: Shape | None, t: NDArray) -> NDArray | float:
    """Value of an opening or scale at instants t; 1 without one."""
    return 1.0 if shape is None else np.maximum(shape.value(t, t), 0.0)


def _of_law(law: ElementLaw) -> Equation | None:
    if law.governor is not None:
        return None
    found, beyond = law.of_kind.flow(law.constants), law.constants[0]
    if found is None:
        return law.of_kind.volume(law.constants)

    def flow(t: NDArray, e: NDArray) -> NDArray:
        across = -e if law.reverse else e
        passed = over_time(law.factor, t) * found(across - beyond)
        return -passed if law.reverse else passed

    return flow


class Term(NamedTuple):
    """An element at a node: its equation, the node at its other side, and whether it points from there to here."""

    equation: Equation
    beyond: str | None = None  # None for the reference
    reversed: bool = False
    weight: float = 0.0  # effort at zero gauge pressure


@dataclass
class Balance:
    """Line ends, elements and prescribed effort at one node."""

    name: str
    ends: list[tuple[str, int]] = field(default_factory=list)
    flows: list[Term] = field(default_factory=list)
    stores: list[Term] = field(default_factory=list)
    held: Callable[[NDArray], NDArray] | None = None  # effort at instants
    known: bool = True  # whether the equations of all elements there are known

    def add(self, term: Term | None) -> None:
        """Attach an element; None stands for one whose equation is unknown."""
        if term is None:
            self.known = False
        else:
            (self.flows if callable(term.equation) else self.stores).append(term)

    def hold(self, effort: Callable[[NDArray], NDArray]) -> None:
        """Prescribe the effort."""
        self.known &= self.held is None
        self.held = effort


def balances_of(description: Description) -> dict[str, Balance]:
    """Return the balances of all nodes with line ends, by name."""
    found: dict[str, Balance] = {}
    for name, line in description.lines.items():
        for end, node in enumerate(line.nodes):
            found.setdefault(node, Balance(node)).ends.append((name, end))
    for end in description.ends:
        for node in {*end.conductors, *end.modal} & found.keys():
            found[node].known = False
    weights = {node: height.weight for node, height in description.scene.heights.items()}
    for load in description.scene.loads.values():
        if load.at in found:
            _attach(found[load.at], load, description, weights.get(load.at, 0.0))
    for link in description.scene.links.values():
        _join(found, link)
    for source in description.scene.sources.values():
        _drive(found, source, weights)
    return found


def _attach(here: Balance, load: Any, description: Description, weight: float) -> None:
    if load.kind in ("short", "reservoir"):
        level = weight if load.kind == "short" else float(load.pressure)
        here.hold(lambda t: np.full_like(t, level))
        return
    if load.kind == "matched":
        conductance = sum(1 / description.lines[name].z0 for name, _ in here.ends)
        here.add(Term(lambda t, e: e * conductance, weight=weight))
        return
    equation = equation_of(load)
    here.add(None if equation is None else Term(equation, weight=weight))


def _join(found: Mapping[str, Balance], link: Any) -> None:
    equation = equation_of(link) if len(link.nodes) == 2 and not isinstance(link, Multiport) else None
    for here, there in zip(link.nodes, reversed(link.nodes), strict=True):
        if here in found:
            found[here].add(None if equation is None else Term(equation, there, here == link.nodes[-1]))


def _drive(found: Mapping[str, Balance], source: Source, weights: Mapping[str, float]) -> None:
    plus, minus = source.terminals
    value, conductance = source.value, source.conductance
    if source.is_effort and conductance == inf:
        if minus is None and plus in found:
            found[plus].hold(lambda t: value.value(t, t))
        for node in {plus, minus} & found.keys() if minus is not None else ():
            found[node].add(None)
        return
    factor = conductance if source.is_effort else 1.0
    for here, there, sign in ((plus, minus, 1.0), (minus, plus, -1.0)):
        if here is not None and here in found:
            weight = weights.get(here, 0.0) if there is None and not source.is_effort else 0.0

            def drawn(t: NDArray, e: NDArray, by: float = sign * factor) -> NDArray:
                return e * conductance - by * value.value(t, t)

            found[here].add(Term(drawn, there, weight=weight))


def watched(description: Description, lumped: Collection[str]) -> list[Balance]:
    """Select the nodes to check: first those at probes and those with elements, busiest first.

    Waves in lumped lines are unknown.
    """
    found = balances_of(description)
    probed = {node for name in description.probed for node in description.lines[name].nodes}
    good = [one for one in found.values() if one.known and 0 < len(one.ends) <= MOST_ENDS and len(one.stores) <= 1]
    good = [one for one in good if _seen(one, found, lumped)]

    def first(one: Balance) -> tuple[bool, bool, int]:
        busy = len(one.flows) + len(one.stores)
        return one.name not in probed, not busy, -busy

    return sorted(good, key=first)[:MOST_NODES]


def _seen(one: Balance, found: Mapping[str, Balance], lumped: Collection[str]) -> bool:
    """Whether waves at the node and efforts across its links are known: no line there is lumped."""
    beyond = {term.beyond for term in (*one.flows, *one.stores) if term.beyond is not None}
    each = [one, *(found[node] for node in beyond if node in found)]
    return len(each) == len(beyond) + 1 and not any(name in lumped for here in each for name, _ in here.ends)


def lines_at(nodes: Collection[Balance], description: Description) -> list[str]:
    """Lines whose waves the balances need: all at these nodes, and one at the far node of each link."""
    names = [name for one in nodes for name, _ in one.ends]
    beyond = {term.beyond for one in nodes for term in (*one.flows, *one.stores)} - {None}
    for node in sorted(str(node) for node in beyond):
        at = [name for name, line in description.lines.items() if node in line.nodes]
        if not set(at) & set(names):
            names.append(at[0])
    return list(dict.fromkeys(names))
