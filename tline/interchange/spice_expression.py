"""Expressions of SPICE netlists: numbers with suffixes, parameters, operators and functions, parsed and computed."""

import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from itertools import count, pairwise
from typing import Any, NamedTuple

from tline.errors import InputError

ANY = 1000  # values at most, of functions that take as many as they are given
PARAMETERS = (".param", ".params", ".parameter", ".global_param", ".csparam")
FUNCTION = ".func"
NAME = r"[a-z_]\w*"
START = re.compile(rf"({NAME})\s*(\([^(){{}}'\"]*\))?\s*=(?!=)", re.IGNORECASE)
HELD = re.compile(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"")
DEFINITION = re.compile(rf"\.\w+\s+({NAME})\s*\(([^()]*)\)\s*=?\s*(.+)", re.IGNORECASE)
NUMBER = r"(\d+\.?\d*|\.\d+)(?:e([+-]?\d{1,4}))?([a-zµμΩΩ]*)"  # what follows a suffix is a unit, and ignored
AS_POINT = r"(\d+)([tgkmunpfarµμ])(\d+)"  # 4k7
SIGNAL = r"[vi]\(\s*[^\s()=]+(?:\s*[,\s]\s*[^\s()=]+)?\s*\)"  # a voltage or a current
TOKEN = re.compile(
    rf"\s*(?:(?P<number>{AS_POINT}(?![\w.])|{NUMBER})|(?P<signal>{SIGNAL})|(?P<name>[a-z_]\w*)"
    r"|(?P<mark>\*\*|==|!=|<=|>=|&&|\|\||[-+*/^(),<>?:!]))",
    re.IGNORECASE,
)
POWERS = {
    "t": 12, "g": 9, "meg": 6, "x": 6, "k": 3, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12, "f": -15, "a": -18
}  # fmt: skip
MIL = 25.4e-6  # m
AMPERES = ("a", "amp", "amps")  # a unit; only in HSPICE "a" alone is 1e-18
LONGEST_EXPRESSION = 1000  # characters of an expression
DEEPEST, MOST_CALLS = 50, 10_000  # brackets and signs in each other; calls of functions that the netlist defines
CONSTANTS = {"pi": math.pi, "e": math.e, "true": 1.0, "false": 0.0}


class Defined(NamedTuple):
    """A function of a netlist: the names of its arguments, and its expression."""

    arguments: tuple[str, ...]
    text: str


class Function(NamedTuple):
    """A function that is known, and how many values it takes."""

    value: Callable[..., Any]
    least: int = 1
    most: int = 1


def _sign(x: float) -> float:
    return float((x > 0) - (x < 0))


def _decibel(x: float) -> float:
    return 20 * math.log10(abs(x))


def _limited(x: float, one: float, other: float) -> float:
    """The value between two bounds that is nearest to x."""
    return min(max(x, min(one, other)), max(one, other))


def _chosen(condition: float, first: float, second: float) -> float:
    return first if condition > 0.5 else second


def _table(x: float, *pairs: float) -> float:
    """Straight lines between points, constant outside."""
    points = [*zip(pairs[::2], pairs[1::2], strict=True)]
    if any(b[0] <= a[0] for a, b in pairwise(points)):
        raise ValueError("its points are not in order")
    for (x0, y0), (x1, y1) in pairwise(points):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * ((x - x0) / (x1 - x0))
    return points[0][1] if x < points[0][0] else points[-1][1]


_PLAIN = {
    name: Function(getattr(math, name))
    for name in (
        "sqrt", "exp", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh",
        "atanh", "floor", "ceil",
    )
}  # fmt: skip
FUNCTIONS: dict[str, Function] = _PLAIN | {
    "ln": Function(math.log), "log": Function(math.log), "arctan": Function(math.atan),
    "arcsin": Function(math.asin), "arccos": Function(math.acos), "abs": Function(abs), "sgn": Function(_sign),
    "int": Function(math.trunc), "nint": Function(round), "round": Function(round), "db": Function(_decibel),
    "square": Function(lambda x: x * x), "u": Function(lambda x: float(x > 0)), "stp": Function(lambda x: float(x > 0)),
    "uramp": Function(lambda x: max(x, 0.0)), "buf": Function(lambda x: float(x > 0.5)),
    "inv": Function(lambda x: float(x <= 0.5)), "sign": Function(lambda x, y: math.copysign(x, y), 2, 2),
    "min": Function(min, 2, ANY), "max": Function(max, 2, ANY), "pow": Function(math.pow, 2, 2),
    "pwr": Function(lambda x, y: math.pow(abs(x), y), 2, 2),
    "pwrs": Function(lambda x, y: math.copysign(math.pow(abs(x), y), x), 2, 2),
    "atan2": Function(math.atan2, 2, 2), "hypot": Function(math.hypot, 2, 2),
    "limit": Function(_limited, 3, 3), "if": Function(_chosen, 3, 3), "ternary_fcn": Function(_chosen, 3, 3),
    "table": Function(_table, 5, ANY),
}  # fmt: skip


