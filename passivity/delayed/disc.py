"""Discs and half-planes symmetric about the real axis, given by where they cross it."""

import math
from dataclasses import dataclass
from fractions import Fraction

from passivity.ball import Real, of_fraction
from passivity.size import MAX_BITS, bits_of


@dataclass(frozen=True, slots=True)
class Disc:
    """The closed disc with the diameter from `low` to `high`; a half-plane if one of them is infinite.

    Sums, multiples and inverses of such discs are discs, found from the two ends as if they were intervals.

    Examples
    --------
    >>> half = Disc(Fraction(0), Fraction(2)).inverse()  # 1/(1 + w) for |w| <= 1
    >>> half.low, half.high
    (Fraction(1, 2), inf)
    """

    low: Real
    high: Real

    def __le__(self, other: "Disc") -> bool:
        return other.low <= self.low and self.high <= other.high

    def __add__(self, other: "Disc") -> "Disc":
        return Disc(_plus(self.low, other.low), _plus(self.high, other.high))

    def scaled(self, c: Fraction) -> "Disc":
        """The disc times a number other than zero."""
        ends = _times(self.low, c), _times(self.high, c)
        return Disc(min(ends), max(ends))

    def inverse(self) -> "Disc | None":
        """All 1/w; None where 0 is inside, so that infinity would be, or where 0 is all there is."""
        if self.low < 0 < self.high or self.low == self.high == 0:
            return None
        if self.low >= 0:
            return Disc(_inverse(self.high), _inverse(self.low))
        return Disc(-_inverse(-self.high), -_inverse(-self.low))

    @property
    def radius(self) -> Real:
        """The largest modulus in it."""
        return max(-self.low, self.high)

    @property
    def width(self) -> Real:
        """The diameter."""
        return _plus(self.high, -self.low)

    def __str__(self) -> str:
        if self.high == math.inf:
            return f"Re >= {_text(self.low)}"
        if self.low == -math.inf:
            return f"Re <= {_text(self.high)}"
        if self.low == -self.high:
            return f"| | <= {_text(self.high)}"
        return f"in the disc on [{_text(self.low)}, {_text(self.high)}]"


def _plus(x: Real, y: Real) -> Real:
    return x if isinstance(x, float) else y if isinstance(y, float) else x + y  # long fractions are no floats


def _times(x: Real, c: Fraction) -> Real:
    return x * (1 if c > 0 else -1) if isinstance(x, float) else x * c


def _inverse(x: Real) -> Real:
    if x == math.inf:
        return Fraction(0)
    return 1 / x if x else math.inf


def power_of_bound(x: Real, e: int) -> Real:
    """A modulus to a power e > 0, infinite where it would have too many digits."""
    return x**e if isinstance(x, Fraction) and (bits_of(x) == 1 or bits_of(x) * e <= MAX_BITS) else math.inf


def _text(x: Real) -> str:
    """The number, or what it is about where that is shorter."""
    exact = Fraction(x)
    if max(abs(exact.numerator), exact.denominator) < 10**9:
        return str(exact)
    return f"about {of_fraction(exact).str(9, radius=False)}"


RIGHT = Disc(Fraction(0), math.inf)  # Re >= 0
UNIT = Disc(Fraction(-1), Fraction(1))  # modulus at most 1
