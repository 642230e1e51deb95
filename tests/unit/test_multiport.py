"""The arithmetic behind verdicts on several ports, what they say besides yes and no, and what is refused."""

import time
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq, fmpq_mat, fmpz_poly

from passivity import ExpressionError, Status
from passivity.delayed.line import check_line_two_port
from passivity.exact.certificate import verify
from passivity.exact.margin import margin
from passivity.exact.positive_real import check_bounded_real, check_positive_real
from passivity.exact.storage import is_semidefinite, negative_direction
from passivity.polynomial.roots import violations
from passivity.polynomial.sign import SignProof
from passivity.rational.matrix import RationalMatrix, impedances, scattering
from passivity.rational.state_space import StateSpace
from passivity.report import as_dict, in_words
from passivity.status import Kind
from passivity.verdict import Certificate, Margins, StorageCertificate

PI = [["1 + 1/(s^2 + s + 1)", "(s + 1)/(s^2 + s + 1)"], ["(s + 1)/(s^2 + s + 1)", "s + (s + 1)/(s^2 + s + 1)"]]
GYRATOR = RationalMatrix.from_rows([[0, -7], [7, 0]])
CIRCULATOR = RationalMatrix.from_rows([[0, 0, 1], [1, 0, 0], [0, 1, 0]])


def random_symmetric(rng, n, rank):
    half = rng.integers(-3, 4, (n, rank))
    return half @ half.T


@pytest.mark.parametrize("seed", range(20))
def test_semidefinite_matrices_and_directions(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    a = random_symmetric(rng, n, int(rng.integers(0, n + 1)))
    exact = fmpq_mat(n, n, [int(x) for x in a.flatten()])
    assert is_semidefinite(exact)
    assert negative_direction(exact) is None
    b = a - random_symmetric(rng, n, 1)
    exact = fmpq_mat(n, n, [int(x) for x in b.flatten()])
    x = negative_direction(exact)
    assert (x is None) == is_semidefinite(exact) == (np.linalg.eigvalsh(b)[0] > -1e-9)
    if x is not None:
        assert sum(p * int(c) * q for p, row in zip(x, b, strict=True) for c, q in zip(row, x, strict=True)) < 0


def test_a_zero_on_the_diagonal_beside_something_is_a_direction():
    a = fmpq_mat(2, 2, [0, 3, 3, 100])
    assert not is_semidefinite(a)
    x = fmpq_mat(2, 1, negative_direction(a))
    assert (x.transpose() * a * x)[0, 0] < 0


def test_common_denominator():
    z = RationalMatrix.from_rows([["1/(s + 1)", "2/(s + 1)^2"], ["(s + 2)/((s + 2)*(2*s + 3))", "3"]])
    n, d = z.fraction
    assert d == fmpz_poly([1, 2, 1]) * fmpz_poly([3, 2])
    for t in range(4):
        for row, entries in zip(n, z.rows, strict=True):
            for p, entry in zip(row, entries, strict=True):
                assert fmpq(p(t), d(t)) == fmpq(entry.p(t), entry.q(t))


@pytest.mark.parametrize(
    ("entry", "parameters", "message"),
    [
        ("1/0", {}, r"entry \(1, 2\): infinite"),
        ("s +", {}, r"entry \(1, 2\), column 4"),
        ("R", {}, r"entry \(1, 2\), parameter R: no value"),
        ("s", {"R": 1}, "parameter R: not in the matrix"),
        (([1, 2, 3],), {}, r"entry \(1, 2\): not a rational function"),
        (float("nan"), {}, r"entry \(1, 2\), numerator\[0\]: not a number"),
        (None, {}, "not a number"),
        ("exp(s)", {}, "not rational"),
    ],
)
def test_bad_entries(entry, parameters, message):
    with pytest.raises(ExpressionError, match=message):
        RationalMatrix.from_rows([["s", entry], ["s", "s"]], parameters)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([], "wrong number of ports"),
        ([["s", "s"]], "row 1: not square"),
        ([["s"] * 13] * 13, "wrong number of ports"),
        ("s", "not a matrix"),
        (3, "not a matrix"),
        (["s"], "not a matrix"),
    ],
)
def test_bad_matrices(rows, message):
    with pytest.raises(ExpressionError, match=message):
        RationalMatrix.from_rows(rows)


