"""Pictures of signals on cables: eyes, time-domain reflectometry, crosstalk, Bergeron's diagram, measured channels."""

import platform
from collections.abc import Iterator, Mapping
from html import escape
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.pictures.bode import plot_misfit
from tline.pictures.page import drawn, table
from tline.signal.all_patterns import SMALLEST, StatisticalEye
from tline.signal.channel import FLOOR, Channel
from tline.signal.crosstalk import Crosstalk
from tline.signal.eye_diagram import Eye
from tline.signal.eye_statistics import Mask, jitter
from tline.signal.load_line import Bergeron, LoadLine
from tline.signal.tdr import Reflections
from tline.style import COLOURS, DASHES, DOWN, FAINT, INK, UP, cells_of, styled
from tline.units import handy

if TYPE_CHECKING:
    from tline.signal.margin import OperatingMargin


MOST_CURVES = 1000  # of an eye, those nearest to its threshold, and as many evenly over time
STEEP = 20.0  # times z0; higher impedances are outside of the picture


@styled
def plot_eye(seen: Eye, ax: Axes | None = None, mask: Mask | None = None) -> Figure | Axes:
    """Plot all bits over each other, two wide, the sampling instant in the middle, with height and width of the eye."""
    medium = seen.medium
    fine = seen.u.shape[1]
    shift = round((seen.instant / seen.period % 1.0) * fine) - fine  # one bit in front of the sampling instant
    turned = np.roll(seen.u.ravel(), -shift)
    sampled = np.roll(turned[::fine], -1)
    drawn_bits = np.argsort(np.abs(sampled - seen.threshold))[:MOST_CURVES]
    drawn_bits = np.union1d(drawn_bits, np.linspace(0, len(sampled) - 1, MOST_CURVES, dtype=int))
    windows = turned[(drawn_bits[:, None] * fine + np.arange(2 * fine + 1)) % turned.size]
    size, unit = handy(float(np.abs(seen.u).max()), medium.shown["effort"])
    second, time_unit = handy(2 * seen.period, "s")
    t = np.linspace(-seen.period, seen.period, 2 * fine + 1) / second
    drawn, (axes,) = cells_of(ax, 8.0, 4.8, title=seen.title)
    axes.plot(t, windows.T / size, color=COLOURS[0], linewidth=0.8, alpha=max(0.2, min(0.6, 12 / len(windows))))
    if mask is not None:
        _fill(axes, mask, second, size, seen.threshold)
    if seen.height > 0:
        level = seen.threshold / size
        look = {"arrowstyle": "<->", "linewidth": 1.3, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (0, seen.zeros / size), (0, seen.ones / size), arrowprops=look | {"color": UP})
        side = seen.width / second / 2
        axes.annotate("", (-side, level), (side, level), arrowprops=look | {"color": DOWN})
    height, width = handy(abs(seen.height) or 1.0, medium.shown["effort"]), handy(seen.width or seen.period, "s")
    told = f"height {seen.height / height[0]:.4g} {height[1]}, width {seen.width / width[0]:.4g} {width[1]}"
    spread = jitter(seen).peak_to_peak
    told += f", jitter {spread / width[0]:.3g} {width[1]} from peak to peak"
    axes.set_title(told if seen.height > 0 else "closed", loc="left")
    axes.set_xlabel(f"time from the sampling instant [{time_unit}]")
    axes.set_ylabel(f"{medium.effort} [{unit}]")
    axes.margins(x=0)
    axes.grid(True)
    return drawn


