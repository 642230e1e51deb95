"""Stability maps: growth rates measured from runs, and the boundaries that theory predicts."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from tline.atomic import write_table
from tline.errors import InputError
from tline.study.charts.maps import MAPS, Map, Strip, rate
from tline.style import INK, figure, styled

POINTS, QUICK, LONG = 101, 11, 5
LOWEST, HIGHEST = 1e-2, 10.0  # growth per transit, the ends of the colours
STILL = "#E3EDF4"


@dataclass(frozen=True)
class MeasuredStrip:
    """One method of a map."""

    label: str
    x: NDArray  # (n,) values of the parameter
    rates: NDArray  # rates, predicted: (n,) growth per transit, measured and by theory
    predicted: NDArray
    boundaries: NDArray  # where the measured rate crosses the map's level
    expected: NDArray  # where the predicted rate crosses the map's level


@dataclass(frozen=True)
class Stability:
    """Finished map."""

    map: Map
    strips: list[MeasuredStrip]

    def differences(self) -> list[tuple[str, float, float, float]]:
        """Predicted and measured boundaries by method, and their difference over the axis; NaN for a missing one.

        Methods without a boundary on the axis have NaN for both, and a difference of 0 if theory and runs agree
        on the side.
        """
        found, width = [], float(np.ptp(self.map.x))
        for strip in self.strips:
            if len(strip.expected) == len(strip.boundaries):
                pairs = zip(strip.expected, strip.boundaries, strict=True)
                found += [(strip.label, float(p), float(m), float(abs(p - m)) / width) for p, m in pairs]
            else:
                found += [(strip.label, float(p), np.nan, np.inf) for p in strip.expected]
                found += [(strip.label, np.nan, float(m), np.inf) for m in strip.boundaries]
            if not len(strip.expected) and not len(strip.boundaries):
                same = (strip.rates[0] > self.map.level) == (strip.predicted[0] > self.map.level)
                found.append((strip.label, np.nan, np.nan, 0.0 if same else np.inf))
        return found


def crossings(x: NDArray, rates: NDArray, level: float) -> NDArray:
    """Crossings of a level by a curve of straight lines through the points."""
    height = np.maximum(rates, level - 1.0) - level
    k = np.flatnonzero((height[:-1] > 0) != (height[1:] > 0))
    return x[k] + (x[k + 1] - x[k]) * height[k] / (height[k] - height[k + 1])


def stability(name: str, *, quick: bool = False, progress: bool = False) -> Stability:
    """Run one map.

    Parameters
    ----------
    name : str
        Key of `MAPS`.
    quick : bool
        11 points along the axis in place of 101, without the methods that take long.
    progress : bool
        Show a progress bar on stderr if it takes more than two seconds.
    """
    from tqdm import tqdm

    if name not in MAPS:
        raise InputError("map", "unknown", " or ".join(MAPS), f"'{name}'")
    chosen = MAPS[name](QUICK if quick else POINTS)
    strips = [strip for strip in chosen.strips if not quick or strip.every < LONG]
    with tqdm(strips, desc=name, disable=not progress, delay=2, unit="method") as bar:
        return Stability(
            chosen, [_measured(strip, chosen.x[:: 1 if quick else strip.every], chosen.level) for strip in bar]
        )


def _measured(strip: Strip, x: NDArray, level: float) -> MeasuredStrip:
    rates, predicted = (
        np.array([tell(float(at)) for at in x]) for tell in (lambda at: rate(*strip.run(at)), strip.predict)
    )
    return MeasuredStrip(strip.label, x, rates, predicted, crossings(x, rates, level), crossings(x, predicted, level))


def save(maps: Iterable[Stability], path: str | Path) -> None:
    """Write all rates as CSV."""
    rows = (
        (found.map.name, strip.label, *map(float, numbers))
        for found in maps
        for strip in found.strips
        for numbers in zip(strip.x, strip.rates, strip.predicted, strict=True)
    )
    write_table(path, ("map", "method", "x", "growth_per_transit", "predicted"), rows)


def save_boundaries(maps: Iterable[Stability], path: str | Path) -> None:
    """Write boundaries as CSV: predicted, measured, difference over the axis."""
    rows = ((found.map.name, *row) for found in maps for row in found.differences())
    write_table(path, ("map", "method", "predicted", "measured", "difference_over_axis"), rows)


@styled
def draw(found: Stability) -> Figure:
    """Draw one band for each method; pale blue for no growth, lines at the predicted boundary."""
    rows = len(found.strips)
    picture = figure(9.0, 1.7 + 0.36 * rows, found.map.title)
    axes = picture.subplots()
    norm = LogNorm(LOWEST, HIGHEST)
    for k, strip in enumerate(found.strips):
        edges = np.concatenate([strip.x[:1], (strip.x[1:] + strip.x[:-1]) / 2, strip.x[-1:]])
        grown = np.where(strip.rates > max(found.map.level, LOWEST / 2), np.clip(strip.rates, LOWEST, HIGHEST), np.nan)
        axes.fill_between(edges[[0, -1]], k - 0.4, k + 0.4, color=STILL, linewidth=0)
        axes.pcolormesh(edges, [k - 0.4, k + 0.4], grown[None, :], cmap="OrRd", norm=norm, rasterized=True)
        axes.vlines(strip.expected, k - 0.46, k + 0.46, color=INK, linewidth=1.8)
        axes.plot(strip.boundaries, np.full(len(strip.boundaries), k), "o", color="#0072B2", markersize=4)
    axes.set_yticks(range(rows), [strip.label for strip in found.strips])
    axes.set_ylim(rows - 0.4, -0.6)
    axes.set_xlim(found.map.x[0], found.map.x[-1])
    axes.set_xlabel(found.map.axis)
    axes.tick_params(axis="y", length=0)
    bar = picture.colorbar(ScalarMappable(norm, "OrRd"), ax=axes, pad=0.02, aspect=14, extend="both")
    bar.set_ticks([0.01, 0.1, 1, 10], labels=["0.01", "0.1", "1", "10"])
    bar.ax.minorticks_off()
    bar.set_label("growth per transit")
    marks = [
        Patch(color=STILL, label="no growth"),
        Line2D([], [], color=INK, linewidth=1.8, label="boundary by theory"),
        Line2D([], [], color="#0072B2", marker="o", markersize=4, linestyle="none", label="boundary of the runs"),
    ]
    axes.legend(handles=marks, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, fontsize=9)
    return picture
