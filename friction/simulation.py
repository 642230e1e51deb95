"""One run on the testbench, by any method."""

from collections.abc import Callable, Sized
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction import witness
from friction.methods import Method, method_for
from friction.models import Model
from friction.parameters import check_number
from friction.result import COLUMNS, Result, Status, events_of
from friction.spring_contact import SpringContact
from friction.testbench import Testbench
from tline.compiled.structure import pack
from tline.errors import InputError, as_numbers, check_kind

if TYPE_CHECKING:
    from friction.kernel.law import Drive, Law
    from friction.kernel.structures import HybridRun
    from friction.mechanism import Mechanism

MOST_STEPS, MOST_SAMPLES, FEW_EVENTS, MOST_EVENTS = 5_000_000, 200_000, 1000, 1_000_000
MOST_BUDGET = 1_000_000_000
BUDGETS = {"events": 5_000_000, "adaptive": 5_000, "rosenbrock": 20_000_000, "taylor": 20_000_000}
OWN = {"rosenbrock": 1e-12, "taylor": 1e-14}  # with error estimates; tolerance of single steps where none is given


def simulate(
    model: Model | SpringContact,
    bench: Testbench,
    t_end: float = 10.0,
    method: str | None = None,
    *,
    h: float | None = None,
    tol: float | None = None,
    times: ArrayLike | None = None,
    budget: int | None = None,
) -> Result:
    """Motion of the testbench from where it starts up to t_end.

    Parameters
    ----------
    model : Model, MaxwellSlip or Armstrong
        `Coulomb`, `Karnopp`, `LuGre`, `Dahl`, `ElastoPlastic`, `Tanh`, `MaxwellSlip` or `Armstrong`.
    bench : Testbench
        Mass, force, spring.
    t_end : float, optional
        End [s], positive.
    method : str, optional
        A name of `METHODS`, such as euler or bdf-events; if not given, `events` for the static laws, Maxwell slip and
        Armstrong's law, `taylor` for LuGre and Dahl, which is explicit where the contact is soft, and `rosenbrock` for
        the others.
    h : float
        Step [s] of a fixed-step method; t_end is rounded to whole steps.
    tol : float, optional
        Tolerance of an adaptive method, 1e-14 to 0.1. `rosenbrock` and `taylor` refine their steps until the estimates
        of their errors, relative to the largest value of each column, meet it; without one, they make steps of 1e-12
        and 1e-14 and tell how good they are. To SciPy's methods (1e-13 to 0.1; 1e-6 if not given) it is the relative
        tolerance of single steps.
    times : array_like, optional
        Where to look [s], rising, within [0, t_end]; 1001 equal steps if not given. Events do not depend on it. Fixed
        steps give every step, thinned evenly above 200 000.
    budget : int, optional
        Most steps an adaptive method may make, up to 10⁹; 5 million for `events`, 20 million for `rosenbrock` and
        `taylor`, 5000 for SciPy's methods if not given.

    Raises
    ------
    InputError
        A number is out of range, or method, model and options do not fit together.

    Examples
    --------
    >>> from friction import Coulomb, Ramp, Testbench, simulate
    >>> run = simulate(Coulomb(), Testbench(Ramp(0.5)))
    >>> float(run.v[-1]), run.events
    (16.0, [Event(kind=<Kind.BREAK_AWAY: 'break-away'>, t=2.0, x=0.0)])
    """
    check_number("t_end", t_end, above=0.0)
    law: Any = model
    chosen = method_for(model, method)
    check_kind("bench", bench, Testbench)
    unknown = "controller" if bench.controller else "play" if bench.spring and bench.spring.play else None
    if unknown and chosen.step != "events":
        raise InputError("method", f"'{chosen.name}' knows no {unknown}", "events, with coulomb or karnopp or springs")
    if bench.z0 and (isinstance(model, SpringContact) or not law.law.sigma0):
        raise InputError("bench.z0", f"the {model.name} model has no bristles", "0", f"{bench.z0:g}")
    if chosen.step == "fixed":
        for option, given in (("tol", tol), ("times", times), ("budget", budget)):
            if given is not None:
                raise InputError(option, f"'{chosen.name}' has fixed steps", "h")
        return _fixed(_Task(law, bench, chosen, float(t_end)), h)
    if h is not None:
        raise InputError("h", f"'{chosen.name}' chooses its own steps", "tol or nothing", f"{h!r}")
    if chosen.step == "events" and tol is not None:
        raise InputError("tol", "the method 'events' is exact to rounding", "nothing", f"{tol!r}")
    at = np.linspace(0.0, t_end, 1001) if times is None else checked_times(times, t_end)
    if budget is not None:
        check_number("budget", budget, least=1)
        if budget > MOST_BUDGET:
            raise InputError("budget", "too large", f"at most {MOST_BUDGET:,}", f"{budget:,}")
    if tol is not None:
        check_number("tol", tol, least=1e-14 if chosen.name in OWN else 1e-13)
        if tol > 0.1:
            raise InputError("tol", "too large", "at most 0.1", f"{tol:g}")
    steps = int(budget or BUDGETS.get(chosen.name, BUDGETS[chosen.step]))
    task = _Task(law, bench, chosen, float(t_end), at, steps, tol)
    if chosen.step == "events":
        return _heard(task, _events)
    return _heard(task, _smooth) if chosen.name in OWN else _scipy(task)