@pytest.mark.parametrize(
    ("matrices", "message"),
    [
        (([[1, 2]], [[1]], [[1]], [[0]]), "A: wrong shape, expected 1 by 1"),
        (([[1]], [[1, 2]], [[1]], [[0]]), "B: wrong shape, expected 1 by 1"),
        (([[1]], [[1]], [[1], [1]], [[0]]), "C: wrong shape"),
        (([[1]], [[1]], [[1]], [[0, 1]]), "D, row 1: not square"),
        (([[1]], [["x"]], [[1]], [[0]]), r"B\[0\]\[0\]: not a number"),
        (([[0] * 401] * 401, [[1]] * 401, [[1] * 401], [[0]]), "A: too many states"),
        (([[Fraction(1, 3**7000)]], [[1]], [[1]], [[0]]), "A: entries too long, or too far apart"),
    ],
)
def test_bad_state_spaces(matrices, message):
    with pytest.raises(ExpressionError, match=message):
        StateSpace.from_entries(*matrices)


def test_time_constants_may_be_far_apart():
    system = StateSpace.from_entries([["-1e400", 0], [0, "-1e-400"]], [[1], [1]], [[1, 1]], [[0]])
    assert check_positive_real(system).status is Status.PROVED
    system = StateSpace.from_entries([["-1e400", 0], [0, "1e-400"]], [[1], [1]], [[1, 1]], [[0]])
    verdict = check_positive_real(system)
    assert verdict.status is Status.REFUTED
    assert verdict.why == "Z + Z^H has a negative eigenvalue for ω < 1"


def test_transfer_matrix_and_what_it_hides():
    system = StateSpace.from_entries(
        [[-1, 0, 5], [0, 2, 0], [0, 0, -3]], [[1, 0], [0, 0], [0, 1]], [[1, 7, 0], [0, 7, 2]], [[1, 0], [0, "1/2"]]
    )
    a, b, c, d = (np.array(x.tolist(), dtype=float) for x in (system.a, system.b, system.c, system.d))
    s = 0.3 + 2j
    assert np.allclose(system.transfer(s), d + c @ np.linalg.solve(s * np.eye(3) - a, b))
    assert check_positive_real(system).hidden == fmpz_poly([-2, 1])
    basis, part = system.reached()
    assert (basis.ncols(), part.states) == (2, 2)
    assert system.a * basis == basis * part.a


def test_hidden_factors_of_a_matrix():
    verdict = check_positive_real(RationalMatrix.from_rows([[([1, -1], [1, -1]), 0], [0, ([1, 2], [1, 2])]]))
    assert verdict.status is Status.PROVED
    assert verdict.hidden == fmpz_poly([-1, 1])


def test_no_states_and_no_losses():
    static = StateSpace.from_entries([], [], [[], []], [[1, 3], [-3, 0]])
    assert check_positive_real(static).status is Status.PROVED
    assert isinstance(check_positive_real(StateSpace.from_entries([], [], [[]], [[0]])).function, StateSpace)
    assert check_positive_real(StateSpace.from_entries([], [], [[]], [[-1]])).status is Status.REFUTED


