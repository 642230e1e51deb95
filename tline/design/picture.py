"""Extremes over the size that a design search varied, with its limits and the size found."""

from math import isfinite

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from tline.design.sizing import Sizing
from tline.style import COLOURS, DASHES, INK, cells_of, styled
from tline.units import handy

WIDTH, HEIGHT = 7.0, 4.2  # inches
WORDS = ("lowest", "highest")


@styled
def plot_sizing(sizing: Sizing, ax: Axes | None = None) -> Figure | Axes:
    """Draw the lowest and highest pressure or head over the size, their limits, and the size found."""
    name, size = sizing.searched
    limits, curve = sizing.limits, np.array(sizing.curve)
    metre, unit = handy(float(curve[:, 0].max()), size.unit) if size.unit in ("s", "bar") else (1.0, size.unit)
    per, effort = limits.unit
    drawn, (axes,) = cells_of(ax, WIDTH, HEIGHT, title=sizing.scene.title)
    for column, (word, colour) in enumerate(zip(WORDS, COLOURS, strict=False), 1):
        bound = (limits.lowest, limits.highest)[column - 1]
        axes.plot(curve[:, 0] / metre, curve[:, column] / per, marker=".", color=colour, label=f"{word} {limits.word}")
        if isfinite(bound):
            axes.axhline(bound / per, color=colour, linestyle=DASHES[column], linewidth=1.2, label=f"limit, {word}")
    axes.axvline(sizing.found.size / metre, color=INK, linewidth=1.0, label=f"{name}, {size}")
    axes.set(xscale="log", xlabel=f"{name} [{unit}]" if unit else name)
    axes.set_ylabel(f"{limits.word} {limits.where} [{effort}]")
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("")
    axes.grid()
    if ax is None:
        drawn.legend(loc="outside lower center", ncols=3)
    else:
        axes.legend()
    return drawn
