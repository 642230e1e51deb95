"""Formulas that say beforehand how a method or a model fails, and how large an explicit step may be."""

from math import atanh, inf, log
from typing import NamedTuple

import numpy as np

from friction.models import Coulomb, LuGre, Model, Tanh
from friction.parameters import check_number
from tline.errors import InputError, check_kind


class Chatter(NamedTuple):
    """Chatter of Euler's method for a mass that should rest, from F_a = 0 up to F_c; see `euler_chatter`.

    Attributes
    ----------
    sign_changes : float
        Of the velocity, F_c/(2·slope·h), dimensionless.
    drift : float
        Way by then, h·F_c²/(2·m·slope) [m].
    friction_work : float
        Work of friction, (2/3)·h·F_c³/(m·slope) [J].
    kinetic_energy : float
        Its mean, h²F_c²/(3m) [J].
    """

    sign_changes: float
    drift: float
    friction_work: float
    kinetic_energy: float


def euler_chatter(F_c: float, slope: float, h: float, mass: float = 1.0) -> Chatter:
    """Predict the chatter of Euler's method on F_c·sign v below break-away, a first-order sigma-delta modulator.

    The force is coded in the share of steps with v > 0, (1 + F_a/F_c)/2, and v is spread evenly over an interval of
    length 2hF_c/m about hF_a/m.

    Parameters
    ----------
    F_c : float
        Coulomb friction [N].
    slope : float
        Slope of the ramp [N/s].
    h : float
        Step [s].
    mass : float, optional
        Mass [kg].

    Raises
    ------
    InputError
        A number is not positive.

    Examples
    --------
    >>> from friction import euler_chatter
    >>> euler_chatter(1.0, 0.5, 0.01).sign_changes
    100.0
    """
    for name, value in (("F_c", F_c), ("slope", slope), ("h", h), ("mass", mass)):
        check_number(name, value, above=0.0)
    return Chatter(
        F_c / (2.0 * slope * h),
        h * F_c**2 / (2.0 * mass * slope),
        2.0 / 3.0 * h * F_c**3 / (mass * slope),
        h**2 * F_c**2 / (3.0 * mass),
    )


class DeadZone(NamedTuple):
    """Whether Euler's method with a dead zone comes to rest, and at which velocity.

    Attributes
    ----------
    certain : bool
        Whether no step can jump over the zone.
    escapes : float
        Probability that chatter goes on for ever.
    frozen_low, frozen_high : float
        Range of the velocity that is left [m/s].
    """

    certain: bool
    escapes: float
    frozen_low: float
    frozen_high: float


def dead_zone(delta: float, F_c: float, h: float, F_a: float = 0.0, mass: float = 1.0) -> DeadZone:
    """Capture of a mass by the dead zone |v| <= δ, for Euler's method.

    A step changes v by h(F_c ± |F_a|)/m and cannot jump over the zone if that is at most 2δ. Otherwise, with F_a = 0,
    it misses the zone for ever with probability 1 − 2δm/(h·F_c). Whoever comes from below freezes within
    [−δ, −δ + h(F_c + F_a)/m), and creeps with that velocity for as long as F_a holds.

    Parameters
    ----------
    delta : float
        Half width of the zone [m/s].
    F_c : float
        Coulomb friction [N].
    h : float
        Step [s].
    F_a : float, optional
        Applied force [N], |F_a| < F_c.
    mass : float, optional
        Mass [kg].

    Raises
    ------
    InputError
        A number is out of range.

    Examples
    --------
    >>> from friction import dead_zone
    >>> dead_zone(0.001, 1.0, 0.01).escapes
    0.8
    """
    for name, value in (("delta", delta), ("F_c", F_c), ("h", h), ("mass", mass)):
        check_number(name, value, above=0.0)
    check_number("F_a", F_a)
    if abs(F_a) >= F_c:
        raise InputError("F_a", "breaks away", f"less than F_c = {F_c:g}", f"{F_a:g}")
    certain = 2.0 * delta >= h * (F_c + abs(F_a)) / mass
    escapes = max(0.0, 1.0 - 2.0 * delta * mass / (h * F_c))
    return DeadZone(certain, escapes, -delta, min(-delta + h * (F_c + F_a) / mass, delta))


