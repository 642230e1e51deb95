"""The arithmetic of discs, forms and fields; each rule once; proofs that were tampered with; balls; zero counts."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import acb, arb

from passivity.delayed import reflection
from passivity.delayed.boxes import UnresolvedError, holds, prove_in_balls
from passivity.calculus.ask import check_expression
from passivity.delayed.disc import RIGHT, UNIT, Disc
from passivity.delayed.field import Field
from passivity.delayed.proof import ProofStep
from passivity.delayed.prove import prove
from passivity.delayed.roots import rightmost_roots, roots_right
from passivity.delayed.translate import of_text
from passivity.delayed.value import value
from passivity.delayed.verify import RULES, verify_proof
from passivity.errors import ExpressionError
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status

INF = math.inf
of = RationalFunction.from_expression


def disc(low, high):
    return Disc(*(x if x in (INF, -INF) else Fraction(x) for x in (low, high)))


@pytest.mark.parametrize(
    ("given", "inverse"),
    [
        (disc(0, 2), disc("1/2", INF)),
        (disc(1, INF), disc(0, 1)),
        (RIGHT, RIGHT),
        (disc("1/2", 4), disc("1/4", 2)),
        (disc(-2, 0), disc(-INF, "-1/2")),
        (disc(-INF, -3), disc("-1/3", 0)),
        (disc(-4, -2), disc("-1/2", "-1/4")),
        (UNIT, None),
        (disc(0, 0), None),
    ],
)
def test_inverse_of_a_disc(given, inverse):
    assert given.inverse() == inverse
    if inverse is None:
        return
    low, high = max(given.low, -100), min(given.high, 100)
    middle, radius = float(low + high) / 2, float(high - low) / 2
    for k in range(1, 12):  # points of the disc, by complex numbers
        w = 1 / (middle + radius * complex(math.cos(k), math.sin(k)))
        a, b = max(inverse.low, -1e9), min(inverse.high, 1e9)
        assert abs(w - float(a + b) / 2) <= float(b - a) / 2 * (1 + 1e-9)


def test_sums_and_multiples_of_discs():
    assert disc(-1, 2) + disc(3, INF) == disc(2, INF)
    assert disc(1, INF).scaled(Fraction(-2)) == disc(-INF, -2)
    assert disc(0, 1) <= UNIT
    assert not UNIT <= RIGHT
    assert disc(10**400, INF) + disc(-(10**500), 0) == disc(10**400 - 10**500, INF)  # longer than floats


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("a*(b - exp(-s))", "1 - 2*exp(-s)"),
        ("sqrt(s)*sqrt(s)*s", "s^2"),
        ("1/tanh(s)/cosh(s)", "coth(s)*sech(s)"),
        ("exp(0)*log(1) + sqrt(4/9)", "2/3"),
        ("s*exp(-s)*s/(2*s^3)", "exp(-s)/(2*s)"),
        ("(1 - exp(-3*s))/(3*s + 1)", "(1 - exp(-3*s))/(3*s + 1)"),
        ("exp(-s) - exp(-s)", "0"),
    ],
)
def test_forms_are_collected(text, written):
    given = {"a": 2, "b": "1/2"} if "a*" in text else {}
    assert str(of_text(text, given)) == written


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("sqrt((1 + 2*s)*(3 + s))*sqrt((1 + 2*s)/(3 + s))", "1 + 2*s"),
        ("sqrt(s^2)", "s"),
        ("sqrt(2)*sqrt(3)", "sqrt(6)"),
        ("1/(sqrt(8) - sqrt(2))", "sqrt(2)/2"),
        ("exp(1 - s/3)^3", "exp(3)*exp(-s)"),
        ("tanh(3*sqrt(s))", "1 - 2/(1 + exp(6*sqrt(s)))"),
        ("sinh(s)*csch(s)", "1"),
        ("cosh(s)^2 - sinh(s)^2", "1"),
        ("exp(-2*(s + sqrt(s)))", "exp(-s)*exp(-s)*exp(-2*sqrt(s))"),
    ],
)
def test_equal_functions(a, b):
    first, second = of_text(a), of_text(b)
    assert Field(first, second).equal(first, second)
    s = acb(arb(7) / 5, arb(3) / 4)
    assert abs(value(first, s) - value(second, s)) < 1e-12  # so is their value


@pytest.mark.parametrize(
    ("a", "b"), [("sqrt((s - 1)^2)", "s - 1"), ("sqrt(s^4)", "s^2"), ("exp(-s)", "exp(-2*s)"), ("sqrt(s)", "s")]
)
def test_roots_are_not_split_where_the_branch_may_change(a, b):
    first, second = of_text(a), of_text(b)
    assert not Field(first, second).equal(first, second)


# one for each rule, the rule being the last step or below it
PROOFS = [
    ("constant", "PR", "sqrt(2)"),
    ("rational", "PR", "exp(0*s)*s + sqrt(s)"),
    ("factors", "PR", "sqrt((1 + s + 1/s)*(2 + s + 3/s))"),
    ("sum", "PR", "s + 1 + exp(-s)"),
    ("multiple", "BR", "-s*exp(-s)/(1 + s)"),
    ("inverse", "PR", "1/(s + 1 + exp(-s))"),
    ("moduli", "BR", "exp(-s)*s/(s^2 + s + 1)"),
    ("product", "PR", "sqrt(s)*sqrt(s + exp(-s) + 1)"),
    ("square", "PR", "sqrt(s + 1)/(s + 2)*sqrt(s + 3)*sqrt((s + 2)/(s + 4))*sqrt((s + 2)/(s + 5))"),
    ("half-plane", "PR", "sqrt(s)"),
    ("root", "PR", "sqrt(s*s + 1)"),
    ("logarithm", "PR", "log(2 + s)"),
    ("hyperbolic", "PR", "tanh(s + sqrt(s))"),
    ("diffusion", "BR", "1/cosh(sqrt(s))"),
    ("exponential", "BR", "exp(-sqrt((1 + 2*s)*(3 + s)))"),
    ("power", "PR", "exp(4/5*log(s))"),
    ("mean", "PR", "log(1 + s)/s"),
    ("mean", "BR", "(1 - exp(-3*s))/(3*s)"),
    ("equal", "PR", "(s + 1 - exp(-2*s))/(s + 1 + exp(-2*s))"),
    ("equal", "PR", "50*(25 + 50*tanh(s))/(50 + 25*tanh(s))"),
    ("equal", "BR", "(9/10 + 9/10*exp(-s))/(1 + 81/100*exp(-s))"),
    ("equal", "BR", "(sqrt(s) - 1)/(sqrt(s) + 1)"),
    ("equal", "PR", "sinh(s)/cosh(s)"),
    ("equal", "PR", "s*sqrt(s)/(s + sqrt(s))"),
    ("equal", "PR", "sqrt(1 + s^2) - s"),
    ("line", "PR", "coth(sqrt(s))/sqrt(s)"),
    ("line", "PR", "sqrt((1 + 2*s)/(3 + s))*tanh(3*sqrt((1 + 2*s)*(3 + s)))"),
    ("line", "PR", "a*(5 + a*tanh(b))/(a + 5*tanh(b))"),
]


def steps(step):
    yield step
    for premise in step.premises:
        yield from steps(premise)


def proof(kind, text):
    if "b" in text:
        a, b = "sqrt((1 + 2*s)/(3 + s))", "sqrt((1 + 2*s)*(3 + s))"
        text = f"{a}*(5 + {a}*tanh({b}))/({a} + 5*tanh({b}))"
    return prove(of_text(text), RIGHT if kind == "PR" else UNIT)


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_each_rule(rule, kind, text):
    found = proof(kind, text)
    assert found is not None
    assert rule in {step.rule for step in steps(found)}
    assert verify_proof(found)
    assert len(list(found.lines())) == len(list(steps(found)))


def test_the_rules_are_all_tested():
    assert {rule for rule, _, _ in PROOFS} == set(RULES)


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_sharper_claims_are_not_verified(rule, kind, text):
    for step in steps(proof(kind, text)):
        if isinstance(step.claim, Disc):
            up = step.claim.low + 1 if step.claim.low > -INF else step.claim.low
            sharper = replace(step, claim=Disc(up, step.claim.high - 1 if step.claim.high < INF else INF))
        else:
            sharper = replace(step, claim=step.claim - 1)
        assert not verify_proof(sharper)


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_claims_about_another_function_are_not_verified(rule, kind, text):
    for step in steps(proof(kind, text)):
        assert not verify_proof(replace(step, form=step.form - of_text("s^3 + 7")))


def test_a_leaf_needs_its_certificate():
    leaf = next(step for step in steps(proof("PR", "1/(s + 1 + exp(-s))")) if step.rule == "rational")
    assert verify_proof(leaf)
    assert not verify_proof(replace(leaf, certificate=None))


def test_a_function_without_values_is_nothing():
    nowhere = of_text("1/(sqrt(s^2) - s)")
    assert not verify_proof(ProofStep("half-plane", nowhere, RIGHT, (ProofStep("constant", nowhere, Fraction(0)),)))


def g1(k, delay):
    return f"(s + 1 - {k}*exp(-{delay}*s))/(s + 1 + {k}*exp(-{delay}*s))"


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        *(("PR", g1(k, 2)) for k in (".9", ".999", "(1 - 1e-6)", "(1 - 1e-9)")),
        *(("PR", g1(".9", delay)) for delay in (".1", "10", "100")),
        ("BR", "1/(s + 1.1 + exp(-s))"),
        ("BR", "(.5*exp(-s) + .4*exp(-sqrt(2)*s))/(s + 1)"),
        ("PR", "1/(s + 1.1 + exp(-s))"),
        ("PR", "s + 2 + exp(-s)/(1 + s)"),
    ],
)
def test_balls(kind, text):
    found = prove_in_balls(Kind[kind], of_text(text))
    assert holds(found)
    assert not holds(replace(found, cuts=found.cuts[:-1]))
    assert not holds(replace(found, form=of_text(text) - of_text("3*s^2")))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (g1("1", 2), "the room"),
        (g1("2", 2), "the room"),
        ("sqrt(s) + 1", "not rational in s and delays"),
        ("exp(2*s)/2", "far out"),
        ("2 + (1 + s/2 + s^2/12)*exp(-s)/(1 - s/2 + s^2/12)", "zeros"),
    ],
)
def test_balls_do_not_prove_what_is_not_strict(text, words):
    with pytest.raises(UnresolvedError, match=words):
        prove_in_balls(Kind.PR, of_text(text))


COMPLEX = [
    "1 + 1e-400*(exp(-s*sqrt(sqrt(-1))) + exp(-s/sqrt(sqrt(-1))))",  # grows like exp(0.7 |s|) beside the axis
    "2 + exp(-s)*log(-2)*1e-30",  # not real for real s
    "2 + exp(-log(-2)*s)*1e-400",
]


@pytest.mark.parametrize("text", COMPLEX)
def test_constants_that_are_not_real_prove_nothing(text):
    with pytest.raises(UnresolvedError, match="not known to be real"):
        prove_in_balls(Kind.PR, of_text(text))
    assert check_expression(text, Kind.PR).status is not Status.PROVED


@pytest.mark.parametrize("text", COMPLEX)
def test_a_wrong_translation_is_caught(text, monkeypatch):
    monkeypatch.setattr(reflection, "_real", lambda constant: value(constant, acb(1)).real)
    with pytest.raises(UnresolvedError, match="zeros"):
        prove_in_balls(Kind.PR, of_text(text))


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("PR", "3*s + 1/(2*s + 5 + exp(-s)*sqrt(2)/(1 + s))"),
        ("BR", "1/(s + 2 + exp(-s))"),
        ("PR", "1/(s + 2 + exp(-s))"),
    ],
)
def test_a_reflection_leads_back_to_its_function(kind, text):
    form, s = of_text(text), acb(1, 2) / 3
    found = reflection.reflection(Kind[kind], form)
    assert found.given(Kind[kind], s).overlaps(value(form, s))
    assert not found.given(Kind[kind], s).overlaps(value(form, s) + 1e-9)


def test_the_unresolved_box_is_named():
    verdict = check_expression("s/(s + 1 - exp(-s))", Kind.PR)
    assert verdict.status is Status.UNDECIDED
    assert "for ω from 0 to" in verdict.why


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("sqrt(s^2 - 1)", "PR"),
        ("sqrt(s - 3)", "PR"),
        ("log(s - 1)", "PR"),
        ("sqrt(-1)*s/(1 + s)", "BR"),
        ("1.0000001*s + exp(-1n*s) + .999999999", "PR"),
        ("exp(-s)/(s^2 + s/1000000 + 1)/1000*1.001", "BR"),
        (g1("(1 + 1e-12)", 2), "PR"),
        ("1/(1 + s*exp(-s)/20)", "PR"),
        ("exp(s)*1e-30", "BR"),
    ],
)
def test_refuted(text, kind):
    verdict = check_expression(text, Kind[kind])
    assert verdict.status is Status.REFUTED
    assert verdict.witness.re > 0
    again = value(verdict.form, acb(*(arb(x.numerator) / x.denominator for x in verdict.witness[:2])))
    assert again.overlaps(verdict.witness.value)
    if "not real" in verdict.why:
        assert verdict.witness.im == 0
        assert not again.imag.contains(0)
    else:
        assert verdict.witness.value.real < 0 if kind == "PR" else abs(verdict.witness.value) > 1


def test_rational_expressions_go_to_the_exact_test():
    verdict = check_expression("R + s*L", Kind.PR, {"R": "50 ohm", "L": "10 nH"})
    assert verdict.rational.status is verdict.status is Status.PROVED
    assert check_expression("sqrt(4)*s*exp(0)", Kind.PR).rational.status is Status.PROVED
    assert check_expression("1/0", Kind.PR).status is Status.PROVED  # the open circuit
    assert check_expression("1/(s - 1)", Kind.PR).witness is None
    assert check_expression("1/(s - 1)", Kind.PR).rational.witness is not None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1/(exp(-s) - exp(-s))", "division by zero"),
        ("sqrt(2/0)^-2", "division by zero"),
        ("1/(sqrt(s^2) - s)", "no value in reach"),
        ("log(0)*s", "log(0) has no value"),
        ("coth(0) + exp(-s)", "coth(0) has no value"),
        ("exp(-k*s)", "parameter k: no value"),
        ("+".join(f"exp(-{k}*s)" for k in range(1, 400)), "too large"),
        ("*".join(f"(s + {k} + exp(-s))" for k in range(1, 200)), "too large"),
        ("sqrt(" * 60 + "s" + ")" * 60, "nested too deeply"),
        ("exp(" * 60 + "s" + ")" * 60, "nested too deeply"),
        ("exp(exp(exp(exp(5))))*s", "no value in reach"),
        ("(s^200 + 1)^3*exp(-s)", "degree"),
        ("cos(s)", "unknown function"),
    ],
)
def test_refused_at_once(text, words):
    with pytest.raises(ExpressionError, match=words.replace("(", r"\(").replace(")", r"\)")):
        check_expression(text, Kind.PR)


@pytest.mark.parametrize(
    ("h2", "delay"),
    [
        ("2/(1 + s)", "1/20"),
        ("2/(1 + s)", 1),
        ("3/2*s/(s^2 + s + 1)", 3),
        ("1.1*s/(s^2 + s + 1)", "0.785"),
        ("9/10", 1),
        ("-3*(1 - s)/(s^2 + 4)", "1/3"),
        ("2/(s - 1)", 1),
        ("1e-22*s^2*.9/(1e-22*s^2 + 1e-10*s + 1)", "1n"),
    ],
)
@pytest.mark.parametrize("sign", [1, -1])
def test_zero_counts_against_the_argument_principle_in_floats(h2, delay, sign):
    h, twice = of(h2), 2 * float(of(str(delay)).numerator[0] / of(str(delay)).denominator[0])
    p, q = ([float(c) for c in side] for side in (h.numerator, h.denominator))
    size = max(np.abs(np.concatenate([np.roots(p), np.roots(q), [1 / twice]])))
    radius, edge = 20 * size, 1e-9 * size
    turn = np.linspace(math.pi / 2, -math.pi / 2, 20_001)
    path = edge + np.concatenate([1j * np.linspace(-radius, radius, 400_001), radius * np.exp(1j * turn)])
    f = np.polyval(q, path) + sign * np.polyval(p, path) * np.exp(-twice * path)
    turned = np.angle(f[1:] / f[:-1]).sum()
    assert roots_right(h, delay, sign) == round(-turned / (2 * math.pi))


def test_zero_counts_at_the_limits():
    assert roots_right(of("3"), 1, 1) == INF
    assert roots_right(of("s"), 1, 1) == INF
    assert roots_right(of("2/(s - 3)"), 0, 1) == 1
    assert roots_right(of("0"), 1, 1) == 0
    for text in ("1", "(1 - s)/(1 + s)"):
        with pytest.raises(UndecidedError):
            roots_right(of(text), 1, 1)
    for arguments in ((of("1/2"), -1, 1), (of("1/2"), 1, 2), (of("1/0"), 1, 1), (of("-1"), 0, 1)):
        with pytest.raises(ExpressionError):
            roots_right(*arguments)


def test_rightmost_roots_are_roots():
    h = of("3/2*s/(s^2 + s + 1)")
    found = rightmost_roots(h, "1/20", -1, 5)
    assert len(found) == 5
    assert all(a.real >= b.real - 1e-9 for a, b in pairwise(found))
    for s in found:
        assert abs(1 - h(s) * complex(mpmath.exp(-s / 10))) < 1e-9
