"""Verdicts on the ports of lines behind loads."""

import math

import pytest

from passivity import (
    ExpressionError,
    RationalFunction,
    Status,
    check_line,
)

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
