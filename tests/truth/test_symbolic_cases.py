"""Functions with parameters whose exact condition is known; evidence is evaluated with mpmath from the text alone."""

import itertools
import json
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

from passivity.calculus.ask import of_text as check_symbolic
from passivity.status import Kind, Status

CASES = json.loads((Path(__file__).parent / "symbolic_cases.json").read_text(encoding="utf-8"))["cases"]
GRID = [
    mpmath.mpc(re, im)
    for re, im in itertools.product(
        (mpmath.mpf(10) ** k for k in (-8, -2, -1, 0, 1)), (x / mpmath.mpf(8) for x in range(0, 60, 3))
    )
]


def evaluate(expr, s, values):
    """The expression as Python reads it, with 40 digits."""
    numbers = {name: mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator for name, x in values.items()}
    return eval(expr.replace("^", "**"), {"s": s, "exp": mpmath.exp, "T": mpmath.mpf(0), **numbers})


def broken(case, s, values):
    """Whether the property fails at s, or s is a pole."""
    try:
        value = evaluate(case["expr"], s, values)
    except ZeroDivisionError:
        return True
    return value.real < 0 if case["kind"] == "PR" else abs(value) > 1


@pytest.fixture(autouse=True)
def _digits():
    with mpmath.workdps(40):
        yield


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_condition_and_counterexample(case):
    verdict = check_symbolic(case["expr"], Kind[case["kind"]], case["assumptions"])
    assert verdict.status is Status.REFUTED
    assert str(verdict.condition) == case["verdict"]
    found = verdict.witness
    assert not verdict.condition.holds(found.names)
    assert found.re > 0
    s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (found.re, found.im)))
    assert broken(case, s, found.names)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_the_condition_with_numbers(case):
    condition = check_symbolic(case["expr"], Kind[case["kind"]], case["assumptions"]).condition
    for values in case["inside"]:
        assert condition.holds(values)
        constant_infinite = case["name"] == "sym_line_T0_real_load" and values["k"] == "-1"
        assert constant_infinite or not any(broken(case, s, values) for s in GRID)
    for values in case["outside"]:
        assert not condition.holds(values)
        assert any(broken(case, s, values) for s in GRID)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_with_the_condition_as_an_assumption_it_is_proved(case):
    """Where the condition is one range, it can be assumed; what is proved then is not broken anywhere we look."""
    if " or " in case["verdict"]:
        assumed = [f"{name} = {x}" for name, x in case["inside"][0].items()]
    else:
        ranges = case["verdict"].split(" and ")
        assumed = ranges + [a for a in case["assumptions"] if not any(a.split()[0] in r for r in ranges)]
    verdict = check_symbolic(case["expr"], Kind[case["kind"]], assumed)
    assert verdict.status is Status.PROVED
    assert verdict.certificate or verdict.steps


def test_where_a_short_line_is_infinite_is_said():
    verdict = check_symbolic("(1 - k*exp(-2*T*s))/(1 + k*exp(-2*T*s))", Kind.PR, ["k real", "T = 0"])
    assert verdict.note.startswith("where k + 1 = 0 it is infinite")
