"""What always holds: the parser means what Python means, and rational functions form a field."""

from fractions import Fraction
from functools import reduce

import control
import flint
import numpy as np
import scipy.signal
from hypothesis import assume, example, given, strategies as st

from passivity import ExpressionError, RationalFunction
from passivity.expression.parse import parse
from passivity.expression.tree import symbols

of = RationalFunction.from_expression
OPEN, SHORT = of("1/0"), of("0")

fractions = st.fractions(-50, 50, max_denominator=60)
points = st.complex_numbers(max_magnitude=1e6, allow_nan=False, allow_infinity=False)
# numbers of everyday size, so that double precision has a fair chance in comparisons
eighths = st.integers(-800, 800).map(lambda n: n / 8)
coefficient_lists = st.lists(eighths, min_size=1, max_size=5).filter(any)


@st.composite
def functions(draw):
    """Finite functions of degree 4 or less; zero is one of them."""
    integers = st.integers(-(10**12), 10**12) | st.integers(-2, 2)
    denominator = st.lists(integers, min_size=1, max_size=5).filter(any)
    return RationalFunction.from_coefficients(draw(st.lists(integers, min_size=1, max_size=5)), draw(denominator))


impedances = functions() | st.sampled_from([OPEN, SHORT])

LEAVES = [(name, name) for name in "sRC"] + [
    ("2", "F(2)"),
    ("0.5", "F(1, 2)"),
    (".1", "F(1, 10)"),
    ("1.25e-3", "F(1, 800)"),
    ("7E+1", "F(70)"),
    ("3k", "F(3000)"),
    ("40 m\u03a9", "F(1, 25)"),
    ("s^2", "s**2"),
    ("R**-3", "R**-3"),
]
SHAPES = ["{}+{}", "{} - {}", "({})*({})", "{} * {}", "({})/({})", "{}/{}", "-{}", "+{}", "({})^3", "({})**-2"]


@st.composite
def expressions(draw, depth=4):
    """A random expression in s, R and C, as the text to parse and as Python code for exact fractions."""
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        return draw(st.sampled_from(LEAVES))
    shape = draw(st.sampled_from(SHAPES))
    children = [draw(expressions(depth=depth - 1)) for _ in range(shape.count("{}"))]
    ours, python = zip(*children, strict=True)
    return shape.format(*ours), shape.replace("^", "**").format(*python)


def exact_value(coefficients, x):
    return reduce(lambda value, c: value * x + c, coefficients, Fraction(0))


def complex_value(coefficients, x):
    """Real and imaginary part of a polynomial at a complex float, exactly."""
    re, im = Fraction(0), Fraction(0)
    a, b = Fraction(x.real), Fraction(x.imag)
    for c in coefficients:
        re, im = re * a - im * b + c, re * b + im * a
    return re, im


@given(expressions(), fractions, fractions, fractions)
def test_parser_and_arithmetic_agree_with_python(expression, s, r, c):
    text, code = expression
    try:
        truth = eval(code, {"__builtins__": {}, "F": Fraction}, {"s": s, "R": r, "C": c})
    except ZeroDivisionError:
        assume(False)
    values = {name: value for name, value in {"R": r, "C": c}.items() if name in symbols(parse(text))}
    z = of(text, values)
    assert exact_value(z.numerator, s) == truth * exact_value(z.denominator, s)
    assert exact_value(z.denominator, s) != 0


@given(st.decimals(allow_nan=False, allow_infinity=False, places=None).filter(lambda d: abs(d.adjusted()) < 300))
def test_decimals_are_exact(number):
    assert of(str(number)).at_zero() == Fraction(number)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_floats_are_exact(number):
    assert of("x", {"x": number}).at_zero() == Fraction(number)
    assert of(repr(number)).at_zero() == Fraction(repr(number))


CHARACTERS = st.characters(exclude_categories=["Cs"])  # to name a codec would take a second
PIECES = ["s", "R", "2", "1e9", "0.5", "10n", "+", "-", "*", "/", "^", "**", "(", ")", "exp", "sqrt", "."]


@given(st.text(CHARACTERS, max_size=60) | st.lists(st.sampled_from(PIECES), max_size=30).map(" ".join))
def test_any_text_is_parsed_or_refused(text):
    refusal = ""
    try:
        of(text, dict.fromkeys(symbols(parse(text)) - {"s"}, 2))
    except ExpressionError as error:
        refusal = str(error)
    assert len(refusal) < 400


