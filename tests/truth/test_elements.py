"""Non-linear elements at the end of one line: recursions per bounce in 40 digits, and independent integrations."""

import math
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from method_of_steps import NODES, WEIGHTS
from one_line import FAR, from_tank, one_line
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tline import Scene, simulate
from tline.scene.characteristic import BOLTZMANN, CHARGE
from tline.scene.pump_curves import TABLES

Z0, DELAY, HEAD, KV = 2e7, 0.1, 6e5, 120.0
CAPACITY = KV / 3600 / 1e5**0.5
TANK = {"at": "tank", "kind": "reservoir", "pressure": HEAD}
RAMP = {"shape": "ramp", "from": 1, "to": 0, "at": 0.05, "duration": 0.73}


def pipe(loads: dict, *, delay: float = DELAY, t_end: float = 2.0, order: int = 8, slab: float = 0.05, **more) -> Scene:
    """A pipe from a tank to whatever is at its end."""
    solver = {"order": order, "slab": slab}
    return from_tank(t_end, {"z0": Z0, "delay": delay}, HEAD, loads, solver=solver, **more)


def share(t: float) -> float:
    """Opening of the ramp."""
    return min(max(1 - (mp.mpf(t) - mp.mpf("0.05")) / mp.mpf("0.73"), 0), 1)


def through_valve(a, capacity):
    """Flow i with a = u + z i and i = capacity·sign(u)·sqrt|u|, as the root of a quadratic."""
    sign = -1 if a < 0 else 1
    half = mp.mpf(capacity) ** 2 * Z0 / 2
    return sign * (-half + mp.sqrt(half**2 + mp.mpf(capacity) ** 2 * abs(a)))


def bounces(t: float, delay: float, start: tuple, flow) -> mp.mpf:
    """Effort at the end at instant t, by the recursion per bounce: the tank sends back 2·HEAD - b."""
    effort, y = start
    times = [mp.mpf(float(t)) - 2 * k * mp.mpf(delay) for k in range(int(t / (2 * delay)) + 1)][::-1]
    a = effort + Z0 * y
    u = effort
    for k, instant in enumerate(times):
        if k > 0:
            a = 2 * HEAD - (2 * u - a)
        u = a - Z0 * flow(a, instant)
    return u


@pytest.mark.parametrize(("delay", "slab"), [(0.1, 0.05), (0.1, 0.04), (0.0873, 0.05)])
def test_a_valve_shut_linearly_is_allievis_chain(delay, slab):
    """Allievi (1913): the interlocked equations, in waves. Corners are fronts; delays need be no whole slabs."""
    with mp.workdps(40):
        result = simulate(
            pipe({"v": {"at": "end", "kind": "orifice", "kv": KV, "opening": RAMP}}, delay=delay, slab=slab)
        )
        probe = result.probes["end"]
        y = CAPACITY * mp.sqrt(HEAD)
        exact = [bounces(t, delay, (HEAD, y), lambda a, s: through_valve(a, CAPACITY * share(s))) for t in probe.t[1:]]
    assert np.abs(probe.u[1:] - np.array(exact, float)).max() < 1e-10 * HEAD
    assert probe.u.max() > 1.2 * HEAD


def test_a_valve_shut_at_once_is_joukowskys_surge():
    """N. Joukowsky (1898): the pressure rises by z0 times the flow that is stopped."""
    shut = {"shape": "step", "from": 1, "to": 0, "at": 0.05}
    probe = simulate(pipe({"v": {"at": "end", "kind": "orifice", "kv": KV, "opening": shut}})).probes["end"]
    flow = CAPACITY * HEAD**0.5
    assert probe.y[0] == pytest.approx(flow, rel=1e-13)
    after = (probe.t > 0.051) & (probe.t < 0.249)
    assert probe.u[after] == pytest.approx(HEAD + Z0 * flow, rel=1e-13)


