"""An eye diagram with its opening."""

import numpy as np
from matplotlib.figure import Figure

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DOWN, UP, figure, styled
from tline.scene.medium import Medium
from tline.signal.eye_diagram import Eye
from tline.signal.eye_statistics import Mask, jitter


@styled
def plot_eye(seen: Eye, medium: Medium, title: str = "", mask: Mask | None = None) -> Figure:
    """All bits laid upon each other, two wide, the sampling instant in the middle, with height and width of the eye.

    Parameters
    ----------
    seen : Eye
    medium : Medium
        For words and units.
    title : str
    mask : Mask, optional
        Drawn around the sampling instant.

    Returns
    -------
    matplotlib.figure.Figure
    """
    n, fine = seen.u.shape
    shift = round((seen.instant / seen.period % 1.0) * fine) - fine  # one bit in front of the sampling instant
    turned = np.roll(seen.u.ravel(), -shift)
    windows = turned[(np.arange(n)[:, None] * fine + np.arange(2 * fine + 1)) % turned.size]
    size, unit = handy(float(np.abs(seen.u).max()), medium.shown["effort"])
    second, time_unit = handy(2 * seen.period, "s")
    t = np.linspace(-seen.period, seen.period, 2 * fine + 1) / second
    picture = figure(8.0, 4.8, title)
    axes = picture.subplots()
    axes.plot(t, windows.T / size, color=COLOURS[0], linewidth=0.8, alpha=max(0.2, min(0.6, 12 / n)))
    if mask is not None:
        corners = mask.corners
        outline = (corners[:, 0] / second, (corners[:, 1] + seen.threshold) / size)
        axes.fill(*outline, facecolor="#888888", edgecolor="#333333", alpha=0.5, zorder=3)
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
    return picture
