"""Limit cycles of a controlled mass with dry friction, by harmonic balance; cycles that stick are not covered.

To a swing v = V sin(ωt) friction is, in its first harmonic, a damping N(V) = F_v + 4/(πV)·(F_c + (F_s − F_c)·D(a)/a)
with a = V/v_s and Dawson's integral D, and a limited controller a gain k(A) <= 1 of its amplitude A (A. Gelb and
W. E. Vander Velde, Multiple-Input Describing Functions, 1968, sections 2.3 and 2.4). The swing holds itself where
m·(jω)² + N(V)·jω + k(A)·C(jω) = 0. A sampled controller is its continuous twin late by its delay and half a period.
"""

from collections.abc import Callable, Sequence
from math import asin, pi, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.models import Coulomb, Karnopp
from friction.testbench import Testbench
from tline.errors import InputError, as_numbers, check_kind

SPAN, POINTS = 1e3, 4000  # range of angular frequencies about √(P/m), and their number


class Swing(NamedTuple):
    """A swing that holds itself, by harmonic balance.

    Attributes
    ----------
    amplitude : float
        Of the place [m].
    period : float
        Time of a cycle [s].
    attracts : bool
        Whether swings near it come to it; else smaller ones die out and larger ones grow.
    """

    amplitude: float
    period: float
    attracts: bool


def harmonic_damping(model: Coulomb | Karnopp, amplitude: ArrayLike) -> NDArray:
    """Damping N(V) [N s/m] that dry friction is to swings of these amplitudes of velocity.

    Parameters
    ----------
    model : Coulomb or Karnopp
    amplitude : array_like
        V [m/s], positive.

    Examples
    --------
    >>> import math
    >>> from friction import Coulomb, harmonic_damping
    >>> float(harmonic_damping(Coulomb(F_c=math.pi), 2.0))
    2.0
    """
    from scipy.special import dawsn

    check_kind("model", model, Coulomb, Karnopp)
    v, law = as_numbers("amplitude", amplitude), model.law
    a = v / law.v_s
    return law.f_v + 4.0 / (np.pi * v) * (law.f_c + (law.f_s - law.f_c) * dawsn(a) / a)


def swings(model: Coulomb | Karnopp, bench: Testbench) -> list[Swing]:
    """Swings under the bench's controller that hold themselves, by harmonic balance, smallest first.

    Parameters
    ----------
    model : Coulomb or Karnopp
        Without a dead zone.
    bench : Testbench
        With a controller.

    Raises
    ------
    InputError
        Another law, or no controller that pulls back.

    Examples
    --------
    Pushes that are small die out, larger ones grow:

    >>> from friction import PID, Coulomb, Ramp, Testbench, swings
    >>> (found,) = swings(Coulomb(), Testbench(Ramp(0.0), controller=PID(100.0, 700.0, 5.0)))
    >>> round(found.amplitude, 9), round(found.period, 9), found.attracts
    (0.063661977, 0.628318531, False)
    """
    check_kind("bench", bench, Testbench)
    pid, m = bench.controller, float(bench.mass)
    if not isinstance(model, Coulomb | Karnopp) or not pid or not pid.proportional:
        raise InputError("bench.controller", "no harmonic balance", "coulomb or karnopp, and a PID that pulls back")
    late = pid.delay + 0.5 * pid.period
    middle = np.sqrt(pid.proportional / m)

    def asked(omega: ArrayLike) -> Any:
        w = np.asarray(omega, float)
        return (pid.proportional + pid.integral / (1j * w) + 1j * w * pid.derivative) * np.exp(-1j * w * late)

    def damping(omega: ArrayLike) -> NDArray:
        """Return N(V) for a balance at ω, with the gain k(A) that balances inertia there."""
        w, c = np.asarray(omega, float), asked(omega)
        return -m * w * c.imag / c.real

    omega = middle * np.geomspace(1.0 / SPAN, SPAN, POINTS)
    free = _roots(lambda w: float(asked(w).real - m * w**2), omega)
    found = []
    for w in free:
        needed = float(damping(w))
        if (v := _amplitude(model, needed)) and (pid.limit is None or abs(asked(w)) * v / w <= pid.limit):
            found.append(Swing(v / w, 2.0 * np.pi / w, False))
    if pid.limit is not None:
        limit = float(pid.limit)

        def velocity(w: float) -> float:
            """V at which the limit leaves the gain mω²/Re C."""
            c = asked(w)
            return w * limit / _share(m * w**2 / float(c.real)) / float(abs(c))

        def excess(w: float) -> float:
            return float(harmonic_damping(model, velocity(w)) - damping(w))

        gains = m * omega**2 / asked(omega).real
        inside = (gains > 0.0) & (gains < 1.0)
        for k in np.flatnonzero(inside[:-1] & inside[1:]):
            for w in _roots(excess, omega[k : k + 2]):
                step = 1e-6 * w
                grows = (excess(w + step) - excess(w - step)) * (velocity(w + step) - velocity(w - step))
                found.append(Swing(velocity(w) / w, 2.0 * np.pi / w, bool(grows > 0.0)))
    return sorted(found)


def _amplitude(model: Coulomb | Karnopp, damping: float) -> float:
    """V at which friction damps so, 0 if none does."""
    law = model.law
    if damping <= law.f_v:
        return 0.0
    most, least = (4.0 * f / (np.pi * (damping - law.f_v)) for f in (law.f_s, law.f_c))
    (v,) = _roots(lambda v: float(harmonic_damping(model, v)) - damping, [0.999 * least, 1.001 * most])
    return v


def _share(gain: float) -> float:
    """Limit over amplitude at which a limit has this gain, below 1: k = 2/π·(asin u + u·√(1 − u²))."""
    (u,) = _roots(lambda u: 2.0 / pi * (asin(u) + u * sqrt(1.0 - u * u)) - gain, [0.0, 1.0])
    return u


def _roots(function: Callable[[float], float], grid: NDArray | Sequence[float]) -> list[float]:
    """Zeros between neighbours of different signs."""
    from scipy.optimize import brentq

    solve: Any = brentq
    values = np.sign([function(float(x)) for x in grid])
    return [
        float(solve(function, grid[k], grid[k + 1], xtol=1e-300, rtol=1e-14))
        for k in np.flatnonzero(values[:-1] * values[1:] < 0).tolist()
    ]
