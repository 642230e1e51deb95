"""Parameters and functions that SPICE netlists define, and the functions of all dialects."""

import math
import re
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

ANY = 1000  # values at most, of functions that take as many as they are given


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


PARAMETERS = (".param", ".params", ".parameter", ".global_param", ".csparam")
FUNCTION = ".func"
NAME = r"[a-z_]\w*"
START = re.compile(rf"({NAME})\s*(\([^(){{}}'\"]*\))?\s*=(?!=)", re.IGNORECASE)
HELD = re.compile(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"")
DEFINITION = re.compile(rf"\.\w+\s+({NAME})\s*\(([^()]*)\)\s*=?\s*(.+)", re.IGNORECASE)


def assignments(text: str) -> list[str]:
    """Words of a card of parameters: name, '=' and value again and again; what is bare gets braces.

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
