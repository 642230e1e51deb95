"""Impedance expressions such as ``R + s*L + 1/(s*C)``: text to a tree; nothing is run or guessed."""

import re
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from passivity.errors import ExpressionError, shorten
from passivity.expression.tree import Add, Call, Divide, Line, Multiply, Negate, Node, Number, Power, Symbol, symbols

MAX_CHARACTERS = 10_000
MAX_DEPTH = 100  # nested parentheses, signs and powers
MAX_EXPONENT = 200  # of a power: s^200
MAX_DIGITS = 4_000
MAX_DECIMAL_EXPONENT = 400  # 1e-400

_PREFIXES = dict(zip("fpnu\u00b5\u03bcmkMG", (-15, -12, -9, -6, -6, -6, -3, 3, 6, 9), strict=True))
_UNITS = ("ohm", "\u03a9", "\u2126", "H", "F", "S", "Hz", "V", "A", "Pa")
# The words that may follow a number, with their power of ten. No prefix T and no Ms: 2T and 2Ts mean a delay
# that lost its "*". A bare f, s or m is missing for the same reason; see `_unit` for the bare prefixes.
_WORDS = dict.fromkeys(_UNITS, 0) | {"km": 3}
_WORDS |= {prefix + unit: power for unit in _UNITS for prefix, power in _PREFIXES.items()}
_WORDS |= {prefix + unit: power for unit in "sm" for prefix, power in _PREFIXES.items() if power < 0}
_LETTERS = r"A-Za-z_\u00b5\u03bc\u03a9\u2126"  # micro, mu, omega and ohm sign count as letters
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"|(?P<name>[{_LETTERS}][{_LETTERS}0-9]*)|(?P<operator>\*\*|[-+*/^(),])|(?P<end>\Z)|(?P<other>.))",
    re.DOTALL,
)
FUNCTIONS = ("exp", "log", "sqrt", "sinh", "cosh", "tanh", "coth", "sech", "csch")


class Token(NamedTuple):
    """One token of the text; `column` counts from 1, `spaced`: white space before it."""

    kind: str  # number, name, operator, end
    text: str
    column: int
    spaced: bool


def _tokens(text: str) -> Iterator[Token]:
    """All tokens of a text, the end of the text being the last."""
    for found in _TOKEN.finditer(text):
        kind = str(found.lastgroup)
        start = found.start(kind)
        if kind == "other":
            raise ExpressionError(
                f"column {start + 1}",
                "this character has no meaning here",
                "a number, a name, an operator or a parenthesis",
                f"{text[start]!a} (U+{ord(text[start]):04X})",
            )
        yield Token(kind, found[kind], start + 1, start > found.start())


def parse(text: str, lines: bool = False) -> Node:
    """Tree of an impedance expression in the Laplace variable ``s``.

    Parameters
    ----------
    text : str
        At most MAX_CHARACTERS: numbers, names, ``+ - * / ^ **``, parentheses, and one of FUNCTIONS before one;
        ``log`` is the natural logarithm.
        Decimals are exact. A number may end in an SI prefix (``4.7k``) or carry a unit (``10 nH``,
        ``50 ohm``), which scales it to SI and is then forgotten; `s` is always the Laplace variable.
    lines : bool
        Whether ``line(z0, gamma, load)``, the input impedance of a line, is known.

    Returns
    -------
    Node
        Sums and products are flat, so the depth of the tree is bounded by MAX_DEPTH, not by the length.

    Raises
    ------
    ExpressionError
        For anything else, with the column (from 1) and the token expected there.

    Examples
    --------
    >>> parse("-s^2")
    Negate(operand=Power(base=Symbol(name='s'), exponent=2))
    >>> parse("10 nH").value
    Fraction(1, 100000000)
    """
    if not isinstance(text, str):
        raise ExpressionError("", "the expression is not text", "a string", type(text).__name__)
    if len(text) > MAX_CHARACTERS:
        expected = f"at most {MAX_CHARACTERS} characters"
        raise ExpressionError("", "the expression is too long", expected, f"{len(text)}")
    parser = _Parser(text, lines)
    node = parser.sum(0)
    parser.fail_unless(parser.token.kind == "end", "an operator such as *")
    names = symbols(node) if parser.units else ()
    for word in parser.units:
        if word.text in names:
            problem = f"{word.text} is a unit or prefix here and a name elsewhere"
            raise ExpressionError(f"column {word.column}", problem, "another name, or a *")
    return node


