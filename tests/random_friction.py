"""Random runs of the static laws, and whether their events can be.

Ramps, sines, rigs (a spring pulls), and noisy tables at 1 kHz; most runs are short, some have 10⁵ events.
"""

from itertools import pairwise

import numpy as np

from friction import Coulomb, Event, Karnopp, Kind, Model, Ramp, Sine, Spring, Table, Testbench

KINDS = ("ramp", "sine", "rig", "table")


def random_model(rng: np.random.Generator) -> Model:
    F_c, F_v = float(10.0 ** rng.uniform(-2, 2)), float(rng.choice([0.0, 10.0 ** rng.uniform(-3, 0)]))
    if rng.random() < 0.25:
        return Coulomb(F_c, F_v)
    F_s, v_s = F_c * (1.0 + float(rng.choice([0.0, rng.random()]))), float(10.0 ** rng.uniform(-3, 0))
    bare, zone = Karnopp(F_c, F_s, F_v, v_s), float(rng.choice([0.0, 0.0, 0.0, 1e-3]))
    return Karnopp(F_c, F_s, F_v, v_s, zone) if bare.steady_force(zone) <= F_s else bare


def random_run(rng: np.random.Generator, kind: str) -> tuple[Model, Testbench, float]:
    """A model, a testbench, and an end."""
    model, mass, long = random_model(rng), float(10.0 ** rng.uniform(-1, 2)), 10.0 ** rng.uniform(0.0, 3.3)
    if rng.random() < 0.005:
        long = 5e4
    F, v0 = model.stiction, float(rng.choice([0.0, rng.normal()]))
    if kind == "ramp":
        return model, Testbench(Ramp(rng.normal() * 10.0 ** rng.uniform(-3, 3), rng.normal() * F), mass, v0), 3.0 * long
    if kind == "sine":
        frequency = 10.0 ** rng.uniform(-2, 3)
        force = Sine(F * rng.uniform(0.9, 3.0), frequency, rng.normal() * 0.3 * F, rng.uniform(0.0, 6.0))
        return model, Testbench(force, mass, v0), 0.5 * long / frequency
    if kind == "rig":
        k = 10.0 ** rng.uniform(0, 4)
        speed = 10.0 ** rng.uniform(-3, 0) * F / (mass * k) ** 0.5
        return model, Testbench(Ramp(0.0), mass, v0, Spring(k, speed)), 0.5 * long * (mass / k) ** 0.5 * 6.0
    n = int(4.0 * long) + 2
    force = Table(1e-3 * np.arange(n), F * rng.uniform(0.5, 3.0) * rng.normal(size=n))
    return model, Testbench(force, mass, v0), 1e-3 * n


def sound(events: list[Event]) -> bool:
    """Whether no event lasts no time, and each may follow the one before."""
    later = all(first.t < second.t for first, second in pairwise(events))
    return later and all((a.kind is Kind.STOP) == (b.kind is Kind.BREAK_AWAY) for a, b in pairwise(events))