@styled
def plot_statistical_eye(seen: StatisticalEye, ax: Axes | None = None, mask: Mask | None = None) -> Figure | Axes:
    """Plot the contours of an eye at an error rate, and in a figure of its own the bathtubs over time and thresholds.

    Parameters
    ----------
    seen : StatisticalEye
    ax : matplotlib Axes, optional
        Where to draw; without it a new figure.
    mask : Mask, optional

    Returns
    -------
    Figure or Axes
        Target of the drawing.
    """
    medium = seen.medium
    size, unit = handy(float(np.abs([seen.ones, seen.zeros]).max()), medium.shown["effort"])
    second, time_unit = handy(seen.period, "s")
    t, opened = seen.t / second, seen.ones > seen.zeros
    drawn, (upper, *lower) = cells_of(ax, 8.0, 8.2, 3, title=seen.title)
    upper.fill_between(t, seen.zeros / size, seen.ones / size, where=opened, color=COLOURS[0], alpha=0.15)
    for curve, name in ((seen.ones, "ones, lowest"), (seen.zeros, "zeros, highest")):
        upper.plot(t, curve / size, label=name)
    upper.axhline(seen.threshold / size, color=INK, linewidth=0.8, linestyle=":")
    if mask is not None:
        _fill(upper, mask, second, size, seen.threshold)
    height, width = handy(abs(seen.height) or 1.0, medium.shown["effort"]), handy(seen.width or seen.period, "s")
    told = f"height {seen.height / height[0]:.4g} {height[1]}, width {seen.width / width[0]:.4g} {width[1]}"
    upper.set_title(f"{told} at an error rate of {seen.ber:g}" if seen.height > 0 else "closed", loc="left")
    upper.set_ylabel(f"{medium.effort} [{unit}]")
    upper.legend()
    bathtubs = (t, seen.bathtub, f"time from the sampling instant [{time_unit}]"), (
        seen.levels / size, seen.misread, f"threshold at the sampling instant [{unit}]",
    )  # fmt: skip
    for axes, (x, rates, name) in zip(lower, bathtubs, strict=False):
        axes.semilogy(x, np.maximum(rates, SMALLEST), color=COLOURS[0])
        axes.axhline(seen.ber, color=INK, linewidth=0.8, linestyle=":")
        axes.set_ylim(SMALLEST, 1)
        ticks = 10.0 ** -np.arange(0, 16, 3)
        axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_ylabel("error rate")
        axes.set_xlabel(name)
        axes.margins(x=0)
    upper.set_xlabel(bathtubs[0][2])
    upper.margins(x=0)
    return drawn


def _fill(axes: Axes, mask: Mask, second: float, size: float, threshold: float) -> None:
    """Draw a mask around the sampling instant."""
    corners = mask.corners
    outline = (corners[:, 0] / second, (corners[:, 1] + threshold) / size)
    axes.fill(*outline, facecolor="#888888", edgecolor="#333333", alpha=0.5, zorder=3)


@styled
def plot_reflections(seen: Reflections, ax: Axes | None = None) -> Figure | Axes:
    """Plot waves in units of the step above, impedance below, not on `ax`; high impedances leave the picture."""
    second, time_unit = handy(float(seen.t[-1]), "s")
    drawn, (upper, *rest) = cells_of(ax, 8.0, 5.4, 2, title=seen.title, sharex=True)
    for k, (name, wave) in enumerate((("incident", seen.incident), ("reflected", seen.reflected))):
        upper.plot(seen.t / second, wave, color=COLOURS[k], linestyle=DASHES[k], label=name)
    upper.set_ylabel("wave / step")
    upper.legend(loc="best", ncols=2)
    for lower in rest:
        _draw_impedance(lower, seen, second)
        drawn.align_ylabels([upper, lower])
    for axes in (upper, *rest):
        axes.grid(True)
        axes.margins(x=0)
    [upper, *rest][-1].set_xlabel(f"time, there and back [{time_unit}]")
    return drawn


def _draw_impedance(lower: Axes, seen: Reflections, second: float) -> None:
    profile = np.where(seen.impedance < STEEP * seen.z0, seen.impedance, np.nan)
    lower.plot(seen.t / second, profile, color=COLOURS[2])
    lower.axhline(seen.z0, color=COLOURS[6], linewidth=0.8, linestyle=DASHES[2])
    lower.set_ylabel(f"impedance [{seen.medium.units['resistance'].replace('ohm', 'Ω')}]")


