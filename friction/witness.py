"""Check that a run satisfies Newton's law and the friction law, by code that shares nothing with the solver.

At all samples forces and energy are held against their definitions. Over short windows the changes of place, speed,
deflection and works are held against integrals of their rates, by two rules of Clenshaw and Curtis: the difference of
the rules is not held against the run, and windows with an event in them prove nothing.
"""

from collections.abc import Iterator, Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from friction.models import Coulomb, ElastoPlastic, Karnopp, Model, Tanh
from friction.spring_contact import MaxwellSlip, SpringContact
from friction.testbench import Force, Ramp, Sine, Steps, Table, Testbench

WINDOWS, SEED = 32, 5
NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 8)  # of a window; every second one is a node of the rougher rule
DIGITS = 1e-10  # of the largest magnitude of each column: tolerance of exact runs
TIMES_TOLD = 10.0  # by which estimates may be wrong, at single instants
PEAK = 5.0  # times v_s, above which nothing is left of the Stribeck peak
UNCERTAIN = 10.0  # share of the difference of two rules that is not held against a run


def _weights(n: int) -> NDArray:
    """Weights of the rule of Clenshaw and Curtis with n nodes, on an interval of length 1."""
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(n) / (n - 1))
    return np.linalg.solve(np.vander(nodes, increasing=True).T, 1.0 / np.arange(1, n + 1))


FINE, ROUGH = _weights(9), _weights(5)
RANDOM = np.random.default_rng(SEED)
STARTS, WIDTHS = np.sort(RANDOM.random(WINDOWS)), RANDOM.uniform(0.3, 1.0, WINDOWS)
Columns = Mapping[str, NDArray]
Rubbing: TypeAlias = Model | SpringContact
Held: TypeAlias = tuple[
    list[str], NDArray, NDArray, NDArray
]  # names; given, by the laws, and how far these may be apart


def windows(model: Rubbing, bench: Testbench, t_end: float) -> NDArray:
    """Instants [s] at which a run is checked, shape (WINDOWS, 9), in windows no wider than its time scales."""
    widest = 0.01 * t_end
    if isinstance(model, Tanh):
        widest = min(widest, bench.mass * model.epsilon / model.F_c)
    elif not isinstance(model, Coulomb | Karnopp):
        stiffness = sum(model.stiffness) if isinstance(model, MaxwellSlip) else _of(model, "sigma0")
        widest = min(widest, float(np.sqrt(bench.mass / stiffness)))
    pull = bench.spring.stiffness if bench.spring else bench.controller.proportional if bench.controller else 0.0
    if pull:
        widest = min(widest, float(np.sqrt(bench.mass / pull)))
    if isinstance(bench.force, Sine):
        widest = min(widest, 0.25 / bench.force.frequency)
    return (t_end - widest) * STARTS[:, None] + widest * WIDTHS[:, None] * NODES


def doubt(
    model: Rubbing, bench: Testbench, run: Columns, heard: NDArray, told: Mapping[str, float], events: NDArray
) -> str | None:
    """A sentence, if this is not a run of this model on this bench.

    Parameters
    ----------
    model : Model or SpringContact
    bench : Testbench
    run : mapping of str to ndarray
        Columns of the result, by name.
    heard : ndarray
        Their rows in each window, shape (n, 9).
    told : mapping of str to float
        Estimates of errors, relative to the largest magnitude of each column; other columns are exact.
    events : ndarray
        Instants at which the run says that the motion changes.
    """
    with np.errstate(all="ignore"):  # values outside the range of floats are not judged
        for found in (_of_forces(model, bench, run), _of_motion(model, bench, run, heard, told, events)):
            for names, given, other, off in found:
                far = np.abs(given - other)
                if (far > off).any():
                    n, k = np.unravel_index(np.nanargmax(far / off), far.shape)
                    t = run["t"] if given.shape[1] == run["t"].size else run["t"][heard[:, 0]]
                    value = f"{given[n, k]:.6g}, by Newton's law and the law of friction {other[n, k]:.6g}"
                    return f"two methods disagree at {t[k]:.6g} s: {names[n]} is {value}"
    return None


def _of(model: Rubbing, name: str) -> float:
    return float(getattr(model, name, 0.0))


def _applied(force: Force, t: NDArray) -> NDArray:
    """The force of a user [N]."""
    if isinstance(force, Ramp | Sine):
        line = force.offset + force.slope * t
        if isinstance(force, Ramp):
            return line
        return line + force.amplitude * np.sin(2.0 * np.pi * force.frequency * t + force.phase)
    if isinstance(force, Table):
        return np.interp(t, force.times, force.values)
    if isinstance(force, Steps):
        return np.r_[0.0, force.values][np.searchsorted(force.times, t, side="right")]
    return np.full(t.size, np.nan)  # another one; not judged