def test_a_lossless_energy_that_is_not_positive_is_refuted():
    """P = diag(1, -1): the second resonator has a negative element."""
    a = [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 2], [0, 0, -2, 0]]
    verdict = check_positive_real(StateSpace.from_entries(a, [[1], [0], [1], [0]], [[1, 0, -1, 0]], [[0]]))
    assert verdict.status is Status.REFUTED
    s = complex(verdict.witness.re, verdict.witness.im)
    assert (s / (s * s + 1) - s / (s * s + 4)).real < 0
    assert s.real > 0


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([["1", "3"], ["0", "1"]], "Z + Z^H has a negative eigenvalue for all ω"),
        ([["1/(s + 1) - 1/4", "0"], ["0", "1"]], "Z + Z^H has a negative eigenvalue for ω > 1.73205"),
        ([["1/4 + 1/(s - 2)", "0"], ["0", "1"]], "Z + Z^H has a negative eigenvalue for ω < 2"),
        ([["1", "0"], ["0", "2 - 1/(s - 2)"]], "Z has a pole in Re s > 0"),
        (
            [["s", "2*s"], ["2*s", "s"]],
            "Z has a pole at infinity that is not simple with a nonnegative Hermitian residue",
        ),
        ([["-1", "s"], ["0", "-1"]], "Z + Z^H has a negative eigenvalue for all ω"),
    ],
)
def test_reasons(rows, why):
    verdict = check_positive_real(RationalMatrix.from_rows(rows))
    assert verdict.status is Status.REFUTED
    assert verdict.why == why


def test_many_bands_are_cut_short():
    f = fmpz_poly([1])
    for root in range(1, 13):
        f *= fmpz_poly([-root, 1])
    assert len(violations([f])) == 6
    assert in_words(violations([f])).endswith(" and 2 more")


def test_ideal_elements():
    transformer = RationalMatrix.from_rows([["5/13", "12/13"], ["12/13", "-5/13"]])  # of ratio 3/2
    s = np.array(transformer(1 + 1j)).real
    a = np.array([0.3, -1.2])
    b = s @ a
    u, y = a + b, a - b
    assert u[0] == pytest.approx(1.5 * u[1])
    assert y[1] == pytest.approx(-1.5 * y[0])
    for element in (transformer, scattering(GYRATOR, 50), CIRCULATOR):
        verdict = check_bounded_real(element)
        assert verdict.lossless
        assert verify(verdict.certificate)
    assert check_positive_real(GYRATOR).lossless
    with pytest.raises(ExpressionError, match="I - S: has no inverse"):
        impedances(transformer)
    with pytest.raises(ExpressionError, match=r"Z \+ z0 I: has no inverse"):
        scattering(RationalMatrix.from_rows([[-50]]), 50)


def test_what_is_no_network_is_refused():
    with pytest.raises(ExpressionError, match=r"function: not a rational function or matrix.* got int"):
        check_positive_real(3)


@pytest.mark.parametrize("reference", [0, -1, "x"])
def test_bad_references(reference):
    for call in (lambda: scattering(GYRATOR, reference), lambda: check_line_two_port(reference, 1)):
        with pytest.raises(ExpressionError, match="z0: not"):
            call()
    with pytest.raises(ExpressionError, match="delay: not"):
        check_line_two_port(1, reference)


def minor_certificate():
    certificate = check_positive_real(RationalMatrix.from_rows(PI)).certificate
    assert isinstance(certificate, Certificate)
    return certificate


def test_verify_sees_through_false_certificates():
    true = minor_certificate()
    assert verify(true)
    first, second = true.sums
    other = RationalMatrix.from_rows([["1", "3"], ["3", "1"]])
    unstable = fmpz_poly([-1, 1])
    assert true.inverse is not None
    agreeing = fmpz_poly([1])  # zero at all places where the sums themselves would be told apart
    for t in range(50):
        agreeing *= fmpz_poly([t * t, 1])
    false = [
        replace(
            true, sums=(first._replace(a=first.a + agreeing, sign=SignProof(((first.a + agreeing, 1),), ())), second)
        ),
        replace(true, function=other),
        replace(true, sums=(first,)),
        replace(true, sums=(second, first)),
        replace(true, sums=(first._replace(a=first.a + 1), second)),
        replace(true, sums=(first._replace(power=first.power + 1), second)),
        replace(true, sums=(first._replace(sign=second.sign), second)),
        replace(true, closing=true.closing * unstable, inverse=[[x * unstable for x in row] for row in true.inverse]),
        replace(true, closing=fmpz_poly([1])),
        replace(true, inverse=None),
        replace(true, kind=Kind.BR),
    ]
    assert not any(verify(certificate) for certificate in false)


