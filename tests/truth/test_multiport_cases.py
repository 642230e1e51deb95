"""Networks with several ports whose property was proved by exact methods independent of ours.

Witnesses, recorded and found, are put into the entries as they are written in the file, in fractions.
"""

import json
from collections import Counter
from fractions import Fraction
from pathlib import Path

import flint
import mpmath
import numpy as np
import pytest

from passivity import Status, verify as verify_one_port
from passivity.delayed.line import check_line_two_port
from passivity.exact.certificate import verify
from passivity.exact.margin import margin
from passivity.exact.positive_real import check_bounded_real, check_positive_real
from passivity.rational.matrix import RationalMatrix
from passivity.rational.state_space import StateSpace
from passivity.status import Kind

CASES = json.loads((Path(__file__).parent / "multiport_cases.json").read_text(encoding="utf-8"))["cases"]
RATIONAL = [case for case in CASES if "expr" not in case]
REFUTED = [case for case in RATIONAL if not case["verdict"]]


def name(case):
    return case["name"]


def network(case):
    if "A" in case:
        return StateSpace.from_entries(*(case[key] for key in "ABCD"))
    return RationalMatrix.from_rows(case["matrix"])


def check(case):
    return (check_bounded_real if case["kind"] == "BR-matrix" else check_positive_real)(network(case))


def real_value(case, re, im):
    """The matrix U + jV at s = re + j im as [[U, -V], [V, U]], in fractions."""
    if "A" in case:
        a, b, c, d = (twice(case[key]) for key in "ABCD")
        n = len(case["A"])
        s = [[re * (i == k) - im * (k == i + n) + im * (i == k + n) for k in range(2 * n)] for i in range(2 * n)]
        x = solved([[p - q for p, q in zip(*rows, strict=True)] for rows in zip(s, a, strict=True)], b)
        return [[p + q for p, q in zip(*rows, strict=True)] for rows in zip(d, times(c, x), strict=True)]
    parts = [[quotient(*entry, re, im) for entry in row] for row in case["matrix"]]
    upper = [[u for u, _ in row] + [-v for _, v in row] for row in parts]
    return upper + [[v for _, v in row] + [u for u, _ in row] for row in parts]


def quotient(p, q, re, im):
    (a, b), (c, d) = (horner(side, re, im) for side in (p, q))
    size = c * c + d * d
    return (a * c + b * d) / size, (b * c - a * d) / size


def horner(coefficients, re, im):
    u, v = Fraction(0), Fraction(0)
    for c in coefficients:
        u, v = u * re - v * im + Fraction(c), u * im + v * re
    return u, v


def twice(rows):
    """A real matrix for real and imaginary parts."""
    numbers = [[Fraction(x) for x in row] for row in rows]
    return [row + [Fraction(0)] * len(row) for row in numbers] + [[Fraction(0)] * len(row) + row for row in numbers]


def times(a, b):
    return [
        [sum((x * y for x, y in zip(row, column, strict=True)), Fraction(0)) for column in zip(*b, strict=True)]
        for row in a
    ]


def solved(a, b):
    """a^-1 b, by FLINT."""
    a, b = (flint.fmpq_mat([[flint.fmpq(x.numerator, x.denominator) for x in row] for row in each]) for each in (a, b))
    return [[Fraction(int(x.p), int(x.q)) for x in row] for row in a.solve(b).tolist()]


def power(case, re, im, vector):
    """v^H (Z + Z^H) v, or |v|^2 - |S v|^2."""
    v = [Fraction(x) for x, _ in vector] + [Fraction(x) for _, x in vector]
    out = [x for (x,) in times(real_value(case, re, im), [[x] for x in v])]
    if case["kind"] == "BR-matrix":
        return sum(x * x for x in v) - sum(x * x for x in out)
    return 2 * sum(x * y for x, y in zip(v, out, strict=True))


def test_the_collection_is_complete():
    assert Counter((case["kind"], case["verdict"]) for case in CASES) == {
        ("PR-matrix", True): 8,
        ("PR-matrix", False): 7,
        ("BR-matrix", True): 4,
        ("BR-matrix", False): 1,
        ("PR-ss", True): 4,
        ("PR-ss", False): 2,
    }


@pytest.mark.parametrize("case", RATIONAL, ids=name)
def test_verdict_and_evidence(case):
    verdict = check(case)
    if case["verdict"]:
        assert verdict.status is Status.PROVED
        assert verdict.witness is None
        assert verify(verdict.certificate)
    else:
        assert verdict.status is Status.REFUTED
        assert verdict.certificate is None
        w = verdict.witness
        assert w.re > 0
        assert power(case, w.re, w.im, w.vector) == w.form < 0


