"""Runs of a sweep: values, ranges and distributions by path, and their combinations."""

import re
from collections.abc import Callable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import changed, parts_of
from tline.scene.quantity import Quantity, Whole
from tline.solver.description.given import Scene
from tline.units import DEGREES, to_si
from tline.words.wording import listed, place, shown

Floats = NDArray[np.float64]
CALL = re.compile(r"\s*(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)\s*")  # units may have parentheses of their own
DISTRIBUTIONS = {
    "uniform": "uniform(low, high)",
    "loguniform": "loguniform(low, high)",
    "normal": "normal(mean, deviation)",
}
EXPECTED = f"values, FROM:TO:COUNT, FROM:TO:COUNT:log, or {', '.join(DISTRIBUTIONS.values())}"
MOST_VALUES = 1_000_000  # of one path
MOST_RUNS = 10_000_000
LARGEST_SEED = 2**63 - 1
DRAWN = ("random", "latin", "sobol")
PLAIN = ("grid", "list")


class Distribution(NamedTuple):
    """Distribution by its quantiles at shares from 0 to 1, both of shape (runs,), and its text as given."""

    quantiles: Callable[[Floats], Floats]
    text: str


def values_or_distribution(scene: Scene, path: str, given: Any) -> list[Any] | Distribution:
    """Values of a path of a scene, in SI where they are numbers, or their distribution; arguments as in `sweep`.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "n"}},
    ...     lines={"a": {"nodes": ["n", "f"], "z0": 50, "delay": 1}},
    ... )
    >>> values_or_distribution(scene, "lines.a.z0", "40 ohm:0.06 kohm:3")
    [40.0, 50.0, 60.0]
    >>> values_or_distribution(scene, "lines.a.z0", "normal(50 ohm, 2 ohm)").quantiles(np.array([0.5])).tolist()
    [50.0]
    """
    if isinstance(given, str):
        if call := CALL.fullmatch(given):
            return _distribution(scene, path, call[1], [part.strip() for part in call[2].split(",")])
        if given.count(":") > 1:
            return _range(scene, path, given)
        given = [_number(part.strip()) for part in given.split(",")]
    if hasattr(given, "ppf"):
        return Distribution(given.ppf, repr(given))
    if not isinstance(given, Sequence | np.ndarray) or (isinstance(given, np.ndarray) and given.ndim != 1):
        raise InputError(path, "not a sequence of values", EXPECTED, shown(given))
    if not 1 <= len(given) <= MOST_VALUES:
        raise InputError(path, "no values, or too many", f"1 to {MOST_VALUES:,}", f"{len(given):,}")
    if isinstance(given, np.ndarray) and given.dtype.kind == "f":
        return given.tolist()
    return [_in_si(scene, path, value) for value in given]


def unit_of(scene: Scene, path: str) -> str:
    """SI unit of a scene's value at a path; empty if that is not a quantity, or nothing is given there."""
    leaf = _leaf(scene, path)
    return (leaf.unit or "") if isinstance(leaf, Quantity) else ""


def _range(scene: Scene, path: str, text: str) -> list[Any]:
    first, last, count, *log = (part.strip() for part in text.split(":"))
    if log not in ([], ["log"]):
        raise InputError(path, "not a range", "FROM:TO:COUNT or FROM:TO:COUNT:log", shown(text))
    try:
        number = Whole(2, MOST_VALUES).read(count)
    except InputError as error:
        raise InputError(path, f"the count of {shown(text)}: {error.problem}", error.expected, error.got) from None
    a, b = _limits(scene, path, [first, last])
    if log and a * b <= 0:
        raise InputError(path, "equal ratios through zero", "limits above zero", shown(text))
    return (np.geomspace if log else np.linspace)(a, b, number).tolist()


