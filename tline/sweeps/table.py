"""Results of a sweep: the values that varied and the results kept of every run, as arrays, text and files."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, import_extra
from tline.presentation import Presentation, plain
from tline.scene.heights import words
from tline.solver.description.given import Scene
from tline.solver.result.quantities import Quantity, in_sweeps
from tline.sweeps.keep import ESTIMATE, EXTREMES
from tline.units import handy
from tline.words.wording import aligned, nearest, shown

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset


NOT_RUN = "not run"
QUANTILES = (0.05, 0.5, 0.95)
LISTED_RUNS = 24  # runs, up to which each is printed
WORDS = ("lowest", "highest")
TOLD = 20  # sentences of failed runs printed


@dataclass(eq=False, repr=False)
class Sweep(Presentation):
    """Finished runs of a sweep; ``sweep["highest"]`` and ``sweep["lines.cable.z0"]`` are arrays over the runs.

    Attributes
    ----------
    scene : Scene
        Scene that is varied.
    inputs : mapping of str to ndarray, shape (runs,)
        Values by path: in SI, or texts where they are not numbers.
    shape : tuple of int
        Of a grid, the number of values along each path; else (runs,).
    sample : str
        Method of choosing runs.
    t : ndarray, shape (instants,)
        Instants at which efforts and flows were kept, s.
    tol : float or None
        Tolerance of the runs; None if their order or slab is fixed by the scene and no tolerance asked.
    kept : mapping of str to ndarray, shape (runs, …)
        By name: ``lowest``, ``lowest_at``, ``highest`` and ``highest_at``, shape (runs, probes), of efforts, which are
        gauge pressures in a scene with elevations; ``u`` and ``y`` as in results, ``u`` the piezometric pressure in
        such a scene, which has ``gauge_pressure`` and ``head`` too, shape (runs, probes, instants); results of
        functions; and ``estimate``, the estimated error of a run relative to the amplitude at each probe. Not a number
        where a run failed.
    done : ndarray of bool, shape (runs,)
        Runs that were made.
    errors : dict of int to str
        Reason why a run failed, by its number.
    unresolved : dict of int to str
        Unresolved features of a run, by its number: a load faster than its slabs, or fronts that were smeared.
    method : str
        ``"vectorised"``, or the reason why runs were made one at a time.
    seconds : float
        Time that the sweep took [s].
    origin : dict of str to Any
        Further contents of a file for resuming the sweep.
    """

    scene: Scene
    inputs: Mapping[str, NDArray]
    shape: tuple[int, ...]
    sample: str
    t: NDArray
    tol: float | None
    kept: dict[str, NDArray] = field(default_factory=dict)
    done: NDArray = field(default_factory=lambda: np.zeros(0, bool))
    errors: dict[int, str] = field(default_factory=dict)
    unresolved: dict[int, str] = field(default_factory=dict)
    method: str = ""
    seconds: float = 0.0
    origin: dict[str, Any] = field(default_factory=dict)
    picture = "tline.pictures.sweep:plot_sweep"

    def __post_init__(self) -> None:
        if not len(self.done):
            self.done = np.zeros(len(self), bool)

    def __len__(self) -> int:
        return len(next(iter(self.inputs.values())))

    def __getitem__(self, name: str) -> NDArray:
        arrays = {**self.inputs, **self.kept}
        if name not in arrays:
            raise InputError("sweep", "holds no such array", nearest(name, [*arrays]), shown(name))
        return arrays[name]

    def text_lines(self) -> Iterator[str]:
        """Describe varied and kept values, and the extremes: run by run if there are few, else quantiles."""
        yield f"{', '.join(self.inputs)}; kept: {', '.join(self.kept)}"
        yield from as_text(self)

    def to_dict(self) -> dict[str, Any]:
        """Summary of the runs, quantiles of the extremes, and a row for each run, in SI."""
        head, rows = self.table()
        return plain(summary(self) | {"columns": head, "rows": rows})

    @property
    def told(self) -> str:
        """Describe the number of runs, and of failed and missing ones."""
        left = len(self) - int(self.done.sum())
        parts = [f"{len(self):,} run{'s' * (len(self) != 1)}"]
        parts += [f"{len(self.errors):,} failed"] if self.errors else []
        parts += [f"{left:,} {NOT_RUN}"] if left else []
        return ", ".join(parts)

    @property
    def told_unresolved(self) -> str:
        """Describe the number of runs with unresolved features, and those of the first; empty if there are none."""
        if not self.unresolved:
            return ""
        run, text = min(self.unresolved.items())
        return f"not all is resolved in {len(self.unresolved):,} of {len(self):,} runs, run {run}: {text}"

    @property
    def probes(self) -> list[str]:
        """Names of the probes, in the order of their axis."""
        return list(self.scene.probes)

    @property
    def good(self) -> NDArray:
        """Numbers of the runs that were made and did not fail."""
        good = self.done.copy()
        good[list(self.errors)] = False
        return np.flatnonzero(good)

    @property
    def unmet(self) -> NDArray:
        """Numbers of the runs whose estimated error is above the tolerance."""
        estimate = self.kept.get(ESTIMATE, np.zeros(0))
        return np.flatnonzero(estimate > self.tol) if self.tol is not None else np.zeros(0, int)

    def put(self, rows: NDArray, kept: Mapping[str, NDArray], errors: Mapping[int, str]) -> None:
        """Take over finished runs: arrays of those `rows` that did not fail, and sentences by number of the others."""
        self.errors |= errors
        self.done[[*errors]] = True
        for name, array in kept.items():
            if name not in self.kept:
                self.kept[name] = np.full((len(self), *array.shape[1:]), np.nan)
            elif self.kept[name].shape[1:] != array.shape[1:]:
                self.put(rows[:0], {}, dict.fromkeys(rows.tolist(), f"keep: {name} has another shape than before"))
                return
        for name, array in kept.items():
            self.kept[name][rows] = array
        self.done[rows] = True

    def dims(self, name: str) -> tuple[str, ...]:
        """Names of the axes of a kept array, except that of the runs."""
        if name in EXTREMES:
            return ("probe",)
        if name in self._samples:
            return "probe", "time"
        return tuple(f"{name}_{k}" for k in range(self.kept[name].ndim - 1))

    def unit(self, name: str) -> str:
        """SI unit of a kept array; empty for results of functions."""
        effort = words(self.scene).units["effort"]
        extremes = {"lowest": effort, "highest": effort, "lowest_at": "s", "highest_at": "s"}
        return extremes.get(name, "") or (self._samples[name].si(self.scene) if name in self._samples else "")

    @property
    def _samples(self) -> dict[str, Quantity]:
        """Quantities kept at instants."""
        return {each.key: each for each in in_sweeps(self.scene)}

    def to_xarray(self) -> "Dataset":
        """Convert to an `xarray.Dataset`, with the scene and all inputs; a grid has an axis for each path.

        Raises
        ------
        MissingExtraError
            xarray is not installed.
        """
        from tline.sweeps.file import dataset

        return dataset(self)

    def to_dataframe(self) -> "DataFrame":
        """Convert to a `pandas.DataFrame`, with a row for each run, as in CSV files.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        head, rows = self.table()
        return import_extra("pandas", "pandas", "data", "to_dataframe").DataFrame(rows, columns=head)

    def save(self, path: str | Path) -> None:
        """Write a file by its suffix: ``.npz``, from which a sweep resumes, ``.nc`` (NetCDF), or ``.csv``.

        Raises
        ------
        InputError
            The suffix is another, or the file cannot be written.
        """
        from tline.sweeps.file import save

        save(self, path)

    def table(self) -> tuple[list[str], list[list[Any]]]:
        """Head and rows, a row for each run: inputs, kept arrays except samples, and the error."""
        effort = words(self.scene, "gauge pressure").effort
        head, columns = list(self.inputs), [values.tolist() for values in self.inputs.values()]
        for name, array in self.kept.items():
            if name in self._samples:
                continue
            wide = array.reshape(len(self), -1)
            if name in EXTREMES:
                word = name if name.endswith("_at") else f"{name} {effort}"
                head += [f"{probe} {word} [{self.unit(name)}]" for probe in self.probes]
            else:
                head += [name] if array.ndim == 1 else [f"{name} {k}" for k in range(wide.shape[1])]
            columns += wide.T.tolist()
        errors = ["" if done else NOT_RUN for done in self.done]
        for k, text in self.errors.items():
            errors[k] = text
        return [*head, "error"], [list(row) for row in zip(*columns, errors, strict=True)]


