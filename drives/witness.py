"""Check that a run satisfies the equations of motion, by code that shares nothing with the solver.

At all samples outputs and stored energy are held against their definitions, and the three energies against each other.
Then the states, the heat and the work at samples are held against those that `drives.followed` finds from earlier ones.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drives.by_hand import Control, Equations
from drives.followed import SUM_ROUNDING, Record, Rows, follow
from drives.torque import Torque

BALANCED = 1e-8  # relative to the energy turned over; runs that are integrated have 1e-10
DIGITS = 1e-13  # relative to an output value
ENERGIES = "the heat", "the work of the motors"


def doubts(
    parts: Any,
    inputs: Sequence[Torque],
    run: Any,
    control: Control | None = None,
    *,
    slack: bool = False,
    dry: Sequence[Any] = (None, None),
    winding: Any = None,
) -> tuple[str, ...]:
    """Return the first contradiction of a run to the equations of motion as a sentence; empty without any.

    Parameters
    ----------
    parts : CoupledDrives
    inputs : sequence of Torque
        T1 and T2, or under control the set points of belt speed and tension, d1 and d2.
    run : drives.simulation.Run
    control : Control, optional
    slack : bool
        Whether the belt cannot push.
    dry : sequence of Coulomb, Karnopp or None
        Dry friction of the left and the right bearing.
    winding : Winding, optional
    """
    equations = Equations(parts, control, slack, dry, winding)
    x = np.array([*(run.states[name] for name in equations.states), run.outputs["phi2"]])
    events = [event.t for side in run.events.values() for event in side]
    record = Record(run.t, x, np.array([run.energy.dissipated, run.energy.supplied]), inputs, events)
    with np.errstate(all="ignore"):  # values outside the range of floats are not judged
        for one in _all(equations, record, run):
            return (one,)
    return ()


def _all(equations: Equations, record: Record, run: Any) -> Iterator[str]:
    rows = Rows(equations, len(record.x), len(record.u))
    z = np.abs(np.vstack([record.x, record.u, 0 * record.u]))
    sizes = {name: np.abs(row) @ z for name, row in rows.outputs.items()}  # of the terms of each
    yield from _of_definitions(equations, record, run, sizes)
    yield from _of_balance(record, run)
    grain = DIGITS * np.abs(record.rows)
    grain[len(record.x) - 1] = DIGITS * sizes["phi2"]
    for starts, ends, found, off in follow(equations, rows, record):
        given, off = record.rows[:, ends], off + grain[:, ends] + grain[:, starts]
        for name, *values in zip((*equations.states, "phi2", *ENERGIES), given, found, off, strict=True):
            yield from _apart(record.t[ends], name, *values)


def _of_definitions(equations: Equations, record: Record, run: Any, sizes: dict[str, NDArray]) -> Iterator[str]:
    """Outputs and stored energy, from the states at each sample."""
    if equations.linear:
        found = equations.outputs(record.x, record.u)
    else:
        each = [equations.outputs(*one) for one in zip(record.x.T.tolist(), record.u.T.tolist(), strict=True)]
        found = {name: np.array([one[name] for one in each]) for name in each[0]}
    for name, value in found.items():
        yield from _apart(run.t, name, run.outputs[name], value, SUM_ROUNDING * sizes.get(name, np.abs(value)))
    stored = equations.stored(record.x)
    yield from _apart(run.t, "the stored energy", run.energy.stored, stored, SUM_ROUNDING * stored)


def _of_balance(record: Record, run: Any) -> Iterator[str]:
    """Gain in stored energy + heat = work."""
    heat, work = record.rows[-2:]
    gained, largest = run.energy.stored - run.energy.stored[0] + heat, np.abs(record.x).max(axis=1)
    torques = [np.abs(one.starts).max() for one in record.inputs[-2:]]
    torques += [np.abs(run.outputs[name]).max() for name in ("T1", "T2") if name in run.outputs]
    back_and_forth = sum(torques) * (largest[1] + largest[2]) * run.t[-1]
    turnover = run.energy.stored.max() + heat.max() + np.abs(work).max() + back_and_forth
    yield from _apart(
        run.t, "the energy stored and dissipated", gained, work, np.full_like(gained, BALANCED * turnover)
    )


def _apart(t: NDArray, name: str, given: NDArray, found: NDArray, off: NDArray) -> Iterator[str]:
    """Yield a sentence if two values differ by more than `off`, at the instant where this is worst."""
    far = np.abs(given - found)
    wrong = far > off
    if wrong.any():
        k = int(np.argmax(np.where(wrong, far / (off + np.finfo(float).tiny), 0.0)))
        value = f"{name} is {given[k]:.6g}, {far[k]:.2g} off what the equations of motion give"
        yield f"two methods disagree at {t[k]:.6g} s: {value}"
