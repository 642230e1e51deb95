"""Several ports in floating point: errors are bounded, and what is not certain stays undecided."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from passivity import Kind, Margins, RationalMatrix, StateSpace, Status, Verdict, Witness
from passivity.exact.positive_real import check_positive_real, refuted_or_undecided
from passivity.floats.axis import AxisAnalysis, analyse, crossings
from passivity.floats.system import FloatSystem
from passivity.report import as_dict

TRIANGLE = ([[0, -1, 0], [1, 0, 2], [0, -2, -1]], [[1], [0], [1]], [[1, 0, 1]], [[0]])
ONE = (Fraction(1), Fraction(0))


def test_scales_do_not_matter():
    """The same circuit in seconds and in nanoseconds."""
    slow = RationalMatrix.from_rows([["1 + s", "s"], ["s", "2 + s"]])
    fast = RationalMatrix.from_rows([["1 + 1n*s", "1n*s"], ["1n*s", "2 + 1n*s"]])
    assert check_positive_real(slow).status is check_positive_real(fast).status is Status.PROVED
    broken = RationalMatrix.from_rows([["1 + 1n*s", "1n*s"], ["1n*s", "2 + 999999999/1000000000*1n*s"]])
    witness = check_positive_real(broken).witness
    assert witness.re > 0
    assert witness.form < 0


@pytest.mark.parametrize("kind", list(Kind))
def test_values_in_floats_are_within_their_error_of_the_exact_ones(kind):
    system = StateSpace.from_entries([[0, "1e9"], ["-4e9", "-1e7"]], [[0], ["1e3"]], [["1e-3", "2e5"]], [["1/3"]])
    floats = FloatSystem.of(kind, system)
    for w in (0, 10**7, 2 * 10**9, 10**11):
        ((u, v),) = system.image(Fraction(0), Fraction(w), [ONE])
        exact = u if kind is Kind.PR else 1 - u * u - v * v
        (place,) = floats.on_axis(w / floats.unit)
        assert abs(Fraction(place.value) - exact) <= place.error < 1e-9 * (1 + abs(exact))


def test_exact_values_of_a_state_space():
    system = StateSpace.from_entries(*TRIANGLE)
    for point in ((Fraction(1, 3), Fraction(0)), (Fraction(2), Fraction(-5, 7))):
        value = system.transfer.at(*point)
        ((u, v),) = system.image(*point, [ONE])
        assert (str(u), str(v)) == (str(value[0, 0]), str(value[1, 0]))
    resonator = StateSpace.from_entries([[0, 2], [-2, 0]], [[1], [0]], [[1, 0]], [[0]])
    assert resonator.image(Fraction(0), Fraction(2), [ONE]) is None


def test_crossings_have_their_error():
    """1/(1 + w^2) = level, in nanoseconds."""
    system = FloatSystem.of(Kind.PR, StateSpace.from_entries([["-1e9"]], [["1e9"]], [[1]], [[0]]))
    for level in (0.9, 0.5, 1e-3):
        (found,) = crossings(system, level)
        assert abs(found.w * system.unit - 1e9 * np.sqrt(1 / level - 1)) <= 10 * found.error * system.unit
        assert found.error * system.unit < 1
    assert crossings(system, 1.1) == []


def test_an_active_network_that_hides_from_the_axis_is_refuted_near_its_pole():
    """1 - 1/(s - 2) and a negative resonator: nothing is negative on the axis."""
    for a, b, c, d in (([[2]], [[1]], [[-1]], [[1]]), ([[0, 3], [-3, 0]], [[1], [0]], [[-1, 0]], [[0]])):
        system = StateSpace.from_entries(a, b, c, d)
        verdict = refuted_or_undecided(Kind.PR, system, "too large")
        assert verdict.status is Status.REFUTED
        assert verdict.analysis.bands == ()
        assert "near a pole" in verdict.why
        s = complex(verdict.witness.re, verdict.witness.im)
        z = (np.array(d) + np.array(c) @ np.linalg.solve(s * np.eye(len(a)) - a, np.array(b))).item()
        assert s.real > 0 > z.real


def test_what_floats_cannot_hold_stays_undecided():
    system = StateSpace.from_entries([["-1e400"]], [[1]], [[1]], [[1]])
    verdict = refuted_or_undecided(Kind.PR, system, "too large")
    assert (verdict.status, verdict.analysis, verdict.why) == (Status.UNDECIDED, None, "too large")
    system = StateSpace.from_entries([["-1e308"]], [["1e308"]], [["1e308"]], [[1]])
    assert refuted_or_undecided(Kind.PR, system, "too large").status is Status.UNDECIDED


def test_an_exact_value_that_takes_too_long_is_not_begun():
    rng = np.random.default_rng(0)
    n = 90
    a = [[Fraction(int(rng.integers(1, 99)), 3**6000 if i == k else 1) for k in range(n)] for i in range(n)]
    verdict = check_positive_real(StateSpace.from_entries(a, [[1]] * n, [[1] * n], [[1]]))
    assert verdict.status is Status.UNDECIDED
    assert verdict.analysis.bands or verdict.analysis.rightmost > 0
    assert "one exact value for 90 states" in verdict.why


def test_methods_that_disagree_say_so():
    analysis = AxisAnalysis(((1.0, 2.0),), 1e-9, -0.25, 1e-9, 1.5, -1.0, agree=False)
    network = StateSpace.from_entries(*TRIANGLE)
    verdict = Verdict(Kind.PR, network, Status.UNDECIDED, reason="too large", floats=SimpleNamespace(analysis=analysis))
    assert verdict.why == (
        "too large; in floating point, by two methods that disagree, the smallest eigenvalue of (Z + Z^H)/2 is "
        "-0.25 ± 1e-09 at ω = 1.5, Z + Z^H has a negative eigenvalue for 1 < ω < 2; "
        "all eigenvalues of A have Re s <= -1"
    )
    v, value = (Fraction(1), Fraction(0)), (-1 / Fraction(3) ** 10000, Fraction(0))
    witness = Witness(Kind.PR, Fraction(1), Fraction(0), (value, (Fraction(0),) * 2), (v, (Fraction(0),) * 2))
    assert len(as_dict(replace(verdict, witness=witness), Margins())["witness"]["value"]) > 4700  # over 4300
    told = as_dict(verdict, Margins())["analysis"]
    assert told["bands"] == [[1.0, 2.0]]
    assert told["agree"] is False


def test_a_singular_value_in_floats():
    """Second-order low pass 1.25/(s^2 + s/2 + 1): its peak is 1.25/(2 h sqrt(1 - h^2)) at sqrt(1 - 2 h^2), h = 1/4."""
    system = StateSpace.from_entries([[0, 1], [-1, "-1/2"]], [[0], [1]], [["1.25", 0]], [[0]])
    found = analyse(FloatSystem.of(Kind.BR, system))
    assert found.value == pytest.approx(1.25 / (0.5 * np.sqrt(15 / 16)), rel=1e-9)
    assert found.frequency == pytest.approx(np.sqrt(7 / 8), rel=1e-6)
    assert found.bands == (pytest.approx((0, np.sqrt(7 / 8 + np.sqrt(49 / 64 + 9 / 16))), rel=1e-9),)
