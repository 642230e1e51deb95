"""Results kept of each run of a sweep: extremes, efforts and flows at instants, functions of the result."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import Scene
from tline.solver.many.runs import ManyRuns
from tline.solver.result.dense_output import extremes
from tline.solver.result.quantities import QUANTITIES, in_sweeps
from tline.solver.result.result import Result
from tline.sweeps.design import values_or_distribution
from tline.units import to_si
from tline.words.wording import shown

Floats = NDArray[np.float64]
EXTREMES = ("lowest", "lowest_at", "highest", "highest_at")
ESTIMATE = "estimate"
TAKEN = (ESTIMATE, "run", "probe", "t", "time", "error", "done", "scene", "about")  # other names in tables and files
EXPECTED = "'extremes', instants in s such as [0, 1, 2] or '0 s:2 s:3', a function of the result, or a list of these"


class Keep(NamedTuple):
    """Results to keep of each run."""

    extremes: bool
    t: Floats  # (instants,) instants at which efforts and flows are kept, s
    # by name; each takes a `Result` and returns a number or an array, of one shape in all runs
    functions: Mapping[str, Callable[[Result], Any]]

    @property
    def names(self) -> list[str]:
        """Names of the results kept."""
        return [*(["extremes"] if self.extremes else []), *self.functions]

    def of(self, result: Result) -> dict[str, Floats]:
        """Arrays by name of one run; those over probes have these as first axis."""
        kept: dict[str, Floats] = {ESTIMATE: np.array(result.accuracy.worst if result.accuracy else np.nan)}
        probes = result.probes.values()
        if self.extremes:
            found = [sum(extremes(probe, "gauge_pressure"), ()) for probe in probes]
            kept |= dict(zip(EXTREMES, np.array(found).reshape(-1, len(EXTREMES)).T.copy(), strict=True))
        if len(self.t):
            seen = [probe.at(self.t) for probe in probes]
            kept |= {each.key: np.array([each.of(samples) for samples in seen]) for each in in_sweeps(result.scene)}
        for name, function in self.functions.items():
            kept[name] = np.asarray(function(result), float)
        return kept

    def of_copies(self, found: ManyRuns, copies: NDArray) -> dict[str, Floats]:
        """Arrays by name of many runs at once, with runs as first axis."""
        probes, errors = found.run(copies, self.t)
        seen, heights = list(probes.values()), [found.description.probes[name].height for name in probes]
        kept = {ESTIMATE: errors}
        for name in EXTREMES if self.extremes else ():
            kept[name] = np.stack([getattr(probe, name) for probe in seen], axis=1)
            if not name.endswith("_at"):
                kept[name] -= np.array([height.weight for height in heights])
        if len(self.t):
            samples = [probe.samples(self.t, height) for probe, height in zip(seen, heights, strict=True)]
            for each in in_sweeps(found.description.scene):
                kept[each.key] = np.stack([each.of(one) for one in samples], axis=1)
        return kept


def kept_of(scene: Scene, keep: Any) -> Keep:
    """Parse the argument `keep` of a sweep."""
    wanted, times, functions = False, [], {}
    for item in _items(keep):
        if isinstance(item, str) and item == "extremes":
            wanted = True
        elif isinstance(item, str):
            times += _instants(scene, _in_seconds(scene, item))
        elif isinstance(item, Mapping) and all(callable(each) for each in item.values()):
            functions |= item
        elif callable(item):
            functions[getattr(item, "__name__", type(item).__name__).strip("<>")] = item
        else:
            times += _instants(scene, item)
    taken = {*EXTREMES, *TAKEN, *(each.key for each in QUANTITIES)} & functions.keys()
    taken |= {name for name in functions if not name.isidentifier()}
    if taken:
        raise InputError(
            "keep", f"{shown(min(taken))} cannot name an array", "a dict with another name for the function"
        )
    return Keep(wanted, np.unique(np.array(times, float)), functions)


def _items(keep: Any) -> Iterable[Any]:
    """Items of a list; anything else, or a list of instants, is one item."""
    if not isinstance(keep, list | tuple):
        return [keep]
    numbers = [isinstance(each, int | float | np.number) for each in keep]
    return [keep] if numbers and all(numbers) else keep


def _in_seconds(scene: Scene, text: str) -> Any:
    """Parse instants listed in a text, or given there as a range."""
    try:
        values = values_or_distribution(scene, "t_end", text)
        return [to_si(each, "s") for each in values] if isinstance(values, list) else text
    except InputError:
        return text


def _instants(scene: Scene, given: Any) -> list[float]:
    try:
        t = np.atleast_1d(np.asarray(given, float))
    except (TypeError, ValueError):
        raise InputError("keep", "unknown", EXPECTED, shown(given)) from None
    outside = t[~((t >= 0) & (t <= scene.t_end * (1 + EDGE)))]
    if t.ndim != 1 or len(outside):
        got = f"{outside.flat[0]:g} s" if outside.size else f"{t.ndim} axes"
        raise InputError("keep", "not instants of the run", f"0 to {scene.t_end:g} s", got)
    return np.minimum(t, scene.t_end).tolist()