@styled
def plot_crosstalk(seen: Crosstalk, ax: Axes | None = None) -> Figure | Axes:
    """Plot the driven conductor's voltages, the quiet ones' (alone on `ax`), and modes of a single pair, over time."""
    second, unit = handy(float(seen.t[-1]), "s")
    quiet = {**seen.near, **seen.far}
    modes = seen.pairs if len(seen.pairs) == 2 else ()
    rows = 3 if modes else 2
    drawn, axes = cells_of(ax, 8.0, 7.0 if modes else 5.0, rows, title=seen.title, sharex=True)
    largest = max(float(abs(seen.voltages[node]).max()) for node in quiet)
    size, prefix = handy(largest, "V")
    shares = {f"{node}, {100 * share:.3g} %": seen.voltages[node] / size for node, share in quiet.items()}
    heard = ax or axes[1]
    _draw(heard, seen, second, shares)
    heard.set_ylabel(f"quiet [{prefix}]")
    axes[-1].set_xlabel(f"time [{unit}]")
    if ax is not None:
        return ax
    _draw(axes[0], seen, second, {node: u for node, u in seen.voltages.items() if node not in quiet})
    axes[0].set_ylabel("driven [V]")
    if modes:
        waves = {f"{a} − {b}": u for (a, b), u in seen.differential.items()}
        _draw(axes[2], seen, second, waves | {f"mean of {a}, {b}": u for (a, b), u in seen.common.items()})
        axes[2].set_ylabel("modes [V]")
    drawn.align_ylabels(axes)
    return drawn


def _draw(axes: Axes, seen: Crosstalk, second: float, waves: dict) -> None:
    for k, (name, u) in enumerate(waves.items()):
        axes.plot(seen.t / second, u, color=COLOURS[k % len(COLOURS)], linestyle=DASHES[k % len(DASHES)], label=name)
    axes.legend(loc="best", fontsize="small", ncols=2)
    axes.grid(True)
    axes.margins(x=0)


ROOM = 0.15  # of the span of the states, on every side
NUMBERED = 5  # number of states with numbers


@styled
def plot_load_lines(found: Bergeron, ax: Axes | None = None) -> Figure | Axes:
    """Plot effort over flow: the next state is where a characteristic meets the load line of the end it arrives at."""
    medium = found.medium
    size_u, unit_u = handy(float(np.abs(found.u).max()) or 1.0, medium.shown["effort"])
    size_y, unit_y = handy(float(np.abs(found.y).max()) or 1.0, medium.shown["flow"])
    drawn, (axes,) = cells_of(ax, 8.0, 5.4, title=found.title)
    x, y = found.y / size_y, found.u / size_u
    axes.set_xlim(*_around(x))
    axes.set_ylim(*_around(y))
    for end, line in enumerate(found.ends):
        _draw_load_line(axes, LoadLine(line.p * size_u, line.q * size_y, line.r), COLOURS[end], end)
    axes.plot(x, y, color=INK, linewidth=1.1, marker="o", markersize=4, label="characteristics, slope ±z0")
    for k in range(min(NUMBERED, len(x))):
        time = ("before", "0", "T")[k] if k < 3 else f"{k - 1} T"
        axes.annotate(time, (x[k], y[k]), (0, 8), textcoords="offset points", fontsize=9, ha="right")
    axes.set_xlabel(f"{medium.flow} [{unit_y}]")
    axes.set_ylabel(f"{medium.effort} [{unit_u}]")
    axes.grid(True)
    if ax is None:
        drawn.legend(loc="outside lower center", ncols=3)
    else:
        ax.legend()
    return drawn


def _around(values: NDArray) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    room = ROOM * (high - low) or 1.0
    return low - room, high + room


def _draw_load_line(axes: Axes, line: LoadLine, colour: str, end: int) -> None:
    """Draw one load line p u + q y = r across the picture."""
    look = {"color": colour, "linestyle": DASHES[end], "label": f"end {end + 1}"}
    if line.p == 0:
        axes.axvline(line.r / line.q, **look)
    else:
        axes.axline((0.0, line.r / line.p), slope=-line.q / line.p, **look)
    axes.axhline(0.0, color=FAINT, linewidth=0.6)


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