@pytest.mark.parametrize(
    "way",
    [
        {"kv": KV},
        {"cv": KV * 1e-3 / 3.6 * (6894.757293168361 / 1e5) ** 0.5 / (3.785411784e-3 / 60)},
        {"flow": CAPACITY * 1e3, "pressure_drop": 1e6},
        {"loss_coefficient": 2.0, "area": CAPACITY * 1000**0.5},
        {"loss_coefficient": 8.0, "diameter": (4 / np.pi * 2 * CAPACITY * 1000**0.5) ** 0.5},
    ],
)
def test_all_ways_to_give_a_capacity_agree(way):
    result = simulate(pipe({"v": {"at": "end", "kind": "orifice"} | way}, t_end=0.2))
    assert result.probes["end"].y[0] == pytest.approx(CAPACITY * HEAD**0.5, rel=1e-12)


def test_a_valve_with_a_characteristic_is_the_composed_opening():
    """Straight from 1 to 0 through (0.5, 0.2): shares of the capacity in two straight pieces."""
    valve = {"at": "end", "kind": "orifice", "kv": KV, "characteristic": [[0, 0], [0.5, 0.2], [1, 1]], "opening": RAMP}
    half, end = 0.05 + 0.73 / 2, 0.05 + 0.73
    same = {"shape": "piecewise linear", "points": [[0.05, 1], [half, 0.2], [end, 0]]}
    one = simulate(pipe({"v": valve})).probes["end"].u
    other = simulate(pipe({"v": {"at": "end", "kind": "orifice", "kv": KV, "opening": same}})).probes["end"].u
    assert np.abs(one - other).max() < 1e-12 * HEAD


