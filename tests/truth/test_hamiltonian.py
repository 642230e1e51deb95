"""Large state spaces in floating point, against exact verdicts, closed forms and exact values of sums over resonances.

Witnesses are put into the entries in fractions, by arithmetic of this file.
"""

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from passivity import Kind, StateSpace, Status
from passivity.exact.positive_real import check_positive_real, refuted_or_undecided
from passivity.floats.axis import analyse
from passivity.floats.system import FloatSystem
from passivity.polynomial.roots import violations
from passivity.rational.polynomial_matrix import axis_sums

CASES = json.loads((Path(__file__).parent / "multiport_cases.json").read_text(encoding="utf-8"))["cases"]


def trimmed(p):
    return p[next((k for k, c in enumerate(p) if c), len(p)) :]


def times(p, q):
    out = [Fraction(0)] * max(len(p) + len(q) - 1, 0)
    for i, a in enumerate(p):
        for k, b in enumerate(q):
            out[i + k] += a * b
    return out


def realised(case):
    """Controller form of a proper matrix over the product of all denominators, None if it is not proper."""
    if "A" in case:
        return tuple([[Fraction(x) for x in row] for row in case[key]] for key in "ABCD")
    rows = [[[trimmed([Fraction(c) for c in side]) for side in entry] for entry in row] for row in case["matrix"]]
    if any(len(p) > len(q) for row in rows for p, q in row):
        return None
    d = [Fraction(1)]
    distinct = {tuple(c / q[0] for c in q) for row in rows for _, q in row}
    for q in distinct:
        d = times(d, list(q))
    m, n = len(rows), len(d) - 1
    feed, columns = [[Fraction(0)] * m for _ in range(m)], [[[Fraction(0)] * m for _ in range(m)] for _ in range(n)]
    for i in range(m):
        for k, (p, q) in enumerate(rows[i]):
            others = [Fraction(1) / q[0]]
            for other in distinct - {tuple(c / q[0] for c in q)}:
                others = times(others, list(other))
            top = times(p, others)
            top = [Fraction(0)] * (n + 1 - len(top)) + top
            feed[i][k] = top[0]
            for j in range(n):  # the coefficient of s^j
                columns[j][i][k] = top[n - j] - top[0] * d[n - j]
    a = [[Fraction(0)] * (n * m) for _ in range(n * m)]
    for j in range(n):
        for i in range(m):
            if j < n - 1:
                a[j * m + i][(j + 1) * m + i] = Fraction(1)
            a[(n - 1) * m + i][j * m + i] = -d[n - j]
    b = [[Fraction(int(j == n - 1 and i == k)) for k in range(m)] for j in range(n) for i in range(m)]
    c = [[columns[j][i][k] for j in range(n) for k in range(m)] for i in range(m)]
    return a, b, c, feed


PROPER = [case for case in CASES if "expr" not in case and (found := realised(case)) and found[0]]


def test_most_cases_are_proper():
    assert len(PROPER) == 14