def _steady(model: Rubbing, v: NDArray) -> NDArray:
    """Stribeck curve [N]."""
    return model.sliding + (model.stiction - model.sliding) * np.exp(-((v / (_of(model, "v_s") or 1.0)) ** 2))


def _slip(model: Rubbing, v: NDArray, z: NDArray) -> NDArray:
    """ż [m/s] of laws with bristles."""
    limit = _steady(model, v) / _of(model, "sigma0")
    share = 1.0
    if isinstance(model, ElastoPlastic):
        angle = np.pi * np.clip((np.abs(z) - model.z_ba) / (limit - model.z_ba), 0.0, 1.0)
        share = np.where(v * z > 0.0, 0.5 - 0.5 * np.cos(angle), 0.0)
    return v - share * np.abs(v) * z / limit


def _of_forces(model: Rubbing, bench: Testbench, run: Columns) -> Iterator[Held]:
    """Applied force and friction at each sample."""
    t, x, v, z, mode, f_a = (run[name] for name in ("t", "x", "v", "z", "mode", "F_a"))
    pull = 0.0 * t
    if spring := bench.spring:
        pull = spring.speed * t - x
        pull = spring.stiffness * (pull - np.clip(pull, -spring.play, spring.play))
    found = f_a if bench.controller else _applied(bench.force, t) + pull
    grain = DIGITS * (np.abs(found).max() + np.abs(x).max() * (bench.spring.stiffness if bench.spring else 0.0))
    if isinstance(bench.force, Steps | Table):  # at jumps both values are right
        corners = np.array(bench.force.times, float)
        after = np.minimum(np.searchsorted(corners, t), corners.size - 1)
        near = np.minimum(np.abs(t - corners[after]), np.abs(t - corners[after - 1])) <= 1e-9 * t[-1]
        found = np.where(near, f_a, found)
    yield ["F_a"], f_a[None], found[None], np.array([[grain]])
    size = np.abs(run["F_f"]).max() + model.stiction
    viscous = (_of(model, "F_v") + _of(model, "sigma2")) * v
    if isinstance(model, Tanh):
        f_f = _steady(model, v) * np.tanh(v / model.epsilon) + viscous
    elif isinstance(model, Coulomb | Karnopp):
        sliding, pushed = _steady(model, v) * np.sign(mode) + viscous, model.stiction * np.sign(mode)
        f_f = np.choose(np.abs(mode), [f_a, sliding, pushed])
        held, zone = mode == 0, _of(model, "delta")
        speed, within = DIGITS * np.abs(v).max() + np.finfo(float).tiny, np.clip(f_a, -model.stiction, model.stiction)
        still = np.where(held, np.clip(v, -zone, zone), v)
        moving = np.where(np.abs(mode) == 1, np.sign(mode) * np.abs(v), v)
        names = ["the speed while stuck", "the speed of sliding", "the force that holds"]
        by_laws, off = [still, moving, np.where(held, within, f_a)], [[speed], [speed], [grain + DIGITS * size]]
        yield names, np.array([v, v, f_a]), np.array(by_laws), np.array(off)
    elif isinstance(model, SpringContact):
        known, way, most = isinstance(model, MaxwellSlip), np.sign(mode), model.stiction
        free = run["F_f"] - _of(model, "F_v") * v * ((mode != 0) | known)
        ends = [way * _steady(model, v)] * 2 if known else [way * model.sliding, way * most]
        low, high = np.where(mode == 0, [[-most], [most]], np.sort(ends, axis=0))
        f_f = np.clip(free, low, high) + run["F_f"] - free
    else:
        rate = _slip(model, v, z)
        size += _of(model, "sigma1") * np.abs(rate).max() + _of(model, "sigma0") * np.abs(z).max()
        f_f = _of(model, "sigma0") * z + _of(model, "sigma1") * rate + viscous
    yield ["F_f"], run["F_f"][None], f_f[None], np.array([[DIGITS * size]])


