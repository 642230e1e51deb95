"""Discs, half-planes and quadratic forms of random functions, against values on the axis and in closed form."""

from fractions import Fraction

import numpy as np
import pytest

from passivity import ExpressionError, Status, is_dissipative, is_in_sector, is_positive_real

CIRCLE = "({c} + {r}*(1 - s)/(1 + s))"  # whose values on the axis are the edge of the disc on [c - r, c + r]


@pytest.mark.parametrize("seed", range(12))
def test_the_disc_is_the_least(seed):
    """Of c + r (1 - s)/(1 + s) and of what lies inside; beyond either end by a millionth it is refuted."""
    random = np.random.default_rng(seed)
    c, r = (Fraction(int(x), 10) for x in random.integers(1, 50, 2))
    text, tiny = CIRCLE.format(c=c, r=r), Fraction(1, 10**6)
    assert is_in_sector(text, c - r, c + r).proved
    assert is_in_sector(f"{text}*0 + {c} + {r}*H", c - r, c + r, ["H bounded real"]).proved
    assert is_in_sector(text, c - r, "inf").proved
    assert is_in_sector(text, "-inf", c + r).proved
    assert is_in_sector(text, c - r + tiny, c + r + tiny).refuted
    assert is_in_sector(text, c - r + tiny, "inf").refuted
    assert is_in_sector(text, "-inf", c + r - tiny).refuted
    q, s, rest = -1, c, r * r - c * c  # |W - c|^2 <= r^2
    assert is_dissipative(text, q, s, rest).proved
    assert is_dissipative(text, q, s, rest - tiny * (2 * r - tiny)).refuted


@pytest.mark.parametrize("seed", range(12))
def test_systems_against_samples(seed):
    """Z of a random stable system of two ports: its least eigenvalue on the axis is its input index."""
    random = np.random.default_rng(seed)
    A = random.standard_normal((4, 4))
    A -= (max(np.linalg.eigvals(A).real) + 0.3) * np.eye(4)
    B, C, D = (random.standard_normal(shape) for shape in ((4, 2), (2, 4), (2, 2)))
    w = np.concatenate([[0], np.geomspace(1e-3, 1e3, 4000)])
    Z = np.array([D + C @ np.linalg.solve(1j * x * np.eye(4) - A, B) for x in w])
    least = min(np.linalg.eigvalsh(Z + Z.conj().swapaxes(1, 2))[:, 0]) / 2
    assert is_in_sector((A, B, C, D), least - 1e-3, "inf").proved
    assert is_in_sector((A, B, C, D), least + 1e-3, "inf").refuted


def test_indices_by_hand():
    """Of 1 + 1/(s + 1): input index 1, output index 1/2; of the backward difference in z the disc on [0, 2]."""
    verdict = is_positive_real("1 + 1/(s + 1)")
    assert (verdict.margins.input.value, verdict.margins.output.value) == (1, 0.5)
    assert is_in_sector("1 + 1/(s + 1)", 0, 2).proved
    assert is_in_sector("1 + 1/(s + 1)", 0, "19999/10000").refuted
    assert is_in_sector("1 - 1/z", 0, 2).proved
    assert is_in_sector("1 - 1/z", 0, "1.9").is_discrete


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: is_in_sector("s", 2, 1), "sector: not an interval, expected two numbers in rising order"),
        (lambda: is_in_sector("s", "-inf", "inf"), "sector: not an interval"),
        (lambda: is_in_sector("s", "a", 1), "sector: not a number"),
        (lambda: is_in_sector(None, 0, 1), "what: not a function of s"),
        (lambda: is_dissipative("s", 1, 0, 1), "supply: no disc or half-plane between fractions, expected Q <= 0"),
        (lambda: is_dissipative("s", -1, 0, 2), "S\\^2 - Q R the square of a fraction"),
    ],
)
def test_other_regions_are_refused(ask, message):
    with pytest.raises(ExpressionError, match=message):
        ask()


def test_the_answer_names_the_function_it_is_about():
    verdict = is_in_sector("1/(s + 1)", 0, 1)
    assert verdict.status is Status.PROVED
    assert "H = 2*W - 1 of the given W, bounded real if and only if W is in the disc on [0, 1]" in str(verdict)
