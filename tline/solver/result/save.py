"""Files of results for other programs: CSV and NPZ."""

from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tline.atomic import replacing, write_table
from tline.errors import InputError
from tline.scene.file import scene_text
from tline.solver.ledger.ledger import Entry
from tline.solver.result.envelope import COLUMNS
from tline.solver.result.export import columns_of
from tline.solver.result.quantities import in_columns, quantity
from tline.solver.result.result import Result

ROWS = 10_000  # turned into text at a time


def save_csv(result: Result, path: str | Path, t: ArrayLike | None = None) -> None:
    """Write the signals of the probes as a table: time, then effort, flow and both waves of each probe on a line.

    One header line names quantity and unit, SI if the scene says nothing, such as ``valve pressure [Pa]``, in a scene
    with elevations ``valve gauge pressure [Pa]`` and ``valve head [m]``; a and b are waves. At a jump
    it is the value before it. Numbers are written so that reading them gives the same floats.
    """
    scene = result.scene
    instants = result.t if t is None else np.atleast_1d(np.asarray(t, float))
    head, columns = ["time [s]"], [instants]
    for name, probe in result.probes.items():
        here = [each for each in in_columns(scene) if each.seen_by(probe)]
        samples = probe.samples if t is None else probe.at(instants)
        units = [each.written(scene) for each in here]
        head += [f"{name} {each.named(scene)} [{unit}]" for each, (_, unit) in zip(here, units, strict=True)]
        columns += [each.of(samples) / size for each, (size, _) in zip(here, units, strict=True)]
    parts = (np.stack([column[k : k + ROWS] for column in columns], axis=1) for k in range(0, len(instants), ROWS))
    write_table(path, head, (row for part in parts for row in part.tolist()))


def save_envelope(result: Result, path: str | Path) -> None:
    """Write the effort before t = 0 and its extremes at every node as a table, in full precision.

    In a scene with elevations these are gauge pressures, followed by heads.
    """
    envelope, written = result.envelope, quantity("u").written
    if envelope is None:
        raise InputError(str(path), "the run kept no envelope", "simulate(scene, envelope=True)")
    heights, words = bool(result.scene.heights), ("start", "lowest", "highest")
    effort = "gauge pressure" if heights else result.medium.effort
    size, unit = written(result.scene)
    start, lowest, highest = (f"{what} {effort} [{unit}]" for what in words)
    error = f"± error [{unit}]"
    columns = [getattr(envelope, name) - envelope.weight * (name in words) for name in COLUMNS]
    columns = [each if name.endswith("_at") else each / size for name, each in zip(COLUMNS, columns, strict=True)]
    head = ["node", start, lowest, "at [s]", error, highest, "at [s]", error]
    if heights:
        metre, unit = quantity("head").written(result.scene)
        head += [f"{word} head [{unit}]" for word in words]
        columns += [getattr(envelope, word) / (envelope.per_metre * metre) for word in words]
    write_table(path, head, zip(envelope.nodes, *(column.tolist() for column in columns), strict=True))


def save_states(result: Result, path: str | Path) -> None:
    """Write the states of elements over time, a column each."""
    if not result.states:
        raise InputError(str(path), "nothing has a state", "a pump that trips, a vessel, a tank, a cavity, a valve")
    units = [result.medium.unit(trace.unit, written=True) for trace in result.states]
    head = [f"{trace.name} [{unit or '1'}]" for trace, (_, unit) in zip(result.states, units, strict=True)]
    columns = [trace.values / size for trace, (size, _) in zip(result.states, units, strict=True)]
    write_table(path, ["time [s]", *head], np.stack([result.states[0].t, *columns], axis=1).tolist())


def save_ledger(result: Result, path: str | Path) -> None:
    """Write the energy supplied, dissipated and stored by every line and element as a table, J, in full precision."""
    if result.ledger is None:
        raise InputError(str(path), "the run kept no ledger", "simulate(scene, ledger=True)")
    write_table(path, ["where", *(f"{column} [J]" for column in Entry._fields[1:])], result.ledger.entries)


def save_npz(result: Result, path: str | Path, t: ArrayLike | None = None) -> None:
    """Write the signals of the probes as NumPy arrays, with the scene.

    The arrays are ``t``; ``NAME/u``, ``NAME/y``, ``NAME/a`` and ``NAME/b`` of each probe, in SI, of one at a node where
    no line ends ``NAME/u`` alone; in a scene with elevations also ``NAME/gauge_pressure`` and ``NAME/head``, and u is
    the piezometric pressure; ``scene``, the scene as TOML text; ``version`` of this package; ``order`` and ``slab`` of
    the run.
    """
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **dict(_arrays(result, t)))


def _arrays(result: Result, t: ArrayLike | None) -> Iterator[tuple[str, Any]]:
    instants, columns = columns_of(result, t)
    yield "t", instants
    yield from ((f"{name}/{key}", values) for (name, key), values in columns.items())
    yield "scene", np.array(scene_text(result.scene))
    yield "version", np.array(version("tline"))
    yield "order", np.array(result.resolution.s)
    yield "slab", np.array(result.resolution.h)