def test_verify_sees_through_false_energies():
    true = check_positive_real(StateSpace.from_entries([[0, -1], [3, 0]], [[1], [0]], [[1, 0]], [[0]])).certificate
    assert isinstance(true, StorageCertificate)
    assert verify(true)
    damped = StateSpace.from_entries([[1, -1], [3, 0]], [[1], [0]], [[1, 0]], [[0]])
    negative = StateSpace.from_entries([[0, -1], [3, 0]], [[1], [0]], [[-1, 0]], [[0]])
    false = [
        replace(true, storage=2 * true.storage),
        replace(true, storage=-true.storage, function=negative, reached=negative),
        replace(true, function=damped),
        replace(true, function=damped, reached=damped),
        replace(true, basis=2 * true.basis),
    ]
    assert not any(verify(certificate) for certificate in false)


def test_a_transfer_matrix_that_is_not_the_state_spaces_is_seen():
    system = StateSpace.from_entries([[-1, 1], [0, -2]], [[1], [1]], [[1, 0]], [[1]])
    certificate = check_positive_real(system).certificate
    assert verify(certificate)
    system.__dict__["transfer"] = RationalMatrix.from_rows([["1 + 1/(s + 1)"]])
    assert not verify(certificate)


def test_margins():
    z = RationalMatrix.from_rows([["3 + s/(s^2 + s + 4)", "1"], ["1", "3"]])
    found = margin(z, Kind.PR)
    assert found.value == pytest.approx(2)
    assert found.frequency in (0, np.inf)
    assert found.bound <= 2
    s = RationalMatrix.from_rows([["0", "3/5*s/(s^2 + s + 4)"], ["1/2", "0"]])
    found = margin(s, Kind.BR)
    assert (found.value, found.frequency) == pytest.approx((0.6, 2.0), rel=1e-6)
    assert 0.6 <= found.bound < 0.6000001
    assert margin(RationalMatrix.from_rows([["0"]]), Kind.BR).value == 0
    assert margin(RationalMatrix.from_rows([["1/s^2"]]), Kind.PR) is None
    assert margin(RationalMatrix.from_rows([["-s^2"]]), Kind.BR) is None
    far = RationalMatrix.from_rows([["1", "1/2"], ["0", "1e308/(1 + 5p*s + 39k*s^2)"]])
    assert margin(far, Kind.PR) is None  # its resonance is beyond all floats


def test_reports_are_plain():
    import json

    verdict = check_positive_real(RationalMatrix.from_rows(PI))
    told = as_dict(verdict, verdict.margins)
    assert told["certificate"]["verified"]
    found = told["margins"]["input"]
    assert (found["value"], found["low"], found["frequency"]) == (pytest.approx(0, abs=1e-12), "0", 1.0)
    limit = margin(RationalMatrix.from_rows([["2 + 1/(s + 1)"]]), Kind.PR)
    assert as_dict(verdict, Margins(limit))["margins"]["input"]["frequency"] == "inf"
    assert json.loads(json.dumps(told)) == told
    lossless = check_positive_real(StateSpace.from_entries([[0, -1], [3, 0]], [[1], [0]], [[1, 0]], [[0]]))
    assert as_dict(lossless, Margins())["certificate"]["storage"] == [["1", "0"], ["0", "1/3"]]
    refuted = check_positive_real(RationalMatrix.from_rows([["1", "3"], ["3", "1"]]))
    assert Fraction(as_dict(refuted, Margins())["witness"]["value"]) < 0


def test_too_much_is_undecided_and_said_so_at_once():
    many = [[(1 + i * k, [1] * 40 + [i + k + 2]) for k in range(12)] for i in range(12)]
    wide = RationalMatrix.from_rows([[([x], q) for x, q in row] for row in many])
    start = time.process_time()
    verdict = check_positive_real(wide)
    assert time.process_time() - start < 2
    assert verdict.status is Status.UNDECIDED
    assert "would be decided" in verdict.why