def _of_motion(
    model: Rubbing, bench: Testbench, run: Columns, heard: NDArray, told: Mapping[str, float], events: NDArray
) -> Iterator[Held]:
    """Energy at each sample, and changes over windows against integrals."""
    m, v = bench.mass, run["v"]
    table = np.array([*run.values()])
    peak = dict(zip(run, np.abs(table).max(axis=1), strict=True))
    off = {name: (DIGITS + TIMES_TOLD * told.get(name, 0.0)) * peak[name] for name in peak}
    gain = 0.5 * m * (v**2 - np.square(bench.v0))
    bar = off["W_a"] + off["W_f"] + m * peak["v"] * off["v"] + DIGITS * m * peak["v"] ** 2
    yield ["the gain of energy"], gain[None], (run["W_a"] - run["W_f"])[None], np.array([[bar]])
    at = dict(zip(run, table[:, heard], strict=True))
    width = at["t"][:, -1] - at["t"][:, 0]
    thrust = off["F_a"] + off["F_f"]
    rates = [
        ("x", at["v"], off["v"]),
        ("v", (at["F_a"] - at["F_f"]) / m, thrust / m),
        ("W_a", at["F_a"] * at["v"], off["F_a"] * peak["v"] + off["v"] * peak["F_a"]),
        ("W_f", at["F_f"] * at["v"], off["F_f"] * peak["v"] + off["v"] * peak["F_f"]),
    ]
    if pid := bench.controller:
        name = "the controller's force without its derivative part"
        at[name] = at["F_a"] - _applied(bench.force, at["t"]) - pid.derivative * (pid.speed - at["v"])
        off[name] = off["F_a"] + pid.derivative * off["v"]
        rate = pid.proportional * (pid.speed - at["v"])
        rate += pid.integral * (pid.target + pid.speed * at["t"] - at["x"])
        if pid.period:
            at[name] = at["F_a"] - _applied(bench.force, at["t"])
            rate = np.zeros_like(rate)
        rates.append((name, rate, pid.proportional * off["v"] + pid.integral * off["x"]))
    stiffness = 0.0 if isinstance(model, SpringContact) else _of(model, "sigma0")
    if stiffness:
        slip = _slip(model, at["v"], at["z"])
        soft = 1.0 + stiffness * peak["z"] / _of(model, "F_c")
        if isinstance(model, ElastoPlastic):
            soft *= 1.0 + np.pi * stiffness * peak["z"] / (model.F_c - stiffness * model.z_ba)
        rates.append(("z", slip, soft * (off["v"] + stiffness * peak["v"] / _of(model, "F_c") * off["z"])))
    even = _undisturbed(model, bench, at, events)
    names, rate = [name for name, *_ in rates], np.array([rate for _, rate, _ in rates])
    change = width * (rate @ FINE)
    unsure = UNCERTAIN * np.abs(change - width * (rate[:, :, ::2] @ ROUGH))
    given = np.array([at[name][:, -1] - at[name][:, 0] for name in names])
    known, wrong = (np.array(each)[:, None] for each in ([off[name] for name in names], [wrong for *_, wrong in rates]))
    bar = 2.0 * known + width * wrong + unsure + np.finfo(float).tiny
    named = [f"the change of {name} in {width.max():.2g} s" for name in names]
    yield named, given, np.where(even, change, given), bar


def _undisturbed(model: Rubbing, bench: Testbench, at: Columns, events: NDArray) -> NDArray:
    """Windows in which neither the motion changes, nor the force its law; a controller at its limit has none.

    Nor does the speed pass the Stribeck peak between two nodes, which neither rule would resolve.
    """
    t, v, force, pid = at["t"], at["v"], bench.force, bench.controller
    slow = np.minimum(np.abs(v[:, 1:]), np.abs(v[:, :-1])) < PEAK * _of(model, "v_s")
    hit = (slow & (np.abs(np.diff(v)) > _of(model, "v_s"))).any(axis=1)
    hit |= np.ptp(at["mode"], axis=1) > 0  # as where a dead zone ends, which is no event
    if pid and pid.period:
        hit |= np.ptp(np.ceil((t[:, [0, -1]] - pid.delay) / pid.period + 1e-9 * np.array([-1, 1])), axis=1) > 0
    elif bench.spring and bench.spring.play:
        slack = np.abs(bench.spring.speed * t - at["x"]) < bench.spring.play
        hit |= np.ptp(slack.astype(int), axis=1) > 0
    elif pid and pid.limit is not None:
        hit |= (np.abs(at["F_a"] - _applied(force, t)) >= pid.limit * (1.0 - 1e-9)).any(axis=1)
    for instants in (events, force.times if isinstance(force, Steps | Table) else []):
        hit |= np.searchsorted(instants, t[:, 0]) != np.searchsorted(instants, t[:, -1], side="right")
    return ~hit & ((v >= 0.0).all(axis=1) | (v <= 0.0).all(axis=1))
