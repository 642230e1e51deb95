"""What always holds of proofs along a structure: each step agrees with values to 60 digits, and no forgery is taken."""

import copy
import json
from fractions import Fraction
from random import Random

import mpmath
import pytest

from passivity import is_bounded_real, is_positive_real
from passivity.verifier import RULES, check

POINTS = [mpmath.mpc(re, im) for re in ("0.03", "0.7", "5") for im in ("0", "0.4", "-2.3", "31")]
ASSUME = ["R > 0", "L >= 0", "0 < k <= 1", "Z2 positive real", "H bounded real"]
OPAQUE = {
    "Z2": [lambda s: s / 3 + 2, lambda s: 1 / (s + 1 / (s + 1)), lambda s: mpmath.mpf(0) * s, mpmath.sqrt],
    "H": [
        lambda s: mpmath.exp(-s),
        lambda s: -1 + 0 * s,
        lambda s: (1 - s) / (2 + s) / 2,
        lambda s: s / (s * s + s + 1),
    ],
}


def value(nodes, n, s, names, known):
    """A node of a proof at a point, from its file alone."""
    if n not in known:
        kind, *parts = nodes[n]
        at = lambda m: value(nodes, m, s, names, known)  # noqa: E731
        scaled = lambda c, m: mpmath.mpf(Fraction(c).numerator) / Fraction(c).denominator * at(m)  # noqa: E731
        if kind == "one":
            known[n] = mpmath.mpf(1)
        elif kind == "s":
            known[n] = s
        elif kind == "name":
            known[n] = names[parts[0]](s)
        elif kind == "sum":
            known[n] = mpmath.fsum(scaled(c, m) for c, m in parts)
        elif kind == "mul":
            known[n] = mpmath.fprod(at(m) ** e for m, e in parts)
        elif kind == "line":
            z0, through, load = (scaled(c, m) for c, m in parts)
            wave = mpmath.tanh(through)
            known[n] = z0 * (load + z0 * wave) / (z0 + load * wave)
        else:
            known[n] = getattr(mpmath, kind)(scaled(*parts[0]))
    return known[n]


def excess(fact, w):
    """By how much a value passes the border of a fact."""
    kind, *ends = fact
    if kind == "arg":
        return (
            abs(mpmath.arg(w)) - mpmath.pi / 2 * mpmath.mpf(Fraction(ends[0]).numerator) / Fraction(ends[0]).denominator
        )
    low, high = (
        mpmath.mpf(x) if "inf" in x else mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator for x in ends
    )
    if kind == "real":
        return max(low - w.real, w.real - high, abs(w.imag))
    if mpmath.isinf(high):
        return low - w.real
    return w.real - high if mpmath.isinf(low) else abs(w - (low + high) / 2) - (high - low) / 2


def steps_hold(proof, seed):
    """All steps, with random choices of the names, at all points; the number of values compared."""
    random, compared = Random(seed), 0
    for s in POINTS:
        r, inductance, k = (
            mpmath.mpf(random.randint(1, 90)) / 16,
            mpmath.mpf(random.randint(0, 40)) / 16,
            random.random(),
        )
        names = {"R": lambda s, x=r: x, "L": lambda s, x=inductance: x, "k": lambda s, x=k or 1: mpmath.mpf(x)}
        names |= {name: random.choice(functions) for name, functions in OPAQUE.items()}
        known = {}
        for n, fact, rule, _, _ in proof["steps"]:
            try:
                w = mpmath.mpc(value(proof["nodes"], n, s, names, known))
            except ZeroDivisionError:  # an open circuit
                continue
            assert excess(fact, w) <= mpmath.mpf(10) ** -40 * (1 + abs(w)), (rule, fact, w)
            compared += 1
    return compared


NETWORKS = [
    "Z2 + s",
    "1/(R + 1/s)",
    "sqrt((s + 2)/(s + 3))",
    "log(1 + Z2)",
    "1 + H*exp(-s)",
    "line(k, R*s, 1/(s + R))",
    "Z2*R/(Z2 + R)",
    "1/(s + R)*R/(1/(s + R) + R)",
    "(1 + k*exp(-2*s)*(L*s - R)/(L*s + R))/(1 - k*exp(-2*s)*(L*s - R)/(L*s + R))",
]


@pytest.mark.parametrize("text", NETWORKS)
def test_what_follows_from_a_proof_is_proved(text):
    """Its Cayley transform and exp(-x) are bounded real, tanh(x) is positive real."""
    assert is_positive_real(text, ASSUME).proved
    for form, ask in (
        ("({0} - 1)/({0} + 1)", is_bounded_real),
        ("exp(-{0})", is_bounded_real),
        ("tanh({0})", is_positive_real),
    ):
        assert ask(form.format(f"({text})"), ASSUME).proved


EXAMPLES = [
    ("let h = exp(-2*R*s)*(Z2 - k)/(Z2 + k); (1 + h)/(1 - h)", is_positive_real),
    ("log(1 + sqrt(s))/sqrt(s) + (1 - exp(-3*s))/s/3 + 1", is_positive_real),
    ("sqrt((1 + 2*s)/(3 + s))*tanh(sqrt((1 + 2*s)*(3 + s)))", is_positive_real),
    ("exp(-log(1 + s)/2) + 1/cosh(sqrt(s)) + (s + 2)/(s^2 + 3*s + 4) + log(2) + exp(1/2) + 1", is_positive_real),
    ("line(R, L*s + k, line(2, s, Z2)) + Z2*R/(Z2 + R)", is_positive_real),
]


@pytest.mark.parametrize(("text", "ask"), EXAMPLES, ids=range(len(EXAMPLES)))
def test_examples_of_all_rules_agree_with_values(text, ask):
    proof = ask(text, ASSUME).proof
    assert check(json.loads(json.dumps(proof))) is None
    with mpmath.workdps(60):
        assert steps_hold(proof, 1) > 50


def test_the_examples_use_the_rules():
    used = {step[2] for text, ask in EXAMPLES for step in ask(text, ASSUME).proof["steps"]}
    assert used >= RULES.keys() - {"storage"}


def test_tampered_proofs_are_refused():
    """A stronger claim or fact, another rule, node, root or premise, a step left out, or one that nothing rests on."""
    proofs = [ask(text, ASSUME).proof for text, ask in EXAMPLES]
    random, refused = Random(7), 0
    for _ in range(300):
        proof = copy.deepcopy(random.choice(proofs))
        proof = json.loads(json.dumps(proof))
        step = random.choice(proof["steps"])
        way = random.choice(("claim", "fact", "rule", "name", "drop", "root", "add", "premise"))
        if way == "claim":
            proof["claim"] = random.choice((["disc", "1000", "inf"], ["disc", "0", "1/1000"], ["real", "0", "inf"]))
        elif way == "fact":
            step[1] = ["disc", "1/9", "1/8"]
        elif way == "rule":
            step[2] = random.choice(sorted(RULES.keys() - {step[2]}))
        elif way == "name":
            step[0] = -1 - random.randint(0, 9)
        elif way == "drop":
            del proof["steps"][random.randrange(len(proof["steps"]))]
        elif way == "root":
            proof["root"][0] = random.choice(("-1", "nan", "-7/2"))
        elif way == "add":  # it is right, and nothing rests on it
            proof["steps"].insert(0, [0, ["real", "1", "1"], "leaf", [], None])
            for each in proof["steps"][1:]:
                each[3] = [k + 1 for k in each[3]]
        else:
            step[3] = [*step[3], random.randrange(len(proof["steps"]))]
        refused += check(proof) is not None
    assert refused == 300
