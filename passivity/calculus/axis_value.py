"""How near a function comes to the border on the axis."""

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from passivity.calculus.proof import Proof, sharpest
from passivity.calculus.search import Search
from passivity.calculus.values import at_point
from passivity.calculus.witness import Question


class AxisValue(NamedTuple):
    """The smallest Re Z(jw), or the largest |H(jw)|, between a value that is attained and one that is not passed.

    Parameters
    ----------
    attained : arb
        At `frequency`, which was found by sampling; a ball.
    bound : Fraction or None
        Proved for all of Re s > 0; None if nothing is, and then `attained` is a sampled value.
    frequency : float
        Angular frequency, rad/s.
    """

    attained: arb
    bound: Fraction | None
    frequency: float


def axis_value(question: Question, proof: Proof | None) -> AxisValue | None:
    """The worst value found on the axis, with the bound that a proof gives; None where there are no values.

    Examples
    --------
    >>> from passivity.calculus.graph import POSITIVE_REAL, Graph
    >>> from passivity.calculus.read import read
    >>> graph = Graph()
    >>> found = axis_value(Question(graph, read(graph, "2 + exp(-s)"), POSITIVE_REAL, "2 + exp(-s)", {}), None)
    >>> round(found.frequency, 6), found.bound
    (3.141593, None)
    """
    frequency = Search(question, {}).lowest()
    if frequency is None:
        return None
    there = at_point(question.graph, question.value, Fraction(0), Fraction(frequency))
    if not there.is_finite():
        return None
    attained = abs(there) if question.bounded else there.real
    return AxisValue(attained, sharpest(proof) if proof else None, frequency)
