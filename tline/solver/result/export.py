"""Results for other programs: tables of pandas, arrays of xarray, and files by their suffix."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError, import_extra
from tline.solver.result.quantities import in_arrays, quantity

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from tline.solver.result.result import Result

SUFFIXES = ".csv", ".npz", ".nc", ".h5", ".zarr"


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
        from tline.atomic import replacing, suffix_of
        from tline.solver.result.save import save_csv, save_npz

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
            import_extra("h5netcdf", "h5netcdf", "data", str(path))
            with TemporaryDirectory() as folder, replacing(path) as temporary:
                file = Path(folder, "result.nc")  # HDF5 locks what it writes, and `temporary` is locked already
                self.to_xarray(t).to_netcdf(file, engine="h5netcdf")
                temporary.write_bytes(file.read_bytes())


def columns_of(result: Result, t: ArrayLike | None) -> tuple[NDArray, dict[tuple[str, str], NDArray]]:
    """Instants, and values by probe and quantity."""
    instants = result.t if t is None else np.atleast_1d(np.asarray(t, float))
    found = {}
    for name, probe in result.probes.items():
        seen = probe.samples if t is None else probe.at(instants)
        found |= {(name, each.key): each.of(seen) for each in in_arrays(result.scene) if each.seen_by(probe)}
    return instants, found
