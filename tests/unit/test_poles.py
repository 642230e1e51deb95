"""Unstable poles beside delays refute; poles that cancel do not."""

from fractions import Fraction

import pytest

from passivity import Kind, RationalFunction, Status, check_line
from passivity.calculus.ask import ask
from passivity.calculus.graph import Graph
from passivity.calculus.read import read
from passivity.delayed.poles import find_pole


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("exp(-3*s)*(s+2)/(s-2)", Kind.BR),
        ("exp(-3*s)*(s+2)/(s-2)", Kind.PR),
        ("exp(-1e10*s)*(s+2)/(s-2)", Kind.BR),
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
    assert verdict.pole or verdict.witness
    assert verdict.why


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("at", ["2", "1/3", "17"])
@pytest.mark.parametrize("form", ["exp(-s)/(s-{a}) - exp(-{a})/(s-{a})", "(exp(-s) - exp(-{a}))*(s+{a})/(s^2-({a})^2)"])
def test_a_pole_that_the_exponentials_cancel_is_none(kind, at, form):
    graph = Graph()
    function = read(graph, form.replace("{a}", f"({at})"))
    found = find_pole(kind, graph, function)
    assert found is None or found.word == "zero"


def test_a_removable_pole_is_not_a_reason():
    """|(exp(-s) - exp(-2))/(s - 2)| <= 1 as a mean of exp(-x) over the way from 2 to s."""
    assert ask("exp(-s)/(s-2) - exp(-2)/(s-2)", Kind.BR).status is not Status.REFUTED


def test_poles_of_sums_are_found_too():
    assert ask("exp(-3*s)/(1000*(s - 2 + exp(-10*s)/1000))", Kind.BR).status is Status.REFUTED


@pytest.mark.parametrize("delay", ["3 ns", "2M", "1e30"])
@pytest.mark.parametrize("load", ["-s", "(s+3)/(s-1)", "-1/(1+s)"])
def test_an_active_load_is_seen_through_any_delay(load, delay):
    chain = check_line(RationalFunction.from_expression(load), Fraction(10), delay)
    assert [step.status for _, step in chain.statements[1:]] == [Status.REFUTED] * 3
