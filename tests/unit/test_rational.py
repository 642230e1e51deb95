"""Exact rational functions: making, refusing, and the corners of open and short circuits."""

import copy
import math
import pickle
from decimal import Decimal
from fractions import Fraction

import control
import numpy as np
import pytest
import scipy.signal

from passivity import ExpressionError, RationalFunction
from passivity.budget import MAX_DEGREE
from passivity.rational.evaluate import exact

of = RationalFunction.from_expression
coefficients = RationalFunction.from_coefficients
s = of("s")
SHORT, OPEN = of("0"), of("1/0")


def pair(z):
    return z.numerator, z.denominator


# ---- making


@pytest.mark.parametrize("number", [np.float64(0.5), np.float32(0.5), np.array(0.5), np.int64(3), 3])
def test_numpy_numbers(number):
    assert exact(number, "x") == Fraction(float(number))


def test_coefficients_come_highest_power_first():
    assert pair(coefficients([0, 0, 4, 2], ["0.5"])) == ((8, 4), (1,))
    assert pair(coefficients((1, 2, 3), iter([4, 5]))) == ((1, 2, 3), (4, 5))
    assert pair(coefficients(np.array([1.0, 2.0]), np.array([3]))) == ((1, 2), (3,))


def test_the_pair_is_without_integer_content_and_with_positive_denominator():
    assert pair(coefficients([6, 4], [-2])) == ((-3, -2), (1,))
    assert pair(coefficients([-3], [0])) == ((1,), (0,))
    assert pair(coefficients([0], [-7])) == ((0,), (1,))


@pytest.mark.parametrize(
    ("numerator", "denominator", "message"),
    [
        ([1, math.nan], [1], r"numerator\[1\]: not a number, expected a finite .*, got nan"),
        ([1], [-math.inf, 1], r"denominator\[0\]: not a number, .* got -inf"),
        ([1j], [1], r"numerator\[0\]: not a number"),
        ([None], [1], r"numerator\[0\]: not a number"),
        ([[1, 2]], [1], r"numerator\[0\]: not a number"),
        (np.ones((2, 2)), [1], r"numerator\[0\]: not a number"),
        (["s"], [1], r"numerator\[0\]: not a number"),
        (["1/0"], [1], r"numerator\[0\]: not a number"),
        (["nan"], [1], r"numerator\[0\]: not a number"),
        ([Decimal("NaN")], [1], r"numerator\[0\]: not a number"),
        ([Decimal("1e999999999")], [1], r"numerator\[0\], column 1: the decimal exponent is out of range"),
        (["1,5"], [1], r"numerator\[0\], column 2: this does not fit here"),
        (["sqrt(2)"], [1], r"numerator\[0\]: sqrt\(...\) is not rational"),
        ([], [1], "numerator: no coefficients, expected at least one number"),
        ("12", [1], "numerator: not coefficients, expected a sequence"),
        ([1], 2, "denominator: not coefficients, expected a sequence"),
        ([0, 0.0], [0], "0/0 has no value"),
    ],
)
def test_refused_coefficients(numerator, denominator, message):
    with pytest.raises(ExpressionError, match=message):
        coefficients(numerator, denominator)


