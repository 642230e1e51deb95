"""How much work a question may take, in units of about a nanosecond that do not depend on the machine or its load.

What may take long says so before it does: `spend`. Within `budget` the sum is limited, and what passes it is undecided.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeVar

from passivity.errors import ExpressionError, shown

T = TypeVar("T")
VERDICT = 1_500_000_000
ASIDE = 500_000_000  # for what is said beside the verdict


class UndecidedError(ArithmeticError):
    """The budget ran out; the message says on what."""


@dataclass
class _Account:
    left: int


_account: ContextVar[_Account | None] = ContextVar("account", default=None)


_times: ContextVar[float] = ContextVar("times", default=1)


@contextmanager
def granted(times: float) -> Iterator[None]:
    """Make every budget within so many times as large.

    Raises
    ------
    ExpressionError
        For what is not a positive number.

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
    """Limit the work within, which also counts against a budget around it.

    Examples
    --------
    >>> with budget(100):
    ...     spend(101, "this")
    Traceback (most recent call last):
    ...
    passivity.budget.UndecidedError: this takes too long
    """
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
    """What a function says of what is given, None if the budget runs out."""
    try:
        with budget(units):
            return ask(*given)
    except UndecidedError:
        return None


def spend(units: int, what: str) -> None:
    """Count work that is about to be done.

    Raises
    ------
    UndecidedError
        If that is more than is left; nothing is limited outside of `budget`.
    """
    account = _account.get()
    if account is not None:
        account.left -= units
        if account.left < 0:
            raise UndecidedError(f"{what} takes too long")
