"""Pictures: Bode plot, poles and zeros, what a run did, the closed loop."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from drives.symbolic import ALL_UNITS, UNITS
from drives.transfer import TransferFunction

# Okabe and Ito's colours
COLOURS, DASHES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7"), ("-", "--", ":", "-.")
WIDE = 100  # largest over smallest real part from which on a linear scale shows only one of them
NOISE = 1e-12  # nothing but rounding, not worth a scale of its own


def draw_bode(transfers: Sequence[TransferFunction], omega: NDArray) -> Figure:
    """Size in dB and phase in degrees, without jumps, over angular frequency.

    Parameters
    ----------
    transfers : sequence of TransferFunction
    omega : numpy.ndarray
        rad/s, more than 0, increasing.
    """
    figure = Figure(figsize=(8, 6), dpi=150, layout="constrained")
    size, phase = figure.subplots(2, 1, sharex=True)
    for k, h in enumerate(transfers):
        look = {"color": COLOURS[k % 4], "linestyle": DASHES[k % 4], "linewidth": 1.8, "label": h.name}
        size.semilogx(omega, 20 * np.log10(h.magnitude(omega)), **look)
        phase.semilogx(omega, np.degrees(h.phase(omega)), **look)
    size.set(ylabel="size [dB]", xlim=(omega[0], omega[-1]))
    phase.set(ylabel="phase [°]", xlabel="angular frequency ω [rad/s]")
    phase.yaxis.set_major_locator(MultipleLocator(45))
    phase.xaxis.set_major_formatter(lambda w, _: f"{w:g}")
    for axes in (size, phase):
        axes.grid(alpha=0.3)
    size.legend(frameon=False)
    return figure


def draw_poles(transfers: Sequence[TransferFunction]) -> Figure:
    """Poles as crosses and zeros as circles, one plane for each transfer function."""
    figure = Figure(figsize=(8, 0.6 + 2.2 * len(transfers)), dpi=150, layout="constrained")
    for axes, h in zip(np.atleast_1d(figure.subplots(len(transfers), 1)), transfers, strict=True):
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
        axes.axvline(0, color="#222222", linewidth=0.8)
        axes.axhline(0, color="#222222", linewidth=0.8)
        sizes = [abs(z.real) for z in h.poles + h.zeros if z.real]
        if sizes and max(sizes) > WIDE * min(sizes):
            axes.set_xscale("symlog", linthresh=10 ** np.floor(np.log10(min(sizes))))
            axes.xaxis.set_major_formatter("{x:g}")
        if not any(z.imag for z in h.poles + h.zeros):
            axes.set_ylim(-1, 1)
        axes.margins(0.08)
        axes.set(title=h.name, xlabel="real part [rad/s]", ylabel="imaginary part")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False)
    return figure


def draw_run(t: NDArray, outputs: Mapping[str, NDArray], names: Sequence[str]) -> Figure:
    """Outputs over time, one above the other.

    Parameters
    ----------
    t : numpy.ndarray
        s.
    outputs : mapping of str to numpy.ndarray
        Of a run.
    names : sequence of str
        Which of them.
    """
    figure = Figure(figsize=(8, 0.6 + 1.7 * len(names)), dpi=150, layout="constrained")
    for k, (axes, name) in enumerate(
        zip(np.atleast_1d(figure.subplots(len(names), 1, sharex=True)), names, strict=True)
    ):
        axes.plot(t, outputs[name], color=COLOURS[k % 4], linewidth=1.8)
        axes.set(ylabel=f"{name}\n[{ALL_UNITS[name]}]", xlim=(t[0], t[-1]))
        axes.grid(alpha=0.3)
        if np.abs(outputs[name]).max() < NOISE:
            axes.set_ylim(-1, 1)
        if k == len(names) - 1:
            axes.set_xlabel("time [s]")
    return figure


def draw_closed_loop(
    t: NDArray, outputs: Mapping[str, NDArray], set_points: Mapping[str, NDArray], limit: float | None = None
) -> Figure:
    """Belt speed and tension beside their set points, and the motors' torques."""
    figure = Figure(figsize=(8, 6.4), dpi=150, layout="constrained")
    speed, tension, torque = figure.subplots(3, 1, sharex=True)
    for axes, name, colour in ((speed, "belt_speed", COLOURS[0]), (tension, "tension", COLOURS[2])):
        axes.plot(t, set_points[name], color="#8A8A8A", linestyle="--", linewidth=1.3, label="set point")
        axes.plot(t, outputs[name], color=colour, linewidth=1.8, label=name.replace("_", " "))
        axes.set(ylabel=f"{name.replace('_', ' ')}\n[{UNITS[name]}]", xlim=(t[0], t[-1]))
        axes.legend(frameon=False, loc="lower right")
    for name, colour, dash in (("T1", COLOURS[1], "-"), ("T2", COLOURS[3], "--")):
        torque.plot(t, outputs[name], color=colour, linestyle=dash, linewidth=1.8, label=name)
    for bound in () if limit is None else (-limit, limit):
        torque.axhline(bound, color="#222222", linewidth=0.8, linestyle=":")
    torque.set(ylabel="torque\n[N m]", xlabel="time [s]")
    torque.legend(frameon=False, loc="lower right")
    for axes in (speed, tension, torque):
        axes.grid(alpha=0.3)
    return figure
