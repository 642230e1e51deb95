"""Verdicts on functions whose answer is known by heart, and certificates that were tampered with."""

import dataclasses
import math
from fractions import Fraction

import pytest
from flint import arb, fmpz_poly

import passivity
from passivity import Kind, Status, check_bounded_real, check_positive_real, margins, robustness, verify
from passivity.polynomial import sign as polynomial_sign
from passivity.polynomial.infimum import infimum
from passivity.polynomial.roots import approximate_roots, positive_roots, routh_column
from passivity.polynomial.sign import SignProof

of = passivity.RationalFunction.from_expression
DIP = of("(s^2 + s + 1)/(s^2 + s + 4) + 1p")
OPEN, SHORT = of("1/0"), of("0")
TOUCHING = of("(s^2 + s + 1)/(s^2 + s + 4)")
CHECKS = {Kind.PR: check_positive_real, Kind.BR: check_bounded_real}


def poly(*coefficients):
    """Highest power first."""
    return fmpz_poly(list(coefficients[::-1]))


def from_roots(*roots):
    product = fmpz_poly([1])
    for root in map(Fraction, roots):
        product *= fmpz_poly([-root.numerator, root.denominator])
    return product


# ---- the sign of a polynomial on the half line


def test_a_budget_that_runs_out_is_said(monkeypatch):
    monkeypatch.setattr(polynomial_sign, "MAX_PIECES", 0)
    verdict = check_positive_real(DIP)
    assert verdict.status is Status.UNDECIDED
    assert "pieces" in verdict.why
    assert (verdict.certificate, verdict.witness) == (None, None)


def test_positive_roots_are_isolated():
    f = from_roots(1, 2, "2000001/1000000", 500, -3) * poly(1, 1, 1)
    found = positive_roots(f)
    assert [float(root) for root in found] == pytest.approx([1, 2, 2.000001, 500], rel=1e-15)
    assert [root.rising for root in found] == [False, True, False, True]
    assert [root.sign_of(poly(1, -3)) for root in found] == [-1, -1, -1, 1]


# ---- Hurwitz


@pytest.mark.parametrize(
    ("f", "answer"),
    [
        (poly(0), False),
        (poly(5), True),
        (poly(-5), True),
        (poly(1, 0), False),
        (poly(1, 1), True),
        (poly(-1, -1), True),
        (poly(1, -1), False),
        (poly(1, 0, 1), False),
        (poly(1, 1, 1, 1), False),  # (s + 1)(s^2 + 1)
        (poly(1, 2, 3, 7), False),
        (poly(1, 2, 4, 7), True),
        (poly(1, 1, 2, 2, 1, 1), False),  # (s + 1)(s^2 + 1)^2
        (poly(1, 1, 2, 2, 3, 5), False),  # a zero pivot
        (from_roots(*range(-30, 0)), True),
        (from_roots(*range(-30, 0), "1/1000000000"), False),
        (from_roots(*range(-30, 0)) * poly(10**40, 1, 10**40), True),
        (from_roots(*range(-30, 0)) * poly(10**40, -1, 10**40), False),
        (from_roots(*range(-30, 0)) * poly(1, 0, 1), False),
    ],
)
def test_hurwitz(f, answer):
    column = routh_column(f)
    assert (column is not None) == answer
    if column is not None:
        assert len(column) == f.degree() + 1
        assert all(pivot > 0 for pivot in column)


def test_approximate_roots_where_the_scheme_ends_early():
    roots = approximate_roots(poly(1, 1, 2, 2, 3, 5))
    assert len(roots) == 2
    assert all(abs(r**5 + r**4 + 2 * r**3 + 2 * r**2 + 3 * r + 5) < 1e-6 for r in roots)


# ---- verdicts


