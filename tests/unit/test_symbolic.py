"""Parameters under assumptions: what is read, proved, refuted and left open, on functions known by heart."""

import time
from fractions import Fraction

import mpmath
import pytest

from passivity import ExpressionError, Kind, Range, Status, admittance_identity, parse_assumption, reflection_identity
from passivity.calculus.ask import of_text as check_symbolic
from passivity.calculus.proof import check_evidence
from passivity.expression.parse import parse
from passivity.expression.tree import symbols
from passivity.symbolic.domain import ALL, Domain
from passivity.verifier import check

RLC = ["R > 0", "L > 0", "C > 0"]

# ---- assumptions


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("R>0", Range("R", Fraction(0), None, True)),
        ("R >= 0", Range("R", Fraction(0))),
        ("0 < R", Range("R", Fraction(0), None, True)),
        ("k real", Range("k")),
        ("0<k<1", Range("k", Fraction(0), Fraction(1), True, True)),
        ("-1 <= k <= 1/2", Range("k", Fraction(-1), Fraction(1, 2))),
        ("1 > k >= 0", Range("k", Fraction(0), Fraction(1), False, True)),
        ("C < 4 pF", Range("C", None, Fraction(1, 250_000_000_000), False, True)),
        ("R = 50", Range("R", Fraction(50), Fraction(50))),
    ],
)
def test_assumptions_are_read(text, expected):
    assert parse_assumption(text) == expected
    assert parse_assumption(str(expected)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "assumption : this says nothing of one parameter"),
        ("R", "assumption R: this says nothing of one parameter"),
        ("R > L", "assumption R > L: not a number"),
        ("s > 0", "assumption s > 0: s is the Laplace variable"),
        ("0 < 1", "assumption 0 < 1: this says nothing of one parameter"),
        ("R > 0 > 1 > 2", "assumption R > 0 > 1 > 2: this says nothing of one parameter"),
        ("R < 0 < L", "assumption R < 0 < L: this says nothing of one parameter"),
        ("1 < k < 0", "parameter k: no value has k > 1 and k < 0"),
        ("R == 5", "assumption R == 5"),
        ("R > 1/0", "assumption R > 1/0: not a number"),
        ("R > " + "9" * 2000, "assumption: not an assumption"),
        ("2k real", "assumption 2k real: not a name"),
    ],
)
def test_bad_assumptions_are_refused_in_one_sentence(text, expected):
    with pytest.raises(ExpressionError) as error:
        parse_assumption(text)
    assert expected in str(error.value)


@pytest.mark.parametrize(
    ("text", "assumptions", "expected"),
    [
        ("R + s*L", ["R > 0"], "parameter L: no value and no assumption"),
        ("R", ["R > 0", "R < 0"], "parameter R: no value has R > 0 and R < 0"),
        ("R", ["R > 0", "k real"], "parameter k: not in the expression, expected values or assumptions for R"),
        (
            "let x = R; x",
            ["R > 0", "x > 0", "Z pr"],
            "parameters Z, x: not in the expression, expected values or assumptions for R, got R, Z, x",
        ),
        ("a/(b - b)*0", ["a > 0", "b > 0"], "division by zero"),
        ("((((a*1e300 + s)^20)^20)^20)", ["a > 0"], "the numbers are too long"),
        ("R +", ["R > 0"], "column 4: the expression ends too early"),
    ],
)
def test_bad_questions_are_refused_in_one_sentence(text, assumptions, expected):
    with pytest.raises(ExpressionError) as error:
        check_symbolic(text, Kind.PR, assumptions)
    assert expected in str(error.value)


# ---- signs