def assignments(text: str) -> list[str]:
    """Words of a card of parameters: name, '=' and value repeatedly; bare expressions get braces.

    Examples
    --------
    >>> assignments(".param z=50 w = z*2 +1k, d='2*z' f(x)='x*2'")
    ['z', '=', '50', 'w', '=', '{z*2 +1k}', 'd', '=', "'2*z'", 'f(x)', '=', "'x*2'"]
    """
    hidden = HELD.sub(lambda found: "#" * len(found[0]), text)
    starts = list(START.finditer(hidden))
    ends = [*(start.start() for start in starts[1:]), len(text)][: len(starts)]
    words = text[: starts[0].start()].split()[1:] if starts else text.split()[1:]
    for start, end in zip(starts, ends, strict=True):
        value = text[start.end() : end].strip().rstrip(",").strip()
        bare = not HELD.fullmatch(value) and not re.fullmatch(r"[\w.+-]*", value)
        words += [start[1] + (start[2] or ""), "=", f"{{{value}}}" if bare else value]
    return [word for word in words if word]


def function(text: str) -> tuple[str, Defined] | None:
    """Name and definition of a function by its card, or by an assignment behind a word."""
    found = DEFINITION.fullmatch(text)
    if found is None:
        return None
    names = tuple(name.strip().lower() for name in found[2].split(",") if name.strip())
    return found[1].lower(), Defined(names, found[3].strip().strip("{}'\""))


