"""The arithmetic of discs, forms and fields; each rule once; proofs that were tampered with; balls; zero counts."""

import json
import math
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import acb, arb
from rightmost_roots import rightmost_roots

from passivity import ExpressionError, Kind, RationalFunction, Status, roots_right
from passivity.ball import of_point
from passivity.calculus.ask import ask
from passivity.calculus.expand import Expansion
from passivity.calculus.fact import BOUNDED_REAL, POSITIVE_REAL, width_of
from passivity.calculus.graph import Graph
from passivity.calculus.proof import prove, verify
from passivity.calculus.question import Question, read
from passivity.calculus.values import in_ball, in_floats
from passivity.delayed import boxes
from passivity.delayed.boxes import UnresolvedError, prove_in_balls, rule_balls
from passivity.polynomial.sign import UndecidedError
from passivity.verifier import check, implies, inverted, is_nonnegative, scaled

INF = math.inf
of = RationalFunction.from_expression


def disc(low, high):
    return tuple(x if x in (INF, -INF) else Fraction(x) for x in (low, high))


RIGHT, UNIT = disc(0, INF), disc(-1, 1)


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
    assert inverted(*given) == inverse
    if inverse is None:
        return
    low, high = max(given[0], -100), min(given[1], 100)
    middle, radius = float(low + high) / 2, float(high - low) / 2
    for k in range(1, 12):  # points of the disc, by complex numbers
        w = 1 / (middle + radius * complex(math.cos(k), math.sin(k)))
        a, b = max(inverse[0], -1e9), min(inverse[1], 1e9)
        assert abs(w - float(a + b) / 2) <= float(b - a) / 2 * (1 + 1e-9)


def test_multiples_of_discs():
    assert scaled(("disc", *disc(1, INF)), Fraction(-2)) == ("disc", *disc(-INF, -2))
    assert implies(("disc", *disc(0, 1)), BOUNDED_REAL)
    assert not implies(BOUNDED_REAL, POSITIVE_REAL)
    assert width_of(("disc", Fraction(10) ** 400, INF)) == INF


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("2*(1/2 - exp(-s))", "1 - 2*exp(-s)"),
        ("sqrt(s)*sqrt(s)*s", "s^2"),
        ("1/tanh(s)/cosh(s)", "coth(s)*sech(s)"),
        ("exp(0)*log(1) + sqrt(4/9)", "2/3"),
        ("s*exp(-s)*s/(2*s^3)", "exp(-s)/(2*s)"),
        ("exp(-s) - exp(-s)", "0"),
        ("sinh(s)*csch(s)", "1"),
        ("exp(1 - s/3)^3", "exp(3 - s)"),
    ],
)
def test_equal_functions_are_one_node(text, other):
    graph = Graph()
    assert read(graph, text) == read(graph, other)


def pairs(*texts):
    """Numerator and denominator of several functions, multiplied out."""
    graph = Graph()
    values = [read(graph, text) for text in texts]
    expansion = Expansion(graph, graph.node("sum", tuple((Fraction(1), n) for n in {n for _, n in values} | {0})))
    return [expansion.of(value) for value in values], [
        in_ball(graph, value, acb(arb(7) / 5, arb(3) / 4)) for value in values
    ]


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("1/(sqrt(2) - 1)", "sqrt(2) + 1"),
        ("tanh(3*sqrt(s))", "1 - 2/(1 + exp(6*sqrt(s)))"),
        ("cosh(s)^2 - sinh(s)^2", "1"),
        ("exp(-2*(s + sqrt(s)))", "exp(-s)*exp(-s)*exp(-2*sqrt(s))"),
        ("line(2, s, 3)", "2*(3 + 2*tanh(s))/(2 + 3*tanh(s))"),
    ],
)
def test_equal_functions_multiplied_out(a, b):
    (x, y), (u, v) = pairs(a, b)
    expansion_of_difference = x.p * y.q - y.p * x.q
    assert not expansion_of_difference or "sqrt(2)" in a
    assert abs(u - v) < 1e-12  # so is their value


@pytest.mark.parametrize(
    ("a", "b"), [("sqrt((s - 1)^2)", "s - 1"), ("sqrt(s^4)", "s^2"), ("exp(-s)", "exp(-2*s)"), ("sqrt(s)", "s")]
)
def test_roots_are_not_split_where_the_branch_may_change(a, b):
    (x, y), _ = pairs(a, b)
    assert x.p * y.q != y.p * x.q


