"""Records of motion and force, smoothed, and parameters of one law from them by nonlinear least squares."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.methods import STATIC
from friction.models import Model
from friction.motion import Motion, splined
from friction.prescribed import deflection
from tline.errors import InputError, as_numbers

if TYPE_CHECKING:
    from friction.kernel.prescribed import Course


FEWEST, MOST_SAMPLES = 50, 100_000  # samples
REST = 1e-3  # of the largest velocity, below which a static law is taken to be at rest
NORMAL, FOURTH = (
    0.6745,
    70.0**0.5,
)  # median of |noise|, and growth of noise in fourth differences, both over its deviation
EXACT = 1e-6  # of the range, noise below which the spline goes through all samples


class Measured(NamedTuple):
    """A record: arrays of shape (n,), time from 0 on, and the velocity between the samples."""

    t: NDArray
    x: NDArray
    v: NDArray
    force: NDArray
    course: "Course"

    @property
    def at_rest(self) -> NDArray:
        """Samples with a speed of at most REST times the largest."""
        return np.abs(self.v) <= REST * np.max(np.abs(self.v))


def measured(t: ArrayLike, force: ArrayLike, velocity: ArrayLike | None, position: ArrayLike | None) -> Measured:
    """The record of a test, its velocity by a smoothing spline.

    Raises InputError: samples are missing or out of order, or nothing moves or changes.
    """
    if (velocity is None) == (position is None):
        raise InputError("motion", "not one", "velocity or position")
    name, given = ("velocity", velocity) if position is None else ("position", position)
    arrays = {key: _column(key, value) for key, value in (("t", t), ("force", force), (name, given))}
    time, size = arrays["t"], arrays["t"].size
    for key, column in arrays.items():
        if column.size != size:
            raise InputError(key, "not as long as t", f"{size} samples", f"{column.size}")
    if not FEWEST <= size <= MOST_SAMPLES:
        raise InputError(
            "t", "too few samples" if size < FEWEST else "too many samples", f"{FEWEST} to {MOST_SAMPLES:,}", f"{size}"
        )
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if late.size:
        raise InputError(
            f"t[{late[0] + 1}]", "time does not rise", f"more than {time[late[0]]:g}", f"{time[late[0] + 1]:g}"
        )
    for key in ("force", name):
        if np.ptp(arrays[key]) <= 1e-12 * np.max(np.abs(arrays[key])):
            raise InputError(key, "constant", "something that changes" if key == "force" else "a motion")
    motion = _smooth(time - time[0], arrays[name], name == "position")
    at = time - time[0]
    return Measured(at, motion.place(at), motion.velocity(at), arrays["force"], motion.course(float(at[-1])))


def _column(name: str, values: ArrayLike | None) -> NDArray:
    column = as_numbers(name, values).ravel()
    bad = np.flatnonzero(~np.isfinite(column))
    if bad.size:
        raise InputError(f"{name}[{bad[0]}]", "a gap", "a number for each sample", f"{bad.size} without")
    return column


def _smooth(t: NDArray, values: NDArray, is_position: bool) -> Motion:
    """A spline as rough as the noise, which the fourth differences of the samples show.

    C. H. Reinsch, Numerische Mathematik 10 (1967) 177; P. Dierckx, Curve and Surface Fitting with Splines (1993).
    """
    noise = float(np.median(np.abs(np.diff(values, 4)))) / NORMAL / FOURTH
    return splined(t, values, is_position, 0.0 if noise < EXACT * np.ptp(values) else noise)


TOL = 1e-8  # of the deflection in a run
DIFFERENCE = 1e-4  # step of scaled parameters for derivatives
PEAK, SHARE = 20.0, 0.999  # largest F_s/F_c - 1, largest z_ba·σ0/F_c
LOGARITHM = 12.0  # scaled parameters that are logarithms stay within this of where they begin
MOST_TRIALS, MOST_AGAIN = 60, 12  # of a fit, and of one without a block
VAGUE = 0.5  # relative standard deviation of a direction that the data do not tell
LEADING = 0.3  # share of a parameter in a direction that names it
AT_BOUND = 1e-6
ENOUGH = 1e-7  # relative change of the sum of squares; a deviation changes it by 1/n


@dataclass(frozen=True)
class Fit:
    """A law fitted to a record.

    Attributes
    ----------
    model : Model
        With the estimates.
    deviations : dict of str to float
        Standard deviation of each parameter, in its unit; NaN where it is at its bound.
    force : ndarray, shape (n,)
        Its friction at the samples [N]; at rest under a static law the measured force, up to F_s.
    rms : float
        Root mean square of the residual [N].
    blocks : ndarray, shape (folds,)
        Mean square of each block of samples that was left out of the fit, one after the other [N²]; empty for a law
        that is out of the question, since another fits all samples better by far.
    vague : list of str
        Directions that the data do not tell, by the parameters that lead in them.
    scaled : ndarray
        Where the search ended, from which those without a block begin.
    """

    model: Model
    deviations: dict[str, float]
    force: NDArray
    rms: float
    blocks: NDArray
    vague: list[str]
    scaled: NDArray

    @property
    def parameters(self) -> dict[str, float]:
        """Estimates by name."""
        return {name: getattr(self.model, name) for name in self.deviations}

    @property
    def foretold(self) -> float:
        """Root mean square over all blocks left out [N]; NaN for a law out of the question."""
        return float(np.sqrt(self.blocks.mean())) if self.blocks.size else float("nan")


class Scaled:
    """A law's parameters as numbers of order 1: logarithms of positive ones, F_s over F_c, z_ba over F_c/σ0."""

    def __init__(self, kind: type[Model], sizes: Mapping[str, float]):
        self.kind, self.sizes = kind, sizes
        self.names = [field.name for field in fields(kind) if field.name != "delta"]
        shape = {"F_s": (0.0, PEAK), "z_ba": (0.0, SHARE)} | dict.fromkeys(("F_v", "sigma1", "sigma2"), (0.0, np.inf))
        self.bounds = np.array([shape.get(name, (-LOGARITHM, LOGARITHM)) for name in self.names]).T

    def model(self, scaled: NDArray) -> Model:
        """Return the law with scaled parameters."""
        given = dict(zip(self.names, scaled.tolist(), strict=True))
        for name, value in given.items():
            if name not in ("F_s", "z_ba"):
                given[name] = self.sizes[name] * (value if name in ("F_v", "sigma1", "sigma2") else np.exp(value))
        if "F_s" in given:
            given["F_s"] = given["F_c"] * (1.0 + given["F_s"])
        if "z_ba" in given:
            given["z_ba"] = given["z_ba"] * given["F_c"] / given["sigma0"]
        return self.kind(**{name: float(value) for name, value in given.items()})

    def values(self, scaled: NDArray) -> NDArray:
        """Return the parameters of the law, unscaled."""
        model = self.model(scaled)
        return np.array([getattr(model, name) for name in self.names])


