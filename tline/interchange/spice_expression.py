"""Expressions of SPICE netlists: numbers with suffixes, parameters, operators and functions, parsed and computed."""

import math
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

NUMBER = r"(\d+\.?\d*|\.\d+)(?:e([+-]?\d{1,4}))?([a-zµμ]*)"  # what follows a suffix is a unit, and ignored
TOKEN = re.compile(rf"\s*(?:(?P<number>{NUMBER})|(?P<name>[a-z_]\w*)|(?P<mark>\*\*|[-+*/^(),]))", re.IGNORECASE)
POWERS = {"t": 12, "g": 9, "meg": 6, "k": 3, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12, "f": -15, "a": -18}
MIL = 25.4e-6  # m
DEEPEST = 50  # brackets and signs in each other
FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {  # and how many arguments they take
    "sqrt": (1, math.sqrt), "exp": (1, math.exp), "ln": (1, math.log), "log": (1, math.log), "log10": (1, math.log10),
    "abs": (1, abs), "sin": (1, math.sin), "cos": (1, math.cos), "tan": (1, math.tan), "atan": (1, math.atan),
    "sinh": (1, math.sinh), "cosh": (1, math.cosh), "tanh": (1, math.tanh), "int": (1, math.trunc),
    "min": (2, min), "max": (2, max), "pow": (2, math.pow), "pwr": (2, lambda x, y: math.pow(abs(x), y)),
}  # fmt: skip
CONSTANTS = {"pi": math.pi, "e": math.e}


def number(text: str) -> float | None:
    """Value of a number with its suffix, None if it is none.

    Examples
    --------
    >>> number("1.1n"), number("3MEGohm"), number("10pF"), number("5 ns")
    (1.1e-09, 3000000.0, 1e-11, None)
    """
    found = re.fullmatch(rf"([+-]?){NUMBER}", text, re.IGNORECASE)
    if found is None:
        return None
    sign, mantissa, exponent, letters = found.groups()
    letters = letters.lower()
    if letters.startswith("mil"):
        return float(f"{sign}{mantissa}e{exponent or 0}") * MIL
    power = POWERS["meg"] if letters.startswith("meg") else POWERS.get(letters[:1], 0)
    return float(f"{sign}{mantissa}e{int(exponent or 0) + power}")


class Token(NamedTuple):
    """A number, a name or a mark, and its text in lower case."""

    kind: str
    text: str


def expression(text: str, parameters: Mapping[str, float]) -> float:
    """Value of an expression.

    Parameters
    ----------
    text : str
        Numbers, names, + - * / and powers (^ or **), brackets and functions.
    parameters : mapping
        Values by name in lower case.

    Raises
    ------
    ValueError
        Saying what is wrong with it; OverflowError and ZeroDivisionError where it has no value.

    Examples
    --------
    >>> expression("2*Z0 + sqrt(4)*1k", {"z0": 50.0})
    2100.0
    """
    parser = _Parser(_tokens(text), parameters)
    value = parser.sum(0)
    if parser.rest:
        raise ValueError(f"nothing is expected before '{parser.rest[0].text:.20}'")
    return value


def _tokens(text: str) -> list[Token]:
    found, at = [], 0
    text = text.rstrip()
    while at < len(text):
        token = TOKEN.match(text, at)
        if token is None:
            raise ValueError(f"'{text[at:].strip():.20}' is not known")
        found.append(Token(token.lastgroup or "", token[token.lastgroup or 0].lower()))
        at = token.end()
    return found


class _Parser:
    """Recursive descent over the tokens that are left."""

    def __init__(self, tokens: list[Token], parameters: Mapping[str, float]):
        self.rest, self.parameters = tokens, parameters

    def _take(self, *marks: str) -> str:
        """The next token if it is one of these marks."""
        if self.rest and self.rest[0].kind == "mark" and self.rest[0].text in marks:
            return self.rest.pop(0).text
        return ""

    def _need(self, mark: str) -> None:
        if not self._take(mark):
            raise ValueError(f"'{mark}' is missing")

    def sum(self, depth: int) -> float:
        value = self._product(depth)
        while sign := self._take("+", "-"):
            other = self._product(depth)
            value = value + other if sign == "+" else value - other
        return value

    def _product(self, depth: int) -> float:
        value = self._signed(depth)
        while sign := self._take("*", "/"):
            other = self._signed(depth)
            value = value * other if sign == "*" else value / other
        return value

    def _signed(self, depth: int) -> float:
        if depth > DEEPEST:
            raise ValueError("it is nested too deeply")
        if sign := self._take("+", "-"):
            value = self._signed(depth + 1)
            return -value if sign == "-" else value
        value = self._atom(depth)
        if self._take("^", "**"):
            return math.pow(value, self._signed(depth + 1))
        return value

    def _atom(self, depth: int) -> float:
        if not self.rest:
            raise ValueError("it ends too early")
        kind, text = self.rest.pop(0)
        if kind == "number":
            value = number(text)
            return math.nan if value is None else value
        if text == "(":
            value = self.sum(depth + 1)
            self._need(")")
            return value
        if kind == "mark":
            raise ValueError(f"a value is expected before '{text}'")
        if self._take("("):
            return self._function(text, depth)
        value = self.parameters.get(text, CONSTANTS.get(text))
        if value is None:
            raise ValueError(f"no such parameter as '{text:.40}'")
        return value

    def _function(self, name: str, depth: int) -> float:
        if name not in FUNCTIONS:
            raise ValueError(f"no such function as '{name:.40}'")
        count, function = FUNCTIONS[name]
        arguments = [self.sum(depth + 1)]
        while self._take(","):
            arguments.append(self.sum(depth + 1))
        self._need(")")
        if len(arguments) != count:
            raise ValueError(f"'{name}' takes {count} value{'s' * (count > 1)}")
        return float(function(*arguments))
