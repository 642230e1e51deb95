"""The doors by which input comes in, each with what makes a case from a seed."""

from collections.abc import Callable
from functools import partial
from random import Random

from benchmarks.fuzz import flags, networks, scenes, tables, verdicts
from benchmarks.fuzz.case import Case

DOORS: dict[str, tuple[Callable[[Random], Case], int]] = {  # and how many of a thousand cases
    "scenes": (scenes.case, 120),
    "expressions": (verdicts.scalar, 200),
    "matrices": (verdicts.matrix, 25),
    "csv": (tables.csv, 130),
    "touchstone": (tables.touchstone, 40),
    "spice": (networks.spice, 220),
    "epanet": (networks.epanet, 50),
    "flags": (flags.case, 30),
    "line": (partial(flags.case, first="line"), 150),
    "friction": (partial(flags.case, first="friction"), 15),
    "drives": (partial(flags.case, first="drives"), 20),
}


def case_of(seed: int, door: str, index: int) -> Case:
    """The same case for the same seed, door and index, whatever ran before."""
    return DOORS[door][0](Random(f"{seed}/{door}/{index}"))