@pytest.mark.parametrize(
    ("expression", "kind", "status", "words"),
    [
        ("0", "pr", "proved", "lossless"),
        ("1/0", "pr", "proved", "lossless"),
        ("-1", "pr", "refuted", "Re Z(jω) < 0 for all ω"),
        ("s", "pr", "proved", "lossless"),
        ("s + 1/s", "pr", "proved", "lossless"),
        ("-s", "pr", "refuted", "pole at infinity with negative residue"),
        ("1 - s", "pr", "refuted", "pole at infinity with negative residue"),
        ("s - 1/s", "pr", "refuted", "pole at s = 0 with negative residue"),
        ("s^3", "pr", "refuted", "grows like s^3"),
        ("1/s^3", "pr", "refuted", "pole of order 3 at s = 0"),
        ("1/s^2", "pr", "refuted", "Re Z(jω) < 0"),
        ("s/(s^2 + 4)^2", "pr", "refuted", "pole of order 2 on the axis at ω = 2"),
        ("1 - s/(s^2 + 4)", "pr", "refuted", "pole on the axis at ω = 2 with negative residue"),
        ("1/(1 - s)", "pr", "refuted", "pole in Re s > 0"),
        ("(s^2 + s + 1)/(s^2 + s + 4)", "pr", "proved", "equal at ω = 1.41421"),
        ("1/(s^2 + s + 1)", "pr", "refuted", "for ω > 1"),
        ("(s + 1)/(s^2 + s + 1)", "pr", "proved", ""),
        ("(s - 1)*(s + 2)/((s - 1)*(s + 1))", "pr", "proved", "common factor s - 1 is a hidden mode"),
        ("1", "br", "proved", "lossless"),
        ("1/0", "br", "refuted", "|H(jω)| > 1"),
        ("2", "br", "refuted", "|H(jω)| > 1 for all ω"),
        ("(1 - s)/(1 + s)", "br", "proved", "lossless"),
        ("(1 + s)/(1 - s)", "br", "refuted", "pole in Re s > 0"),
        ("s", "br", "refuted", "for ω > 1"),
        ("1/s", "br", "refuted", "for ω < 1"),
        ("s/(s^2 + s + 1)", "br", "proved", "equal at ω = 1"),
        ("0", "br", "proved", ""),
    ],
)
def test_verdicts_and_reasons(expression, kind, status, words):
    verdict = CHECKS[Kind[kind.upper()]](of(expression))
    assert verdict.status == status
    assert words in verdict.why
    assert verdict.lossless == ("lossless" in words) or status == "refuted"
    assert (verdict.certificate is None) == (status == "refuted")
    assert (verdict.witness is None) == (status == "proved")


def test_a_verdict_does_not_change():
    verdict = check_positive_real(TOUCHING)
    with pytest.raises(dataclasses.FrozenInstanceError):
        verdict.status = Status.REFUTED
    assert verdict.why is verdict.why
    assert verdict.margins is verdict.margins


# ---- certificates


def test_a_certificate_of_something_else_is_refused():
    certificate = check_positive_real(TOUCHING).certificate
    (axis,) = certificate.sums
    sign = axis.sign

    def signed(*given):
        return (axis._replace(sign=SignProof(*given)),)

    for wrong in (
        {"function": of("(s^2 + s + 1)/(s^2 + s + 5)")},
        {"function": of("1/(1 - s)"), "sums": signed(((fmpz_poly([1]), 1),), ())},
        {"function": of("-1")},
        {"closing": poly(1, 1)},
        {"closing": poly(0)},
        {"sums": ()},
        {"kind": Kind.BR},
        {"sums": signed(((fmpz_poly([4, -4, 1]), 1),), ())},
        {"sums": signed((*sign.factors, (fmpz_poly([2]), 1)), ())},
        {"sums": signed(sign.factors, (Fraction(-1),))},
        {"sums": signed(sign.factors, (Fraction(2), Fraction(1)))},
    ):
        assert not verify(dataclasses.replace(certificate, **wrong)), wrong


def test_the_pieces_of_a_certificate_count():
    certificate = check_positive_real(DIP).certificate
    (axis,) = certificate.sums
    assert axis.sign.breaks
    assert verify(certificate)
    assert not verify(dataclasses.replace(certificate, sums=(axis._replace(sign=axis.sign._replace(breaks=())),)))


# ---- margins


def test_margins_that_are_not_rational_are_enclosed():
    margin = check_positive_real(of("(s + 2)/(s^2 + s + 1)")).margins.input
    exact = (3 - 2 * math.sqrt(3)) / 3  # of (2 - x)/(1 - x + x^2), at x = 2 + sqrt(3)
    assert margin.low < margin.high
    assert margin.value == pytest.approx(exact, rel=1e-11)
    assert margin.frequency == pytest.approx(math.sqrt(2 + math.sqrt(3)), rel=1e-12)


@pytest.mark.parametrize(
    ("expression", "smallest"),
    [  # a long step from where the search begins leads over the minimum and the ridge behind it
        ("10*s^4 + 5*s^3 + 44*s^2 + 15*s + 42", Fraction(-32, 5)),  # of 10 x^2 - 44 x + 42
        ("s^5 + 4*s^4 + 13*s^3 + 25*s^2 + 40*s + 25", Fraction(-225, 16)),  # of 4 x^2 - 25 x + 25
    ],
)
def test_a_minimum_before_a_ridge(expression, smallest):
    found = check_positive_real(of(expression)).margins
    assert found.input[:2] == (smallest, smallest)
    assert found.output.low == -math.inf or found.output.low < 0


