"""What always holds of functions with parameters, against the exact test with numbers and against plain fractions."""

from fractions import Fraction
from random import Random

from flint import fmpz_mpoly
from hypothesis import given, settings, strategies as st

from passivity import ExpressionError, Kind, Range, RationalFunction, Status, check_positive_real, parse_assumption
from passivity.calculus.ask import of_text as check_symbolic
from passivity.calculus.proof import lines
from passivity.exact.positive_real import check
from passivity.symbolic.domain import Domain

NAMES = "ABCDEF"
BIQUADRATIC = "(A*s^2 + B*s + C)/(D*s^2 + E*s + F)"
NONNEGATIVE = check_symbolic(BIQUADRATIC, Kind.PR, [f"{name} >= 0" for name in NAMES]).condition
REAL = check_symbolic(BIQUADRATIC, Kind.PR, [f"{name} real" for name in NAMES]).condition

zeros_too = st.just(Fraction(0)) | st.fractions(0, 20, max_denominator=12)


def is_positive_real(six):
    return check_positive_real(RationalFunction.from_coefficients(six[:3], six[3:])).status is Status.PROVED


def values_of(six):
    return dict(zip(NAMES, six, strict=True))


@given(st.lists(zeros_too, min_size=6, max_size=6).filter(any))
@settings(max_examples=60)
def test_the_biquadratic_condition_agrees_with_the_exact_test(six):
    assert NONNEGATIVE.holds(values_of(six)) == is_positive_real(six)


def test_the_biquadratic_condition_on_thousands():
    random, counts = Random(1), {True: 0, False: 0}
    for _ in range(1500):
        six = [Fraction(random.choice([0, 1, 1, 1]) * random.randint(1, 9), random.randint(1, 9)) for _ in range(6)]
        if any(six):
            expected = is_positive_real(six)
            assert NONNEGATIVE.holds(values_of(six)) == expected
            counts[expected] += 1
    assert min(counts.values()) > 400


def test_the_condition_without_any_assumption_on_thousands():
    """Signs of all kinds, missing terms, and factors that p and q have in common."""
    random, counts = Random(2), {True: 0, False: 0}
    for k in range(1500):
        six = [random.randint(-3, 3) for _ in range(6)]
        if k % 2:  # (y s + x) times two polynomials of degree one
            x, y, a, b, c, d = random.randint(-3, 3), random.randint(-2, 2), *(random.randint(-2, 3) for _ in range(4))
            six = [y * a, y * b + x * a, x * b, y * c, y * d + x * c, x * d]
        if any(six):
            expected = is_positive_real(six)
            assert REAL.holds(values_of(six)) == expected
            counts[expected] += 1
    assert min(counts.values()) > 150


@st.composite
def ladders(draw):
    """Sections from the far end: whether in series or across, and which elements it has, with names."""
    kinds = st.sets(st.sampled_from("RLC"), min_size=1)
    sections = draw(st.lists(st.tuples(st.booleans(), kinds), min_size=1, max_size=6))
    return [(series, sorted(f"{kind}{k}" for kind in found)) for k, (series, found) in enumerate(sections)]


def text_of(ladder):
    z = ""
    for series, names in ladder:
        elements = [{"R": name, "L": f"s*{name}", "C": f"1/(s*{name})"}[name[0]] for name in names]
        if series:
            z = "+".join([*elements, z] if z else elements)
        else:
            z = f"1/({'+'.join(f'1/({x})' for x in [*elements, z] if x)})"
    return z