@pytest.mark.parametrize("load", ["diode", "clamp", "table"])
def test_a_cable_with_a_non_linear_end(load):
    """A ramp through 20 ohm into 50 ohm; at the far end a law whose flow is found per bounce in 40 digits."""
    z0, rs, delay, emf, rise = 50, 20, 1.0, 5, 0.75
    saturation, thermal = 1e-14, float(BOLTZMANN * 300.15 / CHARGE)
    points = [[-1, -0.01], [0, 0], [1, 0.002], [1.5, 0.04]]
    loads = {
        "diode": {"kind": "diode", "saturation": saturation},
        "clamp": {"kind": "diode", "saturation": saturation, "reverse": True},
        "table": {"kind": "table", "points": points},
    }
    sign = -1 if load == "clamp" else 1

    def law(a):
        if load == "table":
            for (u, i), (v, j) in pairwise(points):
                slope = (mp.mpf(j) - i) / (mp.mpf(v) - u)
                found = (slope * a + i - slope * mp.mpf(u)) / (1 + z0 * slope)
                if a - z0 * found <= v or v == points[-1][0]:
                    return found
        p, k = mp.mpf(saturation), mp.mpf(thermal)
        x = a * sign
        return sign * (k / z0 * mp.lambertw(z0 * p / k * mp.exp((x + z0 * p) / k)).real - p)

    value = {"shape": "ramp", "from": 0, "to": sign * emf, "duration": rise}
    solver = {"order": 10, "slab": 0.125}
    scene = one_line(12.0, {"z0": z0, "delay": delay}, value, rs, loads[load], solver=solver, probes=FAR)
    probe = simulate(scene).probes["far"]

    with mp.workdps(40):

        def source(t):
            return mp.mpf(sign * emf) * min(max(mp.mpf(float(t)) / rise, 0), 1)

        exact = []
        for t in probe.t:
            a, b, u = mp.mpf(0), mp.mpf(0), mp.mpf(0)
            for k in range(int(t // 2) + 1, 0, -1):
                left = t - (2 * k - 1) * delay  # when it leaves the near end
                a = 2 * (source(left) * z0 + b * rs) / (z0 + rs) - b if left >= 0 else mp.mpf(0)
                u = a - z0 * law(a)
                b = 2 * u - a
            exact.append(u)
    exact = np.array(exact, float)
    assert np.abs(exact).max() > 0.5
    near_corner = np.zeros(len(exact), bool)
    if load == "table":  # bends of the table are no fronts: what they cut off is cut off in their slab alone
        near_corner = np.r_[True, np.abs(np.diff(exact, 2)) > 1e-9, True]
    assert np.abs(probe.u - exact)[~near_corner].max() < 1e-9 * emf


def test_a_surge_tank_swings_as_its_characteristic_equation_says():
    """Tunnel with elastic walls and no friction: tan(ωT) = 1/(ω C z0), one mode after the other."""
    area, flow, delay = 3.0, 0.05, 1.0
    capacitance, z0 = area / (1000 * 9.80665), Z0 / 20
    scene = Scene(
        medium="hydraulic",
        t_end=60.0,
        start="steady",
        lines={"tunnel": {"nodes": ["tank", "shaft"], "z0": z0, "delay": delay}},
        sources={"turbine": {"at": "shaft", "kind": "flow", "value": {"shape": "step", "from": -flow, "to": 0}}},
        loads={"tank": TANK, "shaft": {"at": "shaft", "kind": "surge tank", "tank_area": area}},
        probes={"shaft": {"at": "shaft"}},
        solver={"order": 6, "slab": 0.25},
    )
    probe = simulate(scene).probes["shaft"]
    target = delay / (z0 * capacitance)
    low, high = np.arange(4000) * np.pi, (np.arange(4000) + 0.5) * np.pi
    for _ in range(60):  # κ tan κ = T/(z0 C), halved on each branch
        kappa = (low + high) / 2
        beyond = kappa * np.tan(kappa) > target
        low, high = np.where(beyond, low, kappa), np.where(beyond, kappa, high)
    size = z0 * flow * (np.sin(kappa) / kappa) / (0.5 + np.sin(2 * kappa) / (4 * kappa))
    exact = HEAD + (size * np.sin(kappa)) @ np.sin(np.outer(kappa / delay, probe.t))
    assert np.ptp(exact) > 0.05 * z0 * flow
    assert np.abs(probe.u - exact).max() < 3e-8 * z0 * flow  # what 4000 modes leave out


def in_steps(rhs, send, first: float, start: float, back: float, t_end: float) -> list:
    """Integrate x' = rhs(t, x, a) where a(t) = 2·HEAD - send(t - 2T), one round trip after the other.

    Steps are short, for DOP853 overlooks the error of a long one in which a flow turns.
    """
    pieces = [lambda t: (np.full(np.shape(t), first), np.full(np.shape(t), back))]
    x, t = start, 0.0
    while t < t_end:
        last = pieces[-1]

        def arriving(s, last=last):
            return 2 * HEAD - last(s - 2 * DELAY)[1]

        done = solve_ivp(
            lambda s, x, arriving=arriving: rhs(s, x, arriving(s)), (t, t + 2 * DELAY), [x], "DOP853",
            dense_output=True, rtol=1e-13, atol=1e-15, max_step=DELAY / 40,
        )  # fmt: skip

        begin, width = done.t[:-1, None], np.diff(done.t)[:, None]
        s = (begin + width * NODES).ravel()
        x_there, a_there = done.sol(s)[0], arriving(s)
        held = np.stack([x_there, send(s, x_there, a_there)]).reshape(2, len(begin), -1)

        def piece(s, held=held, knots=done.t):
            """By the polynomial of the step through Chebyshev's points, lest each trip asks all those before it."""
            k = np.clip(np.searchsorted(knots, s) - 1, 0, held.shape[1] - 1)
            apart = ((s - knots[k]) / (knots[k + 1] - knots[k]))[..., None] - NODES
            share = WEIGHTS / np.where(apart == 0.0, 1e-300, apart)
            return (held[:, k] * share).sum(-1) / share.sum(-1)

        pieces.append(piece)
        x, t = done.y[0, -1], t + 2 * DELAY
    return pieces[1:]


def effort(pieces: list, t: float) -> float:
    """Half of what arrives and what leaves, from the second round trip on."""
    k = int(np.ceil(t / (2 * DELAY) - 1e-9)) - 1
    leaves = pieces[min(k, len(pieces) - 1)](t)[1]
    return (2 * HEAD - pieces[k - 1](t - 2 * DELAY)[1] + leaves) / 2


@pytest.mark.parametrize("loss", [{}, {"kv": 300.0}])
def test_an_air_vessel_is_its_differential_equation(loss):
    """The valve beyond the vessel's pipe shuts; integrated round trip by round trip with DOP853 at 1e-13."""
    n, volume, outside, flow = 1.2, 0.02, 101_325.0, 0.01
    c = (HEAD + outside) * volume**n
    k = 0.0 if not loss else (1e5 * 3600**2) / loss["kv"] ** 2
    stop = {"shape": "step", "from": -flow, "to": 0}
    vessel = {"at": "end", "kind": "air vessel", "gas_volume": volume, "gas_pressure": HEAD, "exponent": n}
    sources = {"out": {"at": "end", "kind": "flow", "value": stop}}
    probe = simulate(pipe({"vessel": vessel | loss}, sources=sources, t_end=1.6, slab=0.0125)).probes["end"]

    def inflow(gas, a):
        d = a - (c * gas**-n - outside)
        return 2 * d / (Z0 + np.sqrt(Z0**2 + 4 * k * np.abs(d)))

    def send(t, gas, a):
        return a - 2 * Z0 * inflow(gas, a)

    pieces = in_steps(lambda t, x, a: -inflow(x, a), send, volume, volume, HEAD - Z0 * flow, 1.6)
    later = probe.t > 2 * DELAY + 1e-9
    exact = [effort(pieces, t) for t in probe.t[later]]
    assert np.abs(probe.u[later] - exact).max() < 4e-9 * HEAD  # what DOP853 interpolates where the flow turns
    assert np.ptp(probe.u) > 0.05 * HEAD


@pytest.mark.parametrize(("check_valve", "lift"), [(False, 2e5), (True, 2e5), (False, 8e5)])
def test_a_pump_that_trips_is_its_differential_equation(check_valve, lift):
    """It lifts from one tank through a pipe to another; its rotor's equation integrated round trip by round trip.

    The highest tank presses liquid back through it from the start, which turns it faster than at its rated speed.
    """
    inertia, turns, point = 0.5, 24.0, (0.02, HEAD + 2e5)
    h0, bend = 4 / 3 * point[1], point[1] / 3 / point[0] ** 2
    energy = inertia * (2 * np.pi * turns) ** 2
    pump = {
        "kind": "pump", "nodes": ["sump", "end"], "curve": [point], "trip": 0.1, "inertia": inertia,
        "rated_speed": turns, "check_valve": check_valve,
    }  # fmt: skip
    sump = {"at": "sump", "kind": "reservoir", "pressure": -lift}
    scene = pipe({"sump": sump}, links={"pump": pump}, t_end=2.0, order=6, slab=0.025 if check_valve else 0.0025)
    probe = simulate(scene).probes["end"]

    def flow(speed, a):
        d = -lift - a + h0 * speed**2
        q = 2 * d / (Z0 + np.sqrt(Z0**2 + 4 * bend * np.abs(d)))
        return np.maximum(q, 0) if check_valve else q

    def slower(t, speed, a):
        return -h0 * speed * flow(speed, a) / energy

    left = h0 - lift - HEAD
    q = math.copysign(abs(left / bend) ** 0.5, left)
    assert -probe.y[0] == pytest.approx(q, rel=1e-12)
    pieces = in_steps(slower, lambda t, x, a: a + 2 * Z0 * flow(x, a), 1.0, 1.0, HEAD + Z0 * q, 2.0)
    later = probe.t > 0.1 + 2 * DELAY + 1e-9
    exact = [effort(pieces, t - 0.1) for t in probe.t[later]]
    assert np.abs(probe.u[later] - exact).max() < 2e-9 * h0
    assert np.ptp(probe.u) > 0.1 * HEAD


def test_a_pump_that_starts_is_its_differential_equation():
    """Its motor turns it up from rest between equal tanks; integrated round trip by round trip until it runs.

    Then it holds its speed, and the pipe settles to the flow at which it lifts nothing.
    """
    inertia, turns, point, torque = 1.0, 24.0, (0.02, HEAD + 2e5), 400.0
    h0, bend = 4 / 3 * point[1], point[1] / 3 / point[0] ** 2
    energy, motor = inertia * (2 * np.pi * turns) ** 2, torque * 2 * np.pi * turns
    pump = {
        "kind": "pump", "nodes": ["sump", "end"], "curve": [point], "start": 0.1, "inertia": inertia,
        "rated_speed": turns, "motor_torque": torque,
    }  # fmt: skip
    sump = {"at": "sump", "kind": "reservoir", "pressure": HEAD}
    probe = simulate(pipe({"sump": sump}, links={"pump": pump}, t_end=9.0, order=6, slab=0.005)).probes["end"]

    def flow(speed, a):
        d = HEAD - a + h0 * speed**2
        return 2 * d / (Z0 + np.sqrt(Z0**2 + 4 * bend * np.abs(d)))

    def faster(t, speed, a):
        return (motor - h0 * speed * flow(speed, a)) / energy

    pieces = in_steps(faster, lambda t, x, a: a + 2 * Z0 * flow(x, a), 0.0, 0.0, HEAD, 2.0)
    assert np.abs(probe.y[probe.t < 0.1]).max() < 1e-6 * point[0]  # the root of a rounding
    runs = brentq(lambda t: pieces[int(t // (2 * DELAY))](t)[0] - 1, 0.05, 0.6)
    until = (probe.t > 0.1 + 2 * DELAY + 1e-9) & (probe.t < 0.1 + runs)
    exact = [effort(pieces, t - 0.1) for t in probe.t[until]]
    assert np.abs(probe.u[until] - exact).max() < 2e-8 * h0
    assert np.ptp(probe.u[until]) > 0.1 * HEAD
    assert -probe.y[-1] == pytest.approx((h0 / bend) ** 0.5, rel=1e-3)


@pytest.mark.parametrize("quadrants", TABLES)
def test_a_pump_that_runs_backward_is_its_four_quadrants(quadrants):
    """The liquid comes back and turns the rotor: Suter's tables, straight over the angle, and Heun's steps of 0.5 ms.

    Their error, and that of the parabolas between two angles, is 2e-3 of the rated rise.
    """
    inertia, turns, (flow, rise), sump, efficiency, step = 0.3, 24.0, (0.02, 5e5), 1.5e5, 0.8, 5e-4
    power, table = flow * rise / efficiency, TABLES[quadrants]
    pump = {
        "kind": "pump", "nodes": ["sump", "end"], "curve": [(flow, rise)], "quadrants": quadrants, "trip": 0.1,
        "inertia": inertia, "rated_speed": turns, "efficiency": efficiency,
    }  # fmt: skip
    below = {"sump": {"at": "sump", "kind": "reservoir", "pressure": sump}}
    probe = simulate(pipe(below, links={"pump": pump}, t_end=3.0, order=5, slab=0.005)).probes["end"]

    def form(values, speed, q):
        at = (math.atan2(q / flow, speed) / math.pi + 1) * 44
        k = min(int(at), 87)
        return (speed**2 + (q / flow) ** 2) * (values[k] + (at - k) * (values[k + 1] - values[k]))

    def through(speed, a):
        return brentq(lambda q: sump + rise * form(table.head, speed, q) - a - Z0 * q, -0.2, 0.2, xtol=1e-14)

    def slower(speed, a):
        return -power * form(table.torque, speed, through(speed, a)) / (inertia * (2 * np.pi * turns) ** 2)

    q = brentq(lambda q: sump + rise * form(table.head, 1.0, q) - HEAD, 0, 0.05, xtol=1e-14)
    assert -probe.y[0] == pytest.approx(q, rel=2e-3)
    back, speed, u = round(2 * DELAY / step), 1.0, []
    leaves = [HEAD + Z0 * q] * back
    for k in range(round(2.9 / step)):
        a, after = (2 * HEAD - leaves[k + j] if k + j < len(leaves) else 2 * HEAD - leaves[-1] for j in (0, 1))
        u.append(a + Z0 * through(speed, a))
        leaves.append(2 * u[-1] - a)
        slope = slower(speed, a)
        speed += step / 2 * (slope + slower(speed + step * slope, after))
    later = probe.t > 0.1
    exact = np.interp(probe.t[later] - 0.1, step * np.arange(len(u)), u)
    assert speed < -0.3  # it turns backward
    assert np.abs(probe.u[later] - exact).max() < 2e-3 * rise


def test_valves_in_series_without_a_line_are_one():
    """1/C² adds up; nothing conducts at the node between them."""
    loads = {"out": {"at": "far", "kind": "orifice", "kv": 150, "opening": RAMP}}
    links = {"v": {"kind": "orifice", "nodes": ["end", "far"], "kv": 200, "opening": RAMP}}
    both = simulate(pipe(loads, links=links)).probes["end"].u
    kv = (1 / 150**2 + 1 / 200**2) ** -0.5
    one = simulate(pipe({"v": {"at": "end", "kind": "orifice", "kv": kv, "opening": RAMP}})).probes["end"].u
    assert np.abs(both - one).max() < 1e-9 * HEAD


def test_elements_side_by_side_add_their_flows():
    loads = {
        "v": {"at": "end", "kind": "orifice", "kv": KV, "opening": RAMP},
        "leak": {"at": "end", "kind": "leak", "flow": CAPACITY / 3 * 1e3, "pressure": 1e6},
    }
    both = simulate(pipe(loads)).probes["end"]
    more = {"shape": "ramp", "from": 1, "to": 0.25, "at": 0.05, "duration": 0.73}
    one = simulate(pipe({"v": {"at": "end", "kind": "orifice", "kv": KV * 4 / 3, "opening": more}})).probes["end"]
    assert np.abs(both.u - one.u).max() < 1e-11 * HEAD


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e-2])
@pytest.mark.parametrize("gauge", [0.0, 1e5])
def test_an_air_vessel_answers_to_the_faintest_wave(size, gauge):
    """As the capacitance V/(n·p) that its gas is in the air outside: u = 2·size·(1 - exp(-t/(z0·C)))."""
    volume, atmosphere, n = 5e-4, 101325.0, 1.2
    vessel = {"kind": "air vessel", "gas_volume": volume, "gas_pressure": gauge, "exponent": n}
    line, loads = {"z0": Z0, "delay": DELAY}, {"vessel": vessel | {"at": "end"}}
    scene = from_tank(0.28, line, size, loads, start="rest", solver={"order": 6, "slab": 0.02})
    probe = simulate(scene).probes["end"]
    capacity = volume * (1 + gauge / atmosphere) ** (1 / n) / (n * atmosphere)
    exact = -2 * size * np.expm1(-np.maximum(probe.t - DELAY, 0) / (Z0 * capacity))
    bend = (n + 1) / (2 * n) * (2 * size) ** 2 / atmosphere  # what the law adds to its slope
    assert np.abs(probe.u - exact).max() < 1e-9 * size + bend
