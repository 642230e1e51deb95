"""What can be asked of a function, and how the question can end."""

from enum import StrEnum
from typing import NoReturn


class Kind(StrEnum):
    """Which property is asked for."""

    PR = "positive real"  # Z analytic and Re Z >= 0 in Re s > 0: an impedance
    BR = "bounded real"  # H analytic and |H| <= 1 in Re s > 0: a reflection


class Status(StrEnum):
    """How the question ended."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    NO_VIOLATION = "no violation seen"  # in samples, which never prove

    def __bool__(self) -> NoReturn:
        raise TypeError("a status is neither true nor false, expected a comparison such as `is Status.PROVED`")


class Decided:
    """An answer with a status, of which there are more than two: so it is neither true nor false."""

    status: Status

    @property
    def proved(self) -> bool:
        """Whether the property is proved."""
        return self.status is Status.PROVED

    @property
    def refuted(self) -> bool:
        """Whether the property is refuted."""
        return self.status is Status.REFUTED

    def __bool__(self) -> NoReturn:
        raise TypeError("a verdict is neither true nor false, expected its .proved, .refuted or .status")
