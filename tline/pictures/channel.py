"""Pictures of a measured channel, and its report."""

import platform
from collections.abc import Iterator, Mapping
from html import escape
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tline.pictures.bode import plot_misfit
from tline.pictures.page import drawn, table
from tline.pictures.signals import plot_reflections, plot_statistical_eye
from tline.signal.all_patterns import StatisticalEye
from tline.signal.channel import FLOOR, Channel
from tline.signal.tdr import Reflections
from tline.style import COLOURS, DASHES, FAINT, INK, cells_of, styled
from tline.units import handy

if TYPE_CHECKING:
    from tline.signal.margin import OperatingMargin

POINTS = 1000  # of the model's curve
BEFORE = 4  # symbols that are drawn before the main cursor
PROGRAMS = "tline", "numpy", "scipy", "matplotlib"
WORDS = {
    "insertion": "insertion loss", "return": "return loss", "crosstalk": "crosstalk into the receiver",
    "conversion": "conversion into common modes",
}  # fmt: skip


@styled
def plot_channel(seen: Channel, ax: Axes | None = None) -> Figure | Axes:
    """Plot transmission and reflection over frequency, dB, of samples and model; below, crosstalk and conversion."""
    hertz, unit = handy(float(seen.measured.f[-1]), "Hz")
    f, curves = seen.measured.f / hertz, seen.curves
    below = [what for what in ("crosstalk", "conversion") if what in curves]
    figure, (upper, *rest) = cells_of(ax, 8.0, 4.6 + 2.0 * len(below), 1 + len(below), title=seen.title, sharex=True)
    at = np.linspace(f[0], f[-1], POINTS)
    model = np.abs(seen.found.model.matrices(2 * np.pi * at * hertz))
    for k, (to, of) in enumerate(((1, 0), (0, 0), (1, 1))):
        name = f"{seen.names[of]} → {seen.names[to]}" if to != of else f"back to {seen.names[of]}"
        upper.plot(f, seen.decibels(to, of), ".", color=FAINT, markersize=5, label=None if k else "samples")
        look = {"color": COLOURS[k], "linestyle": DASHES[k], "linewidth": 1.2, "label": f"model, {name}"}
        upper.plot(at, 20 * np.log10(np.maximum(model[:, to, of], FLOOR)), **look)
    for axes, what in zip(rest, below, strict=bool(ax is None)):
        for k, (name, values) in enumerate(curves[what].items()):
            axes.plot(f, values, color=COLOURS[k % len(COLOURS)], linestyle=DASHES[k % len(DASHES)], label=name)
        axes.set_title(WORDS[what], loc="left")
    for axes in (upper, *rest):
        axes.set_ylabel("|S| [dB]")
        axes.grid(True)
        axes.margins(x=0)
        axes.legend(loc="best", fontsize="small", ncols=2)
    [upper, *rest][-1].set_xlabel(f"frequency [{unit}]")
    return figure


@styled
def plot_margin(seen: "OperatingMargin", ax: Axes | None = None) -> Figure | Axes:
    """Plot the equalised pulse response with its cursors, what feedback leaves of them, and all that disturbs."""
    M, at, flat = seen.clause.M, seen.best.at, seen.best.pulses[0].ravel()
    symbols = np.arange(-BEFORE, len(seen.dfe) + BEFORE + 1)
    around = np.arange(symbols[0] * M, symbols[-1] * M + 1)
    size, unit = handy(float(np.abs(flat).max()), "V")
    pulse, cursors = flat.take(at + around, mode="wrap") / size, flat.take(at + symbols * M, mode="wrap") / size
    left = cursors.copy()
    left[BEFORE + 1 :][: len(seen.dfe)] -= seen.dfe * cursors[BEFORE]
    figure, (axes,) = cells_of(ax, 8.0, 4.6, title=seen.title)
    axes.axhspan(-seen.disturbance / size, seen.disturbance / size, color=FAINT, alpha=0.3, label="disturbance A_ni")
    axes.axhline(seen.signal / size, color=INK, linestyle=":", linewidth=0.8, label="signal A_s")
    axes.plot(around / M, pulse, color=COLOURS[0], label="equalised pulse")
    axes.plot(symbols, cursors, "o", color=COLOURS[0], markersize=4, label="cursors")
    axes.plot(symbols, left, "x", color=COLOURS[1], label="behind the feedback")
    axes.set_title(f"channel operating margin {seen.margin:.3g} dB", loc="left")
    axes.set_xlabel("time from the sampling instant [symbols]")
    axes.set_ylabel(f"voltage [{unit}]")
    axes.grid(True)
    axes.margins(x=0)
    if ax is None:
        figure.legend(loc="outside lower center", ncols=5, fontsize="small")
    else:
        axes.legend(fontsize="small", frameon=True)
    return figure


def report(
    seen: Channel,
    profile: Reflections,
    eye: StatisticalEye | None,
    margin: "OperatingMargin | None",
    inputs: Mapping[str, str],
) -> Iterator[str]:
    """Compose the parts of a report's page."""
    f = seen.measured.f
    yield f"<p>{escape(next(iter(seen.text_lines())))}.</p>"
    yield "<h2>Losses</h2>" + table(*_losses(seen, None if eye is None else 0.5 / eye.period))
    yield drawn(plot_channel, seen)
    yield "<h2>Impedance profile</h2>" + drawn(plot_reflections, profile)
    if eye is not None:
        yield "<h2>Eye of all bit patterns</h2><p>" + "<br>".join(map(escape, eye.text_lines())) + "</p>"
        yield drawn(plot_statistical_eye, eye)
    if margin is not None:
        rows = [["parameters", margin.clause.title], *margin.rows]
        yield "<h2>Channel operating margin</h2>" + table(["what", "value"], rows) + drawn(plot_margin, margin)
    found, verdict = seen.found, seen.verdict
    yield f"<h2>Passivity</h2><p>{escape('; '.join(map(str.strip, verdict.text_lines())))}</p>"
    told = f"{found.order} poles, {found.verdict.status.value} passive, at most {found.error:.2g} from the samples"
    yield f"<p>The model: {told}, of which being passive cost {found.cost:.2g}: {escape(found.why)}.</p>"
    yield drawn(plot_misfit, found)
    rows = [["samples", f"{len(f)}, {f[0]:.6g} to {f[-1]:.6g} Hz"], ["references", f"{seen.measured.z0.tolist()} ohm"]]
    yield "<h2>Inputs</h2>" + table(["what", "value"], [*rows, *([name, value] for name, value in inputs.items())])
    programs = [["Python", platform.python_version()], *([name, version(name)] for name in PROGRAMS)]
    yield "<h2>Versions</h2>" + table(["program", "version"], programs)


def _losses(seen: Channel, nyquist: float | None) -> tuple[list[str], list[list[str]]]:
    """Heading and rows of the table of losses: each curve at its worst, and at half the bit rate."""
    f, head, rows = seen.measured.f, ["what", "between", "worst [dB]", "at [GHz]"], []
    rate = [nyquist] if nyquist is not None and f[0] <= nyquist <= f[-1] else []
    for what, name, value, at in seen.worst:
        there = [f"{np.interp(half, f, seen.curves[what][name]):.3g}" for half in rate]
        rows.append([WORDS[what], name, f"{value:.3g}", f"{at / 1e9:.4g}", *there])
    return head + [f"at {half / 1e9:.4g} GHz [dB]" for half in rate], rows
