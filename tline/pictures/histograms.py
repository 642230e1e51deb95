"""How the extremes of many runs are spread."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, INK, figure, styled
from tline.scene.medium import Medium
from tline.solver.many import Many

BINS = 60
QUANTILES = (0.05, 0.5, 0.95)


@styled
def plot_extremes(runs: Many, medium: Medium, title: str = "") -> Figure:
    """Histograms of the lowest and of the highest effort, a row for each probe, with 5, 50 and 95 % quantiles.

    Where runs differ by no more than the estimated error there is none, only the value that all have.

    Parameters
    ----------
    runs : Many
        With at least one probe.
    medium : Medium
        For the unit of efforts.
    title : str

    Returns
    -------
    matplotlib.figure.Figure
        With two axes for each probe.
    """
    picture = figure(8.0, 0.9 + 2.1 * len(runs.probes), title)
    panels = picture.subplots(len(runs.probes), 2, squeeze=False)
    for row, (name, seen) in zip(panels, runs.probes.items(), strict=True):
        weight = runs.heights[name].weight
        largest = float(max(np.abs(seen.lowest - weight).max(), np.abs(seen.highest - weight).max()))
        size, unit = handy(largest, medium.shown["effort"])
        error = runs.estimate * largest / size
        for axes, word, colour in zip(row, ("lowest", "highest"), COLOURS, strict=False):
            _draw(axes, (getattr(seen, word) - weight) / size, error, colour)
            axes.set_xlabel(f"{word} {medium.effort} at {name} [{unit}]")
        row[0].set_ylabel("runs")
    return picture


def _draw(axes: Axes, values: NDArray, error: float, colour: str) -> None:
    """One histogram; a word where all values are alike."""
    if np.ptp(values) <= error:
        middle = float(np.median(values))
        text = f"{middle if abs(middle) > error else 0:.4g} in all runs"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center")
        axes.set(xticks=[], yticks=[])
        return
    axes.hist(values, bins=BINS, color=colour, alpha=0.75)
    for share, side, dash in zip(
        QUANTILES, ("right", "center", "left"), (DASHES[2], DASHES[0], DASHES[2]), strict=True
    ):
        at = np.quantile(values, share)
        axes.axvline(at, color=INK, linewidth=1.0, linestyle=dash)
        axes.text(at, 1.02, f"{100 * share:g} %", transform=axes.get_xaxis_transform(), ha=side, fontsize=8)
    axes.margins(x=0.04)
    axes.locator_params(axis="x", nbins=6)