class Complex:
    """Complex numbers with rational parts."""

    def __init__(self, re, im=0):
        self.re, self.im = Fraction(re), Fraction(im)

    def __add__(self, other):
        return Complex(self.re + other.re, self.im + other.im)

    def __mul__(self, other):
        return Complex(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    def inverse(self):
        size = self.re**2 + self.im**2
        return Complex(self.re / size, -self.im / size)


def impedance(ladder, values, s):
    """Element by element in fractions; None at a pole."""
    z = None
    try:
        for series, names in ladder:
            elements = [Complex(values[name]) if name[0] == "R" else s * Complex(values[name]) for name in names]
            parts = [x.inverse() if name[0] == "C" else x for name, x in zip(names, elements, strict=True)]
            if z:
                parts.append(z)
            z = sum(parts if series else [x.inverse() for x in parts], Complex(0))
            z = z if series else z.inverse()
    except ZeroDivisionError:
        return None
    return z


@given(ladders(), st.randoms(use_true_random=False))
@settings(max_examples=15, deadline=None)
def test_ladders_with_names_are_proved_by_structure(ladder, random):
    names = [name for _, section in ladder for name in section]
    verdict = check_symbolic(text_of(ladder), Kind.PR, [f"{name} > 0" for name in names])
    assert verdict.status is Status.PROVED
    elements = [line for line in lines(verdict.proof) if "a constant" in line]
    assert all(any(name in line for line in elements) for name in names)
    values = {name: Fraction(random.randint(1, 99), random.randint(1, 99)) for name in names}
    z = impedance(ladder, values, Complex(Fraction(random.randint(1, 50), 20), random.randint(-9, 9)))
    assert z
    assert z.re >= 0


@given(ladders(), st.integers(0, 99))
@settings(max_examples=15, deadline=None)
def test_ladders_with_one_negative_element_are_refuted(ladder, which):
    names = [name for _, section in ladder for name in section]
    negative = names[which % len(names)]
    assumptions = [f"{name} {'<' if name == negative else '>'} 0" for name in names]
    found = check_symbolic(text_of(ladder), Kind.PR, assumptions).witness
    assert found
    assert all((x < 0) == (name == negative) for name, x in found.names.items())
    assert found.re > 0
    z = impedance(ladder, found.names, Complex(found.re, found.im))
    assert z is None or z.re < 0


ASSUMPTIONS = {
    "a": ["a > 0", "a >= 0", "a real", "0 < a < 2"],
    "b": ["b >= 0", "b real", "-1 <= b <= 1", "1 < b <= 3"],
    "c": ["c > 0", "c real", "0 <= c <= 1", "c < 1"],
}
leaves = st.sampled_from(["s", "s", "a", "b", "c", "1", "2", "1/3"])
expressions = st.recursive(leaves, lambda x: st.builds("({}{}{})".format, x, st.sampled_from("++-*/"), x), max_leaves=8)
numbers = st.fractions(-3, 3, max_denominator=4)


@given(expressions, st.sampled_from(Kind), st.data())
@settings(max_examples=40, deadline=None)
def test_no_verdict_on_any_expression_is_against_the_exact_test(text, kind, data):
    assumptions = {x: data.draw(st.sampled_from(ASSUMPTIONS[x])) for x in "abc" if x in text}
    try:
        verdict = check_symbolic(text, kind, assumptions.values())
    except ExpressionError:  # 0/0
        return
    if found := verdict.witness:
        assert check(RationalFunction.from_expression(text, found.names), kind).status is Status.REFUTED
    ranges = [parse_assumption(assumption) for assumption in assumptions.values()]
    values = {r.name: data.draw(numbers.filter(r.__contains__)) for r in ranges}
    try:
        expected = check(RationalFunction.from_expression(text, values), kind).status is Status.PROVED
        condition = verdict.condition and verdict.condition.holds(values)
    except ExpressionError:  # 0/0 at these values
        return
    assert expected or verdict.status is not Status.PROVED
    assert condition in (None, expected)


RANGES = [Range("a", Fraction(0)), Range("b", Fraction(-2), Fraction(3)), Range("c", None, Fraction(1, 2)), Range("d")]
DOMAIN = Domain((*RANGES, Range("e", Fraction(1, 3), None, True)))
points = st.fractions(-4, 4, max_denominator=6)


@given(
    st.dictionaries(st.tuples(*[st.integers(0, 2)] * 5), st.integers(-4, 6), min_size=1, max_size=5),
    st.lists(points, min_size=5, max_size=5),
)
@settings(max_examples=60, deadline=None)
def test_no_sign_is_overlooked(terms, point):
    f: fmpz_mpoly = DOMAIN.context.from_dict({(0, 0, *powers): c for powers, c in terms.items()})
    if all(x in r for x, r in zip(point, DOMAIN.ranges, strict=True)):
        value = sum(c * Fraction(1) * _product(point, powers) for powers, c in terms.items())
        assert (value > 0) - (value < 0) in DOMAIN.signs(f)


def _product(point, powers):
    result = Fraction(1)
    for x, power in zip(point, powers, strict=True):
        result *= x**power
    return result
