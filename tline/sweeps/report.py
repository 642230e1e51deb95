"""What is told of finished runs."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.heights import words
from tline.sweeps import Sweep
from tline.units import handy
from tline.words.aligned import aligned

QUANTILES = (0.05, 0.5, 0.95)
FEW = 24  # runs that are told one by one
WORDS = ("lowest", "highest")
TOLD = 20  # sentences of failed runs


def summary(found: Sweep) -> dict[str, Any]:
    """What was done, and quantiles of the extremes at every probe, in SI."""
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
    """What is not as it was asked for."""
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
    """A head, and the extremes: run by run if there are few, else quantiles."""
    head = f"{found.told} in {found.seconds:.2g} s"
    worst = _worst(found)
    head += "" if worst is None else f", estimated error up to {worst:.1g} of the amplitude"
    title = [found.scene.title] if found.scene.title else []
    if "highest" not in found.kept or not len(found.good):
        return [*title, head]
    return [*title, head, "", *(_one_by_one(found) if len(found) <= FEW else _spread(found))]


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
    """Of the extremes at each probe, in SI."""
    if "highest" in found.kept and len(found.good):
        for k, name in enumerate(found.probes):
            yield name, [(word, np.quantile(found[word][found.good, k], QUANTILES)) for word in WORDS]


def _scale(found: Sweep, probe: int) -> tuple[float, str, float]:
    """Size and name of the unit in which a probe's efforts are read, and their estimated error."""
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
