"""The smallest value of a rational function on the half line x >= 0, enclosed by exact tests."""

import math
from fractions import Fraction
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from passivity.budget import spend
from passivity.polynomial.roots import positive_roots, sqrt
from passivity.polynomial.sign import SignProof, UndecidedError, find_sign, squarefree

MAX_ROUNDS = 40
BITS = 40  # values not found exactly lie in an interval shorter than 2^-BITS of their distance to 0 and to the guess
_SIMPLE = 10_000  # denominators up to this are tried
_FINE = 100  # bits of the place of a minimum, at first
_FINEST = 3200
_LONG = "the smallest value of a function of degree {}"


class Infimum(NamedTuple):
    """A number in [low, high], and a place x where the function comes as close to it."""

    low: Fraction | float  # the same as high if the value is known exactly; -inf if there is none
    high: Fraction | float
    frequency: float  # square root of x; inf if it is a limit


def infimum(num: fmpz_poly, den: fmpz_poly, guess: int = 0) -> Infimum:
    """Infimum of num/den over x >= 0, where den >= 0; the guess is recognised exactly, wherever it is attained."""
    common = num.gcd(den)
    num, den = num // common, den // common
    if den.leading_coefficient() < 0:
        num, den = -num, -den
    pole = _falls(num, den)
    if pole is not None:
        return Infimum(-math.inf, -math.inf, pole)
    touched = _touches(num - guess * den, den)
    if touched is not None:
        return Infimum(Fraction(guess), Fraction(guess), touched)
    level, place = min(_ends(num, den), default=(None, 0.0))
    below = find_sign(_above(num, den, level)) if level is not None else Fraction(1)
    if level is not None and isinstance(below, SignProof):
        return Infimum(level, level, place)
    x, fine = fmpq(0), _FINE
    for _ in range(MAX_ROUNDS):
        assert isinstance(below, Fraction)
        before, x = x, _descend(num, den, below, fine)
        if abs(x - before) * 2 ** (fine // 2) < x:  # the same minimum, and it is a narrow one
            fine = min(2 * fine, _FINEST)
        spend(_exact_cost(num, x) + _exact_cost(den, x), _LONG.format(den.degree()))
        value = num(x) / den(x)
        low, high = _around(Fraction(int(value.p), int(value.q)), guess)
        below = find_sign(_above(num, den, low))
        if isinstance(below, SignProof):
            return _recognised(num, den, low, high, x) or Infimum(low, high, sqrt(x))
    raise UndecidedError(f"the smallest value of a function of degree {den.degree()} takes over {MAX_ROUNDS} tests")


def _recognised(num: fmpz_poly, den: fmpz_poly, low: Fraction, high: Fraction, x: fmpq) -> Infimum | None:
    """The infimum exactly, if it is a simple number or attained at one."""
    near = Fraction(int(x.p), int(x.q)).limit_denominator(_SIMPLE)
    place = fmpq(near.numerator, near.denominator)
    there = num(place) / den(place) if den(place) else x
    for value in (Fraction(int(there.p), int(there.q)), ((low + high) / 2).limit_denominator(_SIMPLE)):
        if low <= value <= high and (touched := _touches(_above(num, den, value), den)) is not None:
            return Infimum(value, value, touched)
    return None


def _above(num: fmpz_poly, den: fmpz_poly, level: Fraction) -> fmpz_poly:
    """A polynomial with the sign of num/den - level."""
    return num * level.denominator - den * level.numerator


def _ends(num: fmpz_poly, den: fmpz_poly) -> list[tuple[Fraction, float]]:
    """The values at 0 and at infinity that are finite."""
    found = [(Fraction(int(num[0]), int(den[0])), 0.0)] if den[0] else []
    if num.degree() <= den.degree():
        found.append((Fraction(int(num[den.degree()]), int(den.leading_coefficient())), math.inf))
    return found


def _falls(num: fmpz_poly, den: fmpz_poly) -> float | None:
    """Where num/den goes to minus infinity, None if nowhere."""
    if num.degree() > den.degree() and num.leading_coefficient() < 0:
        return math.inf
    for factor, power in squarefree(den):
        if factor == fmpz_poly([0, 1]):
            sign_beyond = next(c for c in den.coeffs() if c)
            if (num[0] < 0) == (sign_beyond > 0):
                return 0.0
        elif factor.degree() > 0:
            for root in positive_roots(factor):
                if power % 2 or root.sign_of(num) < 0:
                    return root.frequency
    return None


def _touches(difference: fmpz_poly, den: fmpz_poly) -> float | None:
    """Where a nonnegative difference is zero, also in the limit; None if nowhere or if it is negative somewhere."""
    if not difference:
        return 0.0
    if not isinstance(find_sign(difference), SignProof):
        return None
    for factor, power in squarefree(difference):
        if factor == fmpz_poly([0, 1]):
            return 0.0
        if power % 2 == 0:
            for root in positive_roots(factor):
                return root.frequency
    return math.inf if difference.degree() < den.degree() else None


def _descend(num: fmpz_poly, den: fmpz_poly, start: Fraction, fine: int) -> fmpq:
    """Next to a local minimum of num/den, not above the start: ever longer steps downhill, then bisection.

    Between a point that goes down towards another and that other, if it is higher or goes up, there is a minimum.
    """
    slope = num.derivative() * den - num * den.derivative()
    bits = 3 * fine + 2 * slope.degree()
    with ctx.workprec(bits):
        f, g, df = arb_poly(num), arb_poly(den), arb_poly(slope)

    cost = 1000 * len(slope) + len(slope) * bits // 10

    def rising(x: fmpq) -> bool:
        spend(cost, _LONG.format(den.degree()))
        with ctx.workprec(bits):
            return bool(df(arb(x)) > 0)

    def higher(x: fmpq) -> bool:
        spend(cost, _LONG.format(den.degree()))
        with ctx.workprec(bits):
            a, b = arb(x), arb(inner)
            gap = f(a) * g(b) - f(b) * g(a)
        if gap.contains(0):
            spend(_exact_cost(num, x) + _exact_cost(den, x), _LONG.format(den.degree()))
        return bool(gap > 0 if gap > 0 or gap < 0 else num(x) * den(inner) > num(inner) * den(x))

    inner = fmpq(start.numerator, start.denominator)
    right = not rising(inner)

    def beyond(x: fmpq) -> bool:
        return rising(x) == right or higher(x)

    step = inner / 2**20
    outer = inner + step if right else inner - step
    while not beyond(outer):
        step *= 2
        inner, outer = outer, outer + step if right else max(outer - step, outer / 2)
    while abs(outer - inner) * 2**fine > inner:
        middle = (inner + outer) / 2
        inner, outer = (inner, middle) if beyond(middle) else (middle, outer)
    return inner


def _exact_cost(f: fmpz_poly, x: fmpq) -> int:
    """Cost of one value in exact numbers."""
    return len(f) * (f.height_bits() + len(f) * x.height_bits())


def _around(value: Fraction, guess: int) -> tuple[Fraction, Fraction]:
    """Short numbers a little below and not below, by the distance to 0 and to the guess."""
    size = min((abs(x) for x in (value, value - guess) if x), default=Fraction(1))
    grid = Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length() - BITS - 2)
    return math.floor(value / grid) * grid - grid, math.ceil(value / grid) * grid