@pytest.mark.parametrize(
    ("polynomial", "signs"),
    [
        ("a*b + 1", {1}),
        ("a*b", {0, 1}),
        ("(a - b)^2", {0, 1}),
        ("a - b", ALL),
        ("a - a*k", {0, 1}),
        ("1 - k^2", {1}),
        ("k - 2", {-1}),
        ("r^2 - r + 1", {1}),
        ("r^2 - 2", ALL),
        ("r^2*a", {0, 1}),
        ("2 - c", {0, 1}),
        ("3 - c", {1}),
        ("c*(2 - c)", {0, 1}),
        ("0*a", {0}),
    ],
)
def test_signs(polynomial, signs):
    ranges = {"a": "a >= 0", "b": "b >= 0", "k": "-1 < k < 1", "r": "r real", "c": "1 <= c <= 2"}
    domain = Domain(tuple(map(parse_assumption, ranges.values())))
    values = dict(zip(ranges, domain.context.gens()[2:], strict=True))
    assert domain.signs(eval(polynomial.replace("^", "**"), {}, values)) == signs


# ---- proofs

PROVED = [
    ("R + s*L + 1/(s*C)", "PR", RLC),
    ("R*s*L/(R + s*L)", "PR", ["R >= 0", "L >= 0"]),
    ("1/(1/R + s*C + 1/(s*L))", "PR", RLC),
    ("(1 - k)*R + 1/(1/(k*R) + s*C)", "PR", ["0 <= k <= 1", "R > 0", "C >= 0"]),
    ("(R - s*L)/(R + s*L)", "BR", ["R > 0", "L > 0"]),
    ("R/(R + s*L)", "BR", ["R > 0", "L > 0"]),
    ("sqrt((R + s*L)/(G + s*C))", "PR", [*RLC, "G > 0"]),
    ("1/sqrt(s*R*C)", "PR", ["R > 0", "C > 0"]),
    ("exp(-x*sqrt((R + s*L)*(G + s*C)))", "BR", [*RLC, "G > 0", "x >= 0"]),
    ("(R + s*L - z)/(R + s*L + z)*exp(-2*T*s)", "BR", ["R >= 0", "L >= 0", "z > 0", "T >= 0"]),
    ("(1 - k*exp(-2*T*s))/(1 + k*exp(-2*T*s))", "PR", ["T >= 0", "-1 < k < 1"]),
    ("(s + a)/(s^2 + 3*s + 3*a)", "PR", ["0 <= a <= 3"]),
    ("(s^2 + a*s + 1)/(s^2 + b*s + 1)", "PR", ["a >= 0", "b >= 0"]),
    ("(s^2 + a*s + c)/(s^2 + b*s + c)", "PR", ["a >= 0", "b > 0", "c > 0"]),
    ("k/(s^3 + 2*s^2 + 2*s + 1)", "BR", ["-1 <= k <= 1"]),
    ("k*s/(s^2 + 2*d*s + 1)", "BR", ["0 <= k <= 2", "d >= 1"]),
    ("(s + a)^3/(s + b)^3", "PR", ["1 <= a <= 2", "1 <= b <= 2"]),
    ("k^2 - k + 1 + s*L", "PR", ["k real", "L > 0"]),
    ("*".join(f"(s + {k})/(s + {k + 1})" for k in range(1, 28, 2)), "PR", []),
]


@pytest.mark.parametrize(("text", "kind", "assumptions"), PROVED)
def test_proved(text, kind, assumptions):
    """What is proved is not broken at points of the right half plane, for values here and there, with 30 digits."""
    verdict = check_symbolic(text, Kind[kind], assumptions)
    assert verdict.status is Status.PROVED
    assert verdict.certificate or verdict.steps
    for u in ("1/3", "1", "7"):
        values = {r.name: _inside(r, Fraction(u)) for r in verdict.ranges}
        for s in (mpmath.mpc(x, y) / 1000 for x, y in [(10, 700), (1, 1300), (2000, 5000), (100, 0)]):
            value = _value(text, s, values)
            assert value.real >= 0 if kind == "PR" else abs(value) <= 1


def _inside(r, u):
    if r.low is not None and r.high is not None:
        return (r.low + r.high * u) / (1 + u)
    return u if r.low is None else r.low + u