# one for each rule, the rule being the last step or before it
PROOFS = [
    ("leaf", "PR", "s + exp(-s) + 1"),
    ("rational", "PR", "exp(0*s)*(s + 1)/(s + 2) + sqrt(s)"),
    ("function", "PR", "sqrt((1 + s + 1/s)*(2 + s + 3/s))"),
    ("combination", "PR", "s + 1 + exp(-s)"),
    ("product", "BR", "-s*exp(-s)/(1 + s)"),
    ("product", "PR", "1/(s + 1 + exp(-s))"),
    ("product", "BR", "exp(-s)*s/(s^2 + s + 1)"),
    ("product", "PR", "sqrt(s)*sqrt(s + exp(-s) + 1)"),
    ("square", "PR", "sqrt(s + 1)/(s + 2)*sqrt(s + 3)*sqrt((s + 2)/(s + 4))*sqrt((s + 2)/(s + 5))"),
    ("function", "PR", "log(2 + s)"),
    ("function", "PR", "tanh(s + sqrt(s))"),
    ("function", "BR", "1/cosh(sqrt(s))"),
    ("function", "BR", "exp(-sqrt((1 + 2*s)*(3 + s)))"),
    ("function", "PR", "exp(4/5*log(s))"),
    ("mean", "PR", "log(1 + s)/s"),
    ("mean", "PR", "s/log(1 + s)"),
    ("mean", "BR", "(1 - exp(-3*s))/(3*s)"),
    ("mean", "PR", "s/(s + 1 - exp(-s))"),
    ("equal", "PR", "(s + 1 - exp(-2*s))/(s + 1 + exp(-2*s))"),
    ("equal", "PR", "50*(25 + 50*tanh(s))/(50 + 25*tanh(s))"),
    ("equal", "BR", "(sqrt(s) - 1)/(sqrt(s) + 1)"),
    ("equal", "PR", "s*sqrt(s)/(s + sqrt(s))"),
    ("line", "PR", "coth(sqrt(s))/sqrt(s)"),
    ("line", "PR", "sqrt((1 + 2*s)/(3 + s))*tanh(3*sqrt((1 + 2*s)*(3 + s)))"),
    ("line", "PR", "a*(5 + a*tanh(b))/(a + 5*tanh(b))"),
]


def proof(kind, text):
    if "b" in text:
        a, b = "sqrt((1 + 2*s)/(3 + s))", "sqrt((1 + 2*s)*(3 + s))"
        text = f"{a}*(5 + {a}*tanh({b}))/({a} + 5*tanh({b}))"
    graph = Graph()
    return prove(Question(graph, read(graph, text), POSITIVE_REAL if kind == "PR" else BOUNDED_REAL, text, {}), text)


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_each_rule(rule, kind, text):
    found = proof(kind, text)
    assert found is not None
    assert rule in {name for _, _, name, _, _ in found["steps"]}
    assert verify(found)


def sharper(fact):
    kind, *ends = fact
    if kind == "arg":
        return [kind, str(Fraction(ends[0]) - 1)]
    low, high = (x if "inf" in x else Fraction(x) for x in ends)
    return [kind, str(low if low == "-inf" else low + 1), str(high if high == "inf" else high - 1)]


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_sharper_claims_are_not_verified(rule, kind, text):
    found = proof(kind, text)
    for k in range(len(found["steps"])):
        forged = json.loads(json.dumps(found))
        forged["steps"][k][1] = sharper(forged["steps"][k][1])
        assert not verify(forged)


@pytest.mark.parametrize(("rule", "kind", "text"), PROOFS)
def test_claims_about_another_function_are_not_verified(rule, kind, text):
    forged = json.loads(json.dumps(proof(kind, text)))
    forged["nodes"].append(["sum", ["1", forged["root"][1]], ["-7", 0]])
    forged["root"][1] = forged["steps"][-1][0] = len(forged["nodes"]) - 1
    assert not verify(forged)


