"""How much work a question may take, in units of about a nanosecond that do not depend on the machine or its load.

What may take long says so before it does: `spend`. Within `budget` the sum is limited, and what passes it is undecided.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeVar

T = TypeVar("T")
VERDICT = 1_500_000_000
ASIDE = 500_000_000  # for what is said beside the verdict


class UndecidedError(ArithmeticError):
    """The budget ran out; the message says on what."""


@dataclass
class _Account:
    left: int


_account: ContextVar[_Account | None] = ContextVar("account", default=None)


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
    """What a function says of what is given, None if the budget runs out.

    Examples
    --------
    >>> if_affordable(100, abs, -3), if_affordable(100, spend, 200, "this")
    (3, None)
    """
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
