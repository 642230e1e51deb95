"""Sensitivities of a loop to parameters, against exact poles and runs of other drives under the same controllers."""

from dataclasses import replace

import numpy as np
import pytest

from drives import Belt, CoupledDrives, Pulley, Spool, closed_loop, design, sensitivities

DRIVES = CoupledDrives(Spool(2e-3, 0.1, 0.08), Spool(1e-3, 0.05, 0.1), Belt(80, 0.3), Belt(50, 0.5), Pulley(300, 1.0))
OTHERS = {
    "left.inertia": lambda x: replace(DRIVES, left=Spool(2e-3 * x, 0.1, 0.08)),
    "right.radius": lambda x: replace(DRIVES, right=Spool(1e-3, 0.05, 0.1 * x)),
    "right_belt.stiffness": lambda x: replace(DRIVES, right_belt=Belt(50 * x, 0.5)),
    "pulley.angle": lambda x: replace(DRIVES, pulley=Pulley(300, x)),
}


def overshoot(loop, k, name):
    """By a modal sum, with a parabola through the highest of 40,000 instants and its neighbours."""
    values, modes = np.linalg.eig(loop.A)
    share = np.linalg.solve(modes, loop.B[:, k]) * (loop.C[loop.outputs.index(name)] @ modes)
    used = np.abs(values) > 1e-9
    t = np.linspace(0.0, 3.0, 40_000)
    y = np.sum([(c / z * (np.exp(z * t) - 1.0)).real for c, z in zip(share[used], values[used], strict=True)], axis=0)
    k = int(np.clip(np.argmax(y), 1, y.size - 2))
    bend, slope = y[k + 1] - 2.0 * y[k] + y[k - 1], 0.5 * (y[k + 1] - y[k - 1])
    return (y[k] - 0.5 * slope**2 / bend) / y[-1] - 1.0


@pytest.mark.parametrize("name", OTHERS)
def test_poles_and_overshoots_move_as_those_of_other_drives(name):
    made = design(DRIVES, 20, 30)
    found, small = sensitivities(made), 1e-4
    row = found.parameters.index(name)
    more, less = (closed_loop(made, plant=OTHERS[name](1 + sign * small)) for sign in (1, -1))
    moved = [(z - min(less.poles, key=lambda other: abs(other - z))) / (200 * small) for z in more.poles]
    for pole, move in zip(found.poles, found.of_poles[row], strict=True):
        k = int(np.argmin([abs(z - pole) for z in more.poles]))
        assert move == pytest.approx(moved[k], rel=1e-5, abs=1e-7 * abs(pole))
    for k, output in enumerate(("belt_speed", "tension")):
        slope = (overshoot(more, k, output) - overshoot(less, k, output)) / (200 * small)
        assert found.of_overshoots[row, k] == pytest.approx(slope, rel=1e-3, abs=1e-7)
