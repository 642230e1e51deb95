"""A model beside the samples it was fitted to."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, FAINT, INK, figure, styled

if TYPE_CHECKING:
    from passivity.sampled.behind_delay import DelayedModel

BEYOND = 1.5  # times the highest frequency: how far the model is drawn
POINTS = 1500
LEAST = 1e-17  # of the misfits that are drawn: a logarithm knows no 0


@styled
def plot_misfit(found: "DelayedModel", title: str = "") -> Figure:
    """|S| of samples and model, which no delay changes, and the distance between both S, over frequency.

    Parameters
    ----------
    found : DelayedModel
        From `passivity.fit_behind_delay`.
    title : str

    Examples
    --------
    >>> from passivity import SampledResponse, fit_behind_delay
    >>> found = fit_behind_delay(SampledResponse([1, 2, 3, 4], [0.5, 0.5, 0.5, 0.5], "S"), 1e-3)
    >>> plot_misfit(found).axes[1].get_xlabel()
    'frequency [Hz]'
    """
    f, data = found.samples.f, found.samples.values[:, 0, 0]
    hertz, name = handy(float(f[-1]), "Hz")
    drawn = np.linspace(0, BEYOND * f[-1], POINTS)
    picture = figure(8.0, 5.2, title)
    upper, lower = picture.subplots(2, 1, sharex=True)
    upper.axvspan(f[-1] / hertz, drawn[-1] / hertz, color=FAINT, alpha=0.15, linewidth=0, label="not measured")
    upper.plot(f / hertz, np.abs(data), ".", color=INK, markersize=4, label="samples")
    upper.plot(drawn / hertz, np.abs(found.model.at(2 * np.pi * drawn)), color=COLOURS[0], label="model")
    upper.axhline(1.0, color=COLOURS[1], linewidth=1.0, linestyle="--", label="bound of all that is passive")
    upper.set_ylabel("|S|")
    upper.set_ylim(0.0, None)
    misfit = np.abs(found.model.at(2 * np.pi * f) - data)
    lower.semilogy(f / hertz, np.maximum(misfit, LEAST), ".", color=COLOURS[0], markersize=4)
    lower.yaxis.set_major_formatter(lambda x, _: f"{x:g}")
    lower.yaxis.set_minor_formatter(NullFormatter())
    lower.set_ylabel("|ΔS|")
    lower.set_xlabel(f"frequency [{name}]")
    lower.set_xlim(0.0, drawn[-1] / hertz)
    for axes in (upper, lower):
        axes.grid(True)
    picture.legend(loc="outside lower center", ncols=4)
    return picture
