"""Rational functions whose property was proved twice, by exact methods independent of each other and of ours.

Witnesses, recorded and found, are put into the coefficients as they are written in the file, in fractions.
"""

import json
from collections import Counter
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

import passivity
from passivity import ExpressionError, RationalFunction, Status, check_line, check_positive_real, verify

FILE = json.loads((Path(__file__).parent / "passivity_cases.json").read_text(encoding="utf-8"))
CASES, LINES = FILE["cases"], FILE["lines"]
CHECKS = {"PR": check_positive_real, "BR": passivity.check_bounded_real}
# the open circuit has no impedance, but is as passive as any: the pair (1 : 0)
VERDICTS = {True: Status.PROVED, False: Status.REFUTED, "degenerate:open": Status.PROVED}
DECIDED = [case for case in CASES if case["verdict"] != "invalid"]
NAMES = [case["name"] for case in DECIDED]


def value(coefficients, re, im):
    """Horner's scheme in fractions: real and imaginary part."""
    u, v = Fraction(0), Fraction(0)
    for c in coefficients:
        u, v = u * re - v * im + Fraction(c), u * im + v * re
    return u, v


def broken(case, re, im):
    """Whether the property fails at s = re + j im."""
    (a, b), (c, d) = value(case["num"], re, im), value(case["den"], re, im)
    return re > 0 and (a * c + b * d < 0 if case["kind"] == "PR" else a * a + b * b > c * c + d * d)


def function(case):
    return RationalFunction.from_coefficients(case["num"], case["den"])


def test_the_collection_is_complete():
    counts = Counter(str(case["verdict"]) for case in CASES)
    assert counts == {"True": 51, "False": 46, "degenerate:open": 1, "invalid": 1}


@pytest.mark.parametrize("case", DECIDED, ids=NAMES)
def test_verdict_and_evidence(case):
    verdict = CHECKS[case["kind"]](function(case))
    assert verdict.status is VERDICTS[case["verdict"]]
    if verdict.status is Status.PROVED:
        assert verdict.witness is None
        assert verify(verdict.certificate)
    else:
        assert verdict.certificate is None
        assert broken(case, verdict.witness.re, verdict.witness.im)


@pytest.mark.parametrize("case", [c for c in DECIDED if c.get("witness")], ids=lambda case: case["name"])
def test_the_recorded_witness_is_one(case):
    assert case["verdict"] is False
    assert broken(case, Fraction(case["witness"]["re"]), Fraction(case["witness"]["im"]))


@pytest.mark.parametrize("case", [c for c in DECIDED if c["verdict"] is False], ids=lambda case: case["name"])
def test_the_value_at_the_witness_is_exact(case):
    witness = CHECKS[case["kind"]](function(case)).witness
    (a, b), (c, d) = value(case["num"], witness.re, witness.im), value(case["den"], witness.re, witness.im)
    if (c, d) == (0, 0):
        assert (witness.image, witness.value) == (None, None)
        return
    # Z q = p
    ((re, im),) = witness.image
    assert re * c - im * d == a
    assert re * d + im * c == b


@pytest.mark.parametrize("case", [c for c in DECIDED if c.get("common_factor")], ids=lambda case: case["name"])
def test_hidden_modes_are_reported(case):
    factor = [Fraction(c) for c in case["common_factor"]]
    dies_out = case["name"] == "cancel_lhp"
    hidden = CHECKS[case["kind"]](function(case)).hidden
    assert (hidden is None) == dies_out
    if hidden is not None:
        assert [int(c) for c in reversed(hidden.coeffs())] == factor


def test_zero_over_zero_is_refused():
    (case,) = [case for case in CASES if case["verdict"] == "invalid"]
    with pytest.raises(ExpressionError, match="0/0"):
        function(case)


@pytest.mark.parametrize("case", DECIDED, ids=NAMES)
def test_the_margins_have_the_sign_of_the_verdict(case):
    """A function that is proved has margins on the good side; a bad one on the axis shows in the margin there."""
    verdict = CHECKS[case["kind"]](function(case))
    smallest = [m for m in verdict.margins[:2] if m is not None]
    largest = verdict.margins.reflection
    if verdict.status is Status.PROVED:
        assert all(m.low >= 0 for m in smallest)
        assert largest is None or largest.high <= 1
    elif any(sign in verdict.why for sign in ("Re Z(jω) < 0", "|H(jω)| > 1")):
        assert all(m.high < 0 for m in smallest)
        assert largest is None or largest.low > 1
    else:
        assert all(m.low >= 0 for m in smallest)


def load_of(case):
    """Z2 of a line with z0 = 1 whose H2 is given."""
    h2 = function(case)
    return RationalFunction(h2.q + h2.p, h2.q - h2.p)


@pytest.mark.parametrize("case", LINES, ids=lambda case: case["name"])
def test_ports_of_lines(case):
    delay = case["delay"]["T"]
    if Fraction(delay) < 0:
        with pytest.raises(ExpressionError, match="delay: negative"):
            check_line(load_of(case), 1, delay)
        return
    chain = check_line(load_of(case), 1, delay)
    # "undefined": no delay and a short circuit, where G1 is infinite and the port as passive as a wire
    assert chain.status is (Status.REFUTED if case["verdict"] is False else Status.PROVED)
    assert (chain.witness is None) == (chain.status is Status.PROVED)
    if chain.witness:
        re, im = chain.witness.re, chain.witness.im
        (a, b), (c, d) = value(case["num"], re, im), value(case["den"], re, im)
        with mpmath.workdps(50):
            s, p, q = (mpmath.mpc(big(x), big(y)) for x, y in ((re, im), (a, b), (c, d)))
            h1 = mpmath.exp(-2 * s * big(Fraction(delay))) * p / q
            g1 = (1 - h1) / (1 + h1)
            assert re > 0
            assert abs(h1) > 1
            assert g1.real < 0
            assert abs(g1 - complex(chain.input)) < 1e-9 * abs(g1)


def big(x):
    return mpmath.mpf(x.numerator) / x.denominator
