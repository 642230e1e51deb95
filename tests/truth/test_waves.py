"""Waves against closed forms, exact lattice sums and inverse Laplace transforms; errors relative to the amplitude."""

from math import comb, exp, factorial, inf

import mpmath
import numpy as np
import pytest
from one_line import one_line

from tline import Scene, simulate
from tline.study.reference import lattice

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # fronts inside slabs

ROUNDING = 1e-13  # some hundred operations in double precision


def cable(*loads, t_end, order, slab, resistance, value=None, step_at=0.0, z0=1.0, delay=1.0, **more):
    """A single line behind a resistance, with loads at its far end."""
    value = {"shape": "step", "to": 1.0, "at": step_at} if value is None else value
    line, solver = more.pop("line", {"z0": z0, "delay": delay}), {"order": order, "slab": slab}
    loads = {f"load {k}": {"at": "far", **load} for k, load in enumerate(loads)}
    return simulate(one_line(t_end, line, value, resistance, loads=loads, solver=solver, **more))


def water_pipe(**closing):
    """A running pipe between a reservoir and an end that closes at t = 0: z0·y0 = 2 bar at 5 bar."""
    scene = {
        "medium": "hydraulic",
        "start": "steady",
        "lines": {"pipe": {"nodes": ["tank", "valve"], "z0": 4e7, "delay": 0.25}},
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": "5 bar"}},
        "probes": {"valve": {"at": "valve"}},
    }
    scene["loads"] |= closing.pop("loads", {})
    return simulate(Scene(**scene, **closing))


