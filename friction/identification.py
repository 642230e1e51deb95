"""Which law a record of motion and force follows, and with which parameters."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.fit import FEWEST, Fit, fit, left_out, measured
from friction.models import MODELS, UNITS, Model
from tline.errors import InputError, check_kind
from tline.presentation import History, plain

CERTAIN = 1.96  # standard deviations on each side of an interval of 95 %
HOPELESS = 1.5  # times the least misfit to all samples: beyond it the law misses even the samples of its fit
CORRELATED = 0.2  # of neighbours in a residual that is more than noise


@dataclass(frozen=True, repr=False)
class Identification(History):
    """Laws fitted to one record; arrays of shape (n,), one entry a sample.

    Attributes
    ----------
    t, x, v : ndarray
        Time from the first sample on [s], place [m] and velocity [m/s] of the smoothed record.
    force : ndarray
        As measured [N].
    fits : dict of str to Fit
        By name of the law, best first.
    chosen : str
        The law with fewest parameters that foretells left-out blocks as well as the best one, within the standard error
        of their difference over the blocks.
    """

    t: NDArray
    x: NDArray
    v: NDArray
    force: NDArray
    fits: dict[str, Fit]
    chosen: str
    picture = "friction.pictures:draw_fit"
    units = {"t": "s", "x": "m", "v": "m/s", "force": "N"}  # noqa: RUF012

    @property
    def columns(self) -> dict[str, NDArray]:
        """Motion, measured force, and that of each law, by name, SI."""
        own = {name: getattr(self, name) for name in ("t", "x", "v", "force")}
        return own | {f"force {name}": one.force for name, one in self.fits.items()}

    @property
    def model(self) -> Model:
        """The law chosen, with its estimates."""
        return self.fits[self.chosen].model

    @property
    def correlation(self) -> float:
        """Correlation of neighbours in the residual of the law chosen: 0 for noise."""
        left = self.fits[self.chosen].force - self.force
        size = float(left @ left)
        return float(left[1:] @ left[:-1]) / size if size else 0.0

    def interval(self, name: str) -> tuple[float, float]:
        """Interval of 95 % for a parameter of the law chosen; NaN if it is at its bound."""
        best = self.fits[self.chosen]
        half = CERTAIN * best.deviations[name]
        return best.parameters[name] - half, best.parameters[name] + half

    def text_lines(self) -> Iterator[str]:
        """Law chosen, its parameters, those the data do not determine, and the other laws, as lines of text."""
        best, largest = self.fits[self.chosen], float(np.max(np.abs(self.force)))
        yield (
            f"{self.chosen}: misses blocks left out by {best.foretold:.4g} N (rms), all samples by {best.rms:.4g} N, "
            f"{100.0 * best.rms / largest:.2g} % of the largest force ({self.t.size:,} samples, {self.t[-1]:.6g} s)"
        )
        for name, value in best.parameters.items():
            half = CERTAIN * best.deviations[name]
            told = "at its bound" if np.isnan(half) else f"± {half:.2g}"
            yield f"  {name} = {value:.6g} {told} {UNITS[name]}"
        for names in best.vague:
            yield f"  the data do not tell {names}: other values fit as well"
        if abs(self.correlation) > CORRELATED:
            yield (
                f"  what is left is not noise: neighbours correlate by {self.correlation:.2f}, so intervals are too "
                "narrow, and the law leaves something out"
            )
        for name, other in self.fits.items():
            if name != self.chosen:
                blocks = f"blocks left out by {other.foretold:.4g} N, " if other.blocks.size else ""
                yield f"{name}: misses {blocks}all samples by {other.rms:.4g} N"

    def to_dict(self) -> dict[str, Any]:
        """Law chosen, and for each law estimates, deviations, misfits and parameters the data do not determine."""
        fits = {
            name: {
                "parameters": one.parameters, "deviations": one.deviations, "rms": one.rms, "foretold": one.foretold,
                "vague": one.vague,
            }
            for name, one in self.fits.items()
        }  # fmt: skip
        return plain({"chosen": self.chosen, "correlation": self.correlation, "fits": fits})


def identify(
    t: ArrayLike,
    force: ArrayLike,
    *,
    velocity: ArrayLike | None = None,
    position: ArrayLike | None = None,
    models: Sequence[str] = tuple(MODELS),
    folds: int = 5,
    progress: Callable[[], None] | None = None,
) -> Identification:
    """Fit laws to a record of motion and friction, and choose among them by cross-validation in blocks.

    The motion is smoothed as far as its own noise asks for; the force is fitted as it is, by least squares. Deviations
    of the estimates are those of noise in the force alone.

    Parameters
    ----------
    t : array_like, shape (n,)
        Time [s], rising; 50 to 100 000 samples.
    force : array_like, shape (n,)
        Friction [N], that is, without inertia.
    velocity : array_like, shape (n,)
        Velocity [m/s].
    position : array_like, shape (n,)
        Or place [m].
    models : sequence of str, optional
        Names of the laws to try; all six if not given.
    folds : int, optional
        Number of blocks, 2 to 20.
    progress : callable, optional
        Called twice for each law.

    Raises
    ------
    InputError
        Samples are missing, out of order, or say nothing; a name is unknown.

    Examples
    --------
    >>> import numpy as np
    >>> from friction import Dahl, Sine, identify, prescribe
    >>> run = prescribe(Dahl(F_c=2.0), velocity=Sine(0.05, 1.0), t_end=4.0)
    >>> found = identify(run.t, run.F_f, velocity=run.v, models=("coulomb", "dahl"))
    >>> found.chosen, round(found.model.F_c, 4)
    ('dahl', 2.0)
    """
    check_kind("models", models, list, tuple)
    unknown = [name for name in models if not isinstance(name, str) or name not in MODELS]
    if unknown or not models:
        raise InputError("models", "unknown" if unknown else "none", " or ".join(MODELS), f"'{(*unknown, '')[0]}'")
    if isinstance(folds, bool) or not isinstance(folds, int) or not 2 <= folds <= FEWEST * 2 // 5:
        raise InputError("folds", "not a number of blocks", "2 to 20", repr(folds)[:30])
    record = measured(t, force, velocity, position)
    told, found = progress or (lambda: None), dict[str, Fit]()
    for name in dict.fromkeys(models):
        found[name] = fit(MODELS[name], record)
        told()
    least = min(one.rms for one in found.values())
    for name, one in found.items():
        if one.rms <= HOPELESS * least:
            found[name] = replace(one, blocks=left_out(one, record, folds))
        told()
    fits = dict(sorted(found.items(), key=lambda item: (not item[1].blocks.size, item[1].foretold, item[1].rms)))
    return Identification(record.t, record.x, record.v, record.force, fits, _chosen(fits))


def _chosen(fits: dict[str, Fit]) -> str:
    """The simplest of those that differ from the best by no more than the standard error of the difference."""
    best = next(iter(fits.values())).blocks

    def alike(one: Fit) -> bool:
        excess = one.blocks - best
        return bool(excess.mean() <= excess.std(ddof=1) / excess.size**0.5 + 1e-12 * best.mean())

    return min(
        (len(one.deviations), one.foretold, name) for name, one in fits.items() if one.blocks.size and alike(one)
    )[2]
