"""Balls become fractions of a bounded size, powers are bounded, work is counted."""

from fractions import Fraction

import pytest
from flint import arb

from passivity import ExpressionError, RationalFunction
from passivity.ball import near
from passivity.budget import MAX_BITS, UndecidedError, budget, if_affordable, powered, spend
from passivity.expression.number import written


def test_the_middle_of_what_is_not_finite_is_zero():
    assert near(arb("nan")) == near(arb("inf")) == 0
    assert near((arb(10) ** 30).exp()) == 0  # a ball without a single certain digit
    assert near(arb(2) ** (10**9)) == Fraction(2) ** MAX_BITS


@pytest.mark.parametrize("exponent", [200, -200, 10**9, 10**400])
def test_powers_are_refused_before_they_are_taken(exponent):
    with pytest.raises(ExpressionError, match=r"too long|too high"):
        powered(Fraction(10**308, 3), exponent, 400, 1024)
    assert powered(1, exponent, 0, 1) == 1


def test_huge_numbers_from_python_are_refused_in_a_sentence():
    for number in (Fraction(10) ** 10**6, 10**40_000, Fraction(1, 7**50_000)):
        with pytest.raises(ExpressionError, match=r"numerator\[0\]: the numbers are too long"):
            RationalFunction.from_coefficients([number], [1])
    assert RationalFunction.from_coefficients([1e308, 5e-324], [1]).degree == 1
    with pytest.raises(ExpressionError, match="too high"):
        RationalFunction.from_expression("1 + s") ** 10**6


def test_numbers_of_any_length_are_written():
    x = Fraction(1, 3**20_000)
    assert written(x) == f"1/{written(Fraction(3**20_000))}"
    assert len(written(x)) > 9_000


def test_work_within_counts_against_the_budget_around():
    with budget(100):
        with budget(1000):
            spend(60, "a part")
        with pytest.raises(UndecidedError, match="the rest takes too long"):
            spend(50, "the rest")
    spend(10**18, "what nobody limits")
    assert if_affordable(10, spend, 11, "a part") is None
