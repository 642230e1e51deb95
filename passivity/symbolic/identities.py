"""The two identities that carry passivity along a line, derived for symbols and checked exactly, step by step.

With G2 = x + jy and H1 = a + jb, all four parts real,

    H2 = (G2 - 1)/(G2 + 1):     |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2,
    G1 = (1 - H1)/(1 + H1):     2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2.

So |H2| <= 1 where Re G2 >= 0, and Re G1 >= 0 where |H1| <= 1; and the other way round. Both sides of each step are
quotients of polynomials in the two parts, the left side computed from the definitions, the right side read as it is
printed; that they are the same polynomial after multiplying out is an identity, not a sample.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from passivity.expression.parse import parse
from passivity.symbolic.assumption import Range
from passivity.symbolic.domain import Domain
from passivity.symbolic.expand import Expansion, Pair


class Identity(NamedTuple):
    """One step of a derivation.

    Parameters
    ----------
    text : str
        What it says, in the quantities of the line.
    parts : str
        The right side in real and imaginary parts.
    left, right : Pair
        Both sides as quotients of polynomials: from the definitions, and from `parts`.
    """

    text: str
    parts: str
    left: Pair
    right: Pair

    @property
    def holds(self) -> bool:
        """Whether both sides are the same."""
        return self.left.p * self.right.q == self.right.p * self.left.q

    def __str__(self) -> str:
        return f"{self.text} = {self.parts}"


@dataclass(frozen=True)
class _Complex:
    """A complex number whose parts are quotients of polynomials."""

    ring: Expansion
    re: Pair
    im: Pair

    def __add__(self, other: "_Complex") -> "_Complex":
        return _Complex(self.ring, self.ring.sum(self.re, other.re), self.ring.sum(self.im, other.im))

    def __mul__(self, other: "_Complex") -> "_Complex":
        (a, b), (c, d), by = (self.re, self.im), (other.re, other.im), self.ring.product
        return _Complex(self.ring, self.ring.sum(by(a, c), _minus(by(b, d))), self.ring.sum(by(a, d), by(b, c)))

    def __neg__(self) -> "_Complex":
        return _Complex(self.ring, _minus(self.re), _minus(self.im))

    def __truediv__(self, other: "_Complex") -> "_Complex":
        above, unit = self * other.conjugate(), other.square().inverse()
        return _Complex(self.ring, self.ring.product(above.re, unit), self.ring.product(above.im, unit))

    def conjugate(self) -> "_Complex":
        return _Complex(self.ring, self.re, _minus(self.im))

    def square(self) -> Pair:
        """The square of its modulus."""
        return (self * self.conjugate()).re


def _minus(a: Pair) -> Pair:
    return Pair(-a.p, a.q)


def _symbols(re: str, im: str) -> tuple[Expansion, _Complex, _Complex]:
    """The quotients of polynomials in two symbols, 1, and the number that has the symbols as parts."""
    ring = Expansion(Domain((Range(re), Range(im))), {})
    one = _Complex(ring, ring.number(Fraction(1)), ring.number(Fraction(0)))
    return ring, one, _Complex(ring, ring.values[re], ring.values[im])


def reflection_identity() -> list[Identity]:
    """|H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 for G2 = x + jy, H2 = (G2 - 1)/(G2 + 1), the last of several steps.

    Examples
    --------
    >>> for step in reflection_identity():
    ...     print(step, step.holds)
    |G2 + 1|^2 = (x + 1)^2 + y^2 True
    |G2 - 1|^2 = (x - 1)^2 + y^2 True
    |G2 + 1|^2 - |G2 - 1|^2 = 4 Re G2 = 4*x True
    |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 = 1 - 4*x/((x + 1)^2 + y^2) True
    """
    ring, one, g2 = _symbols("x", "y")
    below, above = (g2 + one).square(), (g2 + -one).square()
    h2 = (g2 + -one) / (g2 + one)
    steps = [
        ("|G2 + 1|^2", "(x + 1)^2 + y^2", below),
        ("|G2 - 1|^2", "(x - 1)^2 + y^2", above),
        ("|G2 + 1|^2 - |G2 - 1|^2 = 4 Re G2", "4*x", ring.sum(below, _minus(above))),
        ("|H2|^2 = 1 - 4 Re G2/|G2 + 1|^2", "1 - 4*x/((x + 1)^2 + y^2)", h2.square()),
    ]
    return [Identity(text, parts, left, ring.of(parse(parts))) for text, parts, left in steps]


def admittance_identity() -> list[Identity]:
    """2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2 for H1 = a + jb, G1 = (1 - H1)/(1 + H1), the last of several steps.

    Examples
    --------
    >>> for step in admittance_identity():
    ...     print(step, step.holds)
    |1 + H1|^2 = (1 + a)^2 + b^2 True
    Re (1 - H1) conj(1 + H1) = 1 - |H1|^2 = 1 - (a^2 + b^2) True
    Im (1 - H1) conj(1 + H1) = -2 Im H1 = -2*b True
    2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2 = 2*(1 - (a^2 + b^2))/((1 + a)^2 + b^2) True
    """
    ring, one, h1 = _symbols("a", "b")
    product = (one + -h1) * (one + h1).conjugate()
    g1 = (one + -h1) / (one + h1)
    steps = [
        ("|1 + H1|^2", "(1 + a)^2 + b^2", (one + h1).square()),
        ("Re (1 - H1) conj(1 + H1) = 1 - |H1|^2", "1 - (a^2 + b^2)", product.re),
        ("Im (1 - H1) conj(1 + H1) = -2 Im H1", "-2*b", product.im),
        ("2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2", "2*(1 - (a^2 + b^2))/((1 + a)^2 + b^2)", ring.sum(g1.re, g1.re)),
    ]
    return [Identity(text, parts, left, ring.of(parse(parts))) for text, parts, left in steps]
