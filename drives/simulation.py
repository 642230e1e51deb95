"""Simulation of the mechanism: exact at the samples; event by event, with a belt that cannot push.

The tension is f = max(0, k_s*e_p), and -e_p is the slack. While there is some the pulley rests at x_k = 0, the belts
relax at their own rate K/B, and the spools turn freely until it is taken up.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drives.assembled import Assembly, Dry
from drives.coupled import CoupledDrives
from drives.discretise import legs, propagate
from drives.energy import Energy, energy_of, open_torques, stored_in
from drives.number import exact, finite, positive
from drives.parts import Winding
from drives.symbolic import ALL_UNITS
from drives.torque import ZERO, Torque
from drives.witness import doubts
from tline.errors import InputError, check_kind
from tline.presentation import History, plain

if TYPE_CHECKING:
    from friction import Event

MOST_STEPS = 1_000_000
SHOWN = 6  # events of a spool in the text
PUSHES = 1e-9  # of the largest tension: more is no rounding


@dataclass(frozen=True, repr=False)
class Run(History):
    """Motion and energy of the mechanism in a run.

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
        Notes beside the numbers: where the belt pushes.
    verdicts : tuple of str
        Requests that cannot be met: set points that the limit does not hold, a stable loop; and where this run does
        not fit the equations of motion, see `drives.witness`: then it is wrong.
    set_points : mapping of str to numpy.ndarray
        Of belt_speed and tension, of a run under control.
    limit : float or None
        Largest torque of each motor, N m, if there is one.
    events : mapping of str to list of Event
        Where friction lets a spool go or stops it: of the left and the right one, with instant [s] and angle [rad].
    """

    t: NDArray[np.float64]
    states: dict[str, NDArray[np.float64]]
    outputs: dict[str, NDArray[np.float64]]
    energy: Energy
    notes: tuple[str, ...] = ()
    verdicts: tuple[str, ...] = ()
    set_points: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    limit: float | None = None
    events: Mapping[str, "list[Event]"] = field(default_factory=dict)
    picture, units = "drives.picture:draw_run", ALL_UNITS

    @property
    def columns(self) -> dict[str, NDArray]:
        """Time and outputs by name, SI."""
        return {"t": self.t} | self.outputs

    def text_lines(self) -> Iterator[str]:
        """Lowest, highest and last sample of each output, the energies at the end, and the verdicts."""
        yield from self.table_lines()
        yield "energy [J]: " + ", ".join(f"{key} {value:.6g}" for key, value in self._energies().items())
        for name, events in self.events.items():
            first = "; ".join(f"{one.kind} at {one.t:.6g} s" for one in events[:SHOWN]) or "none"
            yield f"events of the {name} spool ({len(events)}): {first}"
        yield from self.verdicts

    def to_dict(self) -> dict[str, Any]:
        """Samples of the outputs, the energies at the end, notes and verdicts."""
        parts = {"t": self.t, "outputs": self.outputs, "energy": self._energies()}
        events = {"events": self.events} if self.events else {}
        return plain(parts | {"notes": self.notes, "verdicts": self.verdicts} | events)

    def _energies(self) -> dict[str, float]:
        names = ("stored", "dissipated", "supplied", "imbalance")
        return {name: float(getattr(self.energy, name)[-1]) for name in names}


def simulate(
    drives: CoupledDrives,
    T1: Torque = ZERO,
    T2: Torque = ZERO,
    *,
    t_end: float,
    step: float,
    initial: Mapping[str, float] | None = None,
    slack: bool = False,
    friction: Dry = (None, None),
    winding: Winding | None = None,
) -> Run:
    """Run the mechanism: the linear model, or event by event with a belt that cannot push, dry friction, a wound belt.

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
    slack : bool, optional
        Let the belt pull but not push.
    friction : sequence of Coulomb or Karnopp, optional
        Of `friction`, for the left and the right spool, None for one without: torques [N m] over angular speeds
        [rad/s], beside the viscous friction of the spool.
    winding : Winding, optional
        Of the belt from the left spool on the right one; the radii r1 and r2 [m] and the inertias J1 and J2 [kg m^2]
        are then outputs, too, and the energy that the belt brings and takes with it counts as supplied.

    Raises
    ------
    InputError
        A step or t_end that is not more than 0; too many samples; an unknown state; a law that knows no events; belts
        so stiff beside their damping that ten million steps do not suffice; a spool that runs empty.

    Examples
    --------
    >>> run = simulate(CoupledDrives(), T1=Torque.step(0.1), T2=Torque.step(0.1), t_end=2.0, step=0.5)
    >>> [round(float(x), 6) for x in run.outputs["tension"]]
    [0.0, 0.865756, 0.982125, 0.99762, 0.999683]
    >>> run = simulate(CoupledDrives(), T1=Torque.step(-0.1), T2=Torque.step(-0.1), t_end=1.0, step=0.5, slack=True)
    >>> [float(f) for f in run.outputs["tension"]]
    [0.0, 0.0, 0.0]
    """
    check_kind("drives", drives, CoupledDrives)
    for name, torque in (("T1", T1), ("T2", T2)):
        check_kind(name, torque, Torque)
    t, x0 = sample_times(t_end, step), initial_state(drives.states, initial)
    if slack or winding or any(friction):
        parts = Assembly(drives, x0, slack, winding)
        parts.move(parts.mechanism.input(0), parts.mechanism.input(1), friction)
        run, *_ = moved(parts, t, (T1, T2))
    else:
        model, way = drives.state_space(), legs((T1, T2), float(step), len(t))
        x = propagate(model.a, model.b, x0, way)
        seen = x[way.sampled]
        outputs, energy = named(model.outputs, seen @ model.C.T), energy_of(drives, model, open_torques(drives), x, way)
        run = Run(t, named(drives.states, seen), outputs, energy, pushing(t, outputs["tension"]))
    return replace(run, verdicts=doubts(drives, (T1, T2), run, slack=slack, dry=friction, winding=winding))


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

    Parameters
    ----------
    drives : CoupledDrives
    T1, T2 : float
        Torques [N m].

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


def moved(
    parts: Assembly, t: NDArray, inputs: Sequence[Torque], also: Sequence[float] | NDArray = ()
) -> tuple[Run, dict[str, NDArray], dict[str, NDArray]]:
    """Run from event to event; return the run, and the other recorded signals at the samples and at `also`."""
    drives, every = parts.drives, np.union1d(t, also)
    x, energies, shown, events = parts.run(every, inputs)
    kept, others = (np.searchsorted(every, at) for at in (t, also))
    x, energies, model = x[kept], [one[kept] for one in energies], drives.state_space()
    outputs = named(model.outputs, x @ model.C.T)
    pushed = parts.slack & (outputs["tension"] < 0)
    for name in ("tension", "x_k"):
        outputs[name] = np.where(pushed, 0.0, outputs[name])
    tight = x.copy()
    tight[pushed, drives.states.index("e_p")] = 0.0  # slack stores nothing
    stored = stored_in(drives, tight)
    if parts.winding:
        seen = {name: one[kept] for name, one in shown.items()}
        outputs |= {name: seen[name] for name in ("phi2", "r1", "r2", "J1", "J2", "tension")}
        if (empty := np.minimum(outputs["J1"], outputs["r1"]) <= 0.0).any():
            raise InputError("winding", "the left spool is empty", "a shorter run", f"at {t[empty.argmax()]:.4g} s")
        outputs["belt_speed"] = 0.5 * (outputs["r1"] * outputs["w1"] + outputs["r2"] * outputs["w2"])
        for k, spool in ((1, drives.left), (2, drives.right)):
            stored = stored + 0.5 * (outputs[f"J{k}"] - float(spool.inertia)) * outputs[f"w{k}"] ** 2
    run = Run(t, named(drives.states, x), outputs, Energy(stored, *energies), events=events)
    run = run if parts.slack else replace(run, notes=pushing(t, outputs["tension"]))
    first, second = ({name: one[at] for name, one in shown.items()} for at in (kept, others))
    return run, first, second
