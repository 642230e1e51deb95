"""Circuits between lines against closed forms: inverse Laplace in 30 digits, recursions per bounce, a quadrature."""

import mpmath as mp
import numpy as np
import pytest
from bounces import COILS, SERIES, Z0, C, L, R, closed_form, inverse, leaving, scene_of
from one_line import FAR, one_line

from tline import Scene, simulate
from tline.scene.characteristic import BOLTZMANN, CHARGE


@pytest.mark.parametrize("link", [SERIES, COILS], ids=["series RLC", "coupled coils"])
def test_a_link_between_two_lines_is_its_inverse_laplace_transform(link):
    """A step, and four echoes from either end."""
    probes = simulate(scene_of(link, order=8, slab=0.0625)).probes
    chosen = np.arange(3, len(probes["far"].t), 7)
    exact = closed_form(link, probes["far"].t[chosen])
    for name, efforts in zip(("near", "far"), exact, strict=True):
        assert np.abs(probes[name].u[chosen] - efforts).max() < 1e-10
        assert np.ptp(efforts) > 0.2


def test_the_inverse_transform_is_the_damped_sine():
    """Of the first wave through R, L and C: 1/(L ω)·exp(-α t)·sin(ω t) flows, and z0 times twice that leaves."""
    with mp.workdps(50):
        alpha = (R + sum(map(mp.mpf, Z0))) / (2 * L)
        turns = mp.sqrt(1 / (mp.mpf(L) * C) - alpha**2)
        for t in map(mp.mpf, (1 / 64, 0.25, 0.875, 3)):
            i = mp.exp(-alpha * t) * mp.sin(turns * t) / (turns * L)
            assert abs(inverse(lambda s: leaving(SERIES, s, 0), t)[1] - 2 * Z0[1] * i) < 1e-28


def test_a_helmholtz_resonator_at_the_side_of_a_pipe_is_a_damped_sine():
    """An inertance and a compliance behind it; both pipes end in their z0, so that u = w/2 - z0/2·i."""
    z0, inertance, compliance, delay = 3e6, 4e4, 6e-10, 0.1
    pipe = {"z0": z0, "delay": delay}
    scene = Scene(
        medium="hydraulic",
        t_end=0.9,
        lines={"in": pipe | {"nodes": ["source", "side"]}, "out": pipe | {"nodes": ["side", "end"]}},
        sources={"s": {"at": "source", "kind": "pressure", "resistance": z0, "value": {"shape": "step", "to": 1e5}}},
        links={"neck": {"nodes": ["side", "bottle"], "kind": "inductor", "inductance": inertance}},
        loads={
            "bottle": {"at": "bottle", "kind": "capacitor", "capacitance": compliance},
            "end": {"at": "end", "kind": "matched"},
        },
        probes={"end": {"at": "end"}, "side": {"at": "side", "line": "in"}},
        solver={"order": 10, "slab": 0.0125},
    )
    alpha, natural = z0 / 4 / inertance, 1 / np.sqrt(inertance * compliance)
    turns = np.sqrt(natural**2 - alpha**2)
    probes = simulate(scene).probes
    for name, begin in (("side", delay), ("end", 2 * delay)):
        t = np.maximum(probes[name].t - begin, 0)
        i = 1e5 / (2 * inertance * turns) * np.exp(-alpha * t) * np.sin(turns * t)
        exact = np.where(probes[name].t > begin + 1e-9, 5e4 - z0 / 2 * i, 0)
        later = np.abs(probes[name].t - begin) > 1e-9
        assert np.abs(probes[name].u - exact)[later].max() < 1e-10 * 1e5


