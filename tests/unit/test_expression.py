"""The parser builds the tree one expects, or says in one sentence, at a column, why it does not."""

from fractions import Fraction

import pytest

from passivity.errors import ExpressionError
from passivity.expression.parse import MAX_CHARACTERS, MAX_DEPTH, parse
from passivity.expression.tree import Add, Call, Divide, Multiply, Negate, Number, Power, Symbol, symbols

a, b, c, d, s = (Symbol(name) for name in "abcds")
two = Number(Fraction(2), "2")


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("a", a),
        ("a + b - c", Add((a, b, Negate(c)))),
        ("a - (b - c)", Add((a, Negate(Add((b, Negate(c))))))),
        ("a*b*c", Multiply((a, b, c))),
        ("a/b/c", Divide(a, Multiply((b, c)))),
        ("a/b*c/d", Divide(Multiply((a, c)), Multiply((b, d)))),
        ("a + b*c", Add((a, Multiply((b, c))))),
        ("(a + b)*c", Multiply((Add((a, b)), c))),
        ("-s^2", Negate(Power(s, 2))),
        ("(-s)**2", Power(Negate(s), 2)),
        ("2*-s", Multiply((two, Negate(s)))),
        ("+a", a),
        ("s^-2", Power(s, -2)),
        ("s^(2)", Power(s, 2)),
        ("s^2.0", Power(s, 2)),
        ("a/s^2*b", Divide(Multiply((a, b)), Power(s, 2))),
        ("exp(-2*a*s)", Call("exp", Multiply((Negate(two), a, s)))),
        ("sqrt ( s )", Call("sqrt", s)),
        *((f"{name}(s)", Call(name, s)) for name in ("log", "sinh", "cosh", "tanh", "coth", "sech", "csch")),
        ("\ta\n+ b ", Add((a, b))),
        ("exp", Symbol("exp")),
        ("__import__", Symbol("__import__")),
        ("lambda", Symbol("lambda")),
        ("R_1", Symbol("R_1")),
    ],
)
def test_tree(text, tree):
    assert parse(text) == tree


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("", 1, "too early"),
        ("   ", 4, "too early"),
        ("1 +", 4, "a number, a name or '('"),
        ("(1", 3, "')'"),
        ("1)", 2, "operator"),
        ("()", 2, "got ')'"),
        ("*2", 1, "got '*'"),
        ("2 s", 3, "2*s"),
        ("2s", 2, "2*s"),
        ("2T", 2, "2*T"),
        ("2Ts", 2, "2*Ts"),
        ("5 m", 3, "5m"),
        ("10 n", 4, "10n"),
        ("1f", 2, "1*f"),
        ("2 ks", 3, "2*ks"),
        ("2 R", 3, "2*R"),
        ("2sqrt(s)", 2, "2*sqrt"),
        ("R s", 3, "operator"),
        ("2 3", 3, "operator"),
        ("1.2.3", 4, "operator"),
        ("0x10", 2, "operator"),
        ("(s)(s)", 4, "operator"),
        ("s 2", 3, "operator"),
        ("2H + H", 2, "H is a unit or prefix here"),
        ("G*s + 2G", 8, "G is a unit or prefix here"),
        ("s(1 + s)", 1, "s*(...)"),
        ("sqr(s)", 1, "sqrt"),
        ("Exp(s)", 1, "exp"),
        ("cos(s)", 1, "exp, log, sqrt, sinh, cosh, tanh, coth, sech, csch, or cos*(...)"),
        ("ln(s)", 1, "log"),
        ("I0(s)", 1, "unknown function"),
        ("__import__('os')", 12, "U+0027"),
        ("__import__(os)", 1, "unknown function"),
        ("a.b", 2, "U+002E"),
        ("().__class__", 3, "U+002E"),
        ("s;s", 2, "U+003B"),
        ("[s]", 1, "U+005B"),
        ('"s"', 1, "U+0022"),
        ("s = 2", 3, "U+003D"),
        ("R\u2081", 2, "U+2081"),
        ("\u2212s", 1, "U+2212"),
        ("\U0001f600", 1, "U+1F600"),
        ("\x00", 1, "U+0000"),
        ("\ud800", 1, "U+D800"),
        ("\u0663*s", 1, "U+0663"),  # an Arabic digit, which int() would take
        ("s^201", 2, "-200 to 200"),
        ("s^-201", 2, "-200 to 200"),
        ("s^0.5", 2, "sqrt"),
        ("s^(1/2)", 2, "sqrt"),
        ("s^n", 2, "whole number"),
        ("2^3^2", 2, "whole number"),
        ("s^1e9", 2, "-200 to 200"),
        ("s***2", 4, "got '*'"),
        ("1//s", 3, "got '/'"),
        ("1e401", 1, "e400"),
        ("1e-401", 1, "e-400"),
        ("s + 1e1000000000", 5, "e400"),
        ("1e" + "9" * 5000, 1, "e400"),
        ("9" * 4001, 1, "at most 4000"),
    ],
)
def test_refused_with_column(text, column, words):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    assert caught.value.where == f"column {column}"
    assert words in str(caught.value)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize(
    "text",
    [
        "s" * (MAX_CHARACTERS + 1),
        "(" * MAX_CHARACTERS,
        "-" * (MAX_CHARACTERS - 1) + "s",
        "exp(" * (MAX_CHARACTERS // 4),
        "s^" * (MAX_CHARACTERS // 2),
        "(" * (MAX_DEPTH + 1) + "s" + ")" * (MAX_DEPTH + 1),
        "1" * MAX_CHARACTERS,
        "s+" * (MAX_CHARACTERS // 2),
        "x" * (MAX_CHARACTERS - 3) + "(1)",
        "1 " * (MAX_CHARACTERS // 2),
    ],
)
def test_hostile_text_is_refused_at_once(text):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("text", [None, 3, b"s", ["s"]])
def test_only_text_is_parsed(text):
    with pytest.raises(ExpressionError, match="not text, expected a string, got"):
        parse(text)


def test_the_limits_themselves_are_allowed():
    assert parse("(" * MAX_DEPTH + "s" + ")" * MAX_DEPTH) == s
    assert parse("s" * MAX_CHARACTERS) == Symbol("s" * MAX_CHARACTERS)
    assert len(symbols(parse("+".join(["s"] * 5000)))) == 1


def test_long_sums_and_products_make_flat_trees():
    assert parse("+".join(["s"] * 3000)) == Add((s,) * 3000)
    assert parse("*".join(["s"] * 3000)) == Multiply((s,) * 3000)
    assert parse("/".join(["s"] * 3000)) == Divide(s, Multiply((s,) * 2999))


def test_symbols():
    assert symbols(parse("R + s*L1 + 1/(s*C)^2 - exp(-T*s)*sqrt(x)")) == {"R", "s", "L1", "C", "T", "x"}
    assert symbols(parse("2 nH")) == set()
