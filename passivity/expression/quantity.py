"""Numbers with an SI prefix or a unit behind them, exactly: ``4.7k``, ``10 nH``."""

from fractions import Fraction

from passivity.errors import ExpressionError, shorten
from passivity.expression.tokens import Token

MAX_DIGITS = 4_000
MAX_DECIMAL_EXPONENT = 400  # 1e-400

_PREFIXES = dict(zip("fpnu\u00b5\u03bcmkMG", (-15, -12, -9, -6, -6, -6, -3, 3, 6, 9), strict=True))
_UNITS = ("ohm", "\u03a9", "\u2126", "H", "F", "S", "Hz", "V", "A", "Pa")
# The words that may follow a number, with their power of ten. No prefix T and no Ms: 2T and 2Ts mean a delay
# that lost its "*". A bare f, s or m is missing for the same reason; see `unit` for the bare prefixes.
_WORDS = dict.fromkeys(_UNITS, 0) | {"km": 3}
_WORDS |= {prefix + unit: power for unit in _UNITS for prefix, power in _PREFIXES.items()}
_WORDS |= {prefix + unit: power for unit in "sm" for prefix, power in _PREFIXES.items() if power < 0}


def decimal(number: Token) -> Fraction:
    """Exact value of a number as written, refused where it would fill the memory."""
    where = f"column {number.column}"
    mantissa, _, exponent = number.text.lower().partition("e")
    if len(mantissa) > MAX_DIGITS:
        raise ExpressionError(where, "too many digits", f"at most {MAX_DIGITS}", f"{len(mantissa)}")
    if len(exponent) > 9 or abs(int(exponent or 0)) > MAX_DECIMAL_EXPONENT:
        expected = f"at most e{MAX_DECIMAL_EXPONENT} and at least e-{MAX_DECIMAL_EXPONENT}"
        got = shorten(f"e{exponent}")
        raise ExpressionError(where, "the decimal exponent is out of range", expected, got)
    return Fraction(number.text)


def unit(number: Token, word: Token) -> Fraction:
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
