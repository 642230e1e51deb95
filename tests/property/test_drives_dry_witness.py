"""The witness of drives whose bearings rub: silent about right runs, not about those of others."""

import random
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from drives import CoupledDrives, Spool, Torque, design, simulate, simulate_control
from drives.witness import doubts
from friction import Coulomb, Karnopp

DRIVES = CoupledDrives(right=Spool(2e-3, 0.05, 0.08))
LAWS = Karnopp(F_c=0.04, F_s=0.06, F_v=0.01, v_s=2.0), Coulomb(F_c=0.03, F_v=0.0)
TORQUES = Torque.table([0.0, 0.5, 1.1], [0.1, -0.4, 0.3]), Torque.table([0.0, 0.7], [0.1, 0.5], held=True)


@pytest.mark.parametrize("seed", range(12))
def test_nothing_is_said_of_what_is_right(seed):
    rng = random.Random(seed)
    laws = Karnopp(F_c=0.1 * rng.random(), F_s=0.1 + rng.random(), F_v=rng.random() / 10, v_s=rng.random()), None
    laws = laws if seed % 2 else (laws[1], Coulomb(F_c=rng.random(), F_v=0.0))
    how: dict[str, Any] = {"t_end": 0.5, "step": 0.01, "friction": laws, "slack": seed % 3 == 0}
    if seed < 6:
        assert simulate(DRIVES, *TORQUES, **how).verdicts == ()
    else:
        looks = (
            {"period": rng.uniform(1e-3, 0.02), "delay": rng.uniform(0.0, 0.01)} if seed % 2 else {"filter_time": 0.01}
        )
        how |= looks | ({"limit": 3.0} if seed % 4 < 2 else {})
        steered = simulate_control(design(DRIVES, 20, 20), Torque.step(0.2), Torque.step(5.0, 0.1), **how)
        assert not [one for one in steered.verdicts if "disagree" in one]


@cache
def run() -> Any:
    return simulate(DRIVES, *TORQUES, t_end=2.0, step=0.02, slack=True, friction=LAWS)


TOLD: dict[str, Any] = {"parts": DRIVES, "inputs": TORQUES, "slack": True, "dry": LAWS}


def test_the_run_that_faults_are_put_into_is_right():
    assert sum(map(len, run().events.values())) > 2
    assert doubts(run=run(), **TOLD) == ()


@pytest.mark.parametrize("change", [
    {"dry": (replace(LAWS[0], F_c=0.0404), LAWS[1])},
    {"dry": (replace(LAWS[0], F_v=0.0101), LAWS[1])},
    {"dry": (LAWS[0], replace(LAWS[1], F_c=0.0303))},
    {"dry": (LAWS[0], None)},
    {"parts": replace(DRIVES, left=Spool(1e-3, 0.101, 0.1))},
    {"slack": False},
])  # fmt: skip
def test_another_mechanism_is_found(change):
    (verdict,) = doubts(run=run(), **TOLD | change)
    assert verdict.startswith("two methods disagree at ")
