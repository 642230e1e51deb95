"""Pictures: Bode plot, poles and zeros, what a run did, the closed loop."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from drives.symbolic import ALL_UNITS, UNITS
from drives.transfer import TransferFunction
from tline.pictures.style import COLOURS, DASHES, FAINT, INK, cells_of, styled

WIDE = 100  # largest over smallest real part from which on a linear scale shows only one of them
NOISE = 1e-12  # nothing but rounding, not worth a scale of its own


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
    """
    drawn, both = cells_of(ax, 8.0, 6.0, rows=2, sharex=True)
    for k, h in enumerate(transfers):
        seen = 20 * np.log10(h.magnitude(omega)), np.degrees(h.phase(omega))
        for axes, values in zip(both, seen, strict=False):
            axes.semilogx(omega, values, color=COLOURS[k % 4], linestyle=DASHES[k % 4], label=h.name)
    for axes, label in zip(both, ("magnitude [dB]", "phase [°]"), strict=False):
        axes.set(ylabel=label, xlim=(omega[0], omega[-1]))
        axes.grid(True)
    both[-1].set_xlabel("angular frequency ω [rad/s]")
    both[-1].xaxis.set_major_formatter(lambda w, _: f"{w:g}")
    both[0].legend()
    for phase in both[1:]:
        phase.yaxis.set_major_locator(MultipleLocator(45))
    return drawn


@styled
def draw_poles(transfers: Sequence[TransferFunction]) -> Figure:
    """Poles as crosses and zeros as circles, one plane for each transfer function."""
    drawn, cells = cells_of(None, 8.0, 0.6 + 2.2 * len(transfers), rows=len(transfers))
    for axes, h in zip(cells, transfers, strict=True):
        for found, mark, name in ((h.poles, "x", "pole"), (h.zeros, "o", "zero")):
            if found:
                look = {"markersize": 9, "markeredgewidth": 1.8, "fillstyle": "none", "linestyle": ""}
                axes.plot(
                    [z.real for z in found],
                    [z.imag for z in found],
                    mark,
                    color=COLOURS[mark == "o"],
                    label=name,
                    **look,
                )
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


@styled
def draw_run(t: NDArray, outputs: Mapping[str, NDArray], names: Sequence[str], ax: Axes | None = None) -> Figure | Axes:
    """Outputs over time, one above the other.

    Parameters
    ----------
    t : numpy.ndarray
        s.
    outputs : mapping of str to numpy.ndarray
        Of a run.
    names : sequence of str
        Which of them.
    ax : matplotlib Axes, optional
        Where to draw the first of them alone.
    """
    drawn, cells = cells_of(ax, 8.0, 0.6 + 1.7 * len(names), rows=len(names), sharex=True)
    for k, (axes, name) in enumerate(zip(cells, names, strict=False)):
        axes.plot(t, outputs[name], color=COLOURS[k % 4])
        axes.set(ylabel=f"{name}\n[{ALL_UNITS[name]}]", xlim=(t[0], t[-1]))
        axes.grid(True)
        if np.abs(outputs[name]).max() < NOISE:
            axes.set_ylim(-1, 1)
    cells[-1].set_xlabel("time [s]")
    return drawn


@styled
def draw_closed_loop(
    t: NDArray,
    outputs: Mapping[str, NDArray],
    set_points: Mapping[str, NDArray],
    limit: float | None = None,
    ax: Axes | None = None,
) -> Figure | Axes:
    """Belt speed and tension beside their set points, and the motors' torques; on axes of your own the speed alone."""
    drawn, cells = cells_of(ax, 8.0, 6.4, rows=3, sharex=True)
    for axes, name, colour in zip(cells, ("belt_speed", "tension"), (COLOURS[0], COLOURS[2]), strict=False):
        axes.plot(t, set_points[name], color=FAINT, linestyle="--", linewidth=1.3, label="set point")
        axes.plot(t, outputs[name], color=colour, label=name.replace("_", " "))
        axes.set(ylabel=f"{name.replace('_', ' ')}\n[{UNITS[name]}]", xlim=(t[0], t[-1]))
    for axes in cells[2:]:
        for name, colour, dash in (("T1", COLOURS[1], "-"), ("T2", COLOURS[3], "--")):
            axes.plot(t, outputs[name], color=colour, linestyle=dash, label=name)
        for bound in () if limit is None else (-limit, limit):
            axes.axhline(bound, color=INK, linewidth=0.8, linestyle=":")
        axes.set_ylabel("torque\n[N m]")
    for axes in cells:
        axes.grid(True)
        axes.legend(loc="lower right")
    cells[-1].set_xlabel("time [s]")
    return drawn
