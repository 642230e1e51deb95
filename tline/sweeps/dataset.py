"""A sweep as an `xarray.Dataset`."""

from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tline.errors import import_extra
from tline.sweeps.table import NOT_RUN, Sweep

if TYPE_CHECKING:
    from xarray import Dataset


def dataset(sweep: Sweep) -> "Dataset":
    """See `Sweep.to_xarray`."""
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