def test_two_nodes_of_s_are_not_taken_for_one():
    """Their difference is 0 and not -s, their product is no positive real s."""
    for node, n in ((["sum", ["-1", 1], ["1", 2]], 3), (["mul", [1, 1], [2, 1]], 3)):
        one = {"fact": ["disc", "0", "inf"], "p": ["0", "1"], "q": ["1"], "factors": [[["0"], 1]], "breaks": []}
        forged = {"format": "passivity proof 1", "names": {}, "root": ["1", n], "claim": ["disc", "0", "inf"]}
        forged |= {"nodes": [["one"], ["s"], ["s"], node], "steps": [[n, one["fact"], "rational", [], one]]}
        assert check(forged) == "step 0, rule 'rational': not rational in s"


def test_a_factor_to_a_negative_power_proves_no_sign():
    """x - 1 is negative below 1, whatever (x - 1) (x - 1)^-1 may be."""
    assert not is_nonnegative([-1, 1], [[["-1", "1"], 1], [["-1", "1"], -1]], ["1"])
    assert is_nonnegative([1, 1], [[["1", "1"], 1]], [])


def test_an_exponential_is_not_rational_in_s():
    """Exponentials are numbered from the end: that of node 1 as the node before the last, which is s here."""
    one = {"fact": ["disc", "0", "inf"], "p": ["0", "1"], "q": ["1"], "factors": [[["0"], 1]], "breaks": []}
    forged = {"format": "passivity proof 1", "names": {}, "root": ["1", 2], "claim": ["disc", "0", "inf"]}
    forged["nodes"] = [["one"], ["s"], ["exp", ["1", 1]], ["s"], ["sum", ["1", 0], ["1", 1]]]
    forged["steps"] = [[2, forged["claim"], "rational", [], one]]
    assert check(forged) == "step 0, rule 'rational': not rational in s"
    forged["steps"][0][0], forged["root"][1] = 1, 1
    assert check(forged) is None  # of s itself it is a proof


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
    graph = Graph()
    value, other = read(graph, text), read(graph, f"{text} - 3*s^2")
    found = prove_in_balls(Kind[kind], graph, value)
    assert rule_balls(graph, value[1], [], json.loads(json.dumps(found)))
    assert not rule_balls(graph, other[1], [], found)
    assert not rule_balls(graph, value[1], [], found | {"cuts": found["cuts"][:-1]})


CASCADE = "let q0 = 100 + 1/s; " + "".join(
    f"let q{k + 1} = (q{k} + {z}*tanh({t}*s/10))/(1 + q{k}*tanh({t}*s/10)/{z}); "
    for k, (z, t) in enumerate([(75, 1), (75, 2), (75, 7), (50, 7), (40, 3), (300, 2)])
)


@pytest.mark.parametrize(
    ("text", "least"),
    [
        ("line(50, 7/10*s, 100 + 1/s) - 5", 15),
        ("1/s + 2 - exp(-s)", 1),
        ("1/(1/s + 2 - exp(-s))", 0),
        (g1("1", 2), 0),
        (f"{CASCADE}q6 - 5", 3),
    ],
)
def test_balls_that_touch_at_0(text, least):
    """A pole at s = 0, or a zero: |X(0)| = 1, and |X| < 1 on the rest of the axis, by some lines also far out."""
    graph = Graph()
    value = read(graph, text)
    data = prove_in_balls(Kind.PR, graph, value)
    assert rule_balls(graph, value[1], [], data)
    w = np.geomspace(1e-4, 300, 3000)
    assert in_floats(graph, value, 1e-12 + 1j * w, {}).real.min() > least - 1e-6
    active = graph.sum([value, (Fraction(-3), graph.s[1])])
    assert not rule_balls(graph, active[1], [], data)


def in_balls_of(text):
    graph = Graph()
    value = read(graph, text)
    data = prove_in_balls(Kind.PR, graph, value)
    if not rule_balls(graph, value[1], [], data):
        raise UnresolvedError("zeros")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (g1("2", 2), "the room"),
        ("sqrt(s) + 1", "not rational in s and delays"),
        ("exp(2*s)/2", "far out"),
        ("2 + (1 + s/2 + s^2/12)*exp(-s)/(1 - s/2 + s^2/12)", "zeros"),
    ],
)
def test_balls_do_not_prove_what_is_not_strict(text, words):
    with pytest.raises(UnresolvedError, match=words):
        in_balls_of(text)


