"""Poles, balls, and lines with passive and active ends."""

import json
import math
import re
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb

from passivity import (
    ExpressionError,
    Kind,
    RationalFunction,
    Status,
    check_line,
)
from passivity.ball import near
from passivity.budget import MAX_BITS, UndecidedError, budget, if_affordable, powered, spend
from passivity.calculus.ask import ask
from passivity.calculus.question import check_file
from passivity.calculus.values import Spot
from passivity.expression.number import written


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("exp(-3*s)*(s+2)/(s-2)", Kind.BR),
        ("exp(-3*s)*(s+2)/(s-2)", Kind.PR),
        ("exp(-300*s)*(s+2)/(s-2)", Kind.BR),
        ("exp(-3000*s)/(s-2)", Kind.BR),
        ("1e-400*exp(-s)/(s-1)", Kind.BR),
        ("exp(-3*s)*(s+2)/(s-2)/1000 + 1", Kind.PR),
        ("1 + exp(-20*s)/(s^2 - 2*s + 5)", Kind.PR),
        ("1e-15*exp(-3*s)/(s^2 + 1)", Kind.BR),
        ("exp(-s)*sqrt(s + 1)/(s - 1)", Kind.BR),
        ("tanh(s)/(s - 3)", Kind.PR),
        ("(1 - exp(-s))/s^2", Kind.BR),
        ("exp(-2*s)/(s-2) - exp(-s)*exp(-4)/(s-2)", Kind.BR),
    ],
)
def test_an_unstable_pole_outside_the_exponentials_refutes(text, kind):
    verdict = ask(text, kind)
    assert verdict.status is Status.REFUTED
    assert verdict.witness
    assert verdict.why


LONG = "exp(-1e10*s)*(s+2)/(s-2)"


@pytest.mark.parametrize(
    ("text", "kind", "pole"),
    [
        (LONG, Kind.BR, 2),
        ("exp(-1e300*s)/(s-2)", Kind.BR, 2),
        (f"1 + {LONG}", Kind.PR, 2),
        (f"(1 - {LONG})/(1 + {LONG})", Kind.PR, 2),
        ("exp(-1e10*s)/(s^2 - 2*s + 2)^2", Kind.BR, 1 + 1j),
        ("exp(-1e9*sqrt(s))/(sqrt(s) - 2)", Kind.BR, 4),
        ("exp(-1e5*s)/(log(s) - 1)", Kind.BR, math.e),
    ],
)
def test_a_pole_behind_any_delay_refutes(text, kind, pole):
    """Where exp(-T s) is below 10^-8685889638 no digits tell a point near the pole: a divisor that is as small does."""
    verdict = ask(text, kind)
    assert verdict.status is Status.REFUTED
    assert complex(verdict.witness.re, verdict.witness.im) == pytest.approx(pole)
    assert verdict.witness.spot.radius < 1e-9
    assert check_file(json.loads(json.dumps(verdict.evidence))) is None


@pytest.mark.parametrize(
    ("text", "kind", "distance"),
    [
        ("exp(-60*s)/(s^2 - 4*s + 4.01)", Kind.BR, 2),
        ("exp(-60*s)/(s^2 - 4*s + 3.99)", Kind.BR, 2.1),
        ("exp(-60*s)/(s^3 - 3*s^2 + 3.01*s - 1.01)", Kind.BR, 1),
        ("exp(-40*s)*(s + 1)/(s^2 - 2*s + 1.0001)", Kind.BR, 1),
        ("exp(-20*s)*tanh(s - 5)/10", Kind.BR, 5),
        ("exp(-500*s)*tanh(s - 5)/10", Kind.BR, 5),
        ("exp(-100*s)/log(s)", Kind.BR, 1),
        ("10 + exp(-100*s)*tanh(s - 1)/100", Kind.PR, 1),
        ("1 + exp(-100*s)*tanh(1/(s - 3))", Kind.PR, 3),
    ],
)
def test_poles_near_each_other_or_of_a_function_refute(text, kind, distance):
    """No disc shows them: a divisor's balls are too wide along its edge, or the whole does not depend on it."""
    verdict = ask(text, kind)
    assert verdict.status is Status.REFUTED
    assert float(verdict.witness.re) == pytest.approx(distance)
    assert verdict.witness.spot is None
    assert check_file(json.loads(json.dumps(verdict.evidence))) is None


def test_a_point_near_a_zero_is_told_by_its_disc_and_the_value_there():
    why = ask("1 + " + LONG, Kind.PR).why
    assert re.fullmatch(
        r"Re Z\(s\) < 0 at a point within \S+e-\d+ of s = 2 \+ 0j, where a part of the function is .*2\^-\S+", why
    )
    assert (
        "a part of the function is -2^-16" in replace(ask(LONG, Kind.BR).witness, spot=Spot(Fraction(1), 1, 16, 2)).why
    )


