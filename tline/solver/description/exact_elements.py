"""Linear elements of a scene with exact coefficients, from the numbers as typed; and which elements are none."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.load import Matched, NoFlow, Reservoir, Resistor, Short
from tline.scene.multiport import Junction, Multiport
from tline.scene.rational import RationalImpedance
from tline.scene.touchstone import MeasuredMultiport, Touchstone
from tline.solver.description.given import Scene
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import RationalFunction

Matrix = Sequence[Sequence["RationalFunction"]]


class ExactElement(NamedTuple):
    """Where it stands, and M and N of M u + N i = 0; none of laws, switches and what is passive to rounding only."""

    where: str
    nodes: Sequence[str]
    equations: tuple[Matrix, Matrix] | None


def exact_elements(scene: Scene) -> Iterator[ExactElement]:
    """All loads and links, and sources, which are silent."""
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
    """Numerator and denominator."""
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
    """Of M u + N i = E x and dx/dt = P u + R i, s (M u + N i) = E (P u + R i)."""
    from passivity import RationalFunction

    typed = np.vectorize(lambda x: Fraction(repr(float(x))), otypes=[object])
    M, N, E, _, P, R = map(typed, element.ports())

    def exact(now: NDArray, rates: NDArray) -> Matrix:
        both = zip(now, rates, strict=True)
        return [[RationalFunction.from_coefficients([a, -b], [1]) for a, b in zip(*rows, strict=True)] for rows in both]

    return exact(M, E @ P), exact(N, E @ R)
