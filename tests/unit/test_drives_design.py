"""Bandwidths that are asked for and reached, and what is said where they are not."""

import math
import random

import pytest

from drives import (
    Belt,
    CoupledDrives,
    InputError,
    Pulley,
    Spool,
    Torque,
    decoupler,
    design,
    hidden_modes,
    largest_friction_with_peak,
    peak,
    reach,
    simulate,
)

EXERCISE = CoupledDrives()


@pytest.mark.parametrize("asked", [0.01, 1, 10, 100, 150, 151, 200, 250, 286])
def test_what_is_asked_for_is_reached(asked):
    found = design(EXERCISE, asked, asked)
    assert found.verdicts == ()
    for name in ("speed", "tension"):
        seen = found.margins[name]
        assert seen.crossover == pytest.approx(asked, rel=1e-12)
        assert seen.phase >= math.radians(60)
        assert found.bandwidths[name].met


def test_every_design_is_as_fast_as_asked_or_says_so():
    rng = random.Random(5)
    slower = 0
    for _ in range(40):
        sizes = [10 ** rng.uniform(-3, 1) for _ in range(10)]
        left, right = Spool(*sizes[:3]), Spool(*sizes[3:6])
        drives = CoupledDrives(left, right, Belt(*sizes[6:8]), Belt(*sizes[8:]), Pulley(rng.uniform(1, 300), 0.7))
        asked = 10 ** rng.uniform(-2, 3)
        found = design(drives, asked, asked)
        for name, band in found.bandwidths.items():
            assert band.met is not any(verdict.startswith(f"the {name} loop reaches") for verdict in found.verdicts)
            assert band.reached <= asked * (1 + 1e-12)
            assert max(z.real for z in found.poles[name]) < 0
            response = (getattr(found, name).transfer, getattr(found, f"{name}_plant"))
            size = math.prod(abs(part(1j * band.reached)) for part in response)
            assert size == pytest.approx(1, rel=1e-9)
            slower += not band.met
    assert 5 < slower < 75


def test_a_disturbance_moves_what_can_be_held():
    # T1 + d1 = r (f - D v): a disturbance of 1 N m on spool 1 takes 10 N from what its motor must hold
    assert pytest.approx(1.5) == reach(EXERCISE, 0.0, 25.0, 2.0, d1=1.0).T1
    assert reach(EXERCISE, 0.0, 25.0, 2.0, d1=1.0, d2=1.0).holds
    assert not reach(EXERCISE, 0.0, 25.0, 2.0, d1=1.0).holds


def test_a_limit_that_is_none_is_refused():
    with pytest.raises(InputError, match=r"^limit: not physical, expected more than 0"):
        reach(EXERCISE, 1.0, 1.0, 0.0)


def test_a_belt_that_pushes_is_noted():
    pulled = simulate(EXERCISE, Torque.step(0.1), Torque.step(0.1), t_end=1.0, step=0.1)
    pushed = simulate(EXERCISE, Torque.step(-0.1), Torque.step(0.0), t_end=1.0, step=0.1)
    assert pulled.notes == ()
    assert pushed.notes == (
        "the tension falls to -0.4911 N at 1 s: there the belt pushes, which this linear model lets it do",
    )


def test_the_friction_up_to_which_there_is_a_peak():
    rng = random.Random(3)
    for _ in range(60):  # stiff pulleys with damped belts among them, which resonate where the belts are rigid
        inertia, radius, stiffness, damping, k = (10 ** rng.uniform(-3, 3) for _ in range(5))
        belt, pulley = Belt(stiffness, damping), Pulley(k, rng.uniform(0.05, 1.5))

        def drives(friction, belt=belt, pulley=pulley, inertia=inertia, radius=radius):
            spool = Spool(inertia, friction, radius)
            return CoupledDrives(spool, spool, belt, belt, pulley)

        most = largest_friction_with_peak(drives(1.0))
        assert peak(drives(most * 0.999).transfer("tension", "T1")) is not None
        for more in (1.001, 1.5, 5, 100):
            assert peak(drives(most * more).transfer("tension", "T1")) is None


def test_reasons_of_hidden_modes_are_true_of_spools_that_differ():
    one_bearing = CoupledDrives(Spool(1e-3, 0.1, 0.1), Spool(1e-3, 0, 0.1))
    (last,) = [mode for mode in hidden_modes(one_bearing, "x_k", "T1") if mode.poles[0].real == -100]
    assert last.names == ("belts against each other", "coincidence")
    (last,) = [mode for mode in hidden_modes(EXERCISE, "x_k", "T1") if mode.poles[0].real == -100]
    assert last.names == ("common speed", "belts against each other", "spools and belts alike")


def test_the_decoupler_makes_the_sum_move_the_tension_alone():
    drives = CoupledDrives(Spool(2e-3, 0.03, 0.07), Spool(5e-4, 0.2, 0.13))
    first, second = decoupler(drives)
    # J dw/dt with the torques put in: both spools then have one M dv/dt = -D v -/+ f + tau/(r1 + r2)
    found = []
    for one, spool, sign in ((first, drives.left, -1), (second, drives.right, 1)):
        mass, share = spool.inertia / spool.radius**2, sign * one.share / (2 * spool.radius)
        friction = (spool.friction - sign * one.per_speed) / spool.radius**2
        pull = -sign * (1 - one.per_tension / spool.radius)
        found.append([friction / mass, pull / mass * -sign, share / mass * sign])
    assert found[0] == found[1]
