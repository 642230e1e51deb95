"""A lossy line in s, exactly: what it does to waves of its z0, and what stands inside it."""

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import LossyLine
from tline.solver.description.lines import Line
from tline.words.wording import place


def losses_of(name: str, line: Line) -> LossyLine:
    """The exact laws of a line that has losses."""
    losses = line.losses
    if losses is None or not losses.linear:
        problem = "depends on the size of the flow: there is no transfer function"
        raise InputError(place("lines", name, "friction"), problem, "kind = 'linear', 'laminar' or 'zielke'")
    return losses.exact


def carried(line: LossyLine, z0: float, s: NDArray, late: NDArray | float = 0.0) -> tuple[NDArray, NDArray]:
    """What of a wave that enters the line arrives at its other end, and what comes back; each of the shape of s.

    `late` is added to Γl where it stands for the way of a wave: what a delay is beyond sT.
    With A, B, C, A the chain matrix these are 2/(2A + B/z0 + C z0) and (B/z0 - C z0)/(2A + B/z0 + C z0).

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, table 4.2.
    """
    series, shunt = line.series.at(s), line.shunt.at(s)
    total = np.sqrt(series) * np.sqrt(shunt) * line.length
    fallen = np.exp(-total - late)
    shape = _shape(total, late) * line.length  # sinh(Γl)/Γ exp(-Γl)
    b, c = series * shape / z0, shunt * shape * z0
    whole = 1 + fallen**2 + b + c
    return 2 * fallen / whole, (b - c) / whole


def inside(line: LossyLine, s: NDArray, share: float, u1: NDArray, u2: NDArray) -> tuple[NDArray, NDArray]:
    """Effort and flow at a share of the length, between the efforts at the ends."""
    total = line.gamma(s) * line.length
    near, far = share, 1 - share
    whole = _shape(total)
    decay = np.exp(-total * np.array([near, far, 1 + near, 1 + far])[:, None])
    u = (decay[0] * far * _shape(total * far) * u1 + decay[1] * near * _shape(total * near) * u2) / whole
    slopes = (decay[0] + decay[3]) * u1 - (decay[1] + decay[2]) * u2
    return u, slopes / (2 * line.series.at(s) * line.length * whole)


def _shape(total: NDArray, late: NDArray | float = 0.0) -> NDArray:
    """sinh(x)/x exp(-x), with x + `late` for x where it is no divisor."""
    return np.where(total == 0, 1, -np.expm1(-2 * (total + late)) / (2 * np.where(total == 0, 1, total)))