def summary(found: Sweep) -> dict[str, Any]:
    """Summary of the runs, and quantiles of the extremes at every probe, in SI."""
    probes = {name: {word: values.tolist() for word, values in extremes} for name, extremes in _quantiles(found)}
    return {
        "runs": len(found),
        "failed": len(found.errors),
        "not_run": int((~found.done).sum()),
        "unmet": len(found.unmet),
        "sample": found.sample,
        "method": found.method,
        "seconds": found.seconds,
        "estimate": _worst(found),
        "unit": words(found.scene).units["effort"],
        "quantiles": QUANTILES,
        "probes": probes,
        "errors": dict(list(found.errors.items())[:TOLD]),
    }


def notes(found: Sweep) -> list[str]:
    """Notes on interrupted and failed runs, and on missed tolerances."""
    told = []
    if left := int((~found.done).sum()):
        told.append(f"interrupted: {left:,} of {len(found):,} runs are not made")
    if found.errors:
        run, text = min(found.errors.items())
        told.append(f"{len(found.errors):,} of {len(found):,} runs failed, run {run}: {text}")
    if len(found.unmet):
        told.append(f"{len(found.unmet):,} runs missed the tolerance, estimated errors up to {_worst(found):.1g}")
    return told


def as_text(found: Sweep) -> list[str]:
    """Format a head, and the extremes: run by run if there are few, else quantiles."""
    head = f"{found.told} in {found.seconds:.2g} s"
    worst = _worst(found)
    head += "" if worst is None else f", estimated error up to {worst:.1g} of the amplitude"
    title = [found.scene.title] if found.scene.title else []
    if "highest" not in found.kept or not len(found.good):
        return [*title, head]
    return [*title, head, "", *(_one_by_one(found) if len(found) <= LISTED_RUNS else _spread(found))]


