"""Pictures of prescribed motions: hysteresis over place and over velocity."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction.pictures import COLOURS, NAMES, styled
from friction.prescribe import Prescribed


@styled
def draw_loops(runs: Mapping[str, Prescribed]) -> Figure:
    """Friction over place, velocity and time; where a static law holds the contact, all forces that it may have.

    Parameters
    ----------
    runs : mapping of str to Prescribed
        Runs by their labels.

    Examples
    --------
    >>> from friction import LuGre, Sine, prescribe
    >>> from friction.loops import draw_loops
    >>> len(draw_loops({"LuGre": prescribe(LuGre(), position=Sine(1e-3, 1.0))}).axes)
    3
    """
    figure = Figure(figsize=(11.0, 3.8), dpi=140, layout="constrained")
    for cell, quantity in zip(figure.subplots(1, 3), ("x", "v", "t"), strict=True):
        draw_loop(cell, runs, quantity)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=min(len(runs), 6))
    return figure


def draw_loop(axes: Axes, runs: Mapping[str, Prescribed], quantity: str) -> Axes:
    """Friction over x, v or t."""
    size = max(float(np.max(np.abs(run.x))) for run in runs.values())
    scale, unit = next(((f, u) for f, u in ((1.0, "m"), (1e3, "mm"), (1e6, "µm")) if size * f >= 1.0), (1e6, "µm"))
    for k, (label, run) in enumerate(runs.items()):
        colour, over = COLOURS[k % len(COLOURS)], getattr(run, quantity) * (scale if quantity == "x" else 1.0)
        style = ("-", (0, (5, 2)), (0, (2, 1.5)))[k % 3]
        axes.plot(over, run.F_f, color=colour, label=label, linestyle=style)
        axes.vlines(over[run.held], run.F_low[run.held], run.F_high[run.held], color=colour, alpha=0.3)
    axes.set(ylabel=NAMES["F_f"], xlabel={"x": f"place x [{unit}]", "t": "time t [s]"}.get(quantity, NAMES["v"]))
    return axes
