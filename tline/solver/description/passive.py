"""Passivity of the circuits between line ends, and the active elements of a scene.

Power into a circuit flows into its elements, so a circuit of passive elements is passive. With active ones its
scattering matrix at the line ends is found exactly, from the numbers as typed. Elements whose passivity rests on more
than these numbers, such as laws, switches and measured data, stay outside, with ports at their nodes: a rest that is
passive is passive with them too.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from statistics import median
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from passivity.status import Decided, Status
from tline.scene.load import Matched, NoFlow, Reservoir, Resistor, Short
from tline.scene.multiport import Junction, Multiport
from tline.scene.rational import RationalImpedance
from tline.scene.touchstone import MeasuredMultiport, Touchstone
from tline.solver.description.given import Scene
from tline.solver.description.groups import parts
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import RationalFunction, RationalMatrix

Matrix = Sequence[Sequence["RationalFunction"]]
MOST_PORTS = 12  # as many as are decided


class ExactElement(NamedTuple):
    """Element with exact M and N of M u + N i = 0; None for laws, switches and elements passive only to rounding."""

    where: str
    nodes: Sequence[str]
    equations: tuple[Matrix, Matrix] | None


def exact_elements(scene: Scene) -> Iterator[ExactElement]:
    """Yield all loads and links, and sources with zero value."""
    for (part, name), element in scene.placed:
        nodes = element.nodes if part == "links" else (element.at,)
        yield ExactElement(place(part, name), nodes, _equations(scene, element, len(nodes)))
    for name, source in scene.sources.items():
        nodes = [node for node in source.terminals if node is not None]
        resistance = source.resistance if source.resistance is not None else 0.0 if source.is_effort else np.inf
        yield ExactElement(place("sources", name), nodes, _impedance(*_resistance(float(resistance)), len(nodes)))


def _equations(scene: Scene, element: Any, terminals: int) -> tuple[Matrix, Matrix] | None:
    match element:
        case Touchstone() | MeasuredMultiport() | Junction():
            return None
        case RationalImpedance():
            impedance = element.rational().reduced()
            return _impedance(impedance.numerator, impedance.denominator, terminals)
        case NoFlow() | Resistor() | Short() | Reservoir():
            ideal = np.inf if isinstance(element, NoFlow) else 0.0
            return _impedance(*_resistance(float(getattr(element, "resistance", ideal))), terminals)
        case Matched():
            (line,) = (line for line in scene.lines.values() if element.at in line.nodes)
            return _impedance(*_resistance(line.parameters.z0), terminals)
        case Multiport():
            return _multiport(element)
    return None


def _resistance(r: float) -> tuple[Sequence[Fraction], Sequence[Fraction]]:
    return ([Fraction(1)], [Fraction(0)]) if np.isinf(r) else ([Fraction(repr(r))], [Fraction(1)])


def _impedance(numerator: Sequence[Fraction], denominator: Sequence[Fraction], terminals: int) -> tuple[Matrix, Matrix]:
    """p i = q u, from the only terminal to the reference, or from the first to the second."""
    from passivity import RationalFunction

    p, q = (RationalFunction.from_coefficients(side, [1]) for side in (numerator, denominator))
    none, one = RationalFunction.constant(Fraction(0)), RationalFunction.constant(Fraction(1))
    if terminals == 1:
        return [[q]], [[-p]]
    return [[q, -q], [none, none]], [[-p, none], [one, one]]


def one_port(M: Matrix, N: Matrix) -> "tuple[RationalFunction, RationalFunction] | None":
    """p and q of an impedance p/q with these equations, None if they are of no impedance."""
    (q, *minus), (p, *none) = M[0], N[0]
    across = len(M) == 2 and minus == [-q] and all(x.is_zero for x in (*none, *M[1])) and N[1][0] == N[1][1]
    return (-p, q) if len(M) == 1 or (across and not N[1][0].is_zero) else None


def _multiport(element: Multiport) -> tuple[Matrix, Matrix]:
    """Matrices of s (M u + N i) = E (P u + R i), from M u + N i = E x and dx/dt = P u + R i."""
    from passivity import RationalFunction

    typed = np.vectorize(lambda x: Fraction(repr(float(x))), otypes=[object])
    M, N, E, _, P, R = map(typed, element.ports())

    def exact(now: NDArray, rates: NDArray) -> Matrix:
        both = zip(now, rates, strict=True)
        return [[RationalFunction.from_coefficients([a, -b], [1]) for a, b in zip(*rows, strict=True)] for rows in both]

    return exact(M, E @ P), exact(N, E @ R)


@dataclass(frozen=True)
class CircuitVerdict(Decided):
    """Verdict on the passivity of a circuit at its ports, with its scattering matrix if it was needed."""

    elements: Sequence[str]
    nodes: Sequence[str]
    status: Status
    why: str
    ports: Sequence[str] = ()
    z0: Fraction = Fraction(1)
    scattering: "RationalMatrix | None" = None


def passive_circuits(scene: Scene, active: set[str]) -> list[CircuitVerdict]:
    """Verdicts of all circuits of two elements or more, with silent sources.

    `active` has the places of elements that are refuted to be passive, or may not be.
    """

    elements = list(exact_elements(scene))
    names = list(dict.fromkeys(node for element in elements for node in element.nodes))
    number = {name: k for k, name in enumerate(names)}
    pairs = [(number[element.nodes[0]], number[node]) for element in elements for node in element.nodes]
    first, second = np.array(pairs, int).reshape(-1, 2).T
    part = parts(first, second, len(names))
    found = []
    for k in range(part.max(initial=-1) + 1):
        within = [element for element in elements if part[number[element.nodes[0]]] == k]
        where = [element.where for element in within]
        nodes = [name for name in names if part[number[name]] == k]
        if active.isdisjoint(where):
            if len(nodes) > 1:
                found.append(
                    CircuitVerdict(where, nodes, Status.PROVED, "all that stands there is passive, sources apart")
                )
        elif len(within) > 1 or len(nodes) > 1:
            found.append(_decided(scene, nodes, within))
    return found


def _decided(scene: Scene, nodes: Sequence[str], elements: Sequence[ExactElement]) -> CircuitVerdict:
    from passivity import check_bounded_real
    from passivity.budget import VERDICT, UndecidedError, budget

    where = [element.where for element in elements]
    outside = [element for element in elements if element.equations is None]
    ends = {node for line in scene.lines.values() for node in line.nodes}
    ends |= {node for element in outside for node in element.nodes}
    ports = [node for node in nodes if node in ends]
    z0 = Fraction(f"{median(line.parameters.z0 for line in scene.single_lines.values()):.0e}")
    if not 0 < len(ports) <= MOST_PORTS:
        return CircuitVerdict(
            where, nodes, Status.UNDECIDED, f"{len(ports)} ports; 1 to {MOST_PORTS} are decided", ports
        )
    try:
        with budget(2 * VERDICT):
            matrix = _scattering(nodes, ports, [element for element in elements if element not in outside], z0)
            if matrix is None:
                return CircuitVerdict(
                    where, nodes, Status.UNDECIDED, "no scattering matrix follows from its elements", ports
                )
            verdict = check_bounded_real(matrix)
    except UndecidedError as error:
        return CircuitVerdict(where, nodes, Status.UNDECIDED, str(error), ports)
    status, why = verdict.status, verdict.why
    if outside and status is Status.REFUTED:
        without = " and ".join(element.where for element in outside)
        status, why = Status.UNDECIDED, f"refuted without {without}, which may take up what it gives: {why}"
    return CircuitVerdict(where, nodes, status, why, ports, z0, matrix)


def _scattering(
    nodes: Sequence[str], ports: Sequence[str], elements: Sequence[ExactElement], z0: Fraction
) -> "RationalMatrix | None":
    """S of a circuit, all ports referred to z0; None if no efforts follow from the waves."""
    from passivity import RationalFunction, RationalMatrix

    one, n = RationalFunction.constant(Fraction(1)), len(nodes) + sum(len(element.nodes) for element in elements)
    balances = [{k: one, n + ports.index(node): one} if node in ports else {} for k, node in enumerate(nodes)]
    rows, flow = [*balances], len(nodes)
    for element in elements:
        at = [nodes.index(node) for node in element.nodes]
        for through, binding in zip(*(element.equations or ()), strict=True):
            row: dict[int, RationalFunction] = {}
            for k, x in [*zip(at, through, strict=True), *enumerate(binding, flow)]:
                row[k] = row[k] + x if k in row else x
            rows.append({k: x for k, x in row.items() if not x.is_zero})
        for k, node in enumerate(at, flow):
            balances[node][k] = one * (z0 if nodes[node] in ports else 1)
        flow += len(at)
    efforts = _solved(rows, n)
    if efforts is None:
        return None
    seen = [efforts[nodes.index(port)] for port in ports]
    unit = [[RationalFunction.constant(Fraction(j == k)) for k in range(len(ports))] for j in range(len(ports))]
    return RationalMatrix(
        tuple(
            tuple((2 * row[n + k] - x if n + k in row else -x).reduced() for k, x in enumerate(ones))
            for row, ones in zip(seen, unit, strict=True)
        )
    )


def _solved(rows: "list[dict[int, RationalFunction]]", n: int) -> "Mapping[int, Mapping[int, RationalFunction]] | None":
    """Each of n unknowns by the columns beyond, by Gauss and Jordan with the sparsest row first; None if singular."""
    from passivity.budget import spend

    left, solved = list(rows), {}
    while left:
        row = min(left, key=lambda each: sum(k < n for k in each))
        left.remove(row)
        unknown = [k for k in row if k < n]
        if not unknown:
            return None
        pivot = min(unknown, key=lambda k: (row[k].degree, row[k].bits))
        scale = row.pop(pivot)
        row = {k: (x / scale).reduced() for k, x in row.items()}
        for other in (*left, *solved.values()):
            if pivot in other:
                factor = other.pop(pivot)
                for k, x in row.items():
                    spend(10_000 + (factor.degree + 1) * (x.degree + 1) * (factor.bits + x.bits), "its matrix")
                    more = (other[k] - factor * x if k in other else -factor * x).reduced()
                    other.pop(k, None)
                    if not more.is_zero:
                        other[k] = more
        solved[pivot] = row
    return solved
