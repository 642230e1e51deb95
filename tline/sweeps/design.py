"""Which runs a sweep consists of: the values of every path in every run."""

from collections.abc import Mapping
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import parts_of
from tline.scene.quantity import Whole
from tline.solver.description.given import Scene
from tline.sweeps.values import Distribution, values_or_distribution
from tline.words.wording import listed, place, shown

Floats = NDArray[np.float64]
MOST_RUNS = 10_000_000
LARGEST_SEED = 2**63 - 1
DRAWN = ("random", "latin", "sobol")
PLAIN = ("grid", "list")


class Design(NamedTuple):
    """Values by path and run."""

    levels: Mapping[str, list[Any] | Floats]  # the values that a path takes, by path
    taken: Mapping[str, NDArray | None]  # (runs,) which of them it takes in each run; None where each run has its own
    shape: tuple[int, ...]  # of a grid, the number of values along each path; else (runs,)
    sample: str  # how runs were chosen, such as ``"grid"`` or ``"sobol:128"``

    @property
    def runs(self) -> int:
        """How many."""
        return prod(self.shape)

    def rows(self, rows: NDArray) -> list[dict[str, Any]]:
        """Values by path, of some runs."""
        columns = []
        for path, levels in self.levels.items():
            taken = self.taken[path]
            picked = rows if taken is None else taken[rows]
            columns.append(levels[picked].tolist() if isinstance(levels, np.ndarray) else [levels[k] for k in picked])
        return [dict(zip(self.levels, values, strict=True)) for values in zip(*columns, strict=True)]

    def column(self, path: str) -> NDArray:
        """Values of a path in all runs: floats, or texts where they are not all numbers; shape (runs,)."""
        levels, taken = self.levels[path], self.taken[path]
        try:
            values = np.array(levels, float)
        except (TypeError, ValueError):
            values = np.array([str(level) for level in levels])
        return values if taken is None else values[taken]


def design(scene: Scene, vary: Mapping[str, Any], sample: str | None, seed: int | str) -> Design:
    """Choose the runs of a sweep; arguments are those of `tline.sweeps.sweep`."""
    if not vary:
        raise InputError("vary", "nothing varies", 'such as {"lines.cable.z0": [40, 50, 60]}')
    given: dict[str, list[Any] | Distribution] = {}
    for path, values in vary.items():
        name = place(*parts_of(path))
        if name in given:
            raise InputError(path, "varies twice", "each path once")
        given[name] = values_or_distribution(scene, name, values)
    distributions = [path for path, values in given.items() if isinstance(values, Distribution)]
    if sample is None and distributions:
        expected = "such as 'random:1000', 'latin:100' or 'sobol:128'"
        raise InputError("sample", f"{distributions[0]} has a distribution, and no count of runs", expected)
    kind, _, count = (sample or "grid").partition(":")
    if kind not in (*PLAIN, *DRAWN):
        raise InputError("sample", "unknown", listed([*PLAIN, *(f"{each}:COUNT" for each in DRAWN)]), shown(sample))
    if kind in PLAIN:
        if count or distributions:
            where, problem = ("sample", f"a {kind} has no count") if count else (distributions[0], "a distribution")
            raise InputError(where, problem, f"values for a {kind}, or a sample such as 'random:1000'")
        return _crossed(given) if kind == "grid" else _side_by_side(given)
    number = whole("sample", count, 1, MOST_RUNS)
    shares = _shares(kind, number, len(given), whole("seed", seed, 0, LARGEST_SEED))
    drawn = [_draw(path, values, share) for (path, values), share in zip(given.items(), shares.T, strict=True)]
    levels, taken = (dict(zip(given, each, strict=True)) for each in zip(*drawn, strict=True))
    return Design(levels, taken, (number,), f"{kind}:{number}")


def _crossed(given: Mapping[str, Any]) -> Design:
    """Every value of a path with every value of the others; the last path's change fastest."""
    shape = tuple(len(values) for values in given.values())
    if prod(shape) > MOST_RUNS:
        raise InputError("vary", "too many runs", f"at most {MOST_RUNS:,}", f"{prod(shape):,}")
    taken = np.unravel_index(np.arange(prod(shape)), shape)
    return Design(given, dict(zip(given, taken, strict=True)), shape, "grid")


def _side_by_side(given: Mapping[str, Any]) -> Design:
    lengths = {len(values) for values in given.values()}
    if len(lengths) > 1:
        got = ", ".join(f"{len(values)} of {path}" for path, values in given.items())
        raise InputError("vary", "not as many values of each", "lists of one length", got)
    return Design(given, dict.fromkeys(given), tuple(lengths), "list")


def _shares(kind: str, count: int, paths: int, seed: int) -> Floats:
    """Points of the unit cube, shape (count, paths)."""
    if kind == "random":
        return np.random.default_rng(seed).random((count, paths))
    from scipy.stats import qmc

    if kind == "latin":
        return qmc.LatinHypercube(paths, rng=seed).random(count)
    if count & (count - 1):
        raise InputError("sample", "Sobol points are balanced by powers of two", "such as sobol:128", f"{count}")
    return qmc.Sobol(paths, rng=seed).random(count)


def _draw(path: str, values: list[Any] | Distribution, share: Floats) -> tuple[Any, NDArray | None]:
    """Levels and which of them is taken: of a list all with equal probability."""
    if not isinstance(values, Distribution):
        return values, np.minimum((share * len(values)).astype(int), len(values) - 1)
    drawn = np.asarray(values.quantiles(np.clip(share, 1e-16, 1 - 1e-16)), float)
    if drawn.shape != share.shape:
        raise InputError(path, "its quantiles are of another shape", f"{share.shape}", f"{drawn.shape}")
    return drawn, None


def whole(where: str, typed: Any, least: int, most: int) -> int:
    """An argument as a whole number within limits."""
    try:
        return Whole(least, most).read(typed)
    except InputError as error:
        raise InputError(where, error.problem, error.expected, error.got) from None
