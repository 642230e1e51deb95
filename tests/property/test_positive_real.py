"""What always holds: circuits of positive elements are proved, and the answer does not depend on how it is asked."""

import math
from fractions import Fraction

from hypothesis import given, strategies as st

from passivity import RationalFunction, Status, check_bounded_real, check_positive_real, robustness, verify

s = RationalFunction.from_expression("s")
OPEN, SHORT = RationalFunction.from_expression("1/0"), RationalFunction.from_expression("0")

values = st.fractions(Fraction(1, 50), 50, max_denominator=60)
decades = st.builds(lambda x, k: x * Fraction(10) ** k, values, st.integers(-12, 12))
elements = values | decades
small_functions = st.builds(
    RationalFunction.from_coefficients,
    st.lists(st.integers(-3, 9), min_size=1, max_size=5),
    st.lists(st.integers(-1, 9), min_size=1, max_size=5).filter(any),
)


@st.composite
def foster(draw):
    """A sum of resonances k s/(s^2 + d s + w^2), some without loss, behind a resistor and a coil; its parts."""
    parts = [RationalFunction.constant(draw(elements)), s * draw(elements)]
    for _ in range(draw(st.integers(0, 4))):
        k, d, w = draw(elements), draw(elements | st.just(Fraction(0))), draw(elements)
        parts.append(s * k / (s * s + s * d + w * w))
    return parts


@st.composite
def ladder(draw, *, lossy=True):
    """Elements of a ladder from its far end: coil with resistance in series, capacitor with conductance across."""
    loss = elements | st.just(Fraction(0)) if lossy else st.just(Fraction(0))
    return draw(st.lists(st.tuples(elements, loss), min_size=1, max_size=8))


def impedance(sections):
    z = OPEN
    for k, (reactive, loss) in enumerate(sections):
        branch = s * reactive + loss
        z = z + branch if k % 2 else (z.inverse() + branch).inverse()
    return z


def value(coefficients, re, im):
    u, v = Fraction(0), Fraction(0)
    for c in coefficients:
        u, v = u * re - v * im + c, u * im + v * re
    return u, v


def is_refuted(z):
    verdict = check_positive_real(z)
    if verdict.status is not Status.REFUTED:
        return False
    re, im = verdict.witness.re, verdict.witness.im
    (a, b), (c, d) = value(z.numerator, re, im), value(z.denominator, re, im)
    return re > 0 and a * c + b * d < 0


def is_proved(z):
    verdict = check_positive_real(z)
    return verdict.status is Status.PROVED and verify(verdict.certificate)


@given(foster())
def test_foster_sums_of_positive_elements_are_proved(parts):
    assert is_proved(sum(parts, SHORT))


@given(foster(), st.integers(0, 5), values)
def test_foster_sums_with_a_negative_element_are_refuted(parts, which, size):
    """Each is more negative than the rest can make good: where its real part counts most."""
    which %= len(parts)
    rest = sum((part for k, part in enumerate(parts) if k != which), SHORT)
    if which == 0:  # a negative resistor: Re Z(0) < 0
        assert is_refuted(rest - size)
    elif which == 1:  # a negative coil: a pole at infinity
        assert is_refuted(rest - s * size)
    else:  # a capacitor: the only pole at 0
        assert is_refuted(rest - 1 / (s * size))


@given(ladder())
def test_ladders_of_positive_elements_are_proved(sections):
    assert is_proved(impedance(sections))


@given(ladder(lossy=False), st.integers(0, 7))
def test_ladders_without_loss_and_with_one_negative_element_are_refuted(sections, which):
    """The continued fraction of a lossless impedance is unique, and positive if and only if it is positive real."""
    which %= len(sections)
    sections[which] = (-sections[which][0], Fraction(0))
    assert is_refuted(impedance(sections))


@given(foster(), values)
def test_what_is_taken_away_beyond_the_margin_is_missing(parts, more):
    z = sum(parts, SHORT)
    margin = check_positive_real(z).margins.input
    assert is_proved(z - margin.low)
    assert is_refuted(z - margin.high - more / 10**6)


@given(small_functions)
def test_the_answer_does_not_depend_on_the_question(z):
    proved = is_proved(z)
    assert proved or is_refuted(z)
    if z != RationalFunction.constant(Fraction(-1)):
        assert (check_bounded_real((z - 1) / (z + 1)).status is Status.PROVED) == proved


@given(small_functions, values)
def test_the_answer_does_not_depend_on_units(z, k):
    proved = is_proved(z)
    n = z.degree
    p, q = ([Fraction(0)] * (n + 1 - len(side)) + list(side) for side in (z.numerator, z.denominator))
    powers = [k**i for i in range(n, -1, -1)]
    stretched = RationalFunction.from_coefficients(
        [c * u for c, u in zip(p, powers, strict=True)], [c * u for c, u in zip(q, powers, strict=True)]
    )
    assert is_proved(z.inverse()) == proved
    assert is_proved(RationalFunction.from_coefficients(p[::-1], q[::-1])) == proved  # s -> 1/s
    assert is_proved(stretched) == proved
    assert is_proved(z * k) == proved


@given(small_functions, small_functions)
def test_a_common_factor_does_not_change_the_answer(z, other):
    if other.p:
        assert is_proved(RationalFunction(z.p * other.p, z.q * other.p)) == is_proved(z)


@given(ladder(), st.sampled_from([Fraction(1, 10**3), Fraction(1, 10**9)]), st.data())
def test_robust_verdicts_hold_in_the_box(sections, eps, data):
    z = impedance(sections)
    found = robustness(check_positive_real(z), eps)
    if found.exception is not None:
        assert is_refuted(found.exception)
    if found.same:
        shift = st.sampled_from([1 - eps, 1, 1 + eps])
        sides = [[c * data.draw(shift) for c in side] for side in (z.numerator, z.denominator)]
        assert is_proved(RationalFunction.from_coefficients(*sides))


@given(small_functions)
def test_no_sample_passes_the_smallest_resistance(z):
    margin = check_positive_real(z).margins.input
    if margin is None:
        return
    samples = [resistance(z, Fraction(2**k, 8**4)) for k in range(25)]
    assert all(r is None or r >= margin.low for r in samples)
    if 0 < margin.frequency < math.inf and margin.low > -math.inf:
        here = resistance(z, Fraction(margin.frequency))
        assert here is None or here - margin.high <= Fraction(1, 10**6) * max(1, abs(margin.high))


def resistance(z, w):
    """Re Z(jw), None at a pole."""
    (a, b), (c, d) = value(z.numerator, 0, w), value(z.denominator, 0, w)
    return (a * c + b * d) / (c * c + d * d) if c or d else None