class _Parser:
    """Recursive descent: sum, product, operand (sign and power), atom; one method each."""

    def __init__(self, text: str, lines: bool):
        self.tokens, self.lines = iter(list(_tokens(text))), lines
        self.units: list[Token] = []
        self.token = next(self.tokens)

    def take(self) -> Token:
        taken, self.token = self.token, next(self.tokens, self.token)
        return taken

    def fail_unless(self, condition: bool, expected: str) -> None:
        if not condition:
            problem, got = "this does not fit here", repr(shorten(self.token.text))
            if self.token.kind == "end":
                problem, got = "the expression ends too early", "nothing"
            raise ExpressionError(f"column {self.token.column}", problem, expected, got)

    def sum(self, depth: int) -> Node:
        terms = [self.product(depth)]
        while self.token.text in ("+", "-"):
            sign = self.take().text
            term = self.product(depth)
            terms.append(Negate(term) if sign == "-" else term)
        return terms[0] if len(terms) == 1 else Add(tuple(terms))

    def product(self, depth: int) -> Node:
        above, below = [self.operand(depth)], []
        while self.token.text in ("*", "/"):
            (above if self.take().text == "*" else below).append(self.operand(depth))
        numerator = above[0] if len(above) == 1 else Multiply(tuple(above))
        if not below:
            return numerator
        return Divide(numerator, below[0] if len(below) == 1 else Multiply(tuple(below)))

    def operand(self, depth: int) -> Node:
        if depth > MAX_DEPTH:
            where, expected = f"column {self.token.column}", f"at most {MAX_DEPTH} levels"
            raise ExpressionError(where, "nested too deeply", expected)
        if self.token.text in ("+", "-"):
            sign = self.take().text
            operand = self.operand(depth + 1)
            return Negate(operand) if sign == "-" else operand
        base = self.atom(depth)
        if self.token.text not in ("^", "**"):
            return base
        column = self.take().column
        return Power(base, _whole(self.operand(depth + 1), column))

    def atom(self, depth: int) -> Node:
        token = self.token
        if token.kind == "number":
            return self.number()
        if token.kind == "name":
            self.take()
            if self.token.text != "(":
                self.fail_unless(self.token.kind not in ("name", "number"), "an operator such as *")
                return Symbol(token.text)
            if token.text == "line" and self.lines:
                return self.line(depth)
            if token.text not in FUNCTIONS:
                name = shorten(token.text)
                expected = f"{', '.join(FUNCTIONS)}, or {name}*(...) for a product"
                raise ExpressionError(f"column {token.column}", "unknown function", expected, f"{name}(...)")
        self.fail_unless(self.token.text == "(", "a number, a name or '('")
        self.take()
        inside = self.sum(depth + 1)
        self.fail_unless(self.token.text == ")", "an operator such as * or ')'")
        self.take()
        return Call(token.text, inside) if token.kind == "name" else inside

    def line(self, depth: int) -> Line:
        parts, expected = [], "'(', as in line(z0, T*s, load)"
        for after in ("',' and the propagation along the line, such as T*s", "',' and the load", "an operator or ')'"):
            self.fail_unless(self.token.text == ("," if parts else "("), expected)
            self.take()
            parts.append(self.sum(depth + 1))
            expected = after
        self.fail_unless(self.token.text == ")", expected)
        self.take()
        return Line(*parts)

    def number(self) -> Number:
        token = self.take()
        value = _decimal(token)
        if self.token.kind != "name":
            return Number(value, token.text)
        word = self.take()
        self.units.append(word)
        return Number(value * _unit(token, word), token.text + " " * word.spaced + word.text)


def _whole(exponent: Node, column: int) -> int:
    sign, number = (-1, exponent.operand) if isinstance(exponent, Negate) else (1, exponent)
    if isinstance(number, Number) and number.value.denominator == 1 and number.value <= MAX_EXPONENT:
        return sign * int(number.value)
    raise ExpressionError(
        f"column {column}",
        "this power is not known",
        f"a whole number from -{MAX_EXPONENT} to {MAX_EXPONENT} as exponent, or sqrt(...) for 1/2",
        shorten(number.text) if isinstance(number, Number) else "an expression",
    )


def _decimal(number: Token) -> Fraction:
    """Exact value of a number as written, refused where it would fill the memory."""
    if number.text.isdecimal() and len(number.text) <= MAX_DIGITS:
        return Fraction(int(number.text))
    where = f"column {number.column}"
    mantissa, _, exponent = number.text.lower().partition("e")
    if len(mantissa) > MAX_DIGITS:
        raise ExpressionError(where, "too many digits", f"at most {MAX_DIGITS}", f"{len(mantissa)}")
    if len(exponent) > 9 or abs(int(exponent or 0)) > MAX_DECIMAL_EXPONENT:
        expected = f"at most e{MAX_DECIMAL_EXPONENT} and at least e-{MAX_DECIMAL_EXPONENT}"
        got = shorten(f"e{exponent}")
        raise ExpressionError(where, "the decimal exponent is out of range", expected, got)
    return Fraction(number.text)


def _unit(number: Token, word: Token) -> Fraction:
    """Factor of the word behind a number: a prefix (without a space, and not f), a unit, or both."""
    prefix = word.text in _PREFIXES and word.text != "f"
    if prefix and not word.spaced:
        return Fraction(10) ** _PREFIXES[word.text]
    if word.text in _WORDS:
        return Fraction(10) ** _WORDS[word.text]
    digits, name = shorten(number.text), shorten(word.text)
    other = f"{digits}{name} for a prefix" if prefix else "a unit such as nH"
    problem = "a number and a name without an operator"
    got = repr(digits + " " * word.spaced + name)
    raise ExpressionError(f"column {word.column}", problem, f"{digits}*{name}, or {other}", got)
