"""Extremes of a sweep: over one path as curves, over two as maps, else as histograms."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.heights import words
from tline.style import COLOURS, DASHES, INK, cells_of, styled
from tline.sweeps import Sweep
from tline.sweeps.design import unit_of
from tline.sweeps.table import QUANTILES
from tline.units import handy

WORDS = ("highest", "lowest")
BINS = 60


@styled
def plot_sweep(found: Sweep, ax: Axes | None = None) -> Figure | Axes:
    """Draw the lowest and the highest effort at every probe.

    Over the values of a grid or a list of one path as curves, over those of a grid of two as maps; of all others, as
    histograms with 5, 50 and 95 % quantiles. Failed runs are left out. On `ax` all curves, or the highest effort at the
    first probe.
    """
    if "highest" not in found.kept or not found.probes or not len(found.good):
        raise InputError("plot", "there are no extremes to draw", "a sweep with probes, and keep='extremes'")
    numeric = all(values.dtype.kind == "f" for values in found.inputs.values())
    ordered = numeric and found.sample in ("grid", "list")
    if ordered and len(found.inputs) == 1:
        return _curves(found, ax)
    if ordered and len(found.shape) == 2 and min(found.shape) > 1:
        return _maps(found, ax)
    drawn, cells = _cells(found, 2.1, ax)
    for k, axes in enumerate(cells):
        values, name, error = _efforts(found, k)
        draw_histogram(axes, values[found.good], error, COLOURS[k % 2])
        axes.set_xlabel(name)
        if k % 2 == 0:
            axes.set_ylabel("runs")
    return drawn


def _cells(found: Sweep, height: float, ax: Axes | None) -> tuple[Figure | Axes, list[Axes]]:
    """Create a row of cells for the highest and the lowest effort of each probe."""
    rows = len(found.probes)
    return cells_of(ax, 8.0, 0.9 + height * rows, rows, 2, found.scene.title)


def _curves(found: Sweep, ax: Axes | None) -> Figure | Axes:
    ((path, values),) = found.inputs.items()
    drawn, (axes,) = cells_of(ax, 8.0, 4.2, title=found.scene.title)
    at, label = _along(found, path, values)
    order = np.argsort(at)
    largest = max(float(np.nanmax(np.abs(found[word]))) for word in WORDS)
    size, unit = handy(largest, words(found.scene).shown["effort"])
    for k, (name, colour) in enumerate(zip(found.probes, COLOURS * len(found.probes), strict=False)):
        for word, dash in zip(WORDS, DASHES, strict=False):
            axes.plot(
                at[order], found[word][order, k] / size, ls=dash, marker=".", color=colour, label=f"{name}, {word}"
            )
    axes.set(xlabel=label, ylabel=f"{words(found.scene, 'gauge pressure').effort} [{unit}]")
    if np.ptp(np.log(at)) > np.log(50) if (at > 0).all() else False:
        axes.set_xscale("log")
    axes.grid()
    axes.legend(handlelength=3)
    return drawn


def _maps(found: Sweep, ax: Axes | None) -> Figure | Axes:
    drawn, cells = _cells(found, 3.0, ax)
    (y, y_name), (x, x_name) = (_along(found, path, values) for path, values in found.inputs.items())
    for k, axes in enumerate(cells):
        values, name, _ = _efforts(found, k)
        x2, y2, shown = (each.reshape(found.shape) for each in (x, y, values))
        image = axes.pcolormesh(x2, y2, shown, cmap="viridis", shading="nearest")
        axes.figure.colorbar(image, ax=axes, label=name)
        axes.set(xlabel=x_name, ylabel=y_name)
    return drawn


def _along(found: Sweep, path: str, values: NDArray) -> tuple[NDArray, str]:
    """Values of a path in the unit for display, and the label of their axis."""
    unit = unit_of(found.scene, path)
    size, name = handy(float(np.abs(values).max()), unit) if unit else (1.0, "")
    return values / size, f"{path} [{name}]" if name else path


def _efforts(found: Sweep, cell: int) -> tuple[NDArray, str, float]:
    """Extremes of a cell in the unit for display, label of their axis, and their estimated error."""
    probe, word = cell // 2, WORDS[cell % 2]
    medium = words(found.scene, "gauge pressure")
    values = found[word][:, probe]
    largest = max(float(np.nanmax(np.abs(found[each][:, probe]))) for each in WORDS)
    size, unit = handy(largest, medium.shown["effort"])
    estimate = np.nan_to_num(found["estimate"]).max()
    name = f"{word} {medium.effort} at {found.probes[probe]} [{unit}]"
    return values / size, name, estimate * largest / size


def draw_histogram(axes: Axes, values: NDArray, error: float, colour: str) -> None:
    """Draw a histogram with quantiles; a text where values differ by no more than their error."""
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
