"""What a reflectometer shows: incident and reflected wave, and the impedance profile."""

import numpy as np
from matplotlib.figure import Figure

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, figure, styled
from tline.scene.medium import Medium
from tline.signal.tdr import Reflections

STEEP = 20.0  # times z0; a higher impedance is off the picture


@styled
def plot_reflections(seen: Reflections, medium: Medium, title: str = "") -> Figure:
    """Waves in units of the step above, impedance below; high impedances leave the picture.

    Parameters
    ----------
    seen : Reflections
    medium : Medium
        For the unit of impedances.
    title : str

    Returns
    -------
    matplotlib.figure.Figure
        With two axes that share time.
    """
    second, time_unit = handy(float(seen.t[-1]), "s")
    picture = figure(8.0, 5.4, title)
    upper, lower = picture.subplots(2, 1, sharex=True)
    for k, (name, wave) in enumerate((("incident", seen.incident), ("reflected", seen.reflected))):
        upper.plot(seen.t / second, wave, color=COLOURS[k], linestyle=DASHES[k], label=name)
    upper.set_ylabel("wave / step")
    upper.legend(loc="best", ncols=2)
    profile = np.where(seen.impedance < STEEP * seen.z0, seen.impedance, np.nan)
    lower.plot(seen.t / second, profile, color=COLOURS[2])
    lower.axhline(seen.z0, color=COLOURS[6], linewidth=0.8, linestyle=DASHES[2])
    lower.set_ylabel(f"impedance [{medium.units['resistance'].replace('ohm', 'Ω')}]")
    lower.set_xlabel(f"time, there and back [{time_unit}]")
    for axes in (upper, lower):
        axes.grid(True)
        axes.margins(x=0)
    picture.align_ylabels([upper, lower])
    return picture
