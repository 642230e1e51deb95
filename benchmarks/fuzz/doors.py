"""The doors by which input comes in, each with what makes a case from a seed."""

from collections.abc import Callable
from functools import partial
from random import Random

from benchmarks.fuzz import flags, networks, scenes, tables, verdicts
from benchmarks.fuzz.case import Case

DOORS: dict[str, tuple[Callable[[Random], Case], int]] = {  # and how many of a hundred cases
    "scenes": (scenes.case, 20),
    "expressions": (verdicts.scalar, 15),
    "matrices": (verdicts.matrix, 5),
    "csv": (tables.csv, 10),
    "touchstone": (tables.touchstone, 5),
    "spice": (networks.spice, 15),
    "epanet": (networks.epanet, 5),
    "flags": (flags.case, 5),
    "line": (partial(flags.case, first="line"), 10),
    "friction": (partial(flags.case, first="friction"), 5),
    "drives": (partial(flags.case, first="drives"), 5),
}


def case_of(seed: int, door: str, index: int) -> Case:
    """The same case for the same seed, door and index, whatever ran before."""
    return DOORS[door][0](Random(f"{seed}/{door}/{index}"))
