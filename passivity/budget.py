"""How much work a question may take, how long its numbers and polynomials may grow, and the only powers.

Work is counted in units of about a nanosecond that do not depend on the machine or its load.
Long work is counted before it is done, by `spend`. Within `budget` the sum is limited, a question beyond it undecided.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from passivity.errors import ExpressionError, shown

T = TypeVar("T")
VERDICT = 1_500_000_000
ASIDE = 500_000_000  # for findings beside the verdict
MAX_DEGREE = 400
MAX_BITS = 100_000  # of a number or a coefficient
MAX_TOTAL = 4_000_000  # bits of all coefficients together


class UndecidedError(ArithmeticError):
    """The budget ran out; the message names the work."""


@dataclass
class _Account:
    left: int


_account: ContextVar[_Account | None] = ContextVar("account", default=None)
_times: ContextVar[float] = ContextVar("times", default=1)


@contextmanager
def granted(times: float) -> Iterator[None]:
    """Multiply every budget within by a factor.

    Examples
    --------
    >>> with granted(10), budget(100):
    ...     spend(101, "this")
    """
    if isinstance(times, bool) or not isinstance(times, int | float) or not 0 < times < math.inf:
        raise ExpressionError("budget", "not a multiple", "a number above 0, 1 for the usual work", shown(times, repr))
    token = _times.set(times)
    try:
        yield
    finally:
        _times.reset(token)


@contextmanager
def budget(units: int) -> Iterator[None]:
    """Limit the work within, which also counts against a budget around it."""
    around = _account.get()
    units = round(units * _times.get())
    given = units if around is None else max(min(units, around.left), 0)
    own = _Account(given)
    token = _account.set(own)
    try:
        yield
    finally:
        _account.reset(token)
        if around is not None:
            around.left -= given - own.left


def if_affordable(units: int, ask: Callable[..., T], *given: Any) -> T | None:
    """Call a function within a budget; None if it runs out."""
    try:
        with budget(units):
            return ask(*given)
    except UndecidedError:
        return None


def spend(units: int, what: str) -> None:
    """Count work that is about to be done; UndecidedError if it is more than is left of a `budget` around."""
    account = _account.get()
    if account is not None:
        account.left -= units
        if account.left < 0:
            raise UndecidedError(f"{what} takes too long")


def check_size(degree: int, bits: int, where: str = "") -> None:
    """Raise an error for too high a degree in s, or too long numbers."""
    if degree > MAX_DEGREE:
        raise ExpressionError(where, "the degree in s is too high", f"at most {MAX_DEGREE}", f"{_count(degree)}")
    if bits > MAX_BITS:
        raise ExpressionError(where, "the numbers are too long", f"at most {MAX_BITS} bits", f"{_count(bits)}")
    if (degree + 1) * bits > MAX_TOTAL:
        problem = f"degree {degree} is too high for numbers of {bits} bits"
        raise ExpressionError(where, problem, f"at most {MAX_TOTAL} bits in all")


def _count(number: int) -> str:
    return f"{number}" if number.bit_length() < 64 else f"over 2^{number.bit_length() - 1}"


def bits_of(x: Fraction | int) -> int:
    """Length of the longer of numerator and denominator."""
    return max(x.numerator.bit_length(), x.denominator.bit_length())


def powered(base: Any, exponent: int, degree: int, bits: int) -> Any:
    """A number or polynomial of this degree and length of numbers to a whole power, if that is not too large."""
    if bits > 1 or degree > 0:
        check_size(abs(exponent) * degree, abs(exponent) * bits)
    return base**exponent
