"""The friction force that a prescribed motion meets, for every law."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.methods import ALL, SPRING_CONTACTS, STATIC
from friction.models import MODELS, Karnopp, Model
from friction.motion import Motion, moved_along, moved_by, moved_with
from friction.parameters import check_number
from friction.simulation import checked_times
from friction.spring_contact import SpringContact
from friction.testbench import FORCES, Force
from tline.compiled.structure import pack
from tline.errors import InputError, check_kind
from tline.presentation import History, plain

if TYPE_CHECKING:
    from friction.kernel.prescribed import Course

FINE, SPREAD = 1e-13, 100.0  # error of steps, relative to the largest deflection, and how much rougher a second run is
TIME_ROUNDING = 1e-15
MOST_STEPS = 5_000_000
LAWS: dict[str, type[Any]] = MODELS | {law.name: law for law in SPRING_CONTACTS}
UNITS = {"t": "s", "x": "m", "v": "m/s", "z": "m", "F_f": "N", "F_low": "N", "F_high": "N"}


@dataclass(frozen=True, repr=False)
class Prescribed(History):
    """A prescribed motion and the friction that it meets: arrays of shape (n,), one entry a sample.

    Attributes
    ----------
    model : Model, Armstrong or MaxwellSlip
        The law.
    t, x, v : ndarray
        Time [s], place [m], velocity [m/s].
    z : ndarray
        Deflection of the bristles [m], 0 for the static laws.
    F_f : ndarray
        Friction [N]: the force to apply beside inertia. NaN at rest under a static law, which balances any force
        from F_low to F_high.
    F_low, F_high : ndarray
        Least and largest force [N] that this motion is compatible with; equal where the law gives one.
    errors : dict
        Largest errors of z and F_f between 0 and t_end, and of v where a formula gives the motion, relative to the
        largest magnitude of each; empty for closed forms, exact to rounding.
    steps : int
        Steps of the integration.
    """

    model: Model | SpringContact
    t: NDArray
    x: NDArray
    v: NDArray
    z: NDArray
    F_f: NDArray
    F_low: NDArray
    F_high: NDArray
    errors: dict[str, float]
    steps: int
    picture, units = "friction.pictures:draw_moved", UNITS

    @property
    def columns(self) -> dict[str, NDArray]:
        """All columns by name, SI."""
        return {name: getattr(self, name) for name in UNITS}

    @property
    def held(self) -> NDArray:
        """Where a static law holds the contact at rest."""
        return np.isnan(self.F_f)

    def text_lines(self) -> Iterator[str]:
        """Ranges of force, place and deflection, and how good they are."""
        told = f"{self.model.name}: F_f {self.F_low.min():.6g} to {self.F_high.max():.6g} N"
        told += f", x {self.x.min():.6g} to {self.x.max():.6g} m"
        if self.z.any():
            told += f", z {self.z.min():.6g} to {self.z.max():.6g} m"
        if self.held.any():
            at = f"{self.held.sum()} of {self.t.size} samples"
            told += f"; at rest ({at}) any force up to {self.F_high[self.held].max():g} N"
        errors = [f"{name} {error:.0e}" for name, error in self.errors.items()]
        yield told + (f"; errors, of the largest: {', '.join(errors)}" if errors else "; exact to rounding")

    def to_dict(self) -> dict[str, Any]:
        """Model, errors, steps and all samples."""
        return plain({"model": self.model.name, "errors": self.errors or None, "steps": self.steps} | self.columns)


def prescribe(
    model: Model | SpringContact,
    *,
    velocity: Force | Callable[[NDArray], ArrayLike] | None = None,
    position: Force | Callable[[NDArray], ArrayLike] | None = None,
    t_end: float = 1.0,
    times: ArrayLike | None = None,
    z0: float = 0.0,
) -> Prescribed:
    """Friction that a prescribed motion meets.

    Static laws and tanh have closed forms. Bristles are integrated from reversal to reversal, which are roots of the
    velocity, by Radau collocation of order 9 with errors of 1e-13 a step; a run 100 times rougher estimates the error.
    Formulas are replaced by splines, to 1e-9 of the largest velocity.

    Parameters
    ----------
    model : Model, Armstrong or MaxwellSlip
        `Coulomb`, `Karnopp`, `LuGre`, `Dahl`, `ElastoPlastic`, `Tanh`, `Armstrong` or `MaxwellSlip`.
    velocity : Ramp, Sine, Steps, Table or callable
        Velocity [m/s] over time, from x = 0 on; or a smooth function of an array of times [s] that gives it.
    position : Ramp, Sine, Table or callable
        Or place [m] over time.
    t_end : float, optional
        End [s], positive.
    times : array_like, optional
        Where to look [s], rising, within [0, t_end]; 1001 equal steps if not given.
    z0 : float, optional
        Deflection of the bristles at t = 0 [m].

    Raises
    ------
    InputError
        Not one of velocity and position, a position that jumps, a formula that is not smooth, z0 for a law without
        bristles, or a number out of range.

    Examples
    --------
    >>> from friction import Coulomb, Sine, prescribe
    >>> run = prescribe(Coulomb(F_v=0.5), velocity=Sine(1.0, 0.25), times=[0.0, 1.0])
    >>> run.F_f.tolist(), run.F_low.tolist()
    ([nan, 1.5], [-1.0, 1.5])
    """
    if (velocity is None) == (position is None):
        raise InputError("motion", "not one", "velocity or position")
    check_kind("model", model, *ALL, *SPRING_CONTACTS)
    check_number("t_end", t_end, above=0.0)
    check_number("z0", z0)
    at = np.linspace(0.0, t_end, 1001) if times is None else checked_times(times, t_end)
    where, given = ("velocity", velocity) if velocity is not None else ("position", position)
    errors: dict[str, float] = {}
    if callable(given):
        motion, rougher, errors["v"] = moved_by(given, t_end, where)
    else:
        check_kind(where, given, *FORCES)
        motion = rougher = (moved_with if where == "velocity" else moved_along)(given)  # type: ignore[arg-type]
    if isinstance(model, (*STATIC, *SPRING_CONTACTS)) and z0:
        raise InputError("z0", f"the {model.name} model has no bristles", "0", f"{z0:g}")
    if isinstance(model, SpringContact):
        force, zeros = model.moved(motion, at, t_end), np.zeros(at.size)
        return Prescribed(model, at, motion.place(at), motion.velocity(at), zeros, force, force, force, errors, 0)
    if isinstance(model, STATIC):
        return _static(model, motion, at, errors)
    x, v, course = motion.place(at), motion.velocity(at), motion.course(t_end)
    (z, force), steps = deflection(model, course, at, v, z0, FINE)
    if model.law.sigma0:
        rough, _ = deflection(model, rougher.course(t_end), at, rougher.velocity(at), z0, SPREAD * FINE)
        for name, fine, other in (("z", z, rough[0]), ("F_f", force, rough[1])):
            size = max(float(np.max(np.abs(fine))), np.finfo(float).tiny)
            errors[name] = float(np.max(np.abs(fine - other))) / size + TIME_ROUNDING * steps**0.5
    return Prescribed(model, at, x, v, z, force, force, force, errors, steps)


def _static(model: Model, motion: Motion, at: NDArray, errors: dict[str, float]) -> Prescribed:
    """Closed forms; at rest, or within a dead zone, any force up to F_s."""
    x, v, zeros = motion.place(at), motion.velocity(at), np.zeros(at.size)
    held = np.abs(v) <= (model.delta if isinstance(model, Karnopp) else 0.0)
    force, most = np.asarray(model.steady_force(v)), model.stiction
    low, high = np.where(held, -most, force), np.where(held, most, force)
    return Prescribed(model, at, x, v, zeros, np.where(held, np.nan, force), low, high, errors, 0)


def deflection(
    model: Model, course: "Course", times: NDArray, velocity: NDArray, z0: float, tol: float
) -> tuple[NDArray, int]:
    """z [m] and F_f [N] at times, shape (2, n), with steps to a tolerance of the deflection; the number of steps.

    Raises InputError: it takes more than 5 million steps.
    """
    from friction.kernel.law import DONE
    from friction.kernel.prescribed import deflect, prescribed_run

    law = model.law
    longest = np.max(np.abs(velocity)) * course.edges[-1] + abs(z0)
    allowed = tol * min(law.f_s / law.sigma0, longest) if law.sigma0 else tol
    run = prescribed_run(law, course, float(z0), max(allowed, 1e-300), times, velocity)
    status, steps = deflect(pack(run), MOST_STEPS), int(run.steps[0])
    if status != DONE:
        raise InputError(
            "t_end", "the motion takes too many steps", f"at most {MOST_STEPS:,}", f"more at {times[0]:g} s"
        )
    return run.out.T, steps
