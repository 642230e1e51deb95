"""The witness of the drives: silent about runs of the mechanism given, not about those of another."""

import random
from dataclasses import replace
from functools import cache

import pytest

from drives import (
    Belt,
    CoupledDrives,
    InputError,
    Pulley,
    Spool,
    Torque,
    design,
    simulate,
    simulate_control,
    simulate_slack,
)
from drives.by_hand import Control
from drives.witness import doubts

SAID = "two methods disagree at "


def size(rng, decades):
    return float(f"{10 ** rng.uniform(-decades, decades):.3g}")


def random_drives(rng, decades):
    """Every fifth friction or damping is none."""
    spools, belts = (
        [[size(rng, decades) * (k != 1 or rng.random() > 0.2) for k in range(n)] for _ in range(2)] for n in (3, 2)
    )
    pulley = Pulley(size(rng, decades), round(rng.uniform(0.01, 1.56), 3))
    return CoupledDrives(Spool(*spools[0]), Spool(*spools[1]), Belt(*belts[0]), Belt(*belts[1]), pulley)


def random_torque(rng, end):
    times = sorted({round(rng.random(), 3) * end for _ in range(rng.randint(1, 4))})
    return Torque.table(times, [rng.uniform(-5, 5) for _ in times], held=rng.random() < 0.5)


def random_run(kind, seed):
    rng = random.Random(f"{kind} {seed}")
    linear = kind in ("torques", "control")
    made = random_drives(rng, 3 if linear else 1)
    step = size(rng, 3) if linear else 0.05 * size(rng, 1)  # far beyond all time constants, and far below
    end = rng.choice([1, 3, 30]) * step
    first, second, third = (random_torque(rng, end) for _ in range(3))
    start = {name: rng.uniform(-0.5, 0.5) for name in made.states if rng.random() < 0.5}
    how = {"end": end, "step": step, "initial": start}
    if kind in ("torques", "slack"):
        return {"torques": simulate, "slack": simulate_slack}[kind](made, first, second, **how)
    how |= {"d1": third, "limit": size(rng, 1) if kind == "limit" else None, "antiwindup": rng.random() < 0.7}
    return simulate_control(design(made), first, second, **how)


@pytest.mark.parametrize(("kind", "runs"), [("torques", 60), ("control", 15), ("slack", 15), ("limit", 10)])
def test_nothing_is_said_of_what_is_right(kind, runs):
    heard = 0
    for seed in range(10 * runs):
        try:
            run = random_run(kind, seed)
        except InputError:  # no controller of the rule
            continue
        assert [one for one in run.verdicts if one.startswith(SAID)] == []
        heard += 1
        if heard == runs:
            return
    pytest.fail("too few runs")


DRIVES = CoupledDrives(right=Spool(2e-3, 0.05, 0.08), right_belt=Belt(60, 0.3), pulley=Pulley(200, 0.8))
TORQUES = Torque.table([0.0, 0.5, 1.1], [0.1, -0.4, 0.3]), Torque.table([0.0, 0.7], [0.1, 0.5], held=True)
POINTS = Torque.step(1.0), Torque.step(5.0, 0.3), Torque.step(0.3, 1.0), Torque.step(0.0)
KINDS = ("torques", "long steps", "control", "slack", "limit")


@cache
def heard(kind):
    """A run, and what the witness is told beside the parts."""
    if kind in ("torques", "long steps"):
        return simulate(DRIVES, *TORQUES, end=2.0, step=0.4 if kind == "long steps" else 0.01), {"inputs": TORQUES}
    if kind == "slack":
        return simulate_slack(DRIVES, *TORQUES, end=2.0, step=0.02), {"inputs": TORQUES, "slack": True}
    made, limit = design(DRIVES), 1.0 if kind == "limit" else None
    run = simulate_control(made, *POINTS[:2], d1=POINTS[2], limit=limit, end=2.0, step=0.02)
    gains = [(float(one.gain), float(one.integral_time)) for one in (made.speed, made.tension)]
    control = Control(*gains) if limit is None else Control(*gains, limit)
    return run, {"inputs": POINTS, "control": control}


def said(run, told, parts=DRIVES):
    told = dict(told)
    return doubts(parts, told.pop("inputs"), run, **told)


@pytest.mark.parametrize("kind", KINDS)
def test_the_runs_that_faults_are_put_into_are_right(kind):
    assert said(*heard(kind)) == ()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("part", "key"),
    [(side, key) for side in ("left", "right") for key in ("inertia", "friction", "radius")]
    + [(side, key) for side in ("left_belt", "right_belt") for key in ("stiffness", "damping")]
    + [("pulley", "stiffness"), ("pulley", "angle")],
)
def test_one_per_cent_of_a_parameter_is_found(kind, part, key):
    old = getattr(DRIVES, part)
    values = {
        name: getattr(old, name)
        for name in ("inertia", "friction", "radius", "stiffness", "damping", "angle")
        if hasattr(old, name)
    }
    other = replace(DRIVES, **{part: type(old)(**(values | {key: float(values[key]) * 1.01}))})
    found = said(*heard(kind), other)
    assert [one[: len(SAID)] for one in found] == [SAID]
