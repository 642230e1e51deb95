"""The hydraulic scenes with circuits, their equations written by hand; t counts from where something is operated."""

import numpy as np
from method_of_steps import ByHand, Line, Motion, integrate

GRAVITY = 9.80665


def pipe(length: float, diameter: float, wave_speed: float, density: float = 1000.0) -> Line:
    return Line(density * wave_speed / (np.pi / 4 * diameter**2), length / wave_speed)


def root(size: float) -> float:
    """The square root that changes its sign with its argument."""
    return np.sign(size) * np.sqrt(abs(size))


def beside_a_valve(w: float, z0: float, p: float, k: float, valve: float, q: float) -> float:
    """Flow q into a vessel of pressure p behind k·q·|q|, beside a valve·sqrt(u): (w - u)/z0 = q + valve·sqrt(u)."""
    for _ in range(60):
        u = p + k * q * abs(q)
        off = (w - u) / z0 - q - valve * root(u)
        slope = 2 * k * abs(q) * (1 / z0 + (valve / (2 * np.sqrt(abs(u))) if valve else 0)) + 1
        q += off / slope
        if abs(off) < 1e-15 * abs(w / z0):
            break
    return q


def one_pipe(line: Line, head: float, discharge: float, shuts: float, k: float, vessel, start: float, t_end: float):
    """A tank, a pipe, and beside its valve, which shuts, a vessel behind a loss; the state is the vessel's volume."""
    pressure, inward, volume = vessel
    capacity = discharge / np.sqrt(head)

    def flow(t, x, w):
        valve = capacity * max(1 - t / shuts, 0.0)
        return beside_a_valve(w[1], line.z0, pressure(x[0]), k, valve, 0.0)

    def circuit(t, x, w, mode):
        q = flow(t, x, w)
        return np.array([inward * q]), np.array([head, pressure(x[0]) + k * q * abs(q)])

    def edges(t, x, w, mode):
        q = flow(t, x, w)
        return [(-q if mode[0] == 0 else np.inf, q if mode[0] == 1 else np.inf)]

    before = [head, head, head - line.z0 * discharge, head + line.z0 * discharge]
    return integrate(
        circuit, [line], t_end, scale=[volume], state=[start], steady=before, corners=(shuts,), edges=edges, mode=(1,)
    )


def surge_tank() -> Motion:
    """V' = q, p = density·gravity·V/area, behind a throttle beside the turbine's valve."""
    line, head, discharge, area = pipe(3000.0, 3.0, 1200.0), 6e5, 15.0, 80.0
    lift = 1000 * GRAVITY / area
    vessel = (lambda v: lift * v, 1.0, head / lift)
    return one_pipe(line, head, discharge, 10.0, 0.5e5 / discharge**2, vessel, head / lift, 295.0)


def vessel_valve() -> Motion:
    """V' = -q, p·V^1.2 constant, behind its own loss beside a valve."""
    line, head, discharge, gas, air = pipe(600.0, 0.3, 1200.0), 5e5, 0.08, 0.8, 101_325.0
    k = 1e5 * 3600**2 / 800.0**2
    vessel = (lambda v: (head + air) * (gas / v) ** 1.2 - air, -1.0, gas)
    return one_pipe(line, head, discharge, 1.0, k, vessel, gas, 19.5)


def pump_group() -> Motion:
    """One flow q through pump, check valve and throttle; the rotor loses N·h0·q/(J ω²) of its speed N."""
    suction, main, sump, tank = pipe(50.0, 0.3, 1000.0), pipe(900.0, 0.25, 1000.0), 0.5e5, 4e5
    h0, bend, loss = 6.5e5, 1.5e5 / 0.06**2, 0.4e5 / 0.06**2
    energy, z, k = 1.5 * (2 * np.pi * 24) ** 2, suction.z0 + main.z0, bend + loss

    def drive(x, w):
        return w[1] - w[2] + h0 * x[0] ** 2

    def circuit(t, x, w, mode):
        d = drive(x, w)
        q = mode[0] * 2 * d / (z + np.sqrt(max(z**2 + 4 * k * d, 0.0)))
        return np.array([-h0 * x[0] * q / energy]), np.array([sump, w[1] - suction.z0 * q, w[2] + main.z0 * q, tank])

    def edges(t, x, w, mode):
        d = drive(x, w)
        return [(-d if mode[0] == 0 else np.inf, d if mode[0] == 1 else np.inf)]

    q = np.sqrt((h0 + sump - tank) / k)
    u = np.array([sump, sump, tank, tank])
    along = q * np.array([suction.z0, suction.z0, main.z0, main.z0])
    before = np.concatenate([u, u + along * [-1, 1, -1, 1]])
    return integrate(circuit, [suction, main], 7.5, scale=[1.0], state=[1.0], steady=before, edges=edges, mode=(1,))


HYDRAULIC = {
    "surge_tank": ByHand(surge_tank, {"shaft": 1}, 5.0),
    "vessel_valve": ByHand(vessel_valve, {"end": 1}, 0.5),
    "pump_group": ByHand(pump_group, {"inlet": 1, "main": 2}, 0.5),
}
