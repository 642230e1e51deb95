"""Simulation of the linear model: exact at the samples, whatever the step."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.discretise import legs, propagate
from drives.energy import Energy, energy_of, open_torques
from drives.number import exact, finite, positive
from drives.torque import ZERO, Torque
from drives.witness import doubts
from tline.errors import InputError

MOST_STEPS = 1_000_000
PUSHES = 1e-9  # of the largest tension: more is no rounding


@dataclass(frozen=True)
class Run:
    """What the mechanism did.

    Attributes
    ----------
    t : numpy.ndarray
        Sample times, s, shape (n,).
    states, outputs : dict of str to numpy.ndarray
        By name, each of shape (n,). Outputs are x_k, tension, belt_speed, w1, w2, phi1, phi2; under control also the
        torques T1 and T2 of the motors, N m.
    energy : Energy
        Stored, dissipated and supplied since the start, J, each of shape (n,).
    notes : tuple of str
        What to know beside the numbers: where the belt pushes.
    verdicts : tuple of str
        What was asked for and cannot be had: set points that the limit does not hold, a stable loop; and where this run
        does not fit the equations of motion, see `drives.witness`: then it is wrong.
    """

    t: NDArray[np.float64]
    states: dict[str, NDArray[np.float64]]
    outputs: dict[str, NDArray[np.float64]]
    energy: Energy
    notes: tuple[str, ...] = ()
    verdicts: tuple[str, ...] = ()


def simulate(
    drives: CoupledDrives,
    T1: Torque = ZERO,
    T2: Torque = ZERO,
    *,
    t_end: float,
    step: float,
    initial: Mapping[str, float] | None = None,
) -> Run:
    """Run the linear model, in which the belt can push as well as pull; `drives.slack` has the other one.

    Parameters
    ----------
    drives : CoupledDrives
    T1, T2 : Torque
        Nothing if not given.
    t_end : float
        Length of the run, s.
    step : float
        Time between samples, s; at most `MOST_STEPS` steps. It causes no error.
    initial : mapping of str to float, optional
        Values of states, 0 for those not named; `steady_state` gives some.

    Raises
    ------
    InputError
        A step or t_end that is not more than 0; too many samples; an unknown state.

    Examples
    --------
    >>> run = simulate(CoupledDrives(), T1=Torque.step(0.1), T2=Torque.step(0.1), t_end=2.0, step=0.5)
    >>> [round(float(x), 6) for x in run.outputs["tension"]]
    [0.0, 0.865756, 0.982125, 0.99762, 0.999683]
    """
    t, x0 = sample_times(t_end, step), initial_state(drives.states, initial)
    model, way = drives.state_space(), legs((T1, T2), float(step), len(t))
    x = propagate(model.a, model.b, x0, way)
    seen = x[way.sampled]
    states, outputs = named(drives.states, seen), named(model.outputs, seen @ model.C.T)
    energy = energy_of(drives, model, open_torques(drives), x, way)
    run = Run(t, states, outputs, energy, pushing(t, outputs["tension"]))
    return replace(run, verdicts=doubts(drives, (T1, T2), run))


def pushing(t: NDArray, tension: NDArray) -> tuple[str, ...]:
    """A note, if the belt pushes at a sample by more than rounding."""
    lowest = int(np.argmin(tension))
    if tension[lowest] >= -PUSHES * np.abs(tension).max():
        return ()
    seen = f"{tension[lowest]:.4g} N at {t[lowest]:.4g} s"
    return (f"the tension falls to {seen}: there the belt pushes, which this linear model lets it do",)


def named(names: tuple[str, ...], columns: NDArray) -> dict[str, NDArray[np.float64]]:
    """The columns by their names."""
    return dict(zip(names, columns.T, strict=True))


def sample_times(t_end: float, step: float) -> NDArray[np.float64]:
    """0, step, 2*step, ... up to t_end."""
    last, h = float(positive(t_end, "t_end")), float(positive(step, "step"))
    steps = int(last / h * (1 + 1e-12))
    if not 1 <= steps <= MOST_STEPS:
        raise InputError("step", "unfit", f"from 1 to {MOST_STEPS} steps until {last:g} s", f"{h:g} s")
    return np.arange(steps + 1, dtype=np.float64) * h


def initial_state(names: tuple[str, ...], given: Mapping[str, float] | None) -> NDArray[np.float64]:
    """Values in the order of the names, 0 for those not given."""
    given = given or {}
    for name in given:
        if name not in names:
            raise InputError(f"initial.{name}", "no such state", ", ".join(names))
    return np.array(finite((given.get(name, 0.0) for name in names), "initial"))


def steady_state(drives: CoupledDrives, T1: float, T2: float) -> dict[str, float]:
    """States under constant torques once all has settled, with phi1 = 0; the angles go on from there.

    Raises
    ------
    InputError
        Without friction nothing settles.

    Examples
    --------
    >>> steady_state(CoupledDrives(), 0.1, 0.1)["e1"], steady_state(CoupledDrives(), -0.1, 0.1)["w1"]
    (0.02, 1.0)
    """
    (_, d1), (_, d2) = drives.mobility(drives.left), drives.mobility(drives.right)
    if d1 + d2 == 0:
        raise InputError("friction", "nothing settles without it", "more than 0 on one spool")
    pull1, pull2 = exact(T1, "T1") / drives.left.radius, exact(T2, "T2") / drives.right.radius
    speed = (pull2 - pull1) / (d1 + d2)
    tension = pull1 + d1 * speed
    belts = {name: tension / belt.stiffness for name, belt in drives.damped.items()}
    found = {"phi1": 0, "w1": speed / drives.left.radius, "w2": speed / drives.right.radius}
    found |= {"e_p": tension / drives.spring, **belts}
    return {name: float(value) for name, value in found.items()}
