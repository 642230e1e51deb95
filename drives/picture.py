"""Figures: Bode plot, poles and zeros, and the course of a run, also under control."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from drives.control import Design
from drives.loop import simulate_control
from drives.simulation import Run
from drives.symbolic import ALL_UNITS
from drives.torque import Torque
from drives.transfer import TransferFunction, frequencies
from tline.errors import InputError, check_kind
from tline.style import COLOURS, DASHES, FAINT, INK, cells_of, styled

WIDE = 100  # largest over smallest real part from which on a linear scale shows only one of them
NOISE = 1e-12  # nothing but rounding, not worth a scale of its own
DECADES, POINTS = 2, 400  # beyond the slowest and the fastest pole or zero, and points of a curve
SETTLED = 6.0  # time constants of the slowest pole until all has settled


@styled
def draw_bode(transfers: Sequence[TransferFunction], omega: NDArray, ax: Axes | None = None) -> Figure | Axes:
    """Magnitude in dB and phase in degrees, without jumps, over angular frequency.

    Parameters
    ----------
    transfers : sequence of TransferFunction
    omega : numpy.ndarray
        rad/s, more than 0, increasing.
    ax : matplotlib Axes, optional
        Where to draw the magnitude alone.

    Examples
    --------
    >>> import numpy as np
    >>> from drives import CoupledDrives, draw_bode
    >>> len(draw_bode([CoupledDrives().transfer("x_k", "T1")], np.logspace(-1, 4, 50)).axes)
    2
    """
    drawn, both = cells_of(ax, 8.0, 6.0, rows=2, sharex=True)
    _check_transfers(transfers)
    w = np.atleast_1d(frequencies(omega))
    for k, h in enumerate(transfers):
        seen = 20 * np.log10(h.magnitude(w)), np.degrees(h.phase(w))
        for axes, values in zip(both, seen, strict=False):
            axes.semilogx(w, values, color=COLOURS[k % 4], linestyle=DASHES[k % 4], label=h.name)
    for axes, label in zip(both, ("magnitude [dB]", "phase [°]"), strict=False):
        axes.set(ylabel=label, xlim=(w.min(), w.max()))
        axes.grid(True)
    both[-1].set_xlabel("angular frequency ω [rad/s]")
    both[-1].xaxis.set_major_formatter(lambda w, _: f"{w:g}")
    both[0].legend()
    for phase in both[1:]:
        phase.yaxis.set_major_locator(MultipleLocator(45))
    return drawn


@styled
def draw_poles(transfers: Sequence[TransferFunction]) -> Figure:
    """Poles as crosses and zeros as circles, one plane for each transfer function.

    Parameters
    ----------
    transfers : sequence of TransferFunction

    Examples
    --------
    >>> from drives import CoupledDrives, draw_poles
    >>> len(draw_poles([CoupledDrives().transfer("w1", "T1")]).axes)
    1
    """
    _check_transfers(transfers)
    drawn, cells = cells_of(None, 8.0, 0.6 + 2.2 * len(transfers), rows=len(transfers))
    for axes, h in zip(cells, transfers, strict=True):
        for found, mark, name in ((h.poles, "x", "pole"), (h.zeros, "o", "zero")):
            if found:
                look = {"markersize": 9, "markeredgewidth": 1.8, "fillstyle": "none", "linestyle": "", "label": name}
                axes.plot(np.real(found), np.imag(found), mark, color=COLOURS[mark == "o"], **look)
        axes.axvline(0, color=INK, linewidth=0.8)
        axes.axhline(0, color=INK, linewidth=0.8)
        sizes = [abs(z.real) for z in h.poles + h.zeros if z.real]
        if sizes and max(sizes) > WIDE * min(sizes):
            axes.set_xscale("symlog", linthresh=10 ** np.floor(np.log10(min(sizes))))
            axes.xaxis.set_major_formatter("{x:g}")
        if not any(z.imag for z in h.poles + h.zeros):
            axes.set_ylim(-1, 1)
        axes.margins(0.08)
        axes.set(title=h.name, xlabel="real part [rad/s]", ylabel="imaginary part")
        axes.grid(True)
        axes.legend()
    assert isinstance(drawn, Figure)
    return drawn


def _check_transfers(transfers: Sequence[TransferFunction]) -> None:
    check_kind("transfers", transfers, list, tuple)
    for h in transfers or ("none",):
        check_kind("transfers", h, TransferFunction)


@styled
def draw_run(run: Run, ax: Axes | None = None) -> Figure | Axes:
    """Belt speed and tension, with their set points under control, and pulley or torques, one above the other.

    Parameters
    ----------
    run : Run
    ax : matplotlib Axes, optional
        Where to draw the belt speed alone.

    Examples
    --------
    >>> from drives import CoupledDrives, Torque, draw_run, simulate
    >>> len(draw_run(simulate(CoupledDrives(), Torque.step(0.1), t_end=2.0, step=0.01)).axes)
    3
    """
    check_kind("run", run, Run)
    drawn, cells = cells_of(ax, 8.0, 6.0, rows=3, sharex=True)
    last = ("T1", "T2") if "T1" in run.outputs else ("x_k",)
    for k, (axes, names) in enumerate(zip(cells, (("belt_speed",), ("tension",), last), strict=False)):
        if names[0] in run.set_points:
            axes.plot(run.t, run.set_points[names[0]], color=FAINT, linestyle="--", linewidth=1.3, label="set point")
        for n, name in enumerate(names):
            label = name.replace("belt_", "belt ")
            axes.plot(run.t, run.outputs[name], color=COLOURS[k + n], linestyle=DASHES[n], label=label)
        for bound in () if run.limit is None or len(names) == 1 else (-run.limit, run.limit):
            axes.axhline(bound, color=INK, linewidth=0.8, linestyle=":")
        what = "torque" if len(names) > 1 else names[0].replace("belt_", "belt ")
        axes.set(ylabel=f"{what}\n[{ALL_UNITS[names[0]]}]", xlim=(run.t[0], run.t[-1]))
        axes.grid(True)
        if all(np.abs(run.outputs[name]).max() < NOISE for name in names):
            axes.set_ylim(-1, 1)
        if len(axes.lines) > 1:
            axes.legend(loc="lower right")
    cells[-1].set_xlabel("time [s]")
    return drawn


def draw_response(transfer: TransferFunction, ax: Axes | None = None) -> Figure | Axes:
    """Bode plot from below its slowest to above its fastest pole or zero."""
    sizes = [np.log10(abs(z)) for z in transfer.poles + transfer.zeros if z] or [0.0]
    return draw_bode([transfer], np.logspace(min(sizes) - DECADES, max(sizes) + DECADES, POINTS), ax)


def draw_design(design: Design, ax: Axes | None = None) -> Figure | Axes:
    """Both loops, set points stepping to 1 m/s and 1 N, until they have settled."""
    slowest = min(-z.real for poles in design.poles.values() for z in poles)
    if slowest <= 0:
        raise InputError("design", "an unstable loop settles nowhere", "a stable one")
    one, t_end = Torque.step(1.0), SETTLED / slowest
    return draw_run(simulate_control(design, one, one, t_end=t_end, step=t_end / POINTS), ax)
