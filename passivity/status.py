"""What can be asked of a function, and how the question can end."""

from enum import StrEnum


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
