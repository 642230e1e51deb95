"""Functions of z outside the unit disc: closed forms, Schur's parameters, and random systems of known norm."""

from fractions import Fraction
from random import Random

import mpmath
import numpy as np
import pytest
from scipy import signal

from passivity import RationalFunction, is_bounded_real, is_positive_real, verify
from passivity.calculus.proof import check_evidence

ANGLES = np.linspace(0, np.pi, 2001)
CLOSED = {  # positive real outside the unit disc or not, by hand
    "(z + 1)/(z - 1)": True,  # the trapezoidal integrator
    "z/(z - 1)": True,  # backward Euler: Re = 1/2 on the circle
    "1/(z - 1)": False,  # forward Euler: Re = -1/2
    "1/(z - 1) + 1/2": True,
    "(z + 1)^2/(z - 1)^2": False,
    "(z^2 + 1)/(z^2 - 1)": True,
    "(z^2 - 1)/(z^2 + 1)": True,
    "1 + 1/z": True,
    "1 + 1.000001/z": False,
    "z": False,
    "1/z": False,
    "2 + 1/z - z": False,
    "1 - 1/z^20": True,
    "(z + 2)/(z - 2)": False,
    "1/2 + 3/4/z + 1/2/z^2 + 1/4/z^3": True,  # half of Fejér's kernel, which touches 0
    "1/2 + 3/4/z + 1/2/z^2 + 1/4/z^3 - 1e-30": False,
    "1": True,
    "-1": False,
    "6/5 + 1/(z^2 + 2/9)": False,  # 6/5 - 9/7 at z = j
    "1/(z^2 + 2/9) - 6/5": False,  # at infinity, too
    "sqrt((z + 1)/(z - 1))": True,
    "exp(-1/z)": True,  # cos(sin θ) > 0
    "tanh((z + 1)/(z - 1))": True,
    "log(2 + 1/z)": True,
}


def at(text: str, witness) -> mpmath.mpc:
    names = {name: getattr(mpmath, name) for name in ("sqrt", "exp", "tanh", "log")}
    z = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (witness.re, witness.im)))
    return eval(text.replace("^", "**"), {**names, "z": z})  # of this file alone


@pytest.mark.parametrize("text", CLOSED)
def test_closed_forms(text):
    verdict = is_positive_real(text)
    assert verdict.is_discrete == ("z" in text)
    if verdict.proved or verdict.refuted:
        assert verdict.proved == CLOSED[text]
        assert check_evidence(verdict.evidence) is None
    else:
        assert text.startswith(("exp", "log"))
    if verdict.refuted:
        with mpmath.workdps(60):
            assert verdict.witness.re**2 + verdict.witness.im**2 > verdict.is_discrete
            assert at(text, verdict.witness).real < 0


@pytest.mark.parametrize("seed", range(40))
def test_schur_parameters(seed):
    """H = (c + H'/z)/(1 + c H'/z) is bounded real if and only if |c| <= 1 and H' is, or |c| = 1 and H is c."""
    random, inverse = Random(seed), RationalFunction.from_expression("1/s")
    parameters = [Fraction(random.randint(-99, 99), 100) for _ in range(random.randint(1, 12))]
    broken = seed % 2
    if broken:
        parameters[random.randrange(len(parameters))] = random.choice((-1, 1)) * (
            1 + Fraction(1, 10 ** (seed % 12 + 1))
        )
    h = RationalFunction.constant(parameters[-1])
    for c in reversed(parameters[:-1]):
        h = (inverse * h + c) / (1 + inverse * h * c)
    h = h.reduced()
    verdict = is_bounded_real((h.numerator, h.denominator, 1.0))
    assert verdict.is_discrete
    assert verdict.proved == (not broken)
    cayley = (1 + h) / (1 - h)
    assert is_positive_real((cayley.numerator, cayley.denominator, 1.0)).proved == (not broken)
    if broken:
        value = verdict.witness.image
        assert verdict.witness.re**2 + verdict.witness.im**2 > 1
        assert value is None or sum(x * x for x in value[0]) > 1
    else:
        assert verify(verdict.certificate)


def gain(A, B, C, D, angle) -> float:
    return np.linalg.norm(D + C @ np.linalg.solve(np.exp(1j * angle) * np.eye(len(A)) - A, B), 2)


