"""Figure of the verdict on samples, and of the nearest passive model."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import EngFormatter
from numpy.typing import NDArray

from passivity.sampled.check import Band, SampleVerdict, worst_name, worst_values
from passivity.sampled.enforce import Enforced
from passivity.sampled.extremes import off_poles
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.response import Parameter
from tline.style import COLOURS, INK, cells_of, styled

POINTS = 1500
DRAWN_BAND = 1.5  # times the highest frequency: how far models are drawn
_AFTER, _BAD, _, _, _BEFORE, *_ = COLOURS
_UNITS = {Parameter.Z: "  [Ω]", Parameter.Y: "  [S]", Parameter.S: ""}


@styled
def draw_samples(verdict: SampleVerdict, ax: Axes | None = None, enforced: Enforced | None = None) -> Any:
    """A figure: worst singular value of S or smallest eigenvalue of Z or Y against frequency, violations shaded.

    The models before and after are drawn to DRAWN_BAND times the highest frequency.
    """
    response, f = verdict.response, verdict.response.f
    title = f"samples: {verdict.status.value}"
    title += "" if enforced is None else f"; model: {enforced.status.value}"
    drawn, (axes,) = cells_of(ax, 8.0, 4.6, title=title)
    for k, band in enumerate(verdict.bands):
        label = "" if k else "samples violate the bound"
        axes.axvspan(*_ends(band), facecolor=_BAD, alpha=0.3, hatch="///", edgecolor="white", linewidth=0, label=label)
    axes.errorbar(
        f, verdict.worst, verdict.bars, fmt="o", color=INK, markersize=3.5, elinewidth=0.8, label="samples", zorder=3
    )
    if enforced is not None:
        _draw_models(axes, enforced, f)
    scattering = response.parameter is Parameter.S
    bound, (bottom, top) = float(scattering), axes.get_ylim()
    bottom, top = (bottom, max(top, 1.06)) if scattering else (min(bottom, -0.04 * top), top)
    axes.axhspan(bound, top if scattering else bottom, color=_BAD, alpha=0.12, linewidth=0, label="forbidden")
    axes.axhline(bound, color=_BAD, linewidth=1.2)
    if f[0] > 0 and f[-1] > 100 * f[0]:
        axes.set_xscale("log")
    name = worst_name(response.parameter, response.ports)
    axes.set(xlabel="frequency f", ylabel=name + _UNITS[response.parameter], ylim=(bottom, top))
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    usual = float(np.median(np.abs(verdict.worst)))
    if not scattering and top > 20 * usual > 0:  # a resonance would hide values near the bound
        axes.set_yscale("symlog", linthresh=usual)
    axes.grid()
    axes.legend(loc="best", fontsize=8)
    if ax is not None:
        ax.set_title(title, loc="left")
    return drawn


@styled
def draw_model(model: PoleResidueModel, ax: Axes | None = None) -> Any:
    """Magnitude of all entries over frequency, from below the slowest to above the fastest pole."""
    drawn, (axes,) = cells_of(ax, 8.0, 4.6)
    sizes = np.abs(model.poles[model.poles != 0]) if np.any(model.poles) else np.ones(1)
    w = off_poles(model, np.geomspace(sizes.min() / 10, sizes.max() * 10, POINTS))
    axes.loglog(w / (2 * np.pi), np.abs(model.matrices(w)).reshape(len(w), -1), linewidth=1.7)
    axes.set(xlabel="frequency f", ylabel=f"|{model.parameter.value}|" + _UNITS[model.parameter])
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    axes.grid()
    return drawn


def _ends(band: Band) -> tuple[float, float]:
    """Return the ends of a band, halfway to the sample before and halfway to the one after."""
    before = band.first if band.before is None else (band.first + band.before) / 2
    after = band.last if band.after is None else (band.last + band.after) / 2
    return before, after


def _draw_models(axes: Axes, enforced: Enforced, f: NDArray) -> None:
    spread = np.geomspace if f[0] > 0 else np.linspace
    ends = f[0], f[-1] * DRAWN_BAND
    w = off_poles(enforced.model, 2 * np.pi * np.array([*f, *np.linspace(*ends, POINTS), *spread(*ends, POINTS)]))
    for model, color, style, name in (
        (enforced.original, _BEFORE, "--", "model as given"),
        (enforced.model, _AFTER, "-", "nearest passive model"),
    ):
        values = worst_values(model.matrices(w), model.parameter)
        axes.plot(w / (2 * np.pi), values, style, color=color, linewidth=1.7, label=name)
