"""Quasi-polynomials f(s) = sum of exp(-T s) p(s): their values in balls, their size far out, their zeros counted.

On |s| >= R, Re s >= 0, with the highest power s^d and its coefficient c at T = 0, f(s)/s^d differs from c by at most
the sum of all other coefficients, each times the power of R that belongs to it, because |exp(-T s)| <= 1. Where that is
less than |c|, all zeros of the half-plane lie in the half disc of radius R, and the argument principle counts them.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import acb, arb, arb_poly, ctx

from passivity.ball import of_fraction
from passivity.budget import UndecidedError, spend
from passivity.errors import ExpressionError, shown
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction

MAX_PIECES = 10_000
BITS = 80
_J = acb(0, 1)
_MAX_DOUBLINGS = 400


@dataclass(frozen=True)
class QuasiPolynomial:
    """The sum of exp(-T s) p(s), as pairs (T, p); the T are distinct, the least is 0, T = 0 comes first."""

    terms: tuple[tuple[arb, arb_poly], ...]
    orders: tuple[int, ...] = ()  # k of exp(-k T s) in each, where all are powers of one

    def __call__(self, s: acb) -> acb:
        """A ball with the values in a ball."""
        spend(sum(3_000 + 300 * len(p) for _, p in self.terms), "the values on the axis")
        return sum(((-s * delay).exp() * p(s) for delay, p in self.terms), acb(0))

    def derivative(self) -> "QuasiPolynomial":
        """Derivative."""
        return QuasiPolynomial(tuple((delay, p.derivative() - p * arb_poly([delay])) for delay, p in self.terms))

    @property
    def degree(self) -> int:
        """The highest power of s."""
        return max(p.degree() for _, p in self.terms)

    def leading(self) -> list[arb]:
        """Coefficients of the highest power of s, by powers of the one exponential."""
        found = [arb(0)] * (1 + max(self.orders))
        for k, (_, p) in zip(self.orders, self.terms, strict=True):
            found[k] = p[self.degree]
        return found

    def far(self, radius: Fraction, degree: int) -> tuple[arb, arb]:
        """Coefficient of s^degree at T = 0, and a bound of all else in f/s^degree for |s| >= radius, Re s >= 0."""
        unit, rest, leading = arb(radius.denominator) / radius.numerator, arb(0), arb(0)
        spend(sum(1_000 + 500 * len(p) for _, p in self.terms), "the values far out")
        for delay, p in self.terms:
            for k in range(p.degree() + 1):
                if k == degree and delay == 0:
                    leading = p[k]
                else:
                    rest += abs(p[k]) * unit ** (degree - k)
        return leading, rest


def roots_right(h2: RationalFunction, delay: Exact, sign: int) -> int | float:
    """Number of zeros of 1 + sign exp(-2Ts) H2(s) in Re s > 0, certified: the growing modes of a line with its ends.

    Parameters
    ----------
    h2 : RationalFunction
        Reflection at the far end; the open circuit 1/0 of the pair is refused.
    delay : int, float, Fraction, Decimal or str
        T, time from end to end, at least zero.
    sign : int
        1 where the effort is held at the input, -1 where the flow is.

    Returns
    -------
    int or float
        With multiplicities; ``math.inf`` where |H2| > 1 at high frequencies and T > 0.

    Raises
    ------
    UndecidedError
        If zeros lie on the axis, or so near that balls do not tell; always so where |H2| = 1 at high frequencies.
    ExpressionError
        For another delay or sign, or if the function is zero everywhere.

    Examples
    --------
    >>> h2 = RationalFunction.from_expression("2/(1 + s)")
    >>> roots_right(h2, "1/20", 1), roots_right(h2, "1/20", -1), roots_right(h2, 1, 1)
    (0, 1, 2)
    """
    travel = exact(delay, "delay")
    if travel < 0:
        raise ExpressionError("delay", "negative", "at least 0", shown(delay))
    if sign not in (1, -1):
        raise ExpressionError("sign", "neither sign", "1 or -1", shown(sign, repr))
    if h2.is_infinite:
        raise ExpressionError("h2", "infinite everywhere", "a reflection with a denominator")
    reduced = h2.reduced()
    p, q = sign * reduced.p, reduced.q
    if not travel and not p + q:
        raise ExpressionError("h2", "the function is zero everywhere", "1 + H1 or 1 - H1 that is not")
    ends = [abs(int(f.leading_coefficient())) for f in (p, q)]
    if travel and (p.degree() > q.degree() or (p.degree() == q.degree() and ends[0] > ends[1])):
        return math.inf
    with ctx.workprec(BITS):
        if not travel or not p:
            return _zeros_right(QuasiPolynomial(((arb(0), arb_poly(q + p)),)))
        return _zeros_right(QuasiPolynomial(((arb(0), arb_poly(q)), (of_fraction(2 * travel), arb_poly(p)))))


def _zeros_right(f: QuasiPolynomial) -> int:
    """Number of zeros in Re s > 0, with their multiplicities, by a certified winding number."""

    def dominated(radius: Fraction) -> bool:
        leading, rest = f.far(radius, f.degree)
        return bool(rest < abs(leading))

    def stuck(low: Fraction, high: Fraction) -> UndecidedError:
        return UndecidedError(f"a zero on the axis or too near to it, at ω = {float(low):.6g} to {float(high):.6g}")

    radius = least_radius(dominated)
    if radius is None:
        raise UndecidedError("far out the terms with delay are not smaller than that without")
    return winding(f, radius, cuts_of_axis(lambda s: not f(s).contains(0), radius, stuck))


def winding(f: QuasiPolynomial, radius: Fraction, cuts: list[Fraction]) -> int:
    """Turns of f around the half disc of a radius, f having no zeros far out nor on the pieces of the axis.

    Far out f/s^degree is near its leading part, which turns with one exponential at most, and nowhere vanishes.
    """
    turned = arb(0)
    values = [f(_J * of_fraction(w)) for w in cuts]
    for before, after in pairwise(values):
        turned += (after / before).arg()
    degree = f.degree
    leading, _ = f.far(radius, degree)
    beside = arb(0)
    if f.orders:
        part, unit = (
            arb_poly(f.leading()),
            next((t / k for k, (t, _) in zip(f.orders, f.terms, strict=True) if k), arb(0)),
        )
        z = (-_J * of_fraction(radius) * unit).exp()
        ways = cuts_of_axis(lambda t: not part(t / _J * z).contains(0), Fraction(1), _lost)
        steps = [part(z * of_fraction(t)) for t in ways]
        beside = sum(((after / before).arg() for before, after in pairwise(steps)), arb(0))
        leading = steps[-1]
    end = values[-1] / (_J * of_fraction(radius)) ** degree / leading
    whole = (degree * arb.pi() + 2 * (end.arg() + beside) - 2 * turned) / (2 * arb.pi())
    if (count := whole.unique_fmpz()) is None:
        raise UndecidedError("the winding number is not resolved")
    return int(count)


def _lost(low: Fraction, high: Fraction) -> UndecidedError:
    return UndecidedError("far out the leading part is not seen to be other than 0")


def least_difference(n: QuasiPolynomial, d: QuasiPolynomial) -> arb | None:
    """A bound below |D| - |N| for |z| <= 1, of the leading parts as polynomials in z, D without zeros there.

    None if balls tell of none. |N/D| and 1/|D| are largest on the circle, where real coefficients need half of it.
    """
    if not (n.orders and d.orders) or n.degree > d.degree:
        return None
    top, whole = (arb_poly(f.leading()) if f.degree == d.degree else arb_poly([]) for f in (n, d))
    bounds = []

    def is_clear(t: acb) -> bool:
        z = (t * arb.pi()).exp()
        room = abs(whole(z)) - abs(top(z))
        spend(2_000 * (len(whole) + len(top)), "the values far out")
        good = bool(room > 0) and bool(2 * room.lower() > room.upper())
        bounds.extend([room.lower()] * good)
        return good

    try:
        cuts = cuts_of_axis(is_clear, Fraction(1), _lost)
    except UndecidedError:
        return None
    values = [whole((_J * of_fraction(t) * arb.pi()).exp()) for t in cuts]
    turned = sum(((after / before).arg() for before, after in pairwise(values)), arb(0))
    return min(bounds) if abs(turned) < 1 else None


def pieces(cuts: list[Fraction]) -> Iterator[acb]:
    """Balls around the pieces of the axis between cuts."""
    return (on_axis(low, high) for low, high in pairwise(cuts))


def on_axis(low: Fraction, high: Fraction) -> acb:
    """A ball around a piece of the axis."""
    return _J * of_fraction(low).union(of_fraction(high))


def least_radius(is_far: Callable[[Fraction], bool]) -> Fraction | None:
    """Smallest power of 2 that is far out; None if none is."""
    far = next((k for k in range(_MAX_DOUBLINGS) if is_far(Fraction(2) ** k)), None)
    if far is None:
        return None
    while far > -_MAX_DOUBLINGS and is_far(Fraction(2) ** (far - 1)):
        far -= 1
    return Fraction(2) ** far


def cuts_of_axis(
    is_clear: Callable[[acb], bool], radius: Fraction, stuck: Callable[[Fraction, Fraction], UndecidedError]
) -> list[Fraction]:
    """Cuts of the axis up to a radius, with a clear axis between them; a piece that is not clear raises `stuck`."""
    stack, cuts, count = [(Fraction(0), radius)], [Fraction(0)], 0
    while stack:
        low, high = stack.pop()
        count += 1
        if is_clear(on_axis(low, high)):
            cuts.append(high)
        elif count > MAX_PIECES or high - low < radius / 2**60:
            raise stuck(low, high)
        else:
            middle = (low + high) / 2
            stack += [(middle, high), (low, middle)]
    return cuts
