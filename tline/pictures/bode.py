"""Bode plots: size and phase over frequency."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, figure, styled


@styled
def plot_bode(f: NDArray, curves: dict[str, NDArray], size: str, title: str = "") -> Figure:
    """Size and unwrapped phase of complex curves over frequency.

    Parameters
    ----------
    f : ndarray, shape (n,)
        Frequencies, Hz, increasing.
    curves : dict of str to ndarray of complex, shape (n,)
        What is drawn, by name.
    size : str
        What stands beside the upper axis.
    title : str
    """
    unit, name = handy(float(f[-1]), "Hz")
    picture = figure(8.0, 5.6, title)
    upper, lower = picture.subplots(2, 1, sharex=True)
    for k, (label, values) in enumerate(curves.items()):
        look = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)], "label": label}
        finite = np.isfinite(values) & (values != 0)
        x = f[finite] / unit
        upper.plot(x, 20 * np.log10(np.abs(values[finite])), **look)
        lower.plot(x, np.degrees(np.unwrap(np.angle(values[finite]))), **look)
    upper.set_ylabel(f"{size} [dB]")
    lower.set_ylabel("phase [°]")
    lower.set_xlabel(f"frequency [{name}]")
    for axes in (upper, lower):
        if f[0] > 0 and f[-1] / f[0] > 20:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        axes.grid(True, which="major")
    if len(curves) > 1:
        upper.legend(loc="lower left", bbox_to_anchor=(0, 1), fontsize=9, ncols=4)
    return picture
