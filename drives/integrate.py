"""Runs of what is not linear: `scipy.integrate.solve_ivp`, started anew at every corner of the inputs."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from drives.torque import Torque
from tline.errors import InputError

RELATIVE, ABSOLUTE = 1e-13, 1e-15


def integrate(
    rates: Callable[[NDArray, NDArray], NDArray], x0: NDArray, inputs: tuple[Torque, ...], t: NDArray
) -> NDArray[np.float64]:
    """States at the times t, shape (len(t), n), of x' = rates(x, u), to about 1e-12."""
    from scipy.integrate import solve_ivp

    corners = {time for one in inputs for time in one.times if t[0] < time < t[-1]}
    found, x = np.empty((len(t), len(x0))), x0
    found[0] = x0
    for start, stop in pairwise([float(t[0]), *sorted(corners), float(t[-1])]):
        begin = [one.pieces(np.array([start])) for one in inputs]
        u0, slope = (np.array([part[k][0] for part in begin]) for k in (0, 1))
        inside = (t > start) & (t <= stop)
        done = solve_ivp(
            lambda time, x, u0=u0, slope=slope, start=start: rates(x, u0 + slope * (time - start)),
            (start, stop),
            x,
            method="LSODA",
            t_eval=[*t[inside], *([] if t[inside].size and t[inside][-1] == stop else [stop])],
            rtol=RELATIVE,
            atol=ABSOLUTE,
        )
        if not done.success:
            raise InputError("simulation", "could not be finished", "other parameters", done.message)
        found[inside] = done.y.T[: inside.sum()]
        x = done.y[:, -1]
    return found
