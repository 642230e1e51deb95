"""Bergeron's diagram: load lines of both ends and the characteristics between them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, FAINT, INK, figure, styled
from tline.scene.medium import Medium
from tline.signal.load_line import Bergeron, LoadLine

ROOM = 0.15  # of what the states span, on every side
NUMBERED = 5  # states that are told apart by a number


@styled
def plot_load_lines(found: Bergeron, medium: Medium, title: str = "") -> Figure:
    """Effort over flow: where a characteristic meets the load line of the end it arrives at is the next state.

    Parameters
    ----------
    found : Bergeron
    medium : Medium
        For words and units.
    title : str

    Returns
    -------
    matplotlib.figure.Figure
    """
    size_u, unit_u = handy(float(np.abs(found.u).max()) or 1.0, medium.shown["effort"])
    size_y, unit_y = handy(float(np.abs(found.y).max()) or 1.0, medium.shown["flow"])
    picture = figure(8.0, 5.4, title)
    axes = picture.subplots()
    x, y = found.y / size_y, found.u / size_u
    axes.set_xlim(*_around(x))
    axes.set_ylim(*_around(y))
    for end, line in enumerate(found.ends):
        _draw(axes, LoadLine(line.p * size_u, line.q * size_y, line.r), COLOURS[end], end)
    axes.plot(x, y, color=INK, linewidth=1.1, marker="o", markersize=4, label="characteristics, slope ±z0")
    for k in range(min(NUMBERED, len(x))):
        time = ("before", "0", "T")[k] if k < 3 else f"{k - 1} T"
        axes.annotate(time, (x[k], y[k]), (0, 8), textcoords="offset points", fontsize=9, ha="right")
    axes.set_xlabel(f"{medium.flow} [{unit_y}]")
    axes.set_ylabel(f"{medium.effort} [{unit_u}]")
    axes.grid(True)
    picture.legend(loc="outside lower center", ncols=3)
    return picture


def _around(values: NDArray) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    room = ROOM * (high - low) or 1.0
    return low - room, high + room


def _draw(axes: Axes, line: LoadLine, colour: str, end: int) -> None:
    """One load line p u + q y = r across the picture."""
    look = {"color": colour, "linestyle": DASHES[end], "label": f"end {end + 1}"}
    if line.p == 0:
        axes.axvline(line.r / line.q, **look)
    else:
        axes.axline((0.0, line.r / line.p), slope=-line.q / line.p, **look)
    axes.axhline(0.0, color=FAINT, linewidth=0.6)
