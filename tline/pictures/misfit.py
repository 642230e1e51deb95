"""A model beside the samples it was fitted to."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, FAINT, INK, figure, styled

if TYPE_CHECKING:
    from passivity import DelayedModel, MeasuredNetwork

BEYOND = 1.5  # times the highest frequency: how far the model is drawn
POINTS = 1500
LEAST = 1e-17  # of the misfits that are drawn: a logarithm knows no 0
TOLD_APART = 4  # ports whose waves back are curves of their own; of more all look alike


@styled
def plot_misfit(found: "DelayedModel | MeasuredNetwork", title: str = "") -> Figure:
    """|S| of samples and model, which no delay changes, and the distance between both S, over frequency.

    Of several ports all entries of S are drawn, those into one port in one colour, with the largest singular value,
    which tells whether the model is passive.

    Parameters
    ----------
    found : DelayedModel or MeasuredNetwork
        From `passivity.fit_behind_delay` or `passivity.fit_scattering`.
    title : str

    Examples
    --------
    >>> from passivity import SampledResponse, fit_behind_delay
    >>> found = fit_behind_delay(SampledResponse([1, 2, 3, 4], [0.5, 0.5, 0.5, 0.5], "S"), 1e-3)
    >>> plot_misfit(found).axes[1].get_xlabel()
    'frequency [Hz]'
    """
    f, data, ports = found.samples.f, found.samples.values, found.samples.ports
    hertz, name = handy(float(f[-1]), "Hz")
    drawn = np.linspace(0, BEYOND * f[-1], POINTS)
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
        lower.semilogy(f / hertz, np.maximum(misfit[:, i, k], LEAST), ".", color=colour, markersize=4)
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