def _distribution(scene: Scene, path: str, kind: str, given: list[str]) -> Distribution:
    text = f"{kind}({', '.join(given)})"
    if kind not in DISTRIBUTIONS or len(given) != 2:
        raise InputError(path, "not a distribution", f"one of {', '.join(DISTRIBUTIONS.values())}", shown(text))
    if kind == "normal" and any(given[1].endswith(unit) for unit in DEGREES):
        raise InputError(path, "a deviation is no temperature", "K in place of degC", shown(given[1]))
    a, b = _limits(scene, path, given)
    if kind == "normal":
        if b < 0:
            raise InputError(path, "a negative deviation", DISTRIBUTIONS[kind], shown(text))
        return Distribution(_Normal(a, b), text)
    if a > b:
        raise InputError(path, "the lower limit is above the upper one", DISTRIBUTIONS[kind], shown(text))
    if kind == "loguniform" and a <= 0:
        raise InputError(path, "equal ratios through zero", "limits above zero", shown(text))
    return Distribution(_LogUniform(a, b) if kind == "loguniform" else _Uniform(a, b), text)


class _Uniform(NamedTuple):
    low: float
    high: float

    def __call__(self, share: Floats) -> Floats:
        return self.low + (self.high - self.low) * share


class _LogUniform(NamedTuple):
    low: float
    high: float

    def __call__(self, share: Floats) -> Floats:
        return self.low * (self.high / self.low) ** share


class _Normal(NamedTuple):
    mean: float
    deviation: float

    def __call__(self, share: Floats) -> Floats:
        from scipy.special import ndtri

        return self.mean + self.deviation * ndtri(share)


def _limits(scene: Scene, path: str, given: list[str]) -> list[float]:
    """Convert numbers to SI; those with a unit have that of the path."""
    typed = [_number(part) for part in given]
    texts = [part for part in typed if isinstance(part, str)]
    unit = ""
    if texts:
        leaf = _leaf(scene, path) or _leaf(changed(scene, {path: texts[0]}), path)
        unit = leaf.unit if isinstance(leaf, Quantity) else ""
    return [to_si(part, unit, path) for part in typed]


def _number(text: str) -> float | str:
    """Convert a text to a number without a unit, which is SI, if possible."""
    try:
        return float(text)
    except ValueError:
        return text


def _in_si(scene: Scene, path: str, value: Any) -> Any:
    """Convert a value to a plain number, if the path takes one."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str):
        try:
            leaf = _leaf(changed(scene, {path: value}), path)
        except InputError:
            return value  # does not fit, at least not alone: the run reports it
        return float(leaf) if isinstance(leaf, Quantity) else value
    return value


def _leaf(scene: Scene, path: str) -> Any:
    """Value of a scene at a path, None if nothing is given there."""
    found: Any = scene
    for key in parts_of(path):
        found = found.get(key) if isinstance(found, dict) else getattr(found, key, getattr(found, f"{key}_", None))
    return found


class Design(NamedTuple):
    """Values by path and run."""

    levels: Mapping[str, list[Any] | Floats]  # the values that a path takes, by path
    taken: Mapping[str, NDArray | None]  # (runs,) which of them it takes in each run; None where each run has its own
    shape: tuple[int, ...]  # of a grid, the number of values along each path; else (runs,)
    sample: str  # how runs were chosen, such as ``"grid"`` or ``"sobol:128"``

    @property
    def runs(self) -> int:
        """Number of runs."""
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
    if not isinstance(vary, Mapping) or not vary:
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
    """Combine every value of a path with every value of the others; the last path's change fastest."""
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
    """Levels and the index of the one taken: from a list with equal probability."""
    if not isinstance(values, Distribution):
        return values, np.minimum((share * len(values)).astype(int), len(values) - 1)
    drawn = np.asarray(values.quantiles(np.clip(share, 1e-16, 1 - 1e-16)), float)
    if drawn.shape != share.shape:
        raise InputError(path, "its quantiles are of another shape", f"{share.shape}", f"{drawn.shape}")
    return drawn, None


def whole(where: str, typed: Any, least: int, most: int) -> int:
    """Convert an argument to a whole number within limits."""
    try:
        return Whole(least, most).read(typed)
    except InputError as error:
        raise InputError(where, error.problem, error.expected, error.got) from None
