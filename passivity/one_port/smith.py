"""Smith chart: the reflection plane with circles of constant resistance and reactance."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

BEYOND = "#F7DFD0"  # where |H| > 1
_LEVELS = (0.2, 0.5, 1.0, 2.0, 5.0)
_CURVE, _BAD, _GRID = "#0072B2", "#D55E00", "#B8B8B8"


def draw_smith(axes: Axes, h: NDArray[np.complex128]) -> None:
    """Draw H(jw) on a Smith chart; outside the unit circle it returns more than came.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Empty axes.
    h : ndarray, shape (n,)
        Reflection against z0. The circles are those of r and x in Z = z0 (r + jx).

    References
    ----------
    P. H. Smith, "Transmission line calculator", Electronics 12 (1939), 29-31.
    """
    h = h[np.isfinite(h)]
    half = min(max(1.18, 1.08 * float(np.max(np.abs(h), initial=0))), 5.0)
    axes.set_facecolor(BEYOND)
    edge = axes.add_patch(Circle((0, 0), 1, facecolor="white", edgecolor=_BAD, linewidth=1.2, zorder=0))
    lines = {"fill": False, "edgecolor": _GRID, "linewidth": 0.6, "zorder": 1}
    axes.plot([-1, 1], [0, 0], color=_GRID, linewidth=0.6, zorder=1)
    for level in _LEVELS:
        axes.add_patch(Circle((level / (1 + level), 0), 1 / (1 + level), **lines))
        axes.text((level - 1) / (level + 1), 0.02, f"{level:g}", fontsize=6, color="#666666", ha="right")
        for sign in (1, -1):
            axes.add_patch(Circle((1, sign / level), 1 / level, **lines)).set_clip_path(edge)
            at = (1j * sign * level - 1) / (1j * sign * level + 1)
            label = f"{'−' * (sign < 0)}j{level:g}"
            axes.text(1.07 * at.real, 1.07 * at.imag, label, fontsize=6, color="#666666", ha="center", va="center")
    dot = "." if len(h) and np.ptp(h) == 0 else ""
    axes.plot(h.real, h.imag, color=_CURVE, linewidth=1.7, marker=dot, label="H(jω), ω > 0")
    axes.add_patch(Rectangle((0, 0), 0, 0, color=BEYOND, label="forbidden: |H| > 1"))
    axes.set(xlim=(-half, half), ylim=(-half, half), xlabel="Re H", ylabel="Im H", aspect="equal")
    axes.legend(loc="upper right", fontsize=7, facecolor="white")