@given(functions(), functions(), functions())
def test_field(x, y, z):
    assert x + y == y + x
    assert x * y == y * x
    assert (x + y) + z == x + (y + z)
    assert (x * y) * z == x * (y * z)
    assert x * (y + z) == x * y + x * z
    assert x - y == -(y - x)
    assert x - x == SHORT
    assert (x - y).is_zero == (x == y)
    if not x.is_zero:
        assert x * x.inverse() == x / x == of("1")
        assert y / x * x == y
        assert x**-3 == 1 / (x * x * x)


@given(functions(), functions())
def test_equality_is_that_of_functions(x, y):
    assume(not y.is_zero)
    same = x * y / y
    assert same == x
    assert hash(same) == hash(x)
    assert (same.reduced().p, same.reduced().q) == (x.reduced().p, x.reduced().q)
    assert (x + 1) != x


@given(impedances, impedances, impedances)
def test_series_and_parallel(x, y, z):
    assert x.parallel(y) == y.parallel(x)
    assert x.parallel(y).parallel(z) == x.parallel(y.parallel(z))
    assert x + y == y + x
    assert (x + y) + z == x + (y + z)
    assert x.parallel(y).inverse() == x.inverse() + y.inverse()
    if not (x + y).is_zero and not (x + y).is_infinite:
        assert x.parallel(y) == x * y / (x + y)


@given(impedances)
def test_text_makes_it_again(z):
    again = of(str(z))
    assert (again.p, again.q) == (z.p, z.q)


@given(functions(), points)
@example(of("(s^2 + 1)^9/(s^3 - 1)^9"), 1.0000000001 + 0j)
@example(of("1/(s - 1)"), 1 + 5e-324j)
def test_value_is_the_exact_value_rounded(z, x):
    (a, b), (c, d) = complex_value(z.numerator, x), complex_value(z.denominator, x)
    size = c * c + d * d
    assume(size != 0)
    re, im = (a * c + b * d) / size, (b * c - a * d) / size
    assume(abs(re) < 10**300 and abs(im) < 10**300)
    value = z(x)
    for part, truth in ((value.real, re), (value.imag, im)):
        assert abs(Fraction(part) - truth) <= abs(truth) * Fraction(2e-16) + Fraction(5e-324)


@given(functions())
def test_floats_are_the_nearest(z):
    for floats, coefficients in zip(z.to_floats(), (z.numerator, z.denominator), strict=True):
        largest = max(abs(c) for c in z.numerator + z.denominator)
        assert floats == [float(c / largest) for c in coefficients]


def horner_error(coefficients, x):
    """Bound of the relative rounding error of Horner's rule (Higham, Accuracy and Stability, section 5.1)."""
    n, magnitude = len(coefficients), abs(np.polyval(coefficients, x))
    return 4 * n * 2**-52 * np.polyval(np.abs(coefficients), abs(x)) / magnitude if magnitude else np.inf


@given(coefficient_lists, coefficient_lists, st.builds(complex, eighths, eighths))
def test_agrees_with_other_packages(numerator, denominator, x):
    numerator, denominator = (np.trim_zeros(side, "f") for side in (numerator, denominator))
    bound = horner_error(numerator, x) + horner_error(denominator, x)
    assume(bound < 0.1)
    theirs = control.tf(numerator, denominator)
    value = RationalFunction.from_system(theirs)(x)
    assert abs(value - theirs(x)) <= 2 * bound * abs(value)
    if len(numerator) <= len(denominator):  # scipy knows proper functions only
        proper = RationalFunction.from_system(scipy.signal.lti(numerator, denominator))
        assert abs(proper(x) - value) <= 2 * bound * abs(value)  # it divides by the leading coefficient, rounding


small = st.integers(-3, 3)


@given(st.data(), st.integers(0, 4), fractions)
def test_state_space_is_exact(data, n, x):
    a, b, c = (data.draw(st.lists(small, min_size=size, max_size=size)) for size in (n * n, n, n))
    d = data.draw(small)
    diagonal = flint.fmpq(x.numerator, x.denominator)
    shifted = flint.fmpq_mat(n, n, [(k % (n + 1) == 0) * diagonal - entry for k, entry in enumerate(a)])
    assume(shifted.det() != 0)
    truth = d + (flint.fmpq_mat(1, n, c) * shifted.inv() * flint.fmpq_mat(n, 1, b))[0, 0]
    matrices = (np.reshape(m, shape) for m, shape in ((a, (n, n)), (b, (n, 1)), (c, (1, n)), (d, (1, 1))))
    z = RationalFunction.from_system(control.ss(*matrices, remove_useless_states=False))
    assert z.degree == n
    assert exact_value(z.numerator, x) / exact_value(z.denominator, x) == Fraction(int(truth.p), int(truth.q))
