"""Many runs in files that other programs read: CSV and NPZ."""

from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tline.scene.file import scene_text
from tline.scene.heights import words
from tline.solver.description.given import Scene
from tline.solver.many.runs import Many
from tline.solver.result.atomic import replacing, write_table

EXTREMES = ("lowest", "lowest_at", "highest", "highest_at")


def save_csv(scene: Scene, vary: Mapping[str, ArrayLike], runs: Many, path: str | Path) -> None:
    """Write a table with a row for each copy: the numbers that vary, and the extremes at each probe, in SI.

    One header line names place or quantity, with the unit of what was seen. Numbers are written so that reading them
    gives the same floats.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    medium = words(scene, "gauge pressure")
    unit = medium.units["effort"]
    columns = [f"{word} {rest}" for word in ("lowest", "highest") for rest in (f"{medium.effort} [{unit}]", "at [s]")]
    columns += [f"{word} head [m]" for word in ("lowest", "highest")] if scene.heights else []
    head = [*vary, *(f"{name} {column}" for name in runs.probes for column in columns)]
    seen = []
    for name, probe in runs.probes.items():
        weight = runs.heights[name].weight
        seen += [probe.lowest - weight, probe.lowest_at, probe.highest - weight, probe.highest_at]
        seen += (
            [extreme / runs.heights[name].per_metre for extreme in (probe.lowest, probe.highest)]
            if scene.heights
            else []
        )
    rows = np.stack([*(np.asarray(values, float) for values in vary.values()), *seen], axis=1)
    write_table(path, head, rows.tolist())


def save_npz(scene: Scene, vary: Mapping[str, ArrayLike], runs: Many, path: str | Path) -> None:
    """Write the same as NumPy arrays, with the scene.

    The arrays are the numbers that vary, by place; ``NAME/lowest``, ``NAME/lowest_at``, ``NAME/highest`` and
    ``NAME/highest_at`` of each probe, in SI, of gauge pressures in a scene with elevations; ``scene`` as TOML text;
    ``version`` of this package; ``estimate``.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **dict(_arrays(scene, vary, runs)))


def _arrays(scene: Scene, vary: Mapping[str, ArrayLike], runs: Many) -> Iterator[tuple[str, Any]]:
    yield from ((where, np.asarray(values, float)) for where, values in vary.items())
    for name, seen in runs.probes.items():
        for key in EXTREMES:
            weight = 0.0 if key.endswith("_at") else runs.heights[name].weight
            yield f"{name}/{key}", getattr(seen, key) - weight
    yield "scene", np.array(scene_text(scene))
    yield "version", np.array(version("tline"))
    yield "estimate", np.array(runs.estimate)
