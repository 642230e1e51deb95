"""Search for a size by prepared runs, and its result: the size, its margin, its curve, and the scene with it."""

import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from tline.atomic import write_table
from tline.design.limits import Limits
from tline.design.search import SizeSearch, Trial, smallest
from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.scene import Scene
from tline.solver.prepared import Prepared, prepare
from tline.solver.result.result import Result
from tline.solver.simulate import UnresolvedWarning
from tline.units import engineering
from tline.words.progress import Progress
from tline.words.wording import aligned

USUAL_TOL, USUAL_RUNS = 1e-3, 20
NO_SEARCH = "even the smallest size that was tried keeps the limits"


class Size(NamedTuple):
    """Value of a design, in SI, and its unit for display."""

    value: float
    unit: str

    def __str__(self) -> str:
        return engineering(self.value, self.unit)


@dataclass(frozen=True, eq=False, repr=False)
class Sizing(Presentation):
    """Result of a design search.

    Attributes
    ----------
    kind : str
        ``"vessel"``, ``"closure"``, ``"relief"`` or ``"flywheel"``.
    element : str
        Place of the element that was sized, such as ``"loads.vessel"``.
    sizes : dict of str to Size
        Sizes found, the one searched first.
    found : Trial
        Extremes, margin and estimated error at that size.
    curve : tuple of Trial
        All sizes run, in order.
    limits : Limits
        Limits of the search.
    scene : Scene
        The given scene with the element of that size.
    notes : tuple of str
        Notes on the result.
    """

    kind: str
    element: str
    sizes: Mapping[str, Size]
    found: Trial
    curve: tuple[Trial, ...]
    limits: Limits
    scene: Scene
    notes: tuple[str, ...]
    picture = "tline.design.picture:plot_sizing"

    @property
    def searched(self) -> tuple[str, Size]:
        """Name and value of the size that was searched."""
        return next(iter(self.sizes.items()))

    def text_lines(self) -> Iterator[str]:
        """Describe the size, its margin to the limit, and the curve of extremes over sizes."""
        limits, trial = self.limits, self.found
        per, unit = limits.unit
        name, size = self.searched
        head = [name, f"lowest [{unit}]", f"highest [{unit}]", f"margin [{unit}]"]
        rows = [
            [str(size._replace(value=each.size)), *(f"{value / per:.4g}" for value in each[1:4])] for each in self.curve
        ]
        error = f", estimated error {trial.error / per:.1g} {unit}" if trial.error == trial.error else ""
        yield f"{self.scene.title or 'a scene'}: {self.kind}, {self.element}"
        yield from aligned([[key, str(size)] for key, size in self.sizes.items()], 2)
        yield (
            f"{limits.word} {limits.where}: {limits.shown(trial.lowest)} to {limits.shown(trial.highest)}, "
            f"margin {trial.margin / per:.2g} {unit}{error}"
        )
        yield from ["", *aligned([head, *rows], 0)]

    def to_dict(self) -> dict[str, Any]:
        """Contents except the scene as plain data, in SI."""
        limits = self.limits
        bound = {"lowest": limits.lowest, "highest": limits.highest}
        told = {
            "kind": self.kind,
            "element": self.element,
            **{name: size.value for name, size in self.sizes.items()},
            "limited": limits.word,
            "where": limits.where,
            "limits": {key: value for key, value in bound.items() if isfinite(value)},
            "found": self.found._asdict(),
            "curve": [trial._asdict() for trial in self.curve],
            "notes": list(self.notes),
        }
        return plain(told)

    def save(self, path: str | Path) -> None:
        """Write the curve as CSV: a row for each size, SI."""
        write_table(path, [self.searched[0].replace(" ", "_"), *Trial._fields[1:]], self.curve)


class Runs:
    """Runs of one prepared scene with one variable size: `values` maps a size to values by dotted path."""

    def __init__(
        self,
        scene: Scene,
        values: Callable[[float], Mapping[str, Any]],
        limits: Limits,
        tol: float | None,
        progress: bool,
    ):
        self.prepared: Prepared = prepare(scene)
        self.values, self.limits = values, limits
        fixed = scene.solver.order is not None or scene.solver.slab is not None
        self.tol = tol if tol is not None or fixed or scene.solver.tol is not None else USUAL_TOL
        self.bar = Progress(USUAL_RUNS, "runs", progress, "design")
        self.results: dict[float, Result] = {}

    def run(self, size: float) -> Trial:
        """Run one size."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnresolvedWarning)  # the notes of the size that is found say it
            result = self.prepared.run(
                self.values(size), tol=self.tol, record=self.limits.record, envelope=True, ledger=False
            )
        self.bar.update()
        self.results[size] = result
        return self.limits.trial(size, result)

    def refuse_kept(self, key: str, without: str) -> None:
        """Raise an error if the limit is kept without protection."""
        trial, limits = self.run(1.0), self.limits
        if trial.margin >= 0:
            got = f"{limits.shown(trial.lowest)} to {limits.shown(trial.highest)} {limits.where}"
            raise InputError(key, f"is kept without {without}", "a stricter limit", got)

    def smallest(self, unit: str, first: float, largest: float = float("inf")) -> tuple[Trial, SizeSearch, list[str]]:
        """Search the smallest size, and note irregularities with the size in a given unit."""
        with self.bar:
            search = smallest(self.run, first, largest)
        if search.found is None:
            raise self._unreachable(search, unit)
        notes = []
        if search.found is search.trials[0]:
            notes.append(NO_SEARCH)
        if search.turns:
            small, large = (Size(trial.size, unit) for trial in search.turns)
            notes.append(f"the margin does not grow from size {small} to {large}: look at the curve")
        result = self.results[search.found.size]
        if self.limits.at_the_end(result):
            notes.append("the extreme comes at the end of the run: run longer, for a later one may be worse")
        return search.found, search, [*notes, *result.notes]

    def _unreachable(self, search: SizeSearch, unit: str) -> InputError:
        best, limits = max(search.trials, key=lambda trial: trial.margin), self.limits
        low = best.lowest - limits.lowest < limits.highest - best.highest
        key, reached = ("lowest", best.lowest) if low else ("highest", best.highest)
        there = "" if limits.way else f" at '{limits.worst_node(self.results[best.size], low)}'"
        return InputError(
            key,
            f"no size up to {Size(search.trials[-1].size, unit)} keeps this {limits.word} {limits.where}",
            f"{'at most' if low else 'at least'} {limits.shown(reached)}{there}, the best of what was tried",
            limits.shown(limits.lowest if low else limits.highest),
        )