def residual(model: Model, record: Measured) -> NDArray:
    """Friction of the law less the measured force, at all samples; at rest of a static law the excess over F_s."""
    if isinstance(model, STATIC):
        rest, force = record.at_rest, record.force
        held = np.clip(force, -model.stiction, model.stiction)
        return np.where(rest, held, model.steady_force(record.v)) - force
    return deflection(model, record.course, record.t, record.v, 0.0, TOL)[0][1] - record.force


def fit(kind: type[Model], record: Measured) -> Fit:
    """Least squares from the best start at each Stribeck velocity, or the two best of a law without one."""
    scaled, starts = _starts(kind, record)
    everything, inside = np.ones(record.t.size, bool), scaled.bounds
    costs = [float(np.sum(residual(scaled.model(start), record) ** 2)) for start in starts]
    order = [starts[k] for k in np.argsort(costs)]
    if "v_s" in scaled.names:
        order = list({start[scaled.names.index("v_s")]: start for start in order[::-1]}.values())
    else:
        order = order[:2]
    found = [_solved(scaled, record, start, everything, MOST_TRIALS) for start in order]
    best, jacobian, left = min(found, key=lambda each: float(each[2] @ each[2]))
    free = (best > inside[0] + AT_BOUND) & (best < inside[1] - AT_BOUND)
    deviations, vague = _told(scaled, best, jacobian, left, free)
    told = dict(zip(scaled.names, deviations.tolist(), strict=True))
    rms = float(np.sqrt(np.mean(left**2)))
    return Fit(scaled.model(best), told, record.force + left, rms, np.empty(0), vague, best)