def largest_gain(A, B, C, D) -> float:
    values = [gain(A, B, C, D, angle) for angle in ANGLES]
    k = int(np.argmax(values))
    low, high = ANGLES[max(k - 1, 0)], ANGLES[min(k + 1, len(ANGLES) - 1)]
    for _ in range(30):
        grid = np.linspace(low, high, 5)
        j = int(np.argmax([gain(A, B, C, D, angle) for angle in grid]))
        low, high = grid[max(j - 1, 0)], grid[min(j + 1, 4)]
    return max(*values, gain(A, B, C, D, (low + high) / 2))


@pytest.mark.parametrize(("states", "ports", "seed"), [(1, 1, 0), (3, 2, 1), (6, 1, 2), (13, 3, 3), (20, 2, 4)])
@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_systems_of_known_norm(states, ports, seed, factor):
    """P fulfils the bounded real lemma of discrete time; a witness has |S v| > |v| at 60 digits."""
    random = np.random.default_rng(seed)
    A = random.standard_normal((states, states))
    A *= 0.9 / max(abs(np.linalg.eigvals(A)))
    B, C = random.standard_normal((states, ports)), random.standard_normal((ports, states))
    D = random.standard_normal((ports, ports))
    C, D = (x * factor / largest_gain(A, B, C, D) for x in (C, D))
    verdict = is_bounded_real(signal.dlti(A, B, C, D))
    assert verdict.proved == (factor < 1)
    if verdict.proved and (P := getattr(verdict.certificate, "storage", None)) is not None:
        P = np.array([[float(x) for x in row] for row in P.tolist()]) / 2
        form = [[A.T @ P @ A - P + C.T @ C, A.T @ P @ B + C.T @ D], [B.T @ P @ A + D.T @ C, B.T @ P @ B + D.T @ D]]
        lost = np.block(form) - np.diag([0.0] * states + [1.0] * ports)
        assert np.linalg.eigvalsh(lost).max() < 1e-12 * abs(lost).max()
        assert np.linalg.eigvalsh(P).min() > 0
    if verdict.refuted:
        with mpmath.workdps(60):
            a, b, c, d = (mpmath.matrix(x.tolist()) for x in (A, B, C, D))
            re, im = (mpmath.mpf(x.numerator) / x.denominator for x in (verdict.witness.re, verdict.witness.im))
            v = mpmath.matrix([mpmath.mpc(*map(float, x)) for x in verdict.witness.vector])
            out = d * v + c * mpmath.lu_solve(mpmath.mpc(re, im) * mpmath.eye(states) - a, b * v)
            assert re**2 + im**2 > 1
            assert mpmath.norm(out) > mpmath.norm(v)


def test_any_function_of_z():
    """A loop of any bounded real H behind a delay of one sample, and of parameters."""
    assert is_positive_real("(1 + H/z)/(1 - H/z)", ["H bounded real"]).proved
    assert is_bounded_real("k*H/z^3", ["H bounded real", "-1 <= k", "k <= 1"]).proved
    verdict = is_positive_real("(z + a)/(z - b)", ["0 < a", "a < 1", "0 < b", "b < 2"])
    assert verdict.refuted
    assert str(verdict.condition) == "b <= 1"
    assert verdict.witness.names["b"] > 1


@pytest.mark.parametrize("pole", [-1, 1])
def test_poles_on_the_circle(pole):
    """An integrator, and one that alternates, as states: x' = pole x + u, y = pole x + u/2."""
    verdict = is_positive_real(signal.dlti([[pole]], [[1]], [[pole]], [[0.5]]))
    assert verdict.proved
    assert verdict.lossless
    assert is_positive_real(signal.dlti([[pole]], [[1]], [[-pole]], [[0.5]])).refuted


def test_hidden_modes():
    told = is_positive_real("(z + 1)*(z - 2)/((z - 2)*(z - 1))")
    assert told.why.endswith("the common factor z - 2 is a hidden mode that does not die out")
    assert "z + 1 is a hidden mode" in is_positive_real("(z + 1)*(z + 1)/((z + 1)*(z - 1))").why
    assert is_positive_real("(z + 1)*(2*z - 1)/((2*z - 1)*(z - 1))").hidden is None
