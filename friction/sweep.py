"""Very many runs of one smooth model at once, on all cores."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from os import cpu_count

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.methods import SMOOTH
from friction.models import Model
from friction.parameters import TOLD, Told, check_number
from friction.testbench import Testbench
from tline.compiled.structure import pack
from tline.errors import InputError

LAW_COLUMN = {  # of kernel.Law
    "F_c": 1, "F_s": 2, "F_v": 3, "sigma2": 3, "v_s": 4, "sigma0": 6, "sigma1": 7, "z_ba": 8, "epsilon": 9
}  # fmt: skip
BENCH = ("mass", "v0", "force")
MOST_STEPS = 100_000  # of a run


def sweep(model: Model, bench: Testbench, t_end: float = 10.0, tol: float = 1e-6, **columns: ArrayLike) -> NDArray:
    """Final states of many runs that differ in some parameters, by the Rosenbrock method.

    Parameters
    ----------
    model : LuGre, Dahl, ElastoPlastic or Tanh
        Gives the parameters that do not vary.
    bench : Testbench
        Likewise.
    t_end : float, optional
        End of each run [s], positive.
    tol : float, optional
        Tolerance of x, v, z and F_f at t_end, relative to the largest value of each in the run, 1e-14 to 0.1.
    **columns : array_like, shape (n,)
        Parameters of the model by name, `mass`, `v0`, and `force`, a factor by which the force is multiplied.

    Returns
    -------
    ndarray, shape (n, 4)
        x, v, z and F_f at t_end; NaN for a run that took more than 10⁵ steps or does not meet the tolerance.

    Raises
    ------
    InputError
        A name is unknown, a parameter is out of range, or columns differ in length.

    Examples
    --------
    >>> from friction import LuGre, Testbench, sweep
    >>> sweep(LuGre(), Testbench(), sigma0=[500.0, 1e5], tol=1e-9)[:, 1].round(6).tolist()
    [13.985389, 13.964028]
    """
    from friction import kernel

    check_number("t_end", t_end, above=0.0)
    check_number("tol", tol, least=1e-14)
    if not isinstance(model, SMOOTH):
        raise InputError("model", "no smooth model", " or ".join(one.__name__ for one in SMOOTH), type(model).__name__)
    table = {name: np.atleast_1d(np.asarray(column, float)) for name, column in columns.items()}
    sizes = {column.size for column in table.values()}
    if len(sizes) != 1:
        raise InputError("columns", "not of one length", "at least one column, all as long", f"{sorted(sizes)}")
    (n,) = sizes
    _check(model, table)
    laws = np.tile(np.array(model.law, float), (n, 1))
    if not hasattr(model, "F_s") and "F_c" in table:
        laws[:, LAW_COLUMN["F_s"]] = table["F_c"]
    for name, column in table.items():
        if name not in BENCH:
            laws[:, LAW_COLUMN[name]] = column
    masses, v0 = table.get("mass", np.full(n, float(bench.mass))), table.get("v0", np.full(n, float(bench.v0)))
    factors, out = table.get("force", np.ones(n)), np.empty((n, 5))
    workers, drive, times = cpu_count() or 1, bench.drive, np.array([float(t_end)])
    _ = kernel.sweep.address  # compiled once, for all threads

    def share(k: int) -> None:
        at = slice(k * n // workers, (k + 1) * n // workers)
        value, slope, compared = drive.value.copy(), drive.slope.copy(), kernel.compared(1, MOST_STEPS + 1)
        runs = kernel.Sweep(
            laws[at], drive, masses[at], v0[at], factors[at], float(tol), times, value, slope, compared, out[at]
        )
        kernel.sweep(pack(runs), MOST_STEPS)

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(share, range(workers)))
    out[out[:, 4] != kernel.DONE, :4] = np.nan
    return out[:, :4]


def _check(model: Model, table: dict[str, NDArray]) -> None:
    """Put the worst of each column where the model checks it."""
    names = {field.name for field in fields(model)}
    for name, column in table.items():
        if name not in names and name not in BENCH:
            raise InputError(name, "unknown column", " or ".join(sorted(names.union(BENCH))))
        if not np.isfinite(column).all():
            raise InputError(name, "not finite", "finite numbers")
        told = TOLD.get(name, Told("", "A factor"))
        if (column <= told.above).any() or (column < told.least).any():
            expected = "more than 0" if told.above == 0.0 else "at least 0"
            raise InputError(name, "too small", expected, f"{column.min():g}")

    def given(name: str) -> NDArray:
        return table.get(name, np.array(getattr(model, name)))

    if hasattr(model, "F_s") and np.any(given("F_s") < given("F_c")):
        raise InputError("F_s", "below F_c", "F_s of at least F_c")
    if hasattr(model, "z_ba") and np.any(given("z_ba") >= given("F_c") / given("sigma0")):
        raise InputError("z_ba", "too large", "less than F_c/σ0")