def test_a_diode_beside_a_resistor_behind_another_is_its_recursion_per_bounce():
    """No line ends at their node; Lambert's W in 40 digits gives what the line's end sees."""
    z0, rs, series, beside, rise, emf = 50, 20, 30, 200, 0.75, 5
    saturation, thermal = 1e-14, float(BOLTZMANN * 300.15 / CHARGE)
    links = {"series": {"nodes": ["far", "inner"], "kind": "resistor", "resistance": series}}
    loads = {
        "diode": {"at": "inner", "kind": "diode", "saturation": saturation},
        "beside": {"at": "inner", "kind": "resistor", "resistance": beside},
    }
    more = {"links": links, "loads": loads, "probes": FAR, "solver": {"order": 10, "slab": 0.125}}
    ramp = {"shape": "ramp", "to": emf, "duration": rise}
    probe = simulate(one_line(12.0, {"z0": z0, "delay": 1.0}, ramp, rs, **more)).probes["far"]
    with mp.workdps(40):
        share = mp.mpf(beside) / (beside + z0 + series)
        r, p, k = share * (z0 + series), mp.mpf(saturation), mp.mpf(thermal)

        def inner(a):
            i = k / r * mp.lambertw(r * p / k * mp.exp((a * share + r * p) / k)).real - p
            return a * share - r * i

        def source(t):
            return mp.mpf(emf) * min(max(mp.mpf(t) / mp.mpf(rise), 0), 1)

        reflection = (mp.mpf(rs) - z0) / (rs + z0)
        exact = []
        for t in probe.t:
            leaves, u = mp.mpf(0), mp.mpf(0)
            for instant in [mp.mpf(float(t)) - 1 - 2 * n for n in range(6, -1, -1)]:
                a = source(instant) * 2 * z0 / (rs + z0) + reflection * leaves if instant > 0 else mp.mpf(0)
                u = a - z0 * (a - inner(a)) / (z0 + series)
                leaves = 2 * u - a
            exact.append(u)
    assert np.abs(probe.u - np.array(exact, float)).max() < 1e-9 * emf
    late = probe.t % 2 > 1 + rise + 1e-9  # flat until the next echo
    assert np.abs(probe.u - np.array(exact, float))[late].max() < 1e-12 * emf


def test_the_mass_oscillation_of_a_surge_tank_is_its_quadrature():
    """L q' = h - p - k q|q| and C p' = q: q² is linear in p with an exponential, swing by swing.

    A capillary, through which nothing to speak of flows, ends at the tank so that a probe can stand there.
    """
    head, discharge, inertance, area, drop, gravity = 6e5, 15.0, 4.2e5, 80.0, 0.4e5, 9.80665
    scene = Scene(
        medium="hydraulic",
        t_end=300.0,
        start="steady",
        lines={"capillary": {"nodes": ["tank", "gauge"], "z0": 1e11, "delay": 2.0}},
        sources={
            "turbine": {"at": "tank", "kind": "flow", "value": {"shape": "step", "from": -discharge, "to": 0, "at": 0}}
        },
        links={
            "tunnel": {"nodes": ["lake", "bend"], "kind": "inductor", "inductance": inertance},
            "loss": {"nodes": ["bend", "tank"], "kind": "orifice", "flow": discharge, "pressure_drop": drop},
        },
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": head},
            "tank": {"at": "tank", "kind": "surge tank", "tank_area": area},
        },
        probes={"tank": {"at": "tank"}},
        solver={"order": 6, "slab": 1.0},
    )
    probe = simulate(scene).probes["tank"]
    begin, squared, t = -mp.mpf(drop), mp.mpf(discharge) ** 2, mp.mpf(0)
    for sign in (1, -1):
        turn, lasts = swing(mp.mpf(area) / (1000 * gravity), inertance, drop / discharge**2, begin, squared, sign)
        t += lasts
        assert abs(probe.at([float(t)]).u[0] - head - turn) < 1e-8 * head
        begin, squared = turn, mp.mpf(0)


def swing(c, inertance, k, begin, squared, sign):
    """Level at which a swing of a sign ends, and how long it takes, from its first level and the square of its flow."""
    with mp.workdps(25):
        beta = sign * 2 * c * k / inertance

        def special(x):
            return -2 * c / inertance * (x / beta - 1 / beta**2)

        amplitude = (squared - special(begin)) * mp.exp(beta * begin)

        def flow_squared(x):
            return special(x) + amplitude * mp.exp(-beta * x)

        turn = mp.findroot(flow_squared, (-2 * begin, -begin / 2 if sign < 0 else -4 * begin), solver="anderson")
        middle, half = (begin + turn) / 2, (turn - begin) / 2

        def time(angle):  # its roots where a swing begins and ends are taken out by x = middle - half·cos(angle)
            return c * abs(half) * mp.sin(angle) / mp.sqrt(flow_squared(middle - half * mp.cos(angle)))

        return turn, mp.quad(time, [0, mp.pi], method="gauss-legendre")
