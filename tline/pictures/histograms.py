"""How values of many runs are spread."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from tline.pictures.style import DASHES, INK

BINS = 60
QUANTILES = (0.05, 0.5, 0.95)


def draw_histogram(axes: Axes, values: NDArray, error: float, colour: str) -> None:
    """Draw a histogram with quantiles; a word where values differ by no more than their error."""
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
