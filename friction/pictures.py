"""Pictures of runs, of friction over velocity, of hysteresis, and of laws fitted to a record."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction.identification import Identification
from friction.prescribed import Prescribed
from friction.result import Kind, Result
from tline.style import COLOURS, DASHES, FAINT, cells_of, styled

NAMES = {
    "v": "velocity v [m/s]", "x": "place x [m]", "z": "deflection z [m]", "F_f": "friction F_f [N]",
    "F_a": "applied force F_a [N]", "t": "time t [s]",
}  # fmt: skip
MARKS = {Kind.BREAK_AWAY: "^", Kind.STOP: "s", Kind.REVERSAL: "x"}
MOST_MARKS, MOST_COLUMNS = 40, 6  # events that are marked, and labels beside each other


class Panel(NamedTuple):
    """Content of one pair of axes: a quantity of some runs within a window of time [s]."""

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
        low, high = min(0.0, 1.1 * seen.min()), max(0.0, 1.25 * seen.max())
        axes.set_ylim(low, high if high > low else None)
    axes.set(xlabel=NAMES["t"], ylabel=NAMES[panel.quantity], xlim=panel.window)
    axes.grid(True)


def draw_run(runs: Result | Mapping[str, Result], ax: Axes | None = None) -> Figure | Axes:
    """Velocity, friction and place over time, of a run or of some by their labels, or the velocity on given axes."""
    if isinstance(runs, Result):
        runs = {f"{runs.model.name}, {runs.method.name}": runs}
    window = 0.0, max(float(run.t[-1]) for run in runs.values())
    return draw_panels(runs, [Panel(name, tuple(runs), window) for name in ("v", "F_f", "x")], ax)


@styled
def draw_moved(runs: Prescribed | Mapping[str, Prescribed], ax: Axes | None = None) -> Figure | Axes:
    """Friction over place, velocity and time; where a static law holds the contact, all forces that it may have.

    Parameters
    ----------
    runs : Prescribed or mapping of str to Prescribed
        A run, or runs by their labels.
    ax : matplotlib Axes, optional
        Where to draw friction over place alone.

    Examples
    --------
    >>> from friction import LuGre, Sine, prescribe
    >>> from friction.pictures import draw_moved
    >>> len(draw_moved(prescribe(LuGre(), position=Sine(1e-3, 1.0))).axes)
    3
    """
    runs = {runs.model.name: runs} if isinstance(runs, Prescribed) else runs
    size = max(float(np.max(np.abs(run.x))) for run in runs.values())
    scale, unit = next(((f, u) for f, u in ((1.0, "m"), (1e3, "mm"), (1e6, "µm")) if size * f >= 1.0), (1e6, "µm"))
    drawn, cells = cells_of(ax, 11.0, 3.8, columns=3)
    for axes, quantity in zip(cells, ("x", "v", "t"), strict=False):
        for k, (label, run) in enumerate(runs.items()):
            over = getattr(run, quantity) * (scale if quantity == "x" else 1.0)
            axes.plot(over, run.F_f, color=COLOURS[k % len(COLOURS)], label=label, linestyle=DASHES[k % len(DASHES)])
            ends = over[run.held], run.F_low[run.held], run.F_high[run.held]
            axes.vlines(*ends, color=COLOURS[k % len(COLOURS)], alpha=0.3)
        axes.set(xlabel=f"place x [{unit}]" if quantity == "x" else NAMES[quantity], ylabel=NAMES["F_f"])
        axes.grid(True)
    if isinstance(drawn, Figure):
        columns = min(len(runs), MOST_COLUMNS)
        drawn.legend(*cells[0].get_legend_handles_labels(), loc="outside upper center", ncols=columns)
    return drawn


@styled
def draw_fit(found: Identification, ax: Axes | None = None) -> Figure | Axes:
    """Draw the residual of the law chosen over time, its distribution, and measured and fitted force.

    Parameters
    ----------
    found : Identification
        Laws fitted to a record.
    ax : matplotlib Axes, optional
        Where to draw the residual alone.

    Examples
    --------
    >>> from friction import Coulomb, Sine, identify, prescribe
    >>> from friction.pictures import draw_fit
    >>> run = prescribe(Coulomb(), velocity=Sine(0.05, 1.0, phase=0.1))
    >>> len(draw_fit(identify(run.t, run.F_f, velocity=run.v, models=("coulomb",))).axes)
    4
    """
    best, label = found.fits[found.chosen], "fitted less measured [N]"
    drawn, cells = cells_of(ax, 11.0, 5.6, rows=2, columns=2)
    cells[0].plot(found.t, best.force - found.force, ".", color=COLOURS[0], markersize=2.5)
    cells[0].set(xlabel=NAMES["t"], ylabel=label)
    for axes, over, name in zip(cells[2:], (found.t, found.v), ("t", "v"), strict=False):
        axes.plot(over, found.force, ".", color=FAINT, markersize=2.5, label="measured")
        axes.plot(over, best.force, color=COLOURS[0], linewidth=1.0, label=found.chosen)
        axes.set(xlabel=NAMES[name], ylabel=NAMES["F_f"])
    for axes in cells[1:2]:
        axes.hist(best.force - found.force, 60, color=COLOURS[0], density=True)
        grid = np.linspace(-4.0, 4.0, 201)
        if best.rms:
            bell = np.exp(-0.5 * grid**2) / best.rms / np.sqrt(2.0 * np.pi)
            axes.plot(grid * best.rms, bell, color=COLOURS[1], label="normal, same rms")
            axes.legend()
        axes.set(xlabel=label, ylabel="density [1/N]")
        cells[-1].legend(loc="lower right")
    for axes in cells:
        axes.grid(True)
    return drawn