@pytest.mark.parametrize(
    ("text", "parameters", "message"),
    [
        ("R + s*L", {"R": 1}, "parameter L: no value, expected one for each of L, R, got R"),
        ("R + s", None, "parameter R: no value, expected one for each of R, got no names"),
        ("R", {"R": 1, "r": 2}, "parameter r: not in the expression, expected values for R, got R, r"),
        ("s", {"s": 2}, "parameter s: s is the Laplace variable"),
        ("s", {1: 2, None: 3}, "parameters 1, None: not in the expression"),
        ("R", {"R": math.nan}, "parameter R: not a number"),
        ("R", {"R": "2 s"}, r"parameter R, column 3: .* expected 2\*s"),
        ("R", {"R": "s"}, "parameter R: not a number"),
        ("exp(-2*s)*3", None, r"exp\(...\) is not rational in s"),
        ("sqrt(R)", {"R": 4}, r"sqrt\(...\) is not rational in s"),
        ("0/0", None, "0/0 has no value"),
        ("0*(1/0)", None, "0/0 has no value"),
        ("R/R", {"R": 0}, "0/0 has no value"),
        ("(1 + s)^200 * s^200 * s", None, "degree in s is too high, expected at most 400, got 401"),
        ("((1 + s)^200)^200", None, "degree in s is too high, expected at most 400, got 40000"),
        ("(1e400^50 + s)^2", None, "numbers are too long, expected at most 100000 bits"),
    ],
)
def test_refused_expressions(text, parameters, message):
    with pytest.raises(ExpressionError, match=message):
        of(text, parameters)