def _value(text, s, values):
    names = {name: mpmath.mpf(x.numerator) / x.denominator for name, x in values.items()}
    functions = {"s": s, "exp": mpmath.exp, "sqrt": mpmath.sqrt}
    return eval(text.replace("^", "**"), functions | names)


def test_numbers_and_assumptions_mix():
    mixed = check_symbolic("R + 1/(s*C)", Kind.PR, ["C > 0", "R = 50 ohm"])
    given = check_symbolic("R + 1/(s*C)", Kind.PR, ["C > 0"], {"R": 50})
    assert mixed.asked == given.asked
    assert mixed.status is given.status is Status.PROVED
    active = check_symbolic("R + 1/(s*C)", Kind.PR, ["C > 0"], {"R": "-1 ohm"})
    assert active.witness.names == {"C": 1, "R": -1}
    assert check_evidence(active.evidence) is None


# ---- conditions and counterexamples


@pytest.mark.parametrize(
    ("text", "kind", "assumptions", "condition"),
    [
        ("(s^2 + a*s + b)/(s^2 + a*s + 1)", "PR", ["a > 0", "b > 0"], None),
        ("(s + a)/(s^2 + b*s + a*b)", "PR", ["a > 0", "b > 0"], "b >= a"),
        ("k*s/(s^2 + 2*d*s + 1)", "BR", ["k >= 0", "d > 0"], "2*d >= k"),
        ("k/(s^2 + s + 1)", "BR", ["k real"], "-1 <= k <= 1 and 3 >= 4*k^2"),
        ("a/d", "PR", ["a real", "d > 0"], "a >= 0"),
        ("k*exp(-T*s)", "BR", ["k real", "T real"], "(T >= 0 and -1 <= k <= 1) or k = 0"),
    ],
)
def test_conditions_are_simple(text, kind, assumptions, condition):
    verdict = check_symbolic(text, Kind[kind], assumptions)
    assert verdict.status is Status.REFUTED
    if condition:
        assert str(verdict.condition) == condition
    assert not verdict.condition.holds(verdict.witness.names)


def test_a_condition_refuses_values_against_the_assumptions():
    condition = check_symbolic("R + s*L", Kind.PR, ["R real", "L > 0"]).condition
    assert condition.holds({"R": "0", "L": 1})
    for values, expected in [
        ({"R": 1, "L": 0}, "parameter L: against the assumption, expected L > 0, got 0"),
        ({"L": 1}, "parameter R: no value"),
        ({"R": "x", "L": 1}, "parameter R: not a number"),
    ]:
        with pytest.raises(ExpressionError) as error:
            condition.holds(values)
        assert expected in str(error.value)


@pytest.mark.parametrize(
    ("text", "kind", "assumptions"),
    [
        ("exp(2*T*s)/2", "BR", ["T > 0"]),
        ("k*exp(-2*T*s)*(1 - s*t)/(1 + s*t)", "BR", ["T > 0", "t > 0", "k > 1"]),
        ("exp(-T*s)/(s*t - 1)", "BR", ["T > 0", "t > 0"]),
        ("(1 - exp(-2*T*s)*k/(s + 1))/(1 + exp(-2*T*s)*k/(s + 1))", "PR", ["T > 0", "k real"]),
        ("R + s*L - 1/(s*C)", "PR", RLC),
        ("1/(s + a) - 1/(s + b)", "PR", ["a > 0", "b > 0"]),
        ("a*s^3", "PR", ["a > 0"]),
    ],
)
def test_refuted(text, kind, assumptions):
    """The witness is one, put into the text with 60 digits."""
    found = check_symbolic(text, Kind[kind], assumptions).witness
    with mpmath.workdps(60):
        re, im = (mpmath.mpf(x.numerator) / x.denominator for x in (found.re, found.im))
        value = _value(text, mpmath.mpc(re, im), found.names)
        assert re > 0
        assert value.real < 0 if kind == "PR" else abs(value) > 1


