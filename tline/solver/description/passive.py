"""Passivity of the circuits between line ends, and the active elements of a scene.

Power into a circuit flows into its elements, so a circuit of passive elements is passive. With active ones its
scattering matrix at the line ends is found exactly, from the numbers as typed. Elements whose passivity rests on more
than these numbers, such as laws, switches and measured data, stay outside, with ports at their nodes: a rest that is
passive is passive with them too.

All the power that a scene absorbs is one function of s. With efforts and flows that grow as exp(s t), Re s > 0, the
power of sources is the real part of Σ w Z, w = |i|² >= 0 for the flow i through each impedance Z, because nodes absorb
nothing. A uniform line is two of them, z0 coth(Γ/2) for the even mode of its ends and z0 tanh(Γ/2) for the odd one.
Parts without a formula (laws, losses that are not constant, multiports, circuits that are passive though an element is
not) are names assumed to be positive real.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from passivity.status import Decided, Status
from tline.loss import ConstantLoss
from tline.scene.element import Measured
from tline.scene.load import Matched, NoFlow, Reservoir, Short
from tline.scene.multiport import Junction
from tline.scene.ports import Multiport
from tline.scene.rational import RationalImpedance, Resistor
from tline.solver.description.elements import active_impedances, controlled_sources
from tline.solver.description.given import Scene
from tline.solver.description.groups import parts
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import RationalFunction, RationalMatrix
    from passivity.calculus.given import Structure


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
        case Measured() | Junction():
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
                why = "all that stands there is passive, sources apart"
                found.append(CircuitVerdict(where, nodes, Status.PROVED, why))
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
    undecided = partial(CircuitVerdict, where, nodes, Status.UNDECIDED, ports=ports)
    if not 0 < len(ports) <= MOST_PORTS:
        return undecided(f"{len(ports)} ports; 1 to {MOST_PORTS} are decided")
    try:
        with budget(2 * VERDICT):
            matrix = _scattering(nodes, ports, [element for element in elements if element not in outside], z0)
            if matrix is None:
                return undecided("no scattering matrix follows from its elements")
            verdict = check_bounded_real(matrix)
    except UndecidedError as error:
        return undecided(str(error))
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


def taken_power(scene: Scene, circuits: Sequence[CircuitVerdict] | None = None) -> "Structure | CircuitVerdict":
    """Power absorbed by a scene with zero sources, as a text in s, or the verdict on a circuit that is not passive.

    Parameters
    ----------
    scene : Scene
    circuits : sequence of CircuitVerdict, optional
        All of its circuits, if they are known.

    Returns
    -------
    Structure or CircuitVerdict
        Arguments of `passivity.is_positive_real`: `text`, `assume` of the names in it, and the resulting `statement`.

    Examples
    --------
    >>> import tline as tl
    >>> tl.frequency.taken_power(tl.read("scenes/diode_clamp.toml")).statement
    'the power that the scene takes up, a sum over its parts, is positive real, p0 the links.clamp'
    """
    from passivity import Status
    from passivity.calculus.given import Structure

    suspect = {*active_impedances(scene), *(place("links", name) for name in controlled_sources(scene))}
    circuits = passive_circuits(scene, suspect) if circuits is None else circuits
    for status in (Status.REFUTED, Status.UNDECIDED):
        wrong = [circuit for circuit in circuits if circuit.status is status]
        if wrong:
            return wrong[0]
    decided = {where for circuit in circuits if circuit.scattering is not None for where in circuit.elements}
    names = [f"circuit of {', '.join(circuit.elements)}" for circuit in circuits if circuit.scattering is not None]
    terms: list[str] = []
    for where, text in _parts(scene):
        if where in decided:
            continue
        if where in suspect:
            return Structure(text, (), f"{where} is positive real")
        if text:
            terms.append(f"w{len(terms)}*{text}")
        else:
            names.append(where)
    weights = [f"w{k} >= 0" for k in range(len(terms))]
    opaque = [f"p{k}" for k in range(len(names))]
    known = "".join(f", {name} the {where}" for name, where in zip(opaque, names, strict=True))
    statement = f"the power that the scene takes up, a sum over its parts, is positive real{known}"
    return Structure(
        " + ".join([*terms, *opaque]) or "0", (*weights, *(f"{p} positive real" for p in opaque)), statement
    )


def _parts(scene: Scene) -> Iterator[tuple[str, str]]:
    """Place and impedance of each part, which is empty where there is no text; of each line two."""
    for element in exact_elements(scene):
        found = element.equations and one_port(*element.equations)
        if not found:
            yield element.where, ""
        elif not (found[0].is_zero or found[1].is_zero):  # else there is no effort, or no flow
            yield element.where, f"{found[0] / found[1]}"
    for name, line in scene.lines.items():
        if getattr(line, "mixing", False):
            yield f"losses between conductors of {place('lines', name)}", ""
    for name, line in scene.single_lines.items():
        losses = line.losses
        laws = (losses.exact.series, losses.exact.shunt) if losses else ()
        if losses and losses.flow_law is not None:
            yield f"friction in {place('lines', name)}", ""
        if not all(isinstance(law, ConstantLoss) for law in laws):
            yield place("lines", name), ""
            continue
        z0, half = _exact(line.parameters.z0), f"{_exact(line.parameters.delay or 0.0) / 2}*s"
        if losses and any(law.loss for law in laws):
            series, shunt = (f"({_exact(law.loss)} + {_exact(law.storage)}*s)" for law in laws)
            z0, half = f"sqrt({series}/{shunt})", f"{_exact(losses.exact.length) / 2}*sqrt({series}*{shunt})"
        yield place("lines", name), f"line({z0}, {half}, 0)"
        yield place("lines", name), f"(1/line(1/({z0}), {half}, 0))"


def _exact(x: float) -> Fraction:
    return Fraction(repr(float(x)))