@pytest.mark.parametrize("tail", ["+1", "*3/7", "-s/s"])
def test_hostile_expressions_are_refused_at_once(tail):
    text = "(1+s)^200*(1e400+1e-400*s)^18"
    text += tail * ((9_999 - len(text)) // len(tail))
    with pytest.raises(ExpressionError):
        of(text)


def test_large_honest_expressions_pass():
    ladder = "1"
    for i in range(1, 50):  # 98 levels of parentheses
        ladder = f"{i}.5 + {i}.25e-9*s + 1/({i}e-12*s + 1/({ladder}))"
    assert of(ladder).degree == 98
    assert of("+".join(f"{i}.1/(s + 0.{i})" for i in range(100, 300))).degree == 200
    assert of("((1 + s)^200)^2").degree == MAX_DEGREE


# ---- open and short circuits


def test_open_and_short_are_ordinary():
    assert (SHORT.is_zero, SHORT.is_infinite, OPEN.is_zero, OPEN.is_infinite) == (True, False, False, True)
    assert (SHORT.degree, OPEN.degree) == (0, 0)
    assert pair(SHORT) == ((0,), (1,))
    assert pair(OPEN) == ((1,), (0,))
    assert (SHORT.inverse(), OPEN.inverse()) == (OPEN, SHORT)
    assert OPEN != SHORT
    assert -OPEN == OPEN


@pytest.mark.parametrize("z", [of("2 + s"), of("1/s"), SHORT, OPEN])
def test_open_and_short_in_circuits(z):
    assert z + SHORT == SHORT + z == z
    assert z + OPEN == OPEN + z == OPEN
    assert z.parallel(OPEN) == OPEN.parallel(z) == z
    assert z.parallel(SHORT) == SHORT.parallel(z) == SHORT


def test_resonance_is_an_open_circuit():
    assert s.parallel(-s) == OPEN


@pytest.mark.parametrize("z", [OPEN, SHORT])
def test_zero_times_infinity_is_refused(z):
    with pytest.raises(ExpressionError, match="0/0"):
        z * z.inverse()


# ---- arithmetic


def test_numbers_stand_for_constants():
    assert 2 * s + 1 == s * 2 + Fraction(1) == of("2*s + 1")
    assert 1 / s == of("1/s")
    assert 3 - s == -(s - 3) == of("3 - s")
    assert s / 0 == OPEN
    assert np.float64(0.5) * s == s * np.int64(1) / 2 == s * np.float32(0.5)


@pytest.mark.parametrize("other", ["1", None, 1j, [1]])
def test_other_operands_are_type_errors(other):
    with pytest.raises(TypeError):
        s + other
    assert s != other


def test_non_finite_operands_are_refused():
    with pytest.raises(ExpressionError, match="number: not a number"):
        s + math.inf


def test_common_factors_stay_until_reduced():
    two_capacitors = of("1/(2*s) + 1/(3*s)")
    assert pair(two_capacitors) == ((5, 0), (6, 0, 0))
    assert pair(two_capacitors.reduced()) == ((5,), (6, 0))
    assert two_capacitors == two_capacitors.reduced() == of("5/(6*s)")
    assert len({two_capacitors, two_capacitors.reduced(), of("5/(6*s)"), SHORT, OPEN}) == 3
    assert pair((s - s).reduced()) == ((0,), (1,))


def test_immutable_copied_and_pickled():
    z = of("(1 + 1e-12*s)/(3 + s)")
    with pytest.raises(AttributeError):
        z.p = s.p
    assert pickle.loads(pickle.dumps(z)) == copy.deepcopy(z) == z


def test_repr_makes_it_again():
    z = of("(1 + 1e-12*s)/(3 - s^2)")
    assert repr(z) == "RationalFunction.from_expression('(-1*s - 1000000000000)/(1000000000000*s^2 - 3000000000000)')"
    assert pair(eval(repr(z))) == pair(z)


# ---- values


def test_lossless_means_a_real_part_of_exactly_zero():
    lossless = of("(s^2 + 3)/(s*(s^2 + 5))")
    assert lossless(0.7j).real == 0
    assert (lossless * of("(s + 0.1)^9/(s + 0.1)^9"))(0.7j).real == 0
    slightly_active = lossless - of("1e-40")
    assert slightly_active(0.7j).real == -1e-40


def test_values_leave_the_working_precision_alone():
    import flint

    before = flint.ctx.prec
    of("1/(1 + s)^50")(-1 + 1e-9j)
    assert flint.ctx.prec == before


@pytest.mark.parametrize("point", [math.nan, math.inf, complex(0, -math.inf)])
def test_no_value_where_s_is_not_finite(point):
    with pytest.raises(ExpressionError, match="s: no value here, expected a finite complex number"):
        s(point)


def test_floats_are_refused_where_they_would_vanish():
    with pytest.raises(ExpressionError, match="coefficients: too far apart for floats, expected at most 307 decades"):
        of("1 + 1e-320*s").to_floats()


# ---- systems of other packages


def test_systems_at_the_edge():
    assert RationalFunction.from_system(control.tf([1, 0], [1])) == s
    assert RationalFunction.from_system(control.tf([3.0], [1.0])) == of("3")
    assert RationalFunction.from_system(control.ss([], [], [], 5)) == of("5")
    assert RationalFunction.from_system(scipy.signal.StateSpace(-1, 1, 1, 0.1)) == of("1/(s+1)") + 0.1


def test_hidden_modes_of_a_state_space_stay():
    hidden = control.ss([[-1, 0], [0, 2]], [[1], [0]], [[1, 0]], 0, remove_useless_states=False)
    assert pair(RationalFunction.from_system(hidden)) == ((1, -2), (1, -1, -2))


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (scipy.signal.dlti([1], [1, 0.5]), "discrete in time, expected a continuous system, got .*dt=True"),
        (control.tf([1], [1, 0.5], 0.1), "discrete in time, .*dt=0.1"),
        (control.tf([1], [1, 0.5], True), "discrete in time"),
        (scipy.signal.StateSpace(-1, [[1, 2]], 1, [[0, 0]]), "D, row 1: not square"),
        (scipy.signal.TransferFunction([[1], [2]], [1, 2]), r"one input and one output, got \(1, 2\)"),
        (control.ss(-1, 1, [[1], [2]], [[0], [0]]), "D, row 1: not square"),
        (control.frd([1, 2], [1, 2]), "no coefficients, expected a scipy.signal.lti"),
        ([1, 2], "no coefficients, .* got list"),
        (scipy.signal.TransferFunction([math.nan], [1]), r"numerator\[0\]: not a number"),
        (scipy.signal.StateSpace(math.inf, 1, 1, 0), r"A\[0\]\[0\]: not a number"),
    ],
)
def test_refused_systems(system, message):
    with pytest.raises(ExpressionError, match=message):
        RationalFunction.from_system(system)