@pytest.mark.parametrize(
    "spot",
    [
        ["3", 5, 2**40, 0],
        ["1/1048576", 1, 2**40, 0],
        ["1/1048576", 0, 2**40, 0],
        ["1/1048576", 4, 1, 0],
        ["1/1048576", 99, 2**40, 0],
        ["1/1048576", 4, -(2**40), 0],
        ["-1/1048576", 4, 2**40, 0],
        ["1/1048576"],
    ],
)
def test_other_spots_are_no_witnesses(spot):
    """A disc beyond the half plane, of a part without a zero there, or one that is not that small along its edge."""
    told = ask(LONG, Kind.BR).evidence
    assert check_file(told | {"s": ["5/2", "0"]}) is not None
    assert check_file(told | {"spot": spot}) is not None


def test_a_load_far_behind_a_line():
    """Z + z0 = 0 at s = 51: there the wave that comes back is as large as it takes, whatever the line loses."""
    verdict = ask("line(50, 1e10*s, 1 - s)", Kind.PR)
    assert verdict.refuted
    assert abs(verdict.witness.re - 51) <= verdict.witness.spot.radius
    assert check_file(verdict.evidence) is None
    for other in (-1, 0, 99, -99):
        assert check_file(verdict.evidence | {"spot": [verdict.evidence["spot"][0], other, 2**1400, 0]}) is not None


@pytest.mark.parametrize("text", ["exp(-1e10*s)*(exp(-s) - exp(-2))/(s - 2)", "exp(-1e5*s)*(s - 2)/(s - 2)/(s + 1)"])
def test_no_pole_is_left_where_a_factor_takes_it(text):
    assert ask(text, Kind.BR).status is not Status.REFUTED


@pytest.mark.parametrize("at", ["2", "1/3", "17"])
@pytest.mark.parametrize("form", ["exp(-s)/(s-{a}) - exp(-{a})/(s-{a})", "(exp(-s) - exp(-{a}))*(s+{a})/(s^2-({a})^2)"])
def test_a_pole_that_the_exponentials_cancel_is_no_reason(at, form):
    """|(exp(-s) - exp(-a))/(s - a)| <= 1 as a mean of exp(-x) over the way from a to s."""
    assert ask(form.replace("{a}", f"({at})"), Kind.BR).status is not Status.REFUTED


def test_poles_of_sums_are_found_too():
    assert ask("exp(-3*s)/(1000*(s - 2 + exp(-10*s)/1000))", Kind.BR).status is Status.REFUTED


@pytest.mark.parametrize("delay", ["3 ns", "2M", "1e30"])
@pytest.mark.parametrize("load", ["-s", "(s+3)/(s-1)", "-1/(1+s)"])
def test_an_active_load_is_seen_through_any_delay(load, delay):
    chain = check_line(RationalFunction.from_expression(load), Fraction(10), delay)
    assert [step.status for _, step in chain.statements[1:]] == [Status.REFUTED] * 3


of = RationalFunction.from_expression


@pytest.mark.parametrize(
    ("load", "delay", "words"),
    [
        ("0", 1, "short-circuited and G1 = coth(Ts)"),
        ("0", 0, "G1 is infinite"),
        ("1/0", 1, "open and G1 = tanh(Ts)"),
        ("1/0", 0, "without delay"),
        ("50", "1 ns", "matched and G1 = 1"),
        ("s", 1, "nothing is lost"),
        ("25", 1, ">= 0"),
    ],
)
def test_passive_ends_make_passive_ports(load, delay, words):
    chain = check_line(of(load), 50, delay)
    assert [step.status for _, step in chain.statements] == [Status.PROVED] * 4
    assert chain.status is Status.PROVED
    assert words in chain.statements[-1][1].why
    assert (chain.witness, chain.input) == (None, None)


@pytest.mark.parametrize("load", ["-1", "-1/2", "-50", "(s + 3)/(s - 1)", "-s", "s - 1/s", "1/(1 - s)", "1/s^3"])
@pytest.mark.parametrize("delay", [0, "1/1000", 1, 30])
def test_active_ends_make_active_ports(load, delay):
    chain = check_line(of(load), 1, delay)
    assert [step.status for _, step in chain.statements] == [Status.REFUTED] * 4
    assert chain.witness.re > 0
    assert chain.input.real < 0


@pytest.mark.parametrize(("z0", "delay"), [(0, 1), (-1, 1), ("x", 1), (1, -1), (1, "x"), (1, math.inf)])
def test_lines_that_are_none(z0, delay):
    with pytest.raises(ExpressionError, match=r"z0|delay"):
        check_line(of("s"), z0, delay)


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
