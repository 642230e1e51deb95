"""Kinds of questions about a function, and the statuses of their answers."""

from enum import StrEnum
from typing import Any, NoReturn

from passivity.errors import ExpressionError
from tline.presentation import Presentation


class Kind(StrEnum):
    """Which property is asked for."""

    PR = "positive real"  # Z analytic and Re Z >= 0 in Re s > 0: an impedance
    BR = "bounded real"  # H analytic and |H| <= 1 in Re s > 0: a reflection

    @property
    def letter(self) -> str:
        """Usual letter of such a function."""
        return "Z" if self is Kind.PR else "H"


class Status(StrEnum):
    """Status of an answer."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    NO_VIOLATION = "no violation seen"  # in samples, which never prove

    def __bool__(self) -> NoReturn:
        raise TypeError("a status is neither true nor false, expected a comparison such as `is Status.PROVED`")


class Decided(Presentation):
    """Answer with one of three statuses, and therefore without a truth value."""

    status: Status

    @property
    def proved(self) -> bool:
        """Whether the property is proved."""
        return self.status is Status.PROVED

    @property
    def refuted(self) -> bool:
        """Whether the property is refuted."""
        return self.status is Status.REFUTED

    def text_lines(self) -> list[str]:
        """The answer in words, as the command line prints it."""
        why = getattr(self, "why", "")
        return [self.status.value, f"  because {why}"] if why else [self.status.value]

    def to_dict(self) -> dict[str, Any]:
        """Status and its reason as values for JSON."""
        return {"status": self.status.value, "why": getattr(self, "why", "")}

    def plot(self, ax: Any = None) -> Any:
        """Impedance plane, Smith chart and reflection, or samples against their bound; on `ax` one of these alone."""
        if self.picture:
            return super().plot(ax)
        raise ExpressionError("plot", "there is no picture of this", "a function without names, or samples")

    def __bool__(self) -> NoReturn:
        raise TypeError("a verdict is neither true nor false, expected its .proved, .refuted or .status")
