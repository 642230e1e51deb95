"""Pictures of runs, of friction over velocity, and of hysteresis."""

from collections.abc import Mapping
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction.exercise import Part
from friction.models import Model
from friction.result import Kind, Result
from friction.simulate import simulate
from friction.testbench import Sine, Testbench

# Okabe and Ito's colours, told apart with every kind of colour vision
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
LOOK: dict[Any, Any] = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E4E4E4",
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 8,
}
NAMES = {
    "v": "velocity v [m/s]", "x": "place x [m]", "z": "deflection z [m]", "F_f": "friction F_f [N]",
    "F_a": "applied force F_a [N]",
}  # fmt: skip
MARKS = {Kind.BREAK_AWAY: "^", Kind.STOP: "s", Kind.REVERSAL: "x"}
MOST_MARKS = 40
styled = matplotlib.rc_context(LOOK)  # around what draws


def _figure(rows: int, columns: int, width: float, height: float) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width, height), dpi=140, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _trace(axes: Axes, runs: Mapping[str, Result], quantity: str, window: tuple[float, float]) -> None:
    for k, (label, run) in enumerate(runs.items()):
        values, colour = getattr(run, quantity), COLOURS[k % len(COLOURS)]
        inside = (run.t >= window[0]) & (run.t <= window[1])
        style = ("-", (0, (5, 2)), (0, (2, 1.5)))[k % 3]
        axes.plot(run.t[inside], values[inside], color=colour, label=label, linestyle=style)
        for event in run.events[:MOST_MARKS]:
            if window[0] <= event.t <= window[1] and len(run.events) < MOST_MARKS:
                at = np.interp(event.t, run.t, values)
                axes.plot(event.t, at, MARKS[event.kind], color=colour, markersize=4)
    axes.set(xlabel="time t [s]", ylabel=NAMES[quantity], xlim=window)


@styled
def draw_runs(runs: Mapping[str, Result], quantities: tuple[str, ...] = ("v", "F_f", "x")) -> Figure:
    """Quantities of some runs over time; marks: triangle break-away, square stop, cross reversal.

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
    figure, axes = _figure(len(quantities), 1, 7.0, 2.2 * len(quantities))
    for cell, quantity in zip(axes[:, 0], quantities, strict=True):
        _trace(cell, runs, quantity, (0.0, max(float(run.t[-1]) for run in runs.values())))
    axes[0, 0].legend()
    return figure


@styled
def draw_exercise(parts: Mapping[str, Part]) -> Figure:
    """The parts of the exercise, one row each.

    Parameters
    ----------
    parts : mapping of str to Part
        Answers by their letters.

    Examples
    --------
    >>> from friction import PARTS
    >>> from friction.pictures import draw_exercise
    >>> len(draw_exercise({"b": PARTS["b"]()}).axes)
    2
    """
    figure, axes = _figure(len(parts), 2, 10.0, 2.5 * len(parts))
    for row, (letter, part) in zip(axes, parts.items(), strict=True):
        for cell, panel in zip(row, part.panels, strict=True):
            _trace(cell, {label: part.runs[label] for label in panel.labels}, panel.quantity, panel.window)
        row[0].set_title(f"({letter}) {part.title}", loc="left", fontweight="bold")
        row[0].legend()
    return figure


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
    figure, axes = _figure(1, 3, 11.0, 3.4)
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
    return figure
