"""Results for other programs: tables of pandas, arrays of xarray, and files by their suffix."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.atomic import replacing, suffix_of, write_table
from tline.errors import InputError, as_numbers, import_extra
from tline.scene.file import scene_text
from tline.solver.ledger.ledger import Entry
from tline.solver.result.envelope import COLUMNS
from tline.solver.result.quantities import Quantity, in_arrays, in_columns, quantity

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from tline.solver.description.given import Scene
    from tline.solver.result.result import Result


SUFFIXES = ".csv", ".npz", ".nc", ".h5", ".zarr"
ROWS = 10_000  # turned into text at a time


class Export:
    """Conversion of a result to tables, datasets and files."""

    def to_dataframe(self, t: ArrayLike | None = None) -> DataFrame:
        """Return the signals of the probes as a table of pandas.

        Parameters
        ----------
        t : array_like, s, optional
            Instants; slab ends, where values are most accurate, if not given.

        Returns
        -------
        pandas.DataFrame
            By time in s; columns are pairs of a probe and a quantity, SI: u, y, a and b, in a scene with elevations
            also gauge_pressure and head, of a probe where no line ends u alone.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        pandas = import_extra("pandas", "pandas", "data", "to_dataframe")
        instants, columns = columns_of(cast("Result", self), t)
        index = pandas.Index(instants, name="time")
        return pandas.DataFrame(columns, index=index).rename_axis(columns=["probe", "quantity"])

    def to_xarray(self, t: ArrayLike | None = None) -> Dataset:
        """Return the signals of the probes as a dataset of xarray, with units, scene and accuracy.

        Parameters
        ----------
        t : array_like, s, optional
            Instants; slab ends, where values are most accurate, if not given.

        Returns
        -------
        xarray.Dataset
            Variables u, y, a and b, in a scene with elevations also gauge_pressure and head, over probe and time; NaN
            where no line ends. Attributes: scene (TOML), version, order, slab; error and tol where they are known.

        Raises
        ------
        MissingExtraError
            xarray is not installed.
        """
        xarray = import_extra("xarray", "xarray", "data", "to_xarray")
        result = cast("Result", self)
        instants, columns = columns_of(result, t)
        nothing = np.full(len(instants), np.nan)
        found = {}
        for key in dict.fromkeys(key for _, key in columns):
            values = [columns.get((probe, key), nothing) for probe in result.probes]
            found[key] = (("probe", "time"), np.stack(values), {"units": quantity(key).si(result.scene)})
        about: dict[str, Any] = {
            "title": result.scene.title,
            "scene": result.scene.to_toml(),
            "version": version("tline"),
            "order": result.resolution.s,
            "slab": result.resolution.h,
        }
        if result.accuracy is not None and result.accuracy.tol is not None:
            about |= {"tol": result.accuracy.tol, "error": result.accuracy.worst}
        places = {"probe": np.array([*result.probes], object), "time": ("time", instants, {"units": "s"})}
        return xarray.Dataset(found, places, about)

    def save(self, path: str | Path, t: ArrayLike | None = None) -> None:
        """Write the signals of the probes to a file for other programs.

        Parameters
        ----------
        path : str or Path
            By its suffix: ``.csv``, a table; ``.npz``, arrays of NumPy; ``.nc`` or ``.h5``, HDF5 as netCDF has it, and
            ``.zarr``, through xarray. All of a result, waves at any instant included, keeps ``pickle``.
        t : array_like, s, optional
            Instants; slab ends if not given.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written; MissingExtraError where xarray or its backend is missing.
        """
        suffix = suffix_of(path, SUFFIXES)
        if suffix in (".csv", ".npz"):
            (save_csv if suffix == ".csv" else save_npz)(cast("Result", self), path, t)
        elif suffix == ".zarr":
            import_extra("zarr", "zarr", "data", str(path))
            try:
                self.to_xarray(t).to_zarr(path, mode="w", consolidated=False)
            except OSError as error:
                raise InputError(str(path), "cannot be written", got=error.strerror or str(error)) from None
        else:
            from tempfile import TemporaryDirectory

            import_extra("h5netcdf", "h5netcdf", "data", str(path))
            with TemporaryDirectory() as folder, replacing(path) as temporary:
                file = Path(folder, "result.nc")  # HDF5 locks what it writes, and `temporary` is locked already
                self.to_xarray(t).to_netcdf(file, engine="h5netcdf")
                temporary.write_bytes(file.read_bytes())


def columns_of(
    result: Result, t: ArrayLike | None, listed: Callable[[Scene], list[Quantity]] = in_arrays
) -> tuple[NDArray, dict[tuple[str, str], NDArray]]:
    """Instants, and values by probe and quantity."""
    instants = result.t if t is None else np.atleast_1d(as_numbers("t", t))
    found = {}
    for name, probe in result.probes.items():
        seen = probe.samples if t is None else probe.at(instants)
        found |= {(name, each.key): each.of(seen) for each in listed(result.scene) if each.seen_by(probe)}
    return instants, found


def save_csv(result: Result, path: str | Path, t: ArrayLike | None = None) -> None:
    """Write the signals of the probes as a table: time, then effort, flow and both waves of each probe on a line.

    One header line names quantity and unit, SI if the scene says nothing, such as ``valve pressure [Pa]``, in a scene
    with elevations ``valve gauge pressure [Pa]`` and ``valve head [m]``; a and b are waves. At a jump
    it is the value before it. Numbers are written so that reading them gives the same floats.
    """
    scene, (instants, found) = result.scene, columns_of(result, t, in_columns)
    head, columns = ["time [s]"], [instants]
    for (name, key), values in found.items():
        size, unit = quantity(key).written(scene)
        head.append(f"{name} {quantity(key).named(scene)} [{unit}]")
        columns.append(values / size)
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
