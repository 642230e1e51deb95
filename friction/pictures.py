"""Pictures of runs, of friction over velocity, and of hysteresis."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction.models import Model
from friction.result import Kind, Result
from friction.simulate import simulate
from friction.testbench import Sine, Testbench
from tline.pictures.style import COLOURS, DASHES, FAINT, cells_of, figure, styled

NAMES = {
    "v": "velocity v [m/s]", "x": "place x [m]", "z": "deflection z [m]", "F_f": "friction F_f [N]",
    "F_a": "applied force F_a [N]",
}  # fmt: skip
MARKS = {Kind.BREAK_AWAY: "^", Kind.STOP: "s", Kind.REVERSAL: "x"}
MOST_MARKS = 40


class Panel(NamedTuple):
    """What is drawn in one pair of axes: a quantity of some runs within a window of time [s]."""

    quantity: str
    labels: tuple[str, ...]
    window: tuple[float, float]


@styled
def draw_panels(runs: Mapping[str, Result], panels: Sequence[Panel], ax: Axes | None = None) -> Figure | Axes:
    """Quantities of runs over time; F_f together with F_a; marks: triangle break-away, square stop, cross reversal.

    Parameters
    ----------
    runs : mapping of str to Result
        Runs by their labels.
    panels : sequence of Panel
        Beside each other if there are two, else one below the other.
    ax : matplotlib Axes, optional
        Where to draw the first panel alone.

    Examples
    --------
    >>> from friction import Coulomb, Testbench, simulate
    >>> from friction.pictures import Panel, draw_panels
    >>> run = simulate(Coulomb(), Testbench())
    >>> len(draw_panels({"Coulomb": run}, [Panel("v", ("Coulomb",), (0.0, 10.0))]).axes)
    1
    """
    beside = len(panels) == 2
    size = (10.0, 3.4, 1, 2) if beside else (7.0, 2.2 * len(panels), len(panels), 1)
    drawn, cells = cells_of(ax, *size)
    for cell, panel in zip(cells, panels, strict=False):
        _trace(cell, runs, panel)
        if cell is cells[0] or panel.quantity == "F_f":
            cell.legend()
    return drawn


def _trace(axes: Axes, runs: Mapping[str, Result], panel: Panel) -> None:
    low, high = panel.window
    for k, label in enumerate(panel.labels):
        run, colour = runs[label], COLOURS[k % len(COLOURS)]
        values, inside = getattr(run, panel.quantity), (run.t >= low) & (run.t <= high)
        if panel.quantity == "F_f":
            axes.plot(
                run.t[inside], run.F_a[inside], color=FAINT, linewidth=1.0, zorder=1, label="F_a" if k == 0 else None
            )
        axes.plot(run.t[inside], values[inside], color=colour, label=label, linestyle=DASHES[k % len(DASHES)])
        for event in run.events if len(run.events) < MOST_MARKS else ():
            if low <= event.t <= high:
                at = np.interp(event.t, run.t, values)
                axes.plot(event.t, at, MARKS[event.kind], color=colour, markersize=4)
    if panel.quantity == "F_f":  # the force goes on rising, friction is what is looked at
        seen = np.concatenate(
            [runs[label].F_f[(runs[label].t >= low) & (runs[label].t <= high)] for label in panel.labels]
        )
        axes.set_ylim(min(0.0, 1.1 * seen.min()), 1.25 * seen.max())
    axes.set(xlabel="time t [s]", ylabel=NAMES[panel.quantity], xlim=panel.window)
    axes.grid(True)


def draw_runs(runs: Mapping[str, Result], quantities: tuple[str, ...] = ("v", "F_f", "x")) -> Figure:
    """Quantities of some runs over time, from their beginning to their end, one below the other.

    Parameters
    ----------
    runs : mapping of str to Result
        Runs by their labels.
    quantities : tuple of str, optional
        Of `x`, `v`, `z`, `F_a`, `F_f`.

    Examples
    --------
    >>> from friction import Coulomb, Testbench, simulate
    >>> from friction.pictures import draw_runs
    >>> len(draw_runs({"Coulomb": simulate(Coulomb(), Testbench())}).axes)
    3
    """
    window = 0.0, max(float(run.t[-1]) for run in runs.values())
    drawn = draw_panels(runs, [Panel(quantity, tuple(runs), window) for quantity in quantities])
    assert isinstance(drawn, Figure)
    return drawn


@styled
def draw_curves(models: Mapping[str, Model], v_max: float = 0.5) -> Figure:
    """Steady friction over velocity, and hysteresis: friction over place under a slow sine of 0.8 and 1.5·F_c.

    Parameters
    ----------
    models : mapping of str to Model
        Models by their labels.
    v_max : float, optional
        Largest velocity [m/s], positive.

    Examples
    --------
    >>> from friction import LuGre
    >>> from friction.pictures import draw_curves
    >>> len(draw_curves({"LuGre": LuGre()}).axes)
    3
    """
    picture = figure(11.0, 3.4, "")
    axes = picture.subplots(1, 3, squeeze=False)
    v = np.linspace(-v_max, v_max, 2001)
    for k, (label, model) in enumerate(models.items()):
        colour = COLOURS[k % len(COLOURS)]
        axes[0, 0].plot(v, model.steady_force(v), color=colour, label=label)
        for cell, load in zip(axes[0, 1:], (0.8, 1.5), strict=True):
            run = simulate(model, Testbench(Sine(load * model.sliding, 0.25)), 8.0, times=np.linspace(0.0, 8.0, 4001))
            cell.plot(1e3 * run.x, run.F_f, color=colour)
            cell.set(xlabel="place x [mm]", ylabel=NAMES["F_f"], title=f"force {load}·F_c·sin(2π·t/4 s)")
    axes[0, 0].set(xlabel=NAMES["v"], ylabel=NAMES["F_f"], title="steady sliding")
    axes[0, 0].legend()
    for cell in axes[0]:
        cell.grid(True)
    return picture
