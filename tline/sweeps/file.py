"""Sweeps in files (NPZ, which can be resumed, NetCDF and CSV), and as an `xarray.Dataset`."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tline.atomic import replacing, write_table
from tline.errors import InputError, import_extra
from tline.sweeps.table import NOT_RUN, Sweep

if TYPE_CHECKING:
    from xarray import Dataset


def dataset(sweep: Sweep) -> "Dataset":
    """Convert a sweep to an `xarray.Dataset`; see `Sweep.to_xarray`."""
    xarray = import_extra("xarray", "xarray", "data", "to_xarray")
    grid = sweep.sample == "grid"
    runs = tuple(sweep.inputs) if grid else ("run",)
    coords = {path: (path if grid else "run", values) for path, values in _axes(sweep).items()}
    more = {"probe": sweep.probes} | ({"time": ("time", sweep.t, {"units": "s"})} if len(sweep.t) else {})
    errors = np.full(len(sweep), "", object)
    errors[~sweep.done] = NOT_RUN
    errors[list(sweep.errors)] = list(sweep.errors.values())
    variables = {
        name: ((*runs, *sweep.dims(name)), _shaped(sweep, array), {"units": sweep.unit(name)})
        for name, array in sweep.kept.items()
    }
    variables["error"] = (runs, _shaped(sweep, errors), {})
    about = {"title": sweep.scene.title, "scene": sweep.scene.to_toml(), "version": version("tline")}
    about |= {"sample": sweep.sample, "method": sweep.method}
    return xarray.Dataset(variables, coords | more, about | ({} if sweep.tol is None else {"tol": sweep.tol}))


def _shaped(sweep: Sweep, array: NDArray) -> NDArray:
    return array.reshape(*sweep.shape, *array.shape[1:])


def _axes(sweep: Sweep) -> dict[str, NDArray]:
    """Values along the axes of a grid, each with its own; else along the runs."""
    axes = {}
    for k, (path, values) in enumerate(sweep.inputs.items()):
        first = tuple(slice(None) if j == k else 0 for j in range(len(sweep.shape)))
        axes[path] = _shaped(sweep, values)[first] if sweep.sample == "grid" else values
    return axes


SUFFIXES = (".npz", ".nc", ".csv")
ABOUT = "about"
TAKEN = ("t", "done", "scene", ABOUT)  # names of arrays that are neither inputs nor kept


def save(sweep: Sweep, path: str | Path) -> None:
    """Write a sweep to a file; see `Sweep.save`."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(str(path), "unknown kind of file", " or ".join(SUFFIXES))
    if suffix == ".csv":
        write_table(path, *sweep.table())
    elif suffix == ".nc":
        import_extra("h5netcdf", "h5netcdf", "data", str(path))
        found = sweep.to_xarray()
        with replacing(path) as temporary:
            temporary.write_bytes(found.to_netcdf(engine="h5netcdf"))
    else:
        with replacing(path) as temporary, temporary.open("wb") as file:
            np.savez(file, allow_pickle=False, **_arrays(sweep))


def _arrays(sweep: Sweep) -> dict[str, Any]:
    about = {
        "shape": sweep.shape,
        "sample": sweep.sample,
        "probes": sweep.probes,
        "tol": sweep.tol,
        "errors": sweep.errors,
        "unresolved": sweep.unresolved,
        "method": sweep.method,
        "seconds": sweep.seconds,
        "origin": sweep.origin,
        "version": version("tline"),
    }
    arrays = {"t": sweep.t, "done": sweep.done, "scene": sweep.scene.to_toml(), ABOUT: json.dumps(about)}
    return {**arrays, **sweep.inputs, **sweep.kept}


def take_over(sweep: Sweep, path: str | Path) -> None:
    """Put the runs of a file into a sweep with equal inputs."""
    try:
        with open(path, "rb") as whole, np.load(whole, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
            about = json.loads(str(arrays[ABOUT]))
    except Exception as error:  # noqa: BLE001 (zip files, arrays and JSON each fail in ways of their own)
        raise InputError(str(path), "is no file of a sweep", "one that a sweep wrote", _reason(error)) from None
    mine = _arrays(sweep)
    same = all(
        name in arrays and np.array_equal(arrays[name], mine[name])
        for name in mine
        if name in ("t", "scene", *sweep.inputs)
    )
    names = {name: array for name, array in arrays.items() if name not in (*TAKEN, *sweep.inputs)}
    whole = all(len(array) == len(sweep) for array in (arrays.get("done", ()), *names.values()))
    told = {"tol": sweep.tol, "version": version("tline")}
    origin = about.get("origin", {})
    same = same and told.items() <= about.items() and sweep.origin.items() <= origin.items()
    if not same or not whole:
        expected = "the same scene, values, sample, seed, keep and tol, and the same version"
        raise InputError(str(path), "holds another sweep", f"{expected}, or another file")
    sweep.kept, sweep.done = names, arrays["done"].astype(bool)
    for name in ("errors", "unresolved"):
        setattr(sweep, name, {int(k): str(text) for k, text in about[name].items()})
    sweep.origin = origin


def _reason(error: Exception) -> str:
    return (isinstance(error, OSError) and error.strerror) or type(error).__name__
