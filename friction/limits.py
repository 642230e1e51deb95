"""How large an explicit step may be before it blows up."""

from math import inf
from typing import NamedTuple

import numpy as np

from friction.models import Coulomb, Model, Tanh
from friction.number import check_number
from tline.errors import InputError


class Limits(NamedTuple):
    """Largest steps [s] that keep a small disturbance from growing, and the eigenvalues [1/s] they follow from."""

    euler: float
    rk4: float
    eigenvalues: tuple[complex, ...]


def limits(model: Model, v: float, mass: float = 1.0) -> Limits:
    """Explicit step limits of a model that slides steadily with velocity v, or sticks unloaded at v = 0.

    For LuGre, steady sliding gives h < 2g/(σ0·|v|) for Euler and 2.7853·g/(σ0·|v|) for RK4, where g is flat; stick
    gives the roots of m·s² + (σ1 + σ2)·s + σ0, so that σ1 first enlarges the limit, up to σ1 + σ2 = 2√(m·σ0), then
    shrinks it.

    Parameters
    ----------
    model : Model
        Any.
    v : float
        Velocity [m/s].
    mass : float, optional
        Mass [kg], positive.

    Returns
    -------
    Limits
        `inf` where nothing limits the step; 0 for Euler on an undamped oscillation, and for the jump of the bare law.
        Disturbances that grow by themselves, as on the falling part of the Stribeck curve, limit nothing.

    Raises
    ------
    InputError
        A number is out of range.

    Examples
    --------
    >>> from friction import LuGre, limits
    >>> limits(LuGre(sigma0=500.0), 4.0).euler  # 2g/(σ0·v) = 0.001
    0.001
    """
    check_number("v", v)
    check_number("mass", mass, above=0.0)
    if v == 0.0 and isinstance(model, Coulomb):
        return Limits(0.0, 0.0, ())
    with np.errstate(all="ignore"):
        values = _eigenvalues(model, np.float64(v), np.float64(mass))
    if not np.all(np.isfinite(values)):
        raise InputError("v", "too large", "a velocity whose square is a number", f"{v:g}")
    decaying = [s for s in values if s.real < 0.0 or (s.real == 0.0 and s.imag != 0.0)]
    euler = min((-2.0 * s.real / abs(s) ** 2 for s in decaying), default=inf)
    return Limits(euler, min((_rk4_limit(s) for s in decaying), default=inf), values)


def _eigenvalues(model: Model, v: np.float64, mass: np.float64) -> tuple[complex, ...]:
    """Of the velocity, and of the bristle if there is one."""
    from friction import kernel

    law, sign = model.law, 1.0 if v >= 0.0 else -1.0
    if law.kind == kernel.ZONE and abs(v) <= law.delta:
        return ()
    if law.kind < kernel.BRISTLE:
        slope = sign * kernel.steady(law, v)[1] + law.f_v
        return (complex(-slope / mass),) if slope else ()
    z = sign * float(model.g(v)) / law.sigma0 if v != 0.0 and law.sigma0 else 0.0
    f_v, f_z, z_v, z_z = kernel.jacobian(law, sign, v, z)
    if isinstance(model, Tanh):
        return (complex(-f_v / mass),)
    return tuple(complex(s) for s in np.linalg.eigvals([[-f_v / mass, -f_z / mass], [z_v, z_z]]))


def _rk4_limit(s: complex) -> float:
    """First h at which |R(hs)| = 1 with R(x) = 1 + x + x²/2 + x³/6 + x⁴/24, which is below 3/|s|."""
    direction = s / abs(s)

    def grows(r: float) -> bool:
        x = r * direction
        return abs(1 + x * (1 + x / 2 * (1 + x / 3 * (1 + x / 4)))) > 1.0 + 1e-12

    low, high = 0.0, next((float(r) for r in np.arange(0.05, 4.0, 0.05) if grows(float(r))), 4.0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high / abs(s)