def checked_times(times: ArrayLike, t_end: float) -> NDArray:
    """Instants of samples, rising within the run."""
    few = not isinstance(times, Sized) or len(times) <= MOST_SAMPLES
    at = as_numbers("times", times).ravel() if few else np.empty(0)
    if not at.size or not np.isfinite(at).all() or np.any(np.diff(at) <= 0.0):
        raise InputError("times", "not rising", f"1 to {MOST_SAMPLES} rising numbers")
    if at[0] < 0.0 or at[-1] > t_end * (1.0 + 1e-9):
        raise InputError("times", "outside the run", f"0 to {t_end:g}", f"{at[0]:g} to {at[-1]:g}")
    return np.minimum(at, t_end)


class _Task(NamedTuple):
    """A run as it was asked for."""

    model: Any
    bench: Testbench
    method: Method
    t_end: float
    times: NDArray = np.empty(0)
    budget: int = 0
    tol: float | None = None

    @property
    def contact(self) -> "tuple[Law, Drive, float, NDArray]":
        """In the form of the kernels."""
        return self.model.law, self.bench.drive, float(self.bench.mass), self.bench.start


def _fixed(task: _Task, h: float | None) -> Result:
    from friction.kernel.fixed import march
    from friction.kernel.structures import fixed_run

    if h is None:
        raise InputError("h", f"'{task.method.name}' needs a step", "a number of seconds")
    check_number("h", h, above=0.0)
    if task.t_end / h > MOST_STEPS:
        expected, given = f"at most {MOST_STEPS:,} steps up to t_end", f"{task.t_end / h:.3g} steps"
        raise InputError("h", "too small", expected, given)
    steps = round(task.t_end / h)
    if steps < 1:
        raise InputError("h", "longer than the run", f"at most t_end = {task.t_end:g}", f"{h:g}")
    every = -(-steps // MOST_SAMPLES)
    samples, code = -(-steps // every) + 1, ("euler", "rk4", "moreau", "exponential").index(task.method.name)
    run = fixed_run(*task.contact, float(h), samples, min(steps, MOST_EVENTS) + 1)
    status = march(pack(run), steps, code, every)
    return _packed(task, status, run.counts, run.record, run.events)


def _scipy(task: _Task) -> Result:
    from friction.adaptive import adaptive

    solver, tol = task.method.name.removesuffix("-events"), 1e-6 if task.tol is None else task.tol
    how = tol, task.budget, solver, solver != task.method.name
    status, made, record, met = adaptive(task.model, task.bench, task.t_end, task.times, *how)
    task = task._replace(tol=None)
    return _packed(task, status, np.array([made, 0, len(met)]), record, np.reshape(met, (-1, 4)))


def _heard(task: _Task, run: "Callable[[_Task, NDArray, int], tuple[Result, NDArray]]") -> Result:
    """Run with samples at the times asked for, checked by the witness at other instants too.

    Room for as many events as there may be costs more than most runs, so that few are expected at first, and counted.
    """
    model, bench, times = task.model, task.bench, task.times
    windows = witness.windows(model, bench, task.t_end)
    all_times = np.union1d(times, windows)
    result, changes = run(task, all_times, FEW_EVENTS)
    if result.event_count > FEW_EVENTS:
        result, changes = run(task, all_times, min(result.event_count, MOST_EVENTS))
    columns, doubt = result.columns, None
    if result.status is Status.DONE and result.event_count == len(result.events):
        heard, lag = np.searchsorted(all_times, windows), getattr(model, "lag", 0.0)
        events = np.sort(np.concatenate([[lag], changes, changes + lag])) if lag else changes
        doubt = witness.doubt(model, bench, columns, heard, result.errors, events)
    asked = np.searchsorted(all_times, times)
    asked = asked[asked < result.t.size]
    kept = {name: column[asked] for name, column in columns.items()}
    if result.stored is not None:
        kept["stored"] = result.stored[asked]
    return replace(result, **kept, doubt=doubt, status=Status.DOUBTED if doubt else result.status)


def _smooth(task: _Task, times: NDArray, room: int) -> tuple[Result, NDArray]:
    from friction.kernel import rodas, series
    from friction.kernel.structures import RUN, Bench, SmoothRun, compared
    from friction.kernel.tolerance import solve

    law, drive, mass, start = task.contact
    both = compared(times.size, room + 1, (series if task.method.name == "taylor" else rodas).TERMS)
    here = Bench(drive, mass, start, task.t_end, times)
    run = SmoothRun(law, here, float(task.tol or 0.0), OWN[task.method.name], both)
    status, chosen = solve(pack(run), task.budget), both.counts[RUN]
    told = dict(zip(COLUMNS[:-1], both.errors.tolist()[:-1], strict=True))
    if list(Status)[status] not in (Status.DONE, Status.INACCURATE):
        told = {}
    records, events = both.records[chosen], both.events[chosen]
    result = _packed(task, status, both.counts, records, events, told)
    return result, events[: result.event_count, 2]


def _events(task: _Task, times: NDArray, room: int) -> tuple[Result, NDArray]:
    from friction.kernel.automaton import automaton
    from friction.kernel.law import V, Z
    from friction.kernel.structures import EVENTS, STEPS

    model = task.model
    mechanism, run = on_testbench(model, task.bench, task.t_end, times, room + 1)
    status, record, met = automaton(pack(run), task.budget), run.record, int(run.counts[EVENTS])
    changes, z, stored = run.events[: min(met, MOST_EVENTS)], np.zeros(times.size), None
    if isinstance(model, SpringContact):
        n = len(model.elements)
        record, springs, modes = record[:, : -2 * n], record[:, -2 * n : -n], record[:, -n:]
        z, stored = model.bent(springs, modes, record[:, V])
        mode, changes = np.where(np.ptp(modes, axis=1) == 0.0, modes[:, 0], 0.0), mechanism.changes(run)
        record, met = np.column_stack([record, mode]), len(changes) if met <= room else met
    counts = np.array([run.counts[STEPS], 0, met])
    result = _packed(task, status, counts, np.insert(record, Z, z, axis=1), changes, stored=stored)
    return result, run.events[: min(int(run.counts[EVENTS]), room), 2]


def on_testbench(
    model: Model | SpringContact, bench: Testbench, t_end: float, times: NDArray, events: int
) -> "tuple[Mechanism, HybridRun]":
    """Make a mechanism of the mass with its contact, the applied force, and the spring or controller.

    It shows x, v, F_a, F_f and both works, then the forces of the springs of a law that has some.
    """
    from friction.kernel.structures import Inputs
    from friction.mechanism import Mechanism

    m, drive, pid, play = Mechanism(), bench.drive, bench.controller, bench.spring and bench.spring.play
    v, x = m.state(bench.v0), m.state(bench.x0, watched=False)
    works = m.state(watched=False), m.state(watched=False)
    f_a = m.input()
    if drive.stiffness or drive.integral or drive.derivative:
        away = drive.target - float(bench.x0)
        gap, closing = m.state(away, watched=bool(drive.integral)), m.add({v: -1.0}, drive.speed)
        m.integrate(gap, closing)
        if play:
            pull = m.add({gap: drive.stiffness, m.limited(gap, play): -drive.stiffness})
        elif pid and pid.period:
            total, before = m.register(0.0), m.register(away)
            total, rate = m.add({total: 1.0, gap: pid.period}), m.add({gap: 1.0, before: -1.0})
            asked = {gap: drive.stiffness, total: drive.integral, rate: drive.derivative / pid.period}
            pull = m.limited(m.add(asked), inf if pid.limit is None else pid.limit)
            (pull,) = m.sample([total, gap], [pull], pid.period, pid.delay)
        else:
            pull = m.state(drive.stiffness * away, watched=False)
            m.integrate(pull, m.add({closing: drive.stiffness, gap: drive.integral}))
            pull = m.add({pull: 1.0, closing: drive.derivative})
            pull = m.limited(pull, inf if pid is None or pid.limit is None else pid.limit)
        f_a = m.add({f_a: 1.0, pull: 1.0})
    f_f, net = m.contact(model, v, f_a)
    m.integrate(v, m.add({net: 1.0 / bench.mass}))
    m.integrate(x, v)
    for work, force in zip(works, (f_a, f_f), strict=True):
        m.integrate(work, m.multiply(force, v))
    power = np.stack([drive.value, drive.slope], axis=-1)[:, None]
    inputs = Inputs(drive.start, power, drive.amplitude, drive.omega, drive.phase)
    shown = [x, v, f_a, f_f, *works, *(m.springs if isinstance(model, SpringContact) else [])]
    return m, m.prepared(times, shown, inputs, t_end=t_end, places=[x], events=events)


def _packed(
    task: _Task, status: int, counts: NDArray, record: NDArray, events: NDArray,
    errors: dict[str, float] | None = None, stored: NDArray | None = None,
) -> Result:  # fmt: skip
    t, x, v, z, f_a, f_f, w_a, w_f, mode = record[np.isfinite(record[:, 0])].T
    made, refused, met = counts.tolist()[:3]
    return Result(
        task.model, task.bench, task.method, list(Status)[status], made, refused, t, x, v, z, f_a, f_f, w_a, w_f,
        mode.astype(int), events_of(events[: min(met, MOST_EVENTS)]), met, task.tol, errors or {}, stored=stored,
    )  # fmt: skip
