"""Friction laws and applied forces, as compiled code takes them.

Symbols: x, v place and velocity, z bristle deflection, F_a applied force, F_f friction force, g(v) steady friction of
the Stribeck curve, W_a and W_f their work; s the sign of v that a step keeps.
"""

from math import atanh, copysign, cos, exp, inf, pi, sin, tanh
from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats
from tline.compiled.unit import function

SIGN, ZONE, BRISTLE, TANH = range(4)  # kinds of law
DONE, BUDGET, BLOWN_UP, STALLED, INACCURATE = range(5)  # how a run can end
T, X, V, Z, FA, FF, WA, WF, MODE = range(9)  # columns of a record
STEADY = 0.99  # share of the steady friction at which the contact of a smooth law slides


class Law(NamedTuple):
    """A friction law: F_c, F_s, F_v (σ2), v_s, half width δ of the dead zone; σ0, σ1, z_ba; ε of tanh."""

    kind: int
    f_c: float
    f_s: float
    f_v: float
    v_s: float
    delta: float = 0.0
    sigma0: float = 0.0
    sigma1: float = 0.0
    z_ba: float = -1.0  # negative: bristles slip at any deflection, as LuGre's do
    epsilon: float = 1.0


class Drive(NamedTuple):
    """Applied force: straight pieces (start, value there, slope), a sine, and a pull of the mass towards a target.

    The pull is a controller, with e = target + speed·t − x, or a spring, which is its proportional part.
    """

    start: Floats
    value: Floats
    slope: Floats
    amplitude: float = 0.0
    omega: float = 0.0
    phase: float = 0.0
    stiffness: float = 0.0
    speed: float = 0.0
    target: float = 0.0
    integral: float = 0.0  # gain of ∫e dt, N/(m s)
    derivative: float = 0.0  # gain of de/dt, N s/m


class Push(NamedTuple):
    """The applied force while one of the pieces lasts; numbers only, since calls with arrays count references."""

    start: float
    end: float
    value: float
    slope: float
    amplitude: float
    omega: float
    phase: float
    stiffness: float
    speed: float


@function
def piece(drive, i):
    """Piece i of the applied force."""
    end = drive.start[i + 1] if i + 1 < drive.start.size else inf
    return Push(
        drive.start[i], end, drive.value[i], drive.slope[i], drive.amplitude, drive.omega, drive.phase, drive.stiffness,
        drive.speed,
    )  # fmt: skip


@function
def push_at(drive, t):
    """Return the piece of the applied force that holds at t and just after."""
    low, high = 0, drive.start.size
    while low + 1 < high:
        middle = (low + high) // 2
        if drive.start[middle] <= t:
            low = middle
        else:
            high = middle
    return piece(drive, low)


@function
def applied(push, t, x):
    """Applied force and its partial derivative in time."""
    force = push.value + push.slope * (t - push.start) + push.stiffness * (push.speed * t - x)
    rate = push.slope + push.stiffness * push.speed
    if push.amplitude != 0.0:
        angle = push.omega * t + push.phase
        force += push.amplitude * sin(angle)
        rate += push.amplitude * push.omega * cos(angle)
    return force, rate


@function
def steady(law, v):
    """g(v) and its derivative."""
    peak = (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
    return law.f_c + peak, -2.0 * v / law.v_s**2 * peak


@function
def slip_share(law, s, z, g):
    """α of the elasto-plastic model, Dupont et al. (2002), with its derivatives in z and in z_ss = g/σ0."""
    if law.z_ba < 0.0:
        return 1.0, 0.0, 0.0
    z_ss, bend = g / law.sigma0, abs(z)
    if s * z <= 0.0 or bend <= law.z_ba:
        return 0.0, 0.0, 0.0
    if bend >= z_ss:
        return 1.0, 0.0, 0.0
    width = z_ss - law.z_ba
    angle = pi * (bend - 0.5 * (z_ss + law.z_ba)) / width
    steep = 0.5 * cos(angle) * pi / width
    return 0.5 + 0.5 * sin(angle), copysign(steep, z), -steep * (bend - law.z_ba) / width


@function
def respond(law, s, v, z):
    """F_f and ż of a smooth law, with |v| read as s·v."""
    g = law.f_c + (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
    if law.kind == TANH:
        return g * tanh(v / law.epsilon) + law.f_v * v, 0.0
    rate = v - slip_share(law, s, z, g)[0] * law.sigma0 * s * v * z / g
    return law.sigma0 * z + law.sigma1 * rate + law.f_v * v, rate


@function
def jacobian(law, s, v, z):
    """Derivatives of F_f in v and z, and of ż in v and z."""
    g, slope = steady(law, v)
    if law.kind == TANH:
        bend = tanh(v / law.epsilon)
        return slope * bend + g * (1.0 - bend**2) / law.epsilon + law.f_v, 0.0, 0.0, 0.0
    share, share_z, share_ss = slip_share(law, s, z, g)
    full = law.sigma0 * s * v * z / g
    rate_v = 1.0 - share * (law.sigma0 * s * z - full * slope) / g - share_ss * slope / law.sigma0 * full
    rate_z = -share * law.sigma0 * s * v / g - share_z * full
    return law.sigma1 * rate_v + law.f_v, law.sigma0 + law.sigma1 * rate_z, rate_v, rate_z


@function
def friction(law, v, z, f_a):
    """F_f and ż of any law, as a solver that knows nothing of events meets it."""
    if law.kind >= BRISTLE:
        return respond(law, 1.0 if v >= 0.0 else -1.0, v, z)
    if law.kind == ZONE and abs(v) <= law.delta:
        return min(max(f_a, -law.f_s), law.f_s), 0.0
    return (0.0 if v == 0.0 else copysign(steady(law, v)[0], v)) + law.f_v * v, 0.0


@function
def slopes(law, push, mass, t, y, out):
    """Time derivatives of x, v, z, W_a, W_f."""
    f_a = applied(push, t, y[0])[0]
    f_f, rate = friction(law, y[1], y[2], f_a)
    out[0], out[1], out[2] = y[1], (f_a - f_f) / mass, rate
    out[3], out[4] = f_a * y[1], f_f * y[1]


@function
def note(row, t, y, f_a, f_f, mode):
    """Keep a state with its forces and mode in a row of a record."""
    row[T], row[X], row[V], row[Z], row[WA], row[WF] = t, y[0], y[1], y[2], y[3], y[4]
    row[FA], row[FF], row[MODE] = f_a, f_f, mode


@function
def gap(law, v, z):
    """Excess of friction over 99 % of its steady value, in the direction of the motion; a velocity for tanh."""
    if law.kind == TANH:
        return abs(v) - law.epsilon * atanh(STEADY)
    g = law.f_c + (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
    return law.sigma0 * (z if v > 0.0 else -z) - STEADY * g if v != 0.0 else -g


@function
def mode_of(law, mode, v, z, f_a):
    """Sign of the motion, 0 if the mass is held, for a method without events; `mode` is the previous one."""
    way = int(np.sign(v))
    if law.kind == SIGN:
        return way
    if law.kind == ZONE:
        return 0 if abs(v) <= law.delta and abs(f_a) <= law.f_s else way
    if gap(law, v, z) >= 0.0:
        return way
    return mode if way == mode else 0


@function
def row_of(events, met):
    """Row of an event in their list; those beyond its end are counted, and share its last row."""
    return min(met, events.shape[0] - 1)


@function
def put(events, met, before, after, t, x):
    """List an event; returns how many there are then."""
    row = row_of(events, met)
    events[row, 0], events[row, 1], events[row, 2], events[row, 3] = before, after, t, x
    return met + 1
