"""Pictures of fitted laws: measured and fitted force, and what is left."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction.identify import Identification
from friction.pictures import COLOURS, NAMES, styled

MEASURED = "#9A9A9A"


@styled
def draw_fit(found: Identification) -> Figure:
    """Force over time, what is left of it, and force over velocity, of the law chosen.

    Parameters
    ----------
    found : Identification
        Laws fitted to a record.

    Examples
    --------
    >>> from friction import Coulomb, Sine, identify, prescribe
    >>> from friction.residuals import draw_fit
    >>> run = prescribe(Coulomb(), velocity=Sine(0.05, 1.0, phase=0.1))
    >>> len(draw_fit(identify(run.t, run.F_f, velocity=run.v, models=("coulomb",))).axes)
    4
    """
    best = found.fits[found.chosen]
    figure = Figure(figsize=(11.0, 5.6), dpi=140, layout="constrained")
    axes = figure.subplots(2, 2)
    for cell, over, label in ((axes[0, 0], found.t, "time t [s]"), (axes[0, 1], found.v, NAMES["v"])):
        cell.plot(over, found.force, ".", color=MEASURED, markersize=2.5, label="measured")
        cell.plot(over, best.force, color=COLOURS[0], linewidth=1.0, label=found.chosen)
        cell.set(xlabel=label, ylabel=NAMES["F_f"])
    axes[0, 1].legend(loc="lower right")
    draw_residual(axes[1, 0], found)
    axes[1, 1].hist(best.force - found.force, 60, color=COLOURS[0], density=True)
    if best.rms:
        grid = np.linspace(-4.0, 4.0, 201) * best.rms
        bell = np.exp(-0.5 * (grid / best.rms) ** 2) / best.rms / np.sqrt(2.0 * np.pi)
        axes[1, 1].plot(grid, bell, color=COLOURS[1], label="normal, same rms")
        axes[1, 1].legend()
    axes[1, 1].set(xlabel="fitted less measured [N]", ylabel="density [1/N]")
    return figure


def draw_residual(axes: Axes, found: Identification) -> Axes:
    """What is left of the force over time."""
    best = found.fits[found.chosen]
    axes.plot(found.t, best.force - found.force, ".", color=COLOURS[0], markersize=2.5)
    axes.set(xlabel="time t [s]", ylabel="fitted less measured [N]")
    return axes
