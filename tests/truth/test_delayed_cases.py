"""Functions with delays and roots of s whose property was proved by hand or by ball arithmetic, apart from our code.

Witnesses, recorded and found, are put into the expression as it is written in the file, by mpmath.
"""

import json
import re
from collections import Counter
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest
from rightmost_roots import rightmost_roots

from passivity import ExpressionError, Kind, RationalFunction, Status, roots_right, verify
from passivity.calculus.ask import ask

CASES = json.loads((Path(__file__).parent / "delayed_cases.json").read_text(encoding="utf-8"))["cases"]
DECIDED = [case for case in CASES if case["verdict"] != "undefined"]
REFUTED = [case for case in DECIDED if not case["verdict"]]
COUNTED = [case for case in CASES if "certified" in case]
NAMES = ("exp", "log", "sqrt", "tanh", "coth")


def name(case):
    return case["name"]


def value(text, x, y):
    """The expression at x + jy, by mpmath; whole numbers as such, so that quotients are not rounded in double."""
    s = mpmath.mpc(mpmath.mpf(x.numerator) / x.denominator, mpmath.mpf(y.numerator) / y.denominator)
    written = re.sub(r"(\d+)", r"mpf(\1)", text.replace("^", "**"))
    return eval(written, {name: getattr(mpmath, name) for name in (*NAMES, "mpf")} | {"s": s})


def broken(case, x, y):
    with mpmath.workdps(60):
        found = value(case["expression"], x, y)
        return x > 0 and (found.real < -1e-50 if case["kind"] == "PR" else abs(found) > 1 + mpmath.mpf("1e-50"))


def test_the_collection_is_complete():
    assert Counter(str(case["verdict"]) for case in CASES) == {"True": 26, "False": 16, "undefined": 1}


@pytest.mark.parametrize("case", DECIDED, ids=name)
def test_verdict_and_evidence(case):
    verdict = ask(case["expression"], Kind[case["kind"]])
    assert verdict.status is (Status.PROVED if case["verdict"] else Status.REFUTED)
    if verdict.status is Status.PROVED:
        assert verify(verdict.certificate)
        assert not any(broken(case, Fraction(a, 8), Fraction(b, 3)) for a in (1, 9, 60) for b in (0, 1, 5, 19))
    else:
        assert broken(case, verdict.witness.re, verdict.witness.im)


@pytest.mark.parametrize("case", REFUTED, ids=name)
def test_the_recorded_witness_is_one(case):
    assert broken(case, Fraction(case["witness"]["re"]), Fraction(case["witness"]["im"]))


@pytest.mark.parametrize("case", REFUTED, ids=name)
def test_the_value_at_the_witness(case):
    witness = ask(case["expression"], Kind[case["kind"]]).witness
    with mpmath.workdps(60):
        exact = value(case["expression"], witness.re, witness.im)
        for ball, part in ((witness.value.real, exact.real), (witness.value.imag, exact.imag)):
            assert abs(mpmath.mpf(ball.mid().str(50, radius=False)) - part) <= mpmath.mpf("1e-12") * abs(exact)


@pytest.mark.parametrize("case", [case for case in DECIDED if case["verdict"]], ids=name)
def test_the_margin_is_attained_and_bounded(case):
    verdict = ask(case["expression"], Kind[case["kind"]])
    if verdict.function is not None:
        return
    margin = verdict.margins.input if case["kind"] == "PR" else verdict.margins.reflection
    attained, bound = (margin.high, margin.low) if case["kind"] == "PR" else (margin.low, margin.high)
    frequency = Fraction(margin.frequency)
    with mpmath.workdps(60):
        there = value(case["expression"], Fraction(0), frequency)
        size = there.real if case["kind"] == "PR" else abs(there)
        assert abs(size - mpmath.mpf(attained.numerator) / attained.denominator) <= 1e-12 * (1 + abs(there))
        bound = mpmath.mpf(bound.numerator) / bound.denominator
        assert size >= bound - 1e-12 if case["kind"] == "PR" else size <= bound + 1e-12


def test_an_infinite_admittance_is_refused():
    (case,) = [case for case in CASES if case["verdict"] == "undefined"]
    with pytest.raises(ExpressionError, match="division by zero"):
        ask(case["expression"], Kind.PR)


@pytest.mark.parametrize("case", COUNTED, ids=name)
@pytest.mark.parametrize(("sign", "key"), [(1, "rhp_zeros_1pH1"), (-1, "rhp_zeros_1mH1")])
def test_zeros_right(case, sign, key):
    h2 = RationalFunction.from_coefficients(case["num"], case["den"])
    count = roots_right(h2, case["T"], sign)
    assert count == case["certified"][key]
    near = rightmost_roots(h2, case["T"], sign, 4)
    assert sum(2 - (root.imag == 0) for root in near if root.real > 0) == count