BINARY: tuple[dict[str, Callable[[Any, Any], Any]], ...] = (  # from the loosest
    {"||": lambda x, y: float(bool(x) or bool(y))},
    {"&&": lambda x, y: float(bool(x) and bool(y))},
    {"==": operator.eq, "!=": operator.ne, "<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge},
    {"+": operator.add, "-": operator.sub},
    {"*": operator.mul, "/": operator.truediv},
)

Value = Any  # a number, or the meaning of a signal
Parameters = Mapping[str, float | Defined]  # names in lower case; functions as 'name()'
Signal = Callable[[str], Value]  # of its text


def number(text: str) -> float | None:
    """Value of a number with its suffix; None for other text.

    Examples
    --------
    >>> number("1.1n"), number("3MEGohm"), number("10pF"), number("4k7"), number("5 ns")
    (1.1e-09, 3000000.0, 1e-11, 4700.0, None)
    """
    if as_point := re.fullmatch(rf"([+-]?){AS_POINT}", text, re.IGNORECASE):
        sign, whole, letter, rest = as_point.groups()
        return float(f"{sign}{whole}.{rest}e{POWERS.get(letter.lower(), 0)}")
    found = re.fullmatch(rf"([+-]?){NUMBER}", text, re.IGNORECASE)
    if found is None:
        return None
    sign, mantissa, exponent, letters = found.groups()
    letters = letters.lower()
    if letters.startswith("mil"):
        return float(f"{sign}{mantissa}e{exponent or 0}") * MIL
    power = 6 if letters.startswith("meg") else 0 if letters in AMPERES else POWERS.get(letters[:1], 0)
    return float(f"{sign}{mantissa}e{int(exponent or 0) + power}")


class Token(NamedTuple):
    """A number, a signal, a name or a mark, and its text in lower case."""

    kind: str
    text: str


def expression(text: str, parameters: Parameters, signal: Signal | None = None) -> Value:
    """Value of an expression."""
    return _Parser(text, parameters, signal, count()).whole(0)


def _tokens(text: str, signals: bool) -> list[Token]:
    found, at = [], 0
    text = text.rstrip()
    while at < len(text):
        token = TOKEN.match(text, at)
        if token is None:
            raise ValueError(f"'{text[at:].strip():.20}' is not known")
        kind, own = token.lastgroup or "", token[token.lastgroup or 0]
        if kind == "signal" and not signals:
            own, kind = own.partition("(")[0], "name"
        found.append(Token(kind, own.lower()))
        at = token.start(token.lastgroup or 0) + len(own)
    return found


class _Parser:
    """Recursive descent over the tokens that are left."""

    def __init__(self, text: str, parameters: Parameters, signal: Signal | None, calls: Iterator[int]):
        self.rest, self.parameters = _tokens(text, signal is not None), parameters
        self.signal, self.calls = signal, calls

    def whole(self, depth: int) -> Value:
        value = self._choice(depth)
        if self.rest:
            raise ValueError(f"nothing is expected before '{self.rest[0].text:.20}'")
        return value

    def _take(self, *marks: str) -> str:
        """The next token if it is one of these marks."""
        if self.rest and self.rest[0].kind == "mark" and self.rest[0].text in marks:
            return self.rest.pop(0).text
        return ""

    def _need(self, mark: str) -> None:
        if not self._take(mark):
            raise ValueError(f"'{mark}' is missing")

    def _choice(self, depth: int) -> Value:
        """Evaluate a conditional: condition ? value : value."""
        value = self._binary(0, depth)
        if not self._take("?"):
            return value
        first = self._choice(depth + 1)
        self._need(":")
        second = self._choice(depth + 1)
        return first if value else second

    def _binary(self, level: int, depth: int) -> Value:
        if level == len(BINARY):
            return self._signed(depth)
        value = self._binary(level + 1, depth)
        while mark := self._take(*BINARY[level]):
            value = BINARY[level][mark](value, self._binary(level + 1, depth))
            value = float(value) if isinstance(value, bool) else value
        return value

    def _signed(self, depth: int) -> Value:
        if depth > DEEPEST:
            raise ValueError("it is nested too deeply")
        if sign := self._take("+", "-", "!"):
            value = self._signed(depth + 1)
            return value if sign == "+" else -value if sign == "-" else float(not value)
        value = self._atom(depth)
        if self._take("^", "**"):
            return math.pow(value, self._signed(depth + 1))
        return value

    def _atom(self, depth: int) -> Value:
        if not self.rest:
            raise ValueError("it ends too early")
        kind, text = self.rest.pop(0)
        if kind == "number":
            value = number(text)
            return math.nan if value is None else value
        if kind == "signal" and self.signal:
            return self.signal(text)
        if text == "(":
            value = self._choice(depth + 1)
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

    def _function(self, name: str, depth: int) -> Value:
        arguments = [self._choice(depth + 1)]
        while self._take(","):
            arguments.append(self._choice(depth + 1))
        self._need(")")
        defined = self.parameters.get(f"{name}()")
        if isinstance(defined, Defined):
            return self._defined(name, defined, arguments, depth)
        if name not in FUNCTIONS:
            raise ValueError(f"no such function as '{name:.40}'")
        function, least, most = FUNCTIONS[name]
        _check_count(name, arguments, least, most)
        return float(function(*arguments))

    def _defined(self, name: str, defined: Defined, arguments: list[Value], depth: int) -> Value:
        """Value of a function defined in the netlist; it may use the parameters there."""
        if next(self.calls) > MOST_CALLS:
            raise ValueError("its functions call each other too often")
        _check_count(name, arguments, len(defined.arguments), len(defined.arguments))
        inside = {**self.parameters, **dict(zip(defined.arguments, arguments, strict=True))}
        return _Parser(defined.text, inside, self.signal, self.calls).whole(depth + 1)


def _check_count(name: str, arguments: list[Value], least: int, most: int) -> None:
    if not least <= len(arguments) <= most:
        said = f"{least}" if least == most else f"{least} or more"
        raise ValueError(f"'{name:.40}' takes {said} value{'s' * (least > 1)}")


def parse_value(word: str, parameters: Parameters, where: str) -> float:
    """Value of a number, of a parameter, or of an expression of both in braces or quotes."""
    if word[:1] in ("{", "'", '"'):
        value = computed(word[1:-1], parameters, where)
    else:
        value = parameters.get(word.lower(), number(word))
    if not isinstance(value, float):
        raise InputError(where, "not a value", "a number as 4.7n, a parameter, or {an expression}", f"'{word:.40}'")
    if not math.isfinite(value):
        raise InputError(where, "out of range", "a finite number", f"'{word:.40}'")
    return value


def computed(text: str, parameters: Parameters, where: str, signal: Signal | None = None) -> Value:
    """Value of an expression."""
    if len(text) > LONGEST_EXPRESSION:
        raise InputError(where, "an expression that long", f"at most {LONGEST_EXPRESSION} characters", f"{len(text)}")
    try:
        return expression(text, parameters, signal)
    except TypeError:  # of a voltage or current in a function that takes numbers
        problem, got = "not a sum of voltages and currents with constant factors", f"'{text:.40}'"
        raise InputError(where, problem, got=got) from None
    except (ValueError, ArithmeticError) as error:
        raise InputError(where, f"not an expression that can be computed: {error}", got=f"'{text:.40}'") from None