@pytest.mark.parametrize("case", REFUTED, ids=name)
def test_the_recorded_witness_is_one(case):
    w = case["witness"]
    assert Fraction(w["re"]) > 0
    assert power(case, Fraction(w["re"]), Fraction(w["im"]), w["vector"]) < 0


@pytest.mark.parametrize("case", [case for case in CASES if "storage" in case], ids=name)
def test_the_energy_of_a_lossless_network_is_the_recorded_one(case):
    verdict = check(case)
    assert verdict.lossless
    recorded = [[Fraction(x) for x in row] for row in case["storage"]]
    assert [[Fraction(int(x.p), int(x.q)) for x in row] for row in verdict.certificate.storage.tolist()] == recorded


@pytest.mark.parametrize("case", RATIONAL, ids=name)
def test_the_margin_is_that_of_samples(case):
    """No sample is beyond the proved bound, and the value is attained at the frequency."""
    kind = Kind.BR if case["kind"] == "BR-matrix" else Kind.PR
    found = margin(network(case), kind)
    frequencies = np.logspace(-3, 3, 41) * 1.01
    if found is None:
        assert name(case) == "offdiag_double_pole"  # falls without bound towards s = 0
        assert level(case, kind, 1e-6) < -1e5
        return
    samples = [level(case, kind, float(w)) for w in frequencies]
    small = 1e-9 * max(1, *map(abs, samples))
    if kind is Kind.PR:
        assert min(samples) >= found.bound - small
    else:
        assert max(samples) <= found.bound + small
    at = min(max(found.frequency, 1e-9), 1e12)
    assert level(case, kind, at) == pytest.approx(found.value, rel=1e-6, abs=1e-6)


def level(case, kind, w):
    """Smallest eigenvalue or largest singular value on the axis."""
    if "A" in case:
        with flint.ctx.workdps(40):  # floats lose half their digits here
            a, b, c, d = (flint.acb_mat([[flint.acb(x) for x in row] for row in case[key]]) for key in "ABCD")
            found = d + c * (flint.acb(0, w) * flint.acb_mat(a.nrows(), a.nrows(), 1) - a).solve(b)
            value = np.array([[complex(x) for x in row] for row in found.tolist()])
    else:
        value = np.array([[complex(*quotient(*x, Fraction(0), Fraction(w))) for x in row] for row in case["matrix"]])
    return np.linalg.norm(value, 2) if kind is Kind.BR else np.linalg.eigvalsh((value + value.conj().T) / 2)[0]


@pytest.mark.parametrize("case", [case for case in CASES if "expr" in case], ids=name)
def test_lines(case):
    through = case["expr"][0][1].startswith("-")
    verdict = check_line_two_port(1, 1, through=through)
    assert verdict.status is (Status.PROVED if case["verdict"] else Status.REFUTED)
    if case["verdict"]:
        assert all(verify_one_port(mode.reflection.certificate) for mode in verdict.certificate)
        return
    found = verdict.witness
    points = [(found.re, found.im, found.vector, found.form)]
    points += [(*(Fraction(case["witness"][key]) for key in ("re", "im")), case["witness"]["vector"], None)]
    for re, im, vector, value in points:
        with mpmath.workdps(30):
            s, v = mpmath.mpc(float(re), float(im)), mpmath.matrix([mpmath.mpc(*x) for x in vector])
            z = mpmath.matrix([[mpmath.coth(s), -mpmath.csch(s)], [mpmath.csch(s), mpmath.coth(s)]])
            there = (v.H * (z + z.H) * v)[0].real
        assert there < -1.9
        assert value is None or abs(there - float(value)) < 1e-12


@pytest.mark.parametrize(("z0", "delay", "half"), [(1, 1, "1/2"), ("50 ohm", "3 ns", "3/2000000000"), ("1/7", 20, 10)])
def test_the_modes_of_a_line_are_half_of_it_open_and_short(z0, delay, half):
    """coth Ts +- csch Ts = coth(Ts/2) and tanh(Ts/2), as seen at a point of the right half plane."""
    verdict = check_line_two_port(z0, delay)
    assert [mode.load.function.is_zero for mode in verdict.certificate] == [True, False]
    assert [mode.load.function.is_infinite for mode in verdict.certificate] == [False, True]
    assert {mode.delay for mode in verdict.certificate} == {Fraction(half)}
    s = mpmath.mpc(0.3, 1.7)
    assert abs(mpmath.coth(s) + mpmath.csch(s) - mpmath.coth(s / 2)) < 1e-12
    assert abs(mpmath.coth(s) - mpmath.csch(s) - mpmath.tanh(s / 2)) < 1e-12