def _one_by_one(found: Sweep) -> list[str]:
    columns = [[path, *(f"{value:.6g}" if values.dtype.kind == "f" else value for value in values)]
               for path, values in found.inputs.items()]  # fmt: skip
    for k, name in enumerate(found.probes):
        size, unit, error = _scale(found, k)
        for word in WORDS:
            values = found[word][:, k]
            cells = ["failed" if run in found.errors else "" for run in range(len(found))]
            for run in found.good:
                cells[run] = _shown(float(values[run]), size, error)
            columns.append([f"{name} {word} [{unit}]", *cells])
    return aligned([list(row) for row in zip(*columns, strict=True)], 0)


def _spread(found: Sweep) -> list[str]:
    rows = [["probe", words(found.scene, "gauge pressure").effort, *(f"{100 * share:g} %" for share in QUANTILES)]]
    for k, (name, extremes) in enumerate(_quantiles(found)):
        size, unit, error = _scale(found, k)
        for j, (word, values) in enumerate(extremes):
            cells = [_shown(value, size, error) for value in values]
            rows.append(["" if j else name, f"{word} [{unit}]", *cells])
    return aligned(rows, 2)


def _quantiles(found: Sweep) -> Iterator[tuple[str, list[tuple[str, NDArray]]]]:
    """Quantiles of the extremes at each probe, in SI."""
    if "highest" in found.kept and len(found.good):
        for k, name in enumerate(found.probes):
            yield name, [(word, np.quantile(found[word][found.good, k], QUANTILES)) for word in WORDS]


def _scale(found: Sweep, probe: int) -> tuple[float, str, float]:
    """Size and name of the unit for a probe's efforts, and their estimated error."""
    largest = float(max(np.abs(found[word][found.good, probe]).max() for word in WORDS))
    size, unit = handy(largest, words(found.scene).shown["effort"])
    return size, unit, (_worst(found) or 0.0) * largest


def _shown(value: float, size: float, error: float) -> str:
    return f"{value / size if abs(value) > error else 0:.4g}"


def _worst(found: Sweep) -> float | None:
    """Largest estimated error."""
    told = found.kept.get("estimate", np.zeros(0))
    told = told[np.isfinite(told)]
    return float(told.max()) if len(told) else None