@pytest.mark.parametrize(
    "closing",
    [
        {"sources": {"pull": {"at": "valve", "kind": "flow", "value": {"shape": "step", "from": "-5 L/s", "to": 0}}}},
        {"loads": {"valve": {"at": "valve", "kind": "valve", "before": 1e8, "after": inf, "time": 0}}},
    ],
    ids=["flow", "valve"],
)
@pytest.mark.parametrize(("order", "slab"), [(1, 0.25), (3, 0.125), (5, 0.05)])
def test_square_wave_of_an_instant_closure_does_not_drift(closing, order, slab):
    """Joukowsky's z0·y0 and the exact square wave of period 4T, for 10⁴ periods."""
    periods = 10_000
    result = water_pipe(t_end=periods, solver={"order": order, "slab": slab}, **closing)
    valve, per_transit = result.probes["valve"], round(0.25 / slab)
    k = np.arange(len(valve.t))
    sign = np.where((k - 1) // (2 * per_transit) % 2 == 0, 1.0, -1.0)
    exact = np.where(k == 0, 5e5, 5e5 + 2e5 * sign)
    assert np.abs(valve.u - exact).max() < 1e-12 * 2e5
    assert np.abs(valve.y[1:]).max() < 1e-12 * 5e-3


@pytest.mark.parametrize("source", [0.0, 0.2, 1.0, 7.0, inf])
@pytest.mark.parametrize("end", [0.0, 0.5, 1.0, 3.0, inf])
@pytest.mark.parametrize("order", [1, 4])
def test_bounce_sum(source, end, order):
    """A step into any resistances: u = sum of the waves that have arrived, each reflected k times."""
    slab = 1.0 / 8
    result = cable({"kind": "resistor", "resistance": end}, t_end=30, order=order, slab=slab, resistance=source)
    launched = 0.0 if source == inf else 1 / (1 + source)
    here = 1.0 if source == inf else (source - 1) / (source + 1)
    there = 1.0 if end == inf else (end - 1) / (end + 1)
    t = result.t
    near, far = np.where(t > 0, launched, 0.0), np.zeros_like(t)
    for k in range(16):
        wave = launched * (here * there) ** k
        far += (t > 2 * k + 1 + slab / 2) * wave * (1 + there)
        near += (t > 2 * k + 2 + slab / 2) * wave * there * (1 + here)
    assert np.abs(result.probes["far"].u - far).max() < ROUNDING
    assert np.abs(result.probes["near"].u - near).max() < ROUNDING


def rc_step_response(t, step_at, R=3.0, C=0.7, Rs=0.5):
    """Far end of z0 = 1, T = 1 behind Rs with R parallel C: sum over round trips, H2 = -1 + A/(s + p) expanded."""
    p, A, r1 = (R + 1) / (R * C), 2 / C, (Rs - 1) / (Rs + 1)

    def power(k, tau):
        """Step response of H2 to the k."""
        total = (-1.0) ** k
        for j in range(1, k + 1):
            gone = exp(-p * tau) * sum((p * tau) ** m / factorial(m) for m in range(j))
            total += comb(k, j) * (-1.0) ** (k - j) * (A / p) ** j * (1 - gone)
        return total

    out = np.zeros_like(t)
    for i, now in enumerate(t):
        for k in range(5):
            tau = now - step_at - 1 - 2 * k
            if tau > 1e-12:
                out[i] += r1**k * (power(k, tau) + power(k + 1, tau)) / (1 + Rs)
    return out


@pytest.mark.parametrize(
    ("order", "slabs", "step_at", "tolerance"),
    [(5, 4, 0.0, 1e-9), (8, 1, 0.0, 1e-11), (5, 4, 0.371, 2e-7), (8, 4, 0.371, 1e-11)],
)
def test_parallel_rc_load(order, slabs, step_at, tolerance):
    """Sampled sources, interpolation or a first-order load integrator would all fail these bounds."""
    load = {"kind": "parallel", "resistance": 3.0, "capacitance": 0.7}
    far = cable(load, t_end=8, order=order, slab=1 / slabs, resistance=0.5, step_at=step_at).probes["far"]
    since = (far.t - step_at - 1) % 2 * slabs  # slabs from the last front to the slab's end
    clear = (since >= 1) | (far.t < step_at + 1) | (step_at == 0)  # not the front's own slab
    assert np.abs(far.u - rc_step_response(far.t, step_at))[clear].max() < tolerance


def test_series_rlc_load_against_inverse_laplace():
    """A lightly damped resonance: 32 samples per transit, T = 1 ns, ring 2 ns; inverse Laplace at 30 digits."""
    z0, Rs, R, L, C, T = 50.0, 25.0, 10.0, 50e-9, 2e-12, 1e-9
    load = {"kind": "series", "resistance": R, "inductance": L, "capacitance": C}
    far = cable(load, t_end=12 * T, order=8, slab=T / 4, resistance=Rs, z0=z0, delay=T).probes["far"]
    with mpmath.workdps(30):
        unit = mpmath.mpf(T)

        def trip(k):
            """Transform, in units of T, of the k-th wave that arrives, without its delay."""

            def transform(s):
                Z = R + s * L / unit + unit / (s * C)
                H = (Z - z0) / (Z + z0)
                r1 = mpmath.mpf(Rs - z0) / (Rs + z0)
                return z0 / mpmath.mpf(z0 + Rs) * (r1 * H) ** k * (1 + H) / s

            return transform

        check = range(5, len(far.t), 3)
        for i in check:
            now = round(far.t[i] / T * 4) / mpmath.mpf(4)
            exact = sum(
                mpmath.invertlaplace(trip(k), now - 1 - 2 * k, method="talbot") for k in range(6) if now - 1 - 2 * k > 0
            )
            assert abs(far.u[i] - exact) < 1e-8


Y = {"a": ("in", "mid", 1, 0.75), "b": ("mid", "p", 2, 1), "c": ("mid", "q", 0.5, 1.75)}
LOOP = {"a": ("in", "p", 1, 0.5), "b": ("p", "q", 3, 0.75), "c": ("q", "p", 0.3, 1.25)}


@pytest.mark.parametrize("lines", [Y, LOOP], ids=["Y", "loop"])
def test_commensurate_networks_against_the_lattice_in_fractions(lines):
    """A step behind 1/2, resistors 3 and 1/5 at the ends: every wave enumerated exactly."""
    scene = Scene(
        medium="electrical",
        t_end=10,
        solver={"order": 3, "slab": 0.125},
        lines={name: {"nodes": [i, j], "z0": z0, "delay": delay} for name, (i, j, z0, delay) in lines.items()},
        sources={"s": {"at": "in", "kind": "voltage", "value": {"shape": "step", "to": 1}, "resistance": 0.5}},
        loads={name: {"at": name, "kind": "resistor", "resistance": R} for name, R in (("p", 3), ("q", 0.2))},
        probes={name: {"at": name, "line": next(k for k in "bc" if name in lines[k][:2])} for name in "pq"},
    )
    result = simulate(scene)
    mid_way = slice(1, None, 2)  # between the instants at which fronts arrive
    for name, probe in result.probes.items():
        u, y = lattice(scene, probe.t[mid_way].tolist(), name)
        assert np.abs(probe.u[mid_way] - np.array(u, float)).max() < 1e-12
        assert np.abs(probe.y[mid_way] - np.array(y, float)).max() < 1e-12


def test_a_switch_that_closes_inside_a_slab():
    """A closing switch halves the voltage of a matched line; its instant is no multiple of anything."""
    at = 1.2345
    load = {"kind": "switch", "before": inf, "after": 1.0, "time": at}
    far = cable(load, t_end=6, order=6, slab=0.1, resistance=1.0).probes["far"]
    clear = np.abs(far.t - at) > 0.11
    exact = np.where(far.t < 1.05, 0.0, np.where(far.t < at, 1.0, 0.5))
    assert np.abs(far.u - exact)[clear].max() < ROUNDING


def test_a_switch_that_closes_beside_a_capacitor():
    """A matched source charges C through the line; from an instant inside a slab on, R = 0.5 drains it."""
    C, at, slab = 0.7, 1.8321, 0.125
    capacitor, drain = (
        {"kind": "parallel", "capacitance": C},
        {"kind": "switch", "before": inf, "after": 0.5, "time": at},
    )
    result = cable(capacitor, drain, t_end=6, order=6, slab=slab, resistance=1, value={"shape": "step", "to": 2})
    t, u = result.t, result.probes["far"].u
    charged = 2 * (1 - np.exp(-np.clip(t - 1, 0, None) / C))
    there = 2 * (1 - exp(-(at - 1) / C))
    drained = 2 / 3 + (there - 2 / 3) * np.exp(-3 * np.clip(t - at, 0, None) / C)
    clear = (t < at) | (t > at + slab)  # not the slab in which the voltage has its corner
    assert np.abs(u - np.where(t < at, charged, drained))[clear].max() < 1e-10


@pytest.mark.parametrize("at", [1.3, 0.25])
def test_a_switch_that_opens_beside_a_coil_in_steady_flow(at):
    """Before: a divider of Rs, the switch and the coil's R; after: the coil's current settles anew, L/(R + z0)."""
    R, L, shunt = 2.0, 3.0, 0.5
    coil = {"kind": "series", "resistance": R, "inductance": L}
    switch = {"kind": "switch", "before": shunt, "after": inf, "time": at}
    result = cable(coil, switch, t_end=6, order=6, slab=0.125, resistance=1, value=1.0, start="steady")
    t, u = result.t, result.probes["far"].u
    before = 1 / (1 + 1 / shunt + 1 / R)
    first, last = before / R, 1 / (1 + R)
    current = last + (first - last) * np.exp(-(R + 1) / L * (t - at))
    exact = np.where(t <= at, before, 1 - current)
    assert np.abs(u - exact)[np.abs(t - at) > 0.13].max() < 1e-10


def test_a_closed_switch_of_hardly_any_resistance_empties_a_capacitor():
    capacitor = {"kind": "parallel", "capacitance": 1.0}
    switch = {"kind": "switch", "before": inf, "after": 1e-16, "time": 2.0}
    step = {"shape": "step", "to": 2}
    far = cable(capacitor, switch, t_end=4, order=3, slab=0.125, resistance=1, value=step).probes["far"]
    assert far.u[far.t < 1.99].max() > 1.0
    assert np.abs(far.u[far.t > 2.01]).max() < 1e-13


def test_interior_of_a_line_shows_the_two_waves():
    """Matched source, open end: half the step passes x at x/c, the other half at (2l - x)/c."""
    line = {"z0": 50, "length": "2 m", "wave_speed": "2e8 m/s"}
    probes = {"x": {"line": "line", "position": "0.5 m"}, "share": {"line": "line", "position": "25 %"}}
    given = {"order": 4, "slab": "1 ns", "resistance": 50, "value": {"shape": "step", "to": 2}}
    result = cable(t_end=40e-9, line=line, probes=probes, **given)
    t = np.linspace(0, 40e-9, 401) + 0.05e-9
    u = np.where(t < 2.5e-9, 0.0, np.where(t < 17.5e-9, 1.0, 2.0))
    y = np.where(t < 2.5e-9, 0.0, np.where(t < 17.5e-9, 1.0, 0.0)) / 50
    for name in ("x", "share"):
        seen = result.probes[name].at(t[:400])
        assert np.abs(seen.u - u[:400]).max() < ROUNDING
        assert np.abs(seen.y - y[:400]).max() < ROUNDING / 50