def left_out(one: Fit, record: Measured, folds: int) -> NDArray:
    """Mean square of the residual of each block by the fit to all others [N²]."""
    scaled, squares = _starts(type(one.model), record)[0], []
    for block in np.array_split(np.arange(record.t.size), folds):
        kept = np.ones(record.t.size, bool)
        kept[block] = False
        other = _solved(scaled, record, one.scaled, kept, MOST_AGAIN)[0]
        squares.append(np.mean(residual(scaled.model(other), record)[block] ** 2))
    return np.array(squares)


def _starts(kind: type[Model], record: Measured) -> tuple[Scaled, list[NDArray]]:
    """Sizes from the data, and a grid of Stribeck velocities and stiffnesses about them."""
    force, speed = np.abs(record.force), np.abs(record.v)
    fast = speed >= 0.5 * speed.max()
    f_c, most = float(np.median(force[fast])), float(np.quantile(force, 0.99))
    travel = float(np.ptp(record.x))
    sizes = {"F_c": f_c, "v_s": speed.max(), "epsilon": speed.max(), "sigma0": f_c / travel}
    sizes |= dict.fromkeys(("F_v", "sigma2", "sigma1"), f_c / speed.max())
    grid = {"v_s": (0.01, 0.05, 0.3), "sigma0": (3.0, 30.0, 300.0, 3000.0), "epsilon": (1e-4, 1e-3, 1e-2, 0.1)}
    first = {"F_c": 0.0, "F_s": max(most / f_c - 1.0, 0.05), "F_v": 0.05, "sigma2": 0.05, "sigma1": 0.05, "z_ba": 0.5}
    scaled = Scaled(kind, sizes)
    choices = [np.log(grid[name]) if name in grid else (first[name],) for name in scaled.names]
    return scaled, [np.array(start, float) for start in product(*choices)]


def _solved(
    scaled: Scaled, record: Measured, start: NDArray, kept: NDArray, trials: int
) -> tuple[NDArray, NDArray, NDArray]:
    """Scaled parameters, their Jacobian and the residual, of the samples kept."""
    from scipy.optimize import least_squares

    def left(at: NDArray) -> NDArray:
        return residual(scaled.model(at), record)[kept]

    def slopes(at: NDArray) -> NDArray:
        here, columns = left(at), []
        for k in range(at.size):
            step = DIFFERENCE if at[k] + DIFFERENCE < scaled.bounds[1, k] else -DIFFERENCE
            moved = at.copy()
            moved[k] += step
            columns.append((left(moved) - here) / step)
        return np.column_stack(columns)

    inside = np.clip(start, scaled.bounds[0] + 1e-9, scaled.bounds[1] - 1e-9)
    derivatives: Any = slopes  # the stubs of SciPy know no functions here
    options = {"max_nfev": trials, "xtol": 1e-7, "ftol": ENOUGH, "gtol": 1e-12}
    found = least_squares(left, inside, derivatives, (scaled.bounds[0], scaled.bounds[1]), **options)
    return found.x, np.asarray(found.jac), found.fun


def _told(scaled: Scaled, best: NDArray, jacobian: NDArray, left: NDArray, free: NDArray) -> tuple[NDArray, list[str]]:
    """Standard deviations of the parameters themselves, and directions that the data do not tell."""
    values, deviations = scaled.values(best), np.full(best.size, np.nan)
    columns = [(scaled.values(best + DIFFERENCE * unit) - values) / DIFFERENCE for unit in np.eye(best.size)]
    chain = np.column_stack(columns)[np.ix_(free, free)]
    if not free.any():
        return deviations, []
    relative = jacobian[:, free] @ np.linalg.inv(chain) * values[free]
    _, singular, directions = np.linalg.svd(relative, full_matrices=False)
    noise = np.sqrt(left @ left / max(left.size - free.sum(), 1))
    spread = noise / np.maximum(singular, 1e-12 * singular[0])
    deviations[free] = np.sqrt(((directions.T * spread) ** 2).sum(axis=1)) * values[free]
    names = np.array(scaled.names)[free]
    vague = [
        " and ".join(names[np.abs(row) > LEADING]) for size, row in zip(spread, directions, strict=True) if size > VAGUE
    ]
    return deviations, vague