def resolvent(a, b, re, im):
    """((re + j im) - A)^-1 B by Gauss' elimination, numbers as pairs of fractions."""
    n = len(a)
    rows = [
        [(re * (i == k) - a[i][k], im * (i == k)) for k in range(n)] + [(x, Fraction(0)) for x in b[i]]
        for i in range(n)
    ]
    for k in range(n):
        pivot = next(i for i in range(k, n) if any(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        (u, v), size = rows[k][k], rows[k][k][0] ** 2 + rows[k][k][1] ** 2
        rows[k] = [product(x, (u / size, -v / size)) for x in rows[k]]
        for i in range(n):
            if i != k and any(factor := rows[i][k]):
                rows[i] = [
                    (x[0] - y[0], x[1] - y[1])
                    for x, y in zip(rows[i], (product(factor, z) for z in rows[k]), strict=True)
                ]
    return [row[n:] for row in rows]


def product(x, y):
    return x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]


def power(kind, value, vector):
    """v^H (Z + Z^H) v, or |v|^2 - |S v|^2."""
    total = Fraction(0)
    for row, v in zip(value, vector, strict=True):
        terms = [product(z, w) for z, w in zip(row, vector, strict=True)]
        u = sum(x for x, _ in terms), sum(y for _, y in terms)
        if kind is Kind.PR:
            total += 2 * (v[0] * u[0] + v[1] * u[1])
        else:
            total += v[0] ** 2 + v[1] ** 2 - u[0] ** 2 - u[1] ** 2
    return total


def transfer(system, re, im):
    a, b, c, d = system
    x = resolvent(a, b, re, im)
    return [
        [
            (
                d[i][k] + sum(g * y[k][0] for g, y in zip(c[i], x, strict=True)),
                sum(g * y[k][1] for g, y in zip(c[i], x, strict=True)),
            )
            for k in range(len(d))
        ]
        for i in range(len(d))
    ]


@pytest.mark.parametrize("case", PROPER, ids=lambda case: case["name"])
def test_floats_find_what_is_refuted_and_nothing_else(case):
    """As if the exact test had given up: the false ones are still refuted, the true ones stay undecided."""
    kind, system = Kind.BR if case["kind"] == "BR-matrix" else Kind.PR, realised(case)
    verdict = refuted_or_undecided(kind, StateSpace.from_entries(*system), "no exact test")
    assert verdict.analysis.agree
    assert verdict.certificate is None
    if case["verdict"]:
        assert verdict.status is Status.UNDECIDED
        assert verdict.analysis.bands == ()
        assert "two methods that agree" in verdict.why
    else:
        assert verdict.status is Status.REFUTED
        w = verdict.witness
        assert w.re > 0
        assert power(kind, transfer(system, w.re, w.im), w.vector) == w.form < 0


@pytest.mark.parametrize("kind", list(Kind))
@pytest.mark.parametrize("seed", range(8))
def test_bands_are_the_exact_ones(kind, seed):
    """Signs of exact polynomials, against eigenvalues of the pencil; random systems violate in several bands."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(3, 9)), int(rng.integers(1, 4))
    a = rng.integers(-9, 10, (n, n)) - 12 * np.eye(n)
    b, c, d = rng.integers(-9, 10, (n, m)), rng.integers(-9, 10, (m, n)), rng.integers(-3, 4, (m, m)) + np.eye(m) * 3
    c, d = (c, d) if kind is Kind.PR else (c / 8, d / 8)
    system = StateSpace.from_entries(a, b, c, d)
    found = analyse(FloatSystem.of(kind, system))
    assert found.agree
    exact = violations([x for x, _ in axis_sums(kind, *system.transfer.fraction)])
    assert len(found.bands) == len(exact)
    for seen, true in zip(found.bands, exact, strict=True):
        assert seen == pytest.approx(true, rel=1e-9, abs=10 * found.edge_error)


def mixed(rng, parts, d, nano):
    """Parts side by side, with states mixed by rotations; nano: times of 1e-9, and states from 1 to 1e-12."""
    n = sum(len(a) for a, _, _ in parts)
    a, b, c = np.zeros((n, n)), np.vstack([b for _, b, _ in parts]), np.hstack([c for _, _, c in parts])
    ends = np.cumsum([0] + [len(part[0]) for part in parts])
    for (low, high), part in zip(pairwise(ends), parts, strict=True):
        a[low:high, low:high] = part[0]
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    a, b, c = q @ a @ q.T, q @ b, c @ q.T
    if nano:
        t = 10.0 ** rng.uniform(-12, 0, n)
        a, b, c = 1e9 * a / t[:, None] * t, 1e9 * b / t[:, None], c * t
    return StateSpace.from_entries(a, b, c, d)


def lossless(rng, n, m):
    j, b = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    return j - j.T, b, b.T


@pytest.mark.parametrize(
    ("n", "nano", "loss"),
    [(20, False, 3 / 4), (20, True, 1 / 4), (60, False, 1 / 4), (60, True, 3 / 4), (200, True, 1 / 4)],
)
def test_a_resonance_that_takes_a_known_amount(n, nano, loss):
    """Beside lossless parts Re Z = loss - (2 h w)^2/((1 - w^2)^2 + (2 h w)^2)/2 in one direction; its low is at w = 1.

    The ends of its band are w = sqrt(1 + (h k)^2) -+ h k with k^2 = 1/(2 loss) - 1.
    """
    rng, h = np.random.default_rng(n), 1 / 50
    v = np.array([[0.6, 0.8]])
    resonance = np.array([[0, 1.0], [-1, -2 * h]]), np.array([[0.0], [1]]) @ v, -h * v.T @ np.array([[0, 1.0]])
    system = mixed(rng, [lossless(rng, n - 2, 2), resonance], loss * np.eye(2), nano)
    found = analyse(FloatSystem.of(Kind.PR, system))
    unit = 1e9 if nano else 1.0
    assert found.agree
    assert found.value_error < 1e-6
    assert abs(found.value - (loss - 1 / 2)) <= 10 * found.value_error + 1e-9  # what rounding of the entries may do
    assert found.frequency == pytest.approx(unit, rel=1e-4)  # a minimum is flat
    if loss > 1 / 2:
        assert found.bands == ()
        return
    k = np.sqrt(1 / (2 * loss) - 1)
    ends = np.sqrt(1 + (h * k) ** 2) + np.array([-h * k, h * k])
    assert found.bands == (pytest.approx(tuple(ends * unit), rel=1e-8),)
    assert found.edge_error < 1e-8 * unit


@pytest.mark.parametrize("shift", [1e-3, 0, -1e-6])
@pytest.mark.parametrize("n", [20, 100])
def test_a_direct_term_is_the_margin(n, shift):
    """(J - R) Q with losses, and direct term shift: the form is least at infinity, where it is the shift."""
    rng = np.random.default_rng(n)
    half, q = rng.normal(size=(n, 4)), 10 ** rng.uniform(-1, 1, n)
    j, b, _ = lossless(rng, n, 3)
    system = StateSpace.from_entries((j - half @ half.T) * q, b, b.T * q, shift * np.eye(3))
    found = analyse(FloatSystem.of(Kind.PR, system))
    assert found.agree
    assert found.value_error < 1e-11
    assert found.value == pytest.approx(shift, abs=1e-12 + found.value_error)
    assert bool(found.bands) == (shift < 0)
    if shift < 0:
        assert found.frequency == np.inf == found.bands[-1][1]


def many_resonances(rng, number, spoiled):
    """Resonances g s/(s^2 + h s + w), whole numbers, and the state space of their sum, neighbours mixed."""
    parts = [[int(rng.integers(1, 99)), int(rng.integers(1, 99)), int(rng.integers(50, 99999))] for _ in range(number)]
    parts[7] = [spoiled, 1, 777]
    n = 2 * number
    a, b, c = np.zeros((n, n), int), np.zeros((n, 1), int), np.zeros((1, n), int)
    for k, (g, h, w) in enumerate(parts):
        a[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[0, 1], [-w, -h]]
        b[2 * k + 1], c[0, 2 * k + 1] = 1, g
    mix = np.zeros((n, n), int)  # its square is zero
    mix[2::4, 0 : n - 2 : 4][np.diag_indices(len(mix[2::4]))] = 3
    mix[3::4, 1 : n - 2 : 4][np.diag_indices(len(mix[3::4]))] = -2
    one = np.eye(n, dtype=int)
    a, b, c = (one + mix) @ a @ (one - mix), (one + mix) @ b, c @ (one - mix)
    return parts, [[list(map(int, row)) for row in x] for x in (a, b, c)] + [[["1/1000"]]]


def test_250_states_are_refuted_exactly():
    """One resonance of 125 makes energy; what the witness says is the sum over all of them, in fractions."""
    parts, system = many_resonances(np.random.default_rng(0), 125, -200)
    verdict = check_positive_real(StateSpace.from_entries(*system))
    assert verdict.status is Status.REFUTED
    assert "exactly so at the witness" in verdict.why
    w = verdict.witness
    assert w.re > 0
    z = [Fraction(1, 1000), Fraction(0)]
    for g, h, square in parts:
        u, v = w.re**2 - w.im**2 + h * w.re + square, 2 * w.re * w.im + h * w.im
        x = product((g * w.re, g * w.im), (u / (u * u + v * v), -v / (u * u + v * v)))
        z = [z[0] + x[0], z[1] + x[1]]
    assert power(Kind.PR, [[tuple(z)]], w.vector) == w.form < 0
    assert verdict.analysis.agree


def test_250_states_that_look_passive_stay_undecided():
    _, system = many_resonances(np.random.default_rng(0), 125, 200)
    verdict = check_positive_real(StateSpace.from_entries(*system))
    assert verdict.status is Status.UNDECIDED
    assert verdict.analysis.agree
    assert verdict.analysis.value == pytest.approx(1e-3, rel=1e-6)  # at infinity, and at zero
    assert "would be decided; in floating point" in verdict.why
