"""What follows from a proved fact is proved too, however the function is written; random structures and names."""

import cmath
import json
import re
from fractions import Fraction
from math import prod
from random import Random

import pytest

from passivity import is_positive_real
from passivity.verifier import check
from tests.random_identities import ASSUME, FORMS, impedance


@pytest.mark.parametrize("form", FORMS)
def test_identities(form):
    """Of all that is proved positive real, nothing that follows is undecided, and each proof is verified."""
    text, ask = FORMS[form]
    random, proved = Random(form), 0
    for _ in range(25):
        x = impedance(random, random.randint(1, 2), True)
        if is_positive_real(x, ASSUME).proved:
            found = ask(f"let x = {x}; {text.format('x')}", ASSUME)
            assert found.proved, (x, found.why)
            assert check(json.loads(json.dumps(found.evidence))) is None
            proved += 1
    assert proved > 20


def constant(random: Random, depth: int) -> str:
    """A positive constant, made of numbers, parameters and functions of these."""
    if depth == 0:
        return random.choice(["R", "T", "3", "(1 + L)"])
    x, y = (constant(random, depth - 1) for _ in range(2))
    made = [f"({x} + {y})", f"{x}*{y}", f"1/(1/{x} + R)", f"sqrt({x}*{y})", f"tanh({x})", f"(1 - exp(-{x})/2)"]
    return random.choice([*made, f"log(1 + {x})"])


CONSTANTS = ["(3 + R)", "7/3*(R + 3)", "(1 + L)", "(R + T)", "(tanh(R) + R)", "(R + L + 1 - exp(-1 - R)/2)"]


@pytest.mark.parametrize("form", FORMS)
def test_identities_of_constants(form):
    """A constant is a positive real function, and nothing else is assumed of what follows."""
    text, ask = FORMS[form]
    random = Random(f"constants, {form}")
    for x in [*CONSTANTS, *(constant(random, random.randint(1, 2)) for _ in range(12))]:
        assert is_positive_real(x, ASSUME).proved, x
        found = ask(f"let x = {x}; {text.format('x')}", ASSUME)
        assert found.proved, (x, found.why)
        assert check(json.loads(json.dumps(found.evidence))) is None


WRITTEN_OTHERWISE = [
    "let x = 7/3*(1 + H); let h = (x - 1)/(x + 1); (1 + h)/(1 - h)",
    "let x = (s + 1)/(s + 2)*(1 + H)/((s + 1)/(s + 2) + 1 + H); 1/x",
    "let h = tanh(R)*exp(-T*s)*(3 - L)/(3 + L); tanh((1 + h)/(1 - h))",
    "sqrt((R + L*s)/(1 + T*s))*tanh(sqrt((R + L*s)*(1 + T*s)))",
    "sqrt(sqrt((R + L*s)/(1 + T*s))*tanh(sqrt((R + L*s)*(1 + T*s)))/(R + 1/s))",
    "let x = line(R, s, Z2) + R; (x^2 + x)/(x + 1)",
    "(Z2*sqrt(s) + R^2)/(Z2 + sqrt(s))",
    "let x = log(1 + s); let c = x/(x + Z2); c*Z2 + (1 - c)*x",
    "let x = s + 2 + Z2*R/(Z2 + R); (x^3 + x)/(x^2 + 1)",
    "line(0, s, 1) + line(-R, T*s, R) + (tanh(s + 2) - 1)/(tanh(s + 2) + 1) + 2",
]


@pytest.mark.parametrize("text", WRITTEN_OTHERWISE)
def test_functions_written_otherwise(text):
    """Merged, cancelled, transformed and back: proved, and so says the verifier alone."""
    found = is_positive_real(text, ASSUME)
    assert found.proved
    assert check(json.loads(json.dumps(found.proof))) is None


PROVED = [
    "let h = exp(-2*R*s)*(Z2 - T)/(Z2 + T); (1 + h)/(1 - h)",
    "R*(Z2 + R*tanh(T*s))/(R + Z2*tanh(T*s)) + L*s",
    "1/(2 - H*exp(-s)) + tanh(Z2)",
    "sqrt(Z2*(s + R))/3 + 1/(s + 2 + 1/(s + R))",
]
VALUES = {"R": 0.7, "L": 1.9, "T": 0.4}
FUNCTIONS = {"Z2": lambda s: 1 / (s + 0.1), "H": lambda s: (1 - s) / (1 + s)}


def value(nodes, n, s):
    """A node of a proof at a point, from its file alone."""
    kind, *parts = nodes[n]
    if kind == "name":
        return VALUES[parts[0]] if parts[0] in VALUES else FUNCTIONS[parts[0]](s)
    if kind == "mul":
        return prod(value(nodes, m, s) ** e for m, e in parts)
    scaled = [float(Fraction(c)) * value(nodes, m, s) for c, m in parts]
    if kind == "line":
        z0, through, load = scaled
        return z0 * (load + z0 * cmath.tanh(through)) / (z0 + load * cmath.tanh(through))
    return (
        {"one": 1, "s": s, "sum": sum(scaled)}[kind] if kind in ("one", "s", "sum") else getattr(cmath, kind)(*scaled)
    )


def numbers(told, at=()):
    """The places of all numbers within lists and texts."""
    if isinstance(told, list):
        return [place for k, x in enumerate(told) for place in numbers(x, (*at, k))]
    return [at] if isinstance(told, int) or re.fullmatch(r"-?\d+(/\d+)?", str(told)) else []


def test_a_thousand_forgeries_prove_nothing_that_is_false():
    """Any number in nodes, steps or root changed: the file is refused, or what it says agrees with values."""
    proofs = [is_positive_real(text, ASSUME).proof for text in PROVED]
    random, refused = Random(3), 0
    for _ in range(1000):
        forged = json.loads(json.dumps(random.choice(proofs)))
        part = random.choice(["nodes", "nodes", "steps", "root"])
        *path, last = random.choice(numbers(forged[part]))
        inner = forged[part]
        for k in path:
            inner = inner[k]
        x = inner[last]
        new = (
            random.choice([-x, x + 1, 2 * x]) if isinstance(x, int) else random.choice([f"-{x}".replace("--", ""), "5"])
        )
        inner[last] = new
        if new == x or check(forged) is not None:
            refused += new != x
            continue
        c, n = forged["root"]
        for s in (0.1, 2 + 3j, 0.01 + 1.5j, 0.3 + 20j):
            assert (float(Fraction(c)) * value(forged["nodes"], n, s)).real >= -1e-9, (part, path, x, new)
    assert refused > 700
