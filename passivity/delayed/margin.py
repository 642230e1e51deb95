"""How near a function comes to the border on the axis."""

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from passivity.delayed.disc import RIGHT, UNIT
from passivity.delayed.form import Form
from passivity.delayed.proof import ProofStep
from passivity.delayed.search import lowest
from passivity.delayed.value import exact_value
from passivity.status import Kind


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

    @property
    def is_enclosed(self) -> bool:
        """Whether the two ends make an enclosure, or the value is only the worst of the samples."""
        return self.bound is not None


def axis_value(kind: Kind, form: Form, proof: ProofStep | None) -> AxisValue | None:
    """The worst value found on the axis, with the bound that a proof gives; None where there are no values.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> found = axis_value(Kind.PR, of_text("2 + exp(-s)"), None)
    >>> round(found.frequency, 6), found.is_enclosed
    (3.141593, False)
    """
    frequency = lowest(kind, form)
    if frequency is None:
        return None
    there = exact_value(form, Fraction(0), Fraction(frequency))
    if not there.is_finite():
        return None
    attained = there.real if kind is Kind.PR else abs(there)
    return AxisValue(attained, _bound(kind, proof), frequency)


def _bound(kind: Kind, proof: ProofStep | None) -> Fraction | None:
    if proof is None:
        return None
    if kind is Kind.PR:
        return Fraction(proof.disc.low) if proof.within(RIGHT) else None
    return Fraction(proof.disc.radius) if proof.within(UNIT) else None
