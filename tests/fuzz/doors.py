"""The doors by which input comes in, each with what makes a case from a seed."""

from collections.abc import Callable
from functools import partial
from random import Random

from fuzz import flags, networks, scenes, tables, verdicts
from fuzz.case import Case

DOORS: dict[
    str, tuple[Callable[[Random], Case], int]
] = {  # and how many of a thousand cases: the more, the shorter they take
    "scenes": (scenes.case, 30),
    "expressions": (verdicts.scalar, 250),
    "matrices": (verdicts.matrix, 15),
    "csv": (tables.csv, 150),
    "touchstone": (tables.touchstone, 20),
    "spice": (networks.spice, 280),
    "epanet": (networks.epanet, 30),
    "flags": (flags.case, 8),
    "line": (partial(flags.case, first="line"), 210),
    "friction": (partial(flags.case, first="friction"), 2),
    "drives": (partial(flags.case, first="drives"), 5),
}


def case_of(seed: int, door: str, index: int) -> Case:
    """The same case for the same seed, door and index, whatever ran before."""
    return DOORS[door][0](Random(f"{seed}/{door}/{index}"))
