"""Pictures over frequency: Bode plots, and a model compared with the samples of its fit."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from tline.frequency.oscillations import Resonance
from tline.style import COLOURS, DASHES, DOWN, FAINT, INK, UP, cells_of, figure, styled
from tline.units import handy

if TYPE_CHECKING:
    from passivity import DelayedModel
    from tline.frequency.response import Curves

WIDTH, HEIGHT = 8.0, 5.6  # inches
ENTRY = 0.09  # inches per letter in the legend
ALIKE = 1e-9  # relative to the largest value; curves that differ by less are drawn once


@styled
def plot_curves(found: "Curves", ax: Axes | None = None) -> Figure | Axes:
    """Plot magnitude (alone on `ax`) and phase modulo 360° over frequency; equal curves are drawn once.

    Natural oscillations are marked at the upper edge.
    """
    f = found.f
    hertz, name = handy(float(f[-1]), "Hz")
    picture, axes = cells_of(ax, WIDTH, HEIGHT, 2, title=found.scene.title or "", sharex=True)
    upper, lower = axes[0], axes[-1]
    for k, (label, values) in enumerate(_distinct(found.curves).items()):
        look = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        finite = np.isfinite(values) & (values != 0)
        x = f[finite] / hertz
        upper.plot(x, 20 * np.log10(np.abs(values[finite])), label=label, **look)
        if ax is None:
            lower.plot(*_broken(x, np.degrees(np.angle(values[finite]))), **look)
    for each in axes:
        if f[0] > 0 and f[-1] / f[0] > 20:
            each.set_xscale("log")
            each.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        each.grid(True, which="major")
    _mark(upper, [mode for mode in found.oscillations if f[0] <= mode.frequency <= f[-1]], hertz)
    upper.set_ylabel(f"|{found.what}|\n[dB re {'1 ' * (found.unit != '1')}{found.unit}]")
    lower.set_xlabel(f"frequency [{name}]")
    handles, labels = upper.get_legend_handles_labels()
    if ax is not None:
        ax.legend(fontsize="small")
        return ax
    lower.set_ylabel("phase modulo 360° [°]")
    lower.set_ylim(-190, 190)
    lower.set_yticks(range(-180, 181, 90))
    if len(labels) > 1:
        columns = max(int(WIDTH / (0.6 + ENTRY * max(map(len, labels)))), 1)
        picture.legend(handles, labels, loc="outside lower center", ncols=min(columns, len(labels)))
    return picture


def _distinct(curves: Mapping[str, NDArray]) -> dict[str, NDArray]:
    """Merge equal curves under their joined names, such as S(a,b) and S(b,a)."""
    found: dict[str, NDArray] = {}
    for name, values in curves.items():
        nearby = ALIKE * np.abs(values[np.isfinite(values)]).max(initial=0.0)
        same = next((label for label, other in found.items() if np.allclose(values, other, 0.0, nearby, True)), None)
        label = name if same is None else f"{same} = {name}"
        found = {label if key == same else key: other for key, other in found.items()}
        found.setdefault(label, values)
    return found


def _broken(x: NDArray, phase: NDArray) -> tuple[NDArray, NDArray]:
    """Break a curve where its phase jumps from one edge to the other."""
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 180) + 1
    return np.insert(x, jumps, np.nan), np.insert(phase, jumps, np.nan)


def _mark(axes: Axes, modes: Sequence[Resonance], hertz: float) -> None:
    """Mark frequencies by triangles at the upper edge."""
    for growing, label, colour, marker in ((False, "natural oscillation", DOWN, "v"), (True, "grows", UP, "^")):
        x = [mode.frequency / hertz for mode in modes if (mode.decay_time < 0) == growing]
        if x:
            look = {"color": colour, "marker": marker, "linestyle": "", "markersize": 5, "clip_on": False}
            axes.plot(x, np.ones(len(x)), transform=axes.get_xaxis_transform(), label=label, zorder=4, **look)


DRAWN_BAND = 1.5  # times the highest frequency; end of the model's curve
POINTS = 1500
SMALLEST_MISFIT = 1e-17  # smallest misfit drawn: a logarithmic axis has no 0
TOLD_APART = 4  # largest number of ports with distinct colours for their reflections


@styled
def plot_misfit(found: "DelayedModel", title: str = "") -> Figure:
    """Plot |S| of samples and model, independent of any delay, and the distance of both S, over frequency.

    With several ports all entries of S are drawn, those into one port in one colour, with the largest singular value,
    which shows whether the model is passive.

    Parameters
    ----------
    found : DelayedModel
        From `passivity.fit_scattering`.
    title : str

    Examples
    --------
    >>> from passivity import SampledResponse, fit_scattering
    >>> found = fit_scattering(SampledResponse([1, 2, 3, 4], [0.5, 0.5, 0.5, 0.5], "S"), 1e-3)
    >>> plot_misfit(found).axes[1].get_xlabel()
    'frequency [Hz]'
    """
    f, data, ports = found.samples.f, found.samples.values, found.samples.ports
    hertz, name = handy(float(f[-1]), "Hz")
    drawn = np.linspace(0, DRAWN_BAND * f[-1], POINTS)
    model, misfit = (found.model.at(2 * np.pi * at).reshape(-1, ports, ports) for at in (drawn, f))
    misfit = np.abs(misfit - data)
    picture = figure(8.0, 5.2, title)
    upper, lower = picture.subplots(2, 1, sharex=True)
    upper.axvspan(f[-1] / hertz, drawn[-1] / hertz, color=FAINT, alpha=0.15, linewidth=0, label="not measured")
    for i, k in np.ndindex(ports, ports):
        apart, first = 1 < ports <= TOLD_APART, (i, k) == (0, 0)
        colour, dash = (COLOURS[(0, 2, 3, 4)[k]], DASHES[i]) if apart else (COLOURS[0], "-")
        label = f"S{i + 1}{k + 1}" if apart else "model"
        upper.plot(f / hertz, np.abs(data[:, i, k]), ".", color=INK, markersize=4, label="samples" if first else None)
        shown = label if apart or first else None
        upper.plot(drawn / hertz, np.abs(model[:, i, k]), color=colour, linestyle=dash, label=shown)
        lower.semilogy(f / hertz, np.maximum(misfit[:, i, k], SMALLEST_MISFIT), ".", color=colour, markersize=4)
    if ports > 1:
        largest = np.linalg.norm(model, 2, axis=(1, 2))
        upper.plot(drawn / hertz, largest, color=FAINT, label="largest singular value")
    upper.axhline(1.0, color=COLOURS[1], linewidth=1.0, linestyle="--", label="bound of all that is passive")
    upper.set_ylabel("|S|")
    upper.set_ylim(0.0, None)
    lower.yaxis.set_major_formatter(lambda x, _: f"{x:g}")
    lower.yaxis.set_minor_formatter(NullFormatter())
    lower.set_ylabel("|ΔS|")
    lower.set_xlabel(f"frequency [{name}]")
    lower.set_xlim(0.0, drawn[-1] / hertz)
    for axes in (upper, lower):
        axes.grid(True)
    picture.legend(loc="outside lower center", ncols=4)
    return picture