COMPLEX = [
    "1 + 1e-400*(exp(-s*sqrt(sqrt(-1))) + exp(-s/sqrt(sqrt(-1))))",  # grows like exp(0.7 |s|) beside the axis
    "2 + exp(-s)*log(-2)*1e-30",  # not real for real s
    "2 + exp(-log(-2)*s)*1e-400",
]


@pytest.mark.parametrize("text", COMPLEX)
def test_constants_that_are_not_real_prove_nothing(text):
    with pytest.raises(UnresolvedError, match="not known to be real"):
        in_balls_of(text)
    assert ask(text, Kind.PR).status is not Status.PROVED


@pytest.mark.parametrize("text", COMPLEX)
def test_a_wrong_translation_is_caught(text, monkeypatch):
    monkeypatch.setattr(boxes, "_real", lambda graph, constant: in_ball(graph, constant, acb(1)).real)
    with pytest.raises(UnresolvedError, match="zeros"):
        in_balls_of(text)


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("PR", "3*s + 1/(2*s + 5 + exp(-s)*sqrt(2)/(1 + s))"),
        ("BR", "1/(s + 2 + exp(-s))"),
        ("PR", "1/(s + 2 + exp(-s))"),
    ],
)
def test_a_reflection_leads_back_to_its_function(kind, text):
    graph, s = Graph(), acb(1, 2) / 3
    function = read(graph, text)
    found, there = boxes.reflection(Kind[kind], graph, function), in_ball(graph, function, s)
    assert found.given(Kind[kind], s).overlaps(there)
    assert not found.given(Kind[kind], s).overlaps(there + 1e-9)


def test_the_unresolved_box_is_named():
    verdict = ask("s/(s + 2 - exp(-s) - exp(-2*s))", Kind.PR)
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
        ("sqrt((exp(-s) - 1/2)*(sqrt(s) - 3))", "PR"),  # of whose factors nothing is known
    ],
)
def test_refuted(text, kind):
    verdict = ask(text, Kind[kind])
    assert verdict.status is Status.REFUTED
    assert verdict.witness.re > 0
    graph = Graph()
    again = in_ball(graph, read(graph, text), of_point(verdict.witness.re, verdict.witness.im))
    assert again.overlaps(verdict.witness.value)
    if "not real" in verdict.why:
        assert verdict.witness.im == 0
        assert not again.imag.contains(0)
    else:
        assert verdict.witness.value.real < 0 if kind == "PR" else abs(verdict.witness.value) > 1


def test_rational_expressions_go_to_the_exact_test():
    verdict = ask("R + s*L", Kind.PR, values={"R": "50 ohm", "L": "10 nH"})
    assert verdict.function is not None
    assert verdict.status is Status.PROVED
    assert ask("sqrt(4)*s*exp(0)", Kind.PR).function == 2 * of("s")
    assert ask("1/0", Kind.PR).status is Status.PROVED  # the open circuit
    assert ask("1/(s - 1)", Kind.PR).witness.image is not None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1/(exp(-s) - exp(-s))", "division by zero"),
        ("sqrt(2/0)^-2", "division by zero"),
        ("1/(sqrt(s^2) - s)", "no value in reach"),
        ("log(0)*s", "log(0) has no value"),
        ("coth(0) + exp(-s)", "coth(0) has no value"),
        ("exp(-k*s)", "parameter k: no value"),
        ("exp(" * 60 + "s" + ")" * 60, "no value in reach"),
        ("exp(exp(exp(exp(5))))*s", "no value in reach"),
        ("(s^200 + 1)^3*sqrt(s^2)^2", "degree"),
        ("cos(s)", "unknown function"),
    ],
)
def test_refused_at_once(text, words):
    with pytest.raises(ExpressionError, match=words.replace("(", r"\(").replace(")", r"\)")):
        ask(text, Kind.PR)


@pytest.mark.parametrize(
    ("text", "status"),
    [
        ("+".join(f"exp(-{k}*s)" for k in range(1, 400)), Status.REFUTED),
        ("400 + " + "+".join(f"exp(-{k}*s)" for k in range(1, 400)), Status.PROVED),
        ("sqrt(" * 60 + "s" + ")" * 60, Status.PROVED),
        ("(s^200 + 1)^3*exp(-s)", Status.REFUTED),
    ],
)
def test_what_is_long_is_decided(text, status):
    assert ask(text, Kind.PR).status is status


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