def test_the_search_is_the_same_each_time():
    text, assumptions = "1/(s + a) - c/(s + b) + d", [f"{name} > 0" for name in "abcd"]
    assert check_symbolic(text, Kind.PR, assumptions).why == check_symbolic(text, Kind.PR, assumptions).why


# ---- left open


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sqrt(1 + R*s^2)", "sqrt(...) is not rational"),
        ("(s^2 + s + exp(-T*s)/9 + 1)/(s^2 + 2*s + exp(-T*s)/9 + 1)", "not exp(-T*s) times"),
        ("(s^2 + s + exp(-T*s)/9 + 1)/(s^2 + 2*s + exp(-R*s)/9 + 1)", "not whole multiples of one"),
    ],
)
def test_what_cannot_be_decided_says_why(text, reason):
    verdict = check_symbolic(text, Kind.PR, [f"{name} > 0" for name in "RT" if name in text])
    assert verdict.status is Status.UNDECIDED
    assert reason in verdict.why
    assert "to settle it" in verdict.why


@pytest.mark.parametrize(
    "text",
    [
        "((((a + s)^20)^20)^20)",
        "(a + b + c + d + e + f + g + h + s)^50",
        "*".join(f"(s + a*{k} + b)/(s + b*{k} + c)" for k in range(12)),
        "exp(-s*a)^200*exp(-exp(-s*b))",
    ],
)
def test_hostile_questions_end_soon(text):
    names = symbols(parse(text)) - {"s"}
    start = time.process_time()
    verdict = check_symbolic(text, Kind.PR, [f"{name} > 0" for name in names])
    assert verdict.status is not Status.PROVED
    assert time.process_time() - start < 5  # one second on a quiet machine


PARTS = ("exp(-x)", "tanh(x)", "x + Z2", "line(R, T*s, x)", "sqrt(x)", "x")


@pytest.mark.parametrize("whole", PARTS)
def test_what_polynomials_prove_of_a_part_goes_into_the_whole(whole):
    """Re 1/x = R - R/(1 + R^2 w^2), which the terms of 1/x do not show."""
    text = f"let x = 1/(1/(R*s + 1)/s + R); {whole}"
    assume = ["R > 0", *(x for x in ("T > 0", "Z2 positive real") if x.split()[0] in whole)]
    found = check_symbolic(text, Kind.BR if "exp" in whole else Kind.PR, assume)
    assert found.proved
    evidence = found.evidence
    assert check_evidence(evidence) is None
    assert "'parameters'" in check(evidence)
    for step in evidence["steps"]:
        step[4] = ["BR", "1000"] if step[2] == "parameters" else step[4]
    assert "does not follow" in check_evidence(evidence)


# ---- identities and text


@pytest.mark.parametrize("steps", [reflection_identity(), admittance_identity()], ids=["H2", "G1"])
def test_identities_hold_and_are_not_empty(steps):
    """Checked again in doubles at points that have nothing to do with the polynomials."""
    for step in steps:
        assert step.holds
        assert not step._replace(parts=f"{step.parts} + 1").holds
        values = {"x": 3 / 7, "y": -5 / 11, "a": 3 / 7, "b": -5 / 11, "i": 1j}
        left, right = (eval(text.replace("^", "**"), {}, values) for text in (step.definition, step.parts))
        assert left == pytest.approx(right, rel=1e-14)


def test_the_last_steps_are_the_identities():
    """|H2|^2 and 2 Re G1 from complex division in double precision."""
    g2, h1 = complex(0.3, -1.7), complex(-0.4, 0.2)
    h2, g1 = (g2 - 1) / (g2 + 1), (1 - h1) / (1 + h1)
    right_h2, right_g1 = (steps()[-1].parts.replace("^", "**") for steps in (reflection_identity, admittance_identity))
    assert eval(right_h2, {"x": g2.real, "y": g2.imag}) == pytest.approx(abs(h2) ** 2, rel=1e-12)
    assert eval(right_g1, {"a": h1.real, "b": h1.imag}) == pytest.approx(2 * g1.real, rel=1e-12)
