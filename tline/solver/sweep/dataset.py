"""A sweep as an `xarray.Dataset`."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.file import scene_text
from tline.solver.sweep.table import NOT_RUN, Sweep

if TYPE_CHECKING:
    import xarray as xr


def dataset(sweep: Sweep) -> "xr.Dataset":
    """See `Sweep.to_xarray`."""
    try:
        import xarray as xr
    except ImportError:
        raise InputError("", "xarray is not installed", "pip install 'tline[xarray]'") from None
    grid = sweep.sample == "grid"
    runs = tuple(sweep.inputs) if grid else ("run",)
    coords = {path: (path if grid else "run", values) for path, values in _axes(sweep).items()}
    more = {"probe": sweep.probes} | ({"t": ("t", sweep.t, {"units": "s"})} if len(sweep.t) else {})
    errors = np.full(len(sweep), "", object)
    errors[~sweep.done] = NOT_RUN
    errors[list(sweep.errors)] = list(sweep.errors.values())
    variables = {
        name: ((*runs, *sweep.dims(name)), _shaped(sweep, array), {"units": sweep.unit(name)})
        for name, array in sweep.kept.items()
    }
    variables["error"] = (runs, _shaped(sweep, errors), {})
    about = {"scene": scene_text(sweep.scene), "sample": sweep.sample, "method": sweep.method}
    return xr.Dataset(variables, coords | more, about | ({} if sweep.tol is None else {"tol": sweep.tol}))


def _shaped(sweep: Sweep, array: NDArray) -> NDArray:
    return array.reshape(*sweep.shape, *array.shape[1:])


def _axes(sweep: Sweep) -> dict[str, NDArray]:
    """Values along the axes of a grid, each with its own; else along the runs."""
    axes = {}
    for k, (path, values) in enumerate(sweep.inputs.items()):
        first = tuple(slice(None) if j == k else 0 for j in range(len(sweep.shape)))
        axes[path] = _shaped(sweep, values)[first] if sweep.sample == "grid" else values
    return axes