def tanh_creep(epsilon: float, F_a: float, F_c: float) -> float:
    """Velocity [m/s] with which F_c·tanh(v/ε) gives way to a force that should not move it: ε·atanh(F_a/F_c).

    Parameters
    ----------
    epsilon : float
        Velocity scale of tanh [m/s], positive.
    F_a : float
        Applied force [N], |F_a| < F_c.
    F_c : float
        Coulomb friction [N], positive.

    Raises
    ------
    InputError
        |F_a| is not below F_c, or ε is not positive.

    Examples
    --------
    >>> from friction import tanh_creep
    >>> round(tanh_creep(0.001, 0.5, 1.0), 9)
    0.000549306
    """
    check_number("epsilon", epsilon, above=0.0)
    check_number("F_c", F_c, above=0.0)
    check_number("F_a", F_a)
    if not abs(F_a) < F_c:
        raise InputError("F_a", "breaks away", f"less than F_c = {F_c:g}", f"{F_a:g}")
    return epsilon * atanh(F_a / F_c)


def lugre_drift(model: LuGre, low: float, high: float) -> float:
    """Drift [m] of a LuGre contact in each slow cycle of a force between two loads below break-away.

    Quasi-static: (F_s/σ0)·ln((1 − u1²)/(1 − u2²)) with u1 = low/F_s, u2 = high/F_s. Karnopp's model and the
    elasto-plastic one have none.

    Parameters
    ----------
    model : LuGre
    low, high : float
        Smallest and largest load of a cycle [N].

    Raises
    ------
    InputError
        Not 0 <= low <= high < F_s.

    Examples
    --------
    >>> from friction import LuGre, lugre_drift
    >>> round(lugre_drift(LuGre(), 0.0, 0.6), 9)
    0.000690437
    """
    check_kind("model", model, LuGre)
    for name, load in (("low", low), ("high", high)):
        check_number(name, load)
    if not 0.0 <= low <= high < model.F_s:
        raise InputError("low, high", "out of range", f"0 <= low <= high < F_s = {model.F_s:g}", f"{low}, {high}")
    u1, u2 = low / model.F_s, high / model.F_s
    return model.F_s / model.sigma0 * log((1.0 - u1**2) / (1.0 - u2**2))


def passive_damping(model: LuGre) -> float:
    """Bound of σ1 [N·s/m] below which LuGre is passive from v to F_f: σ2·F_c/(F_s − F_c); inf if F_s = F_c.

    N. Barabanov and R. Ortega, IEEE Trans. Autom. Control 45 (2000) 675, doi:10.1109/9.847100.

    Parameters
    ----------
    model : LuGre

    Examples
    --------
    >>> from friction import LuGre, passive_damping
    >>> round(passive_damping(LuGre()), 12)
    0.25
    """
    check_kind("model", model, LuGre)
    peak = model.F_s - model.F_c
    return model.sigma2 * model.F_c / peak if peak > 0.0 else float("inf")


class Limits(NamedTuple):
    """Largest steps [s] that keep a small disturbance from growing, and the eigenvalues [1/s] they follow from.

    Attributes
    ----------
    euler, rk4 : float
        Steps [s].
    eigenvalues : tuple of complex
        Of velocity and bristle [1/s].
    """

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
    check_kind("model", model, Model)
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
    """Eigenvalues of the velocity, and of the bristle if there is one."""
    from friction.kernel import law as laws

    law, sign = model.law, 1.0 if v >= 0.0 else -1.0
    if law.kind == laws.ZONE and abs(v) <= law.delta:
        return ()
    if law.kind < laws.BRISTLE:
        slope = sign * laws.steady(law, v)[1] + law.f_v
        return (complex(-slope / mass),) if slope else ()
    z = sign * float(model.g(v)) / law.sigma0 if v != 0.0 and law.sigma0 else 0.0
    f_v, f_z, z_v, z_z = laws.jacobian(law, sign, v, z)
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
