"""Bode plots: size and phase over frequency."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.frequency.oscillations import Resonance
from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, DOWN, UP, figure, styled

WIDTH, HEIGHT = 8.0, 5.6  # inches
ENTRY = 0.09  # inches per letter in the legend
ALIKE = 1e-9  # of the largest value; curves nearer to each other than this are one


@styled
def plot_bode(
    f: NDArray, curves: Mapping[str, NDArray], what: str, unit: str, modes: Sequence[Resonance] = (), title: str = ""
) -> Figure:
    """Size and phase modulo 360° of complex curves over frequency; curves that are alike are drawn once.

    Parameters
    ----------
    f : ndarray, shape (n,)
        Frequencies, Hz, increasing.
    curves : mapping of str to ndarray of complex, shape (n,)
        What is drawn, by name.
    what, unit : str
        What the curves are, such as "voltage / source" in "V/V".
    modes : sequence of Resonance
        Natural oscillations, marked at the upper edge.
    title : str
    """
    hertz, name = handy(float(f[-1]), "Hz")
    drawn = _distinct(curves)
    picture = figure(WIDTH, HEIGHT, title)
    upper, lower = picture.subplots(2, 1, sharex=True)
    for k, (label, values) in enumerate(drawn.items()):
        look = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        finite = np.isfinite(values) & (values != 0)
        x = f[finite] / hertz
        upper.plot(x, 20 * np.log10(np.abs(values[finite])), label=label, **look)
        lower.plot(*_broken(x, np.degrees(np.angle(values[finite]))), **look)
    upper.set_ylabel(f"|{what}|\n[dB re {'1 ' * (unit != '1')}{unit}]")
    lower.set_ylabel("phase modulo 360° [°]")
    lower.set_ylim(-190, 190)
    lower.set_yticks(range(-180, 181, 90))
    lower.set_xlabel(f"frequency [{name}]")
    for axes in (upper, lower):
        if f[0] > 0 and f[-1] / f[0] > 20:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        axes.grid(True, which="major")
    _mark(upper, [mode for mode in modes if f[0] <= mode.frequency <= f[-1]], hertz)
    handles, labels = upper.get_legend_handles_labels()
    if len(labels) > 1:
        columns = max(int(WIDTH / (0.6 + ENTRY * max(map(len, labels)))), 1)
        picture.legend(handles, labels, loc="outside lower center", ncols=min(columns, len(labels)))
    return picture


def _distinct(curves: Mapping[str, NDArray]) -> dict[str, NDArray]:
    """Curves that are alike under their names together, such as S(a,b) and S(b,a)."""
    found: dict[str, NDArray] = {}
    for name, values in curves.items():
        nearby = ALIKE * np.abs(values[np.isfinite(values)]).max(initial=0.0)
        same = next((label for label, other in found.items() if np.allclose(values, other, 0.0, nearby, True)), None)
        label = name if same is None else f"{same} = {name}"
        found = {label if key == same else key: other for key, other in found.items()}
        found.setdefault(label, values)
    return found


def _broken(x: NDArray, phase: NDArray) -> tuple[NDArray, NDArray]:
    """A curve that is broken where its phase jumps from one edge to the other."""
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 180) + 1
    return np.insert(x, jumps, np.nan), np.insert(phase, jumps, np.nan)


def _mark(axes: Axes, modes: Sequence[Resonance], hertz: float) -> None:
    """Triangles at the upper edge."""
    for growing, label, colour, marker in ((False, "natural oscillation", DOWN, "v"), (True, "grows", UP, "^")):
        x = [mode.frequency / hertz for mode in modes if (mode.decay_time < 0) == growing]
        if x:
            look = {"color": colour, "marker": marker, "linestyle": "", "markersize": 5, "clip_on": False}
            axes.plot(x, np.ones(len(x)), transform=axes.get_xaxis_transform(), label=label, zorder=4, **look)