def test_margins_beyond_the_doubles():
    found = check_positive_real(of("s - 1e400")).margins
    assert (found.input.low, found.input.value) == (-(10**400), -math.inf)
    assert found.output[:2] == (-Fraction(1, 10**400),) * 2
    assert check_bounded_real(of("1e400/(s + 1)")).margins.reflection.low == 10**400
    assert math.isclose(check_positive_real(of("s + 1e400/s - 1")).margins.output.frequency, 1e200, rel_tol=1e-15)


def test_a_witness_with_delay_a_hair_beyond_the_border():
    chain = passivity.check_line(of("s - 1"), 10**400, 1)  # |H2| = 1 + 2e-400
    assert chain.status is Status.REFUTED
    assert chain.input.real < 0


def test_reflections_against_a_reference():
    verdict = check_positive_real(of("25 + s/1000"))
    assert margins(verdict, 25).reflection.frequency == math.inf
    assert margins(check_positive_real(of("25")), "50 ohm").reflection[:2] == (Fraction(1, 3), Fraction(1, 3))
    for bad in (0, -1, "x", math.inf):
        with pytest.raises(passivity.ExpressionError):
            margins(verdict, bad)


def test_a_margin_within_a_hair_of_the_border():
    verdict = check_bounded_real(of("s/(s^2 + s + 1)") * (1 + Fraction(1, 10**30)))
    reflection = verdict.margins.reflection
    assert 1 < reflection.low <= 1 + Fraction(1, 10**30) <= reflection.high < 1 + Fraction(2, 10**30)


@pytest.mark.parametrize("z", [OPEN, SHORT])
def test_margins_of_open_and_short_circuit(z):
    found = check_positive_real(z).margins
    assert (found.input is None, found.output is None) == (z == OPEN, z == SHORT)
    assert found.reflection.value == 1


def test_a_smallest_value_among_many():
    f = from_roots(1, 1) * from_roots(5, 5) + fmpz_poly([1])
    g = from_roots(-1, -1, -1, -1)
    found = infimum(f * 10**6 - 3 * g, 10**6 * g)
    x = found.frequency**2
    assert found.low <= ((x - 1) ** 2 * (x - 5) ** 2 + 1) / (x + 1) ** 4 - 3e-6 + 1e-9
    assert x == pytest.approx(5, abs=0.1)


# ---- robustness


@pytest.mark.parametrize(
    ("expression", "tolerance", "same"),
    [
        ("50 + 1n*s + 1/(1p*s)", "1e-3", True),
        ("1", "0.999", True),
        ("-1", "0.999", True),
        ("s + 1/s", 2**-53, True),
        ("(s^2 + s + 1)/(s^2 + s + 4)", 0, True),
        ("(s^2 + s + 1)/(s^2 + s + 4)", 2**-53, False),
        ("(s^2 + s + 1)/(s^2 + s + 4) - 1/10^20", 0, True),
        ("(s^2 + s + 1)/(s^2 + s + 4) - 1/10^20", "1e-6", None),
    ],
)
def test_robustness(expression, tolerance, same):
    found = robustness(check_positive_real(of(expression)), tolerance)
    assert found.same is same
    assert (found.exception is not None) == (same is False)


def test_the_exception_is_in_the_box_and_not_positive_real():
    eps = Fraction(1, 10**9)
    exception = robustness(check_positive_real(TOUCHING), eps).exception
    assert check_positive_real(exception).status is Status.REFUTED
    scale = exception.numerator[0] / TOUCHING.numerator[0]
    for given, found in ((TOUCHING.numerator, exception.numerator), (TOUCHING.denominator, exception.denominator)):
        ratios = [b / a / scale for a, b in zip(given, found, strict=True)]
        assert max(ratios) / min(ratios) <= (1 + eps) / (1 - eps)


@pytest.mark.parametrize("tolerance", [-1, 1, "x", math.nan])
def test_a_wrong_tolerance_is_refused(tolerance):
    with pytest.raises(passivity.ExpressionError, match="tolerance"):
        robustness(check_positive_real(TOUCHING), tolerance)


def test_robustness_is_about_impedances():
    with pytest.raises(passivity.ExpressionError, match="one port, positive real proved or refuted"):
        robustness(check_bounded_real(TOUCHING), 0)


def test_a_column_of_balls():
    assert all(isinstance(pivot, arb) for pivot in check_positive_real(TOUCHING).certificate.column)


# ---- through a line
