"""Z(jw) in the plane with its forbidden half, the Smith chart, and the reflection against 1."""

import math
import sys
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from passivity.calculus.search import Search
from passivity.errors import ExpressionError
from passivity.exact.margin import Margin, Margins
from passivity.rational.function import RationalFunction
from passivity.status import Kind
from passivity.verdict import Verdict
from tline.style import COLOURS, INK, cells_of, styled

POINTS = 1200
MOST_DECADES = 307.0  # decades of a frequency
DECADES_BEYOND = 1.5  # below the smallest and above the largest modulus of a pole or zero
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ACTIVE_COLOUR = "#F7DFD0"  # where |H| > 1
_LEVELS = (0.2, 0.5, 1.0, 2.0, 5.0)
_CURVE, _BAD = COLOURS[:2]
_GRID = "#B8B8B8"


@styled
def draw_verdict(verdict: Verdict, margins: Margins, z0: float = 1.0, ax: Axes | None = None) -> Any:
    """A figure: Z(jw) beside the forbidden half plane, the Smith chart, and |H(jw)| against z0 with its largest value.

    On `ax` the Smith chart alone.
    """
    if not sys.float_info.min <= z0 < math.inf:
        raise ExpressionError("z0", "too large or too small to be drawn", "a number from 1e-307 to 1e308")
    w, values = _on_axis(verdict, [m.frequency for m in margins if m is not None])
    with np.errstate(invalid="ignore", divide="ignore"):
        h = values if verdict.kind is Kind.BR else np.where(np.isfinite(values), (values - z0) / (values + z0), 1)
    width, columns = (13.0, 3) if verdict.kind is Kind.PR else (9.5, 2)
    drawn, cells = cells_of(ax, width, 4.6, columns=columns, title=f"{verdict.kind.value}: {verdict.status.value}")
    if ax is not None:
        draw_smith(ax, h)
        return ax
    *plane, smith, size = cells
    for axes in plane:
        _impedance_plane(axes, values, margins.input)
    draw_smith(smith, h)
    _size(size, w, np.abs(h), margins.reflection, "" if verdict.kind is Kind.BR else f" against z0 = {z0:.6g}")
    return drawn


def _on_axis(verdict: Verdict, also: list[float]) -> tuple[NDArray, NDArray]:
    """Frequencies, and the values there."""
    if verdict.function is not None:
        verdict.function.to_floats()
        w = frequencies(verdict.function, also)
        return w, np.array([verdict.function(1j * x) for x in w])
    search = Search(verdict.question, {})
    w = np.geomspace(search.low * 1e4, search.high / 1e5, POINTS)
    return w, search.values(1j * w)


def frequencies(function: RationalFunction, also: list[float]) -> NDArray:
    """Increasing angular frequencies that cover all features of a function, and the finite ones of `also`."""
    moduli = [m for f in (function.p, function.q) for m in _moduli(f)] or [0.0]
    marks = [math.log10(x) for x in also if 0 < x < math.inf]
    low, high = (
        max(min(moduli + marks) - DECADES_BEYOND, -MOST_DECADES),
        min(max(moduli + marks) + DECADES_BEYOND, MOST_DECADES),
    )
    near = [m + d for m in marks for d in np.linspace(-0.02, 0.02, 41)]
    return 10 ** np.unique([*np.linspace(low, high, POINTS), *near])


def _moduli(f) -> list[float]:
    """Decimal logarithms of about the moduli of the roots other than 0: slopes of Newton's polygon."""
    points = [(k, abs(c).bit_length() * math.log10(2)) for k, c in enumerate(f.coeffs()) if c]
    hull: list[tuple[int, float]] = []
    for k, y in points:
        while len(hull) > 1 and (hull[-1][1] - hull[-2][1]) * (k - hull[-1][0]) <= (y - hull[-1][1]) * (
            hull[-1][0] - hull[-2][0]
        ):
            hull.pop()
        hull.append((k, y))
    return [(a[1] - b[1]) / (b[0] - a[0]) for a, b in pairwise(hull)]


def _impedance_plane(axes: Axes, z: NDArray[np.complex128], margin: Margin | None) -> None:
    z = z[np.isfinite(z)]
    if not len(z):
        z = np.zeros(1, complex)
    middle = np.median(np.abs(z)) or 1.0
    shown = z[np.abs(z) <= 20 * middle]  # near a pole the curve leaves every picture
    left, right = _range(np.append(shown.real, 0.0), middle)
    bottom, top = _range(shown.imag, middle)
    axes.axvspan(min(left, -0.08 * (right - left)), 0, color=_BAD, alpha=0.15, linewidth=0, label="forbidden: Re Z < 0")
    axes.plot(
        z.real, z.imag, color=_CURVE, linewidth=1.7, label="Z(jω), ω > 0", marker="." if np.ptp(shown) == 0 else ""
    )
    if margin is not None and math.isfinite(margin.value):
        axes.axvline(margin.value, color=INK, linestyle="--", linewidth=1, label=f"smallest Re Z = {margin.value:.4g}")
    axes.set(xlim=(min(left, -0.08 * (right - left)), right), ylim=(bottom, top))
    axes.set(xlabel="Re Z  [unit of Z]", ylabel="Im Z  [unit of Z]")
    axes.grid()
    axes.legend(loc="best", fontsize=8)


def _range(values: NDArray, scale: float) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    room = 0.06 * (high - low) or 0.5 * scale
    return low - room, high + room


def _size(axes: Axes, w: NDArray, h: NDArray, margin: Margin | None, against: str) -> None:
    largest = margin.value if margin is not None else math.inf
    top = min(max(1.12, 1.12 * float(np.max(h[np.isfinite(h)], initial=0))), 5.0)
    axes.axhspan(1, top, color=_BAD, alpha=0.15, linewidth=0, label="forbidden: |H| > 1")
    axes.axhline(1, color=_BAD, linewidth=1.2)
    axes.semilogx(w, h, color=_CURVE, linewidth=1.7, label="|H(jω)|")
    if margin is not None and math.isfinite(largest):
        axes.axhline(largest, color=INK, linestyle="--", linewidth=1, label=f"largest: {largest:.6g}")
        if w[0] <= margin.frequency <= w[-1]:
            axes.plot([margin.frequency], [largest], "o", color=INK, markersize=5)
    axes.set(xlim=(w[0], w[-1]), ylim=(0, top), xlabel="angular frequency ω  [rad/s]", ylabel=f"|H(jω)|{against}")
    axes.xaxis.set_major_formatter(lambda x, _: f"10{str(round(math.log10(x))).translate(_RAISED)}")
    axes.grid()
    axes.legend(loc="lower left", fontsize=8)


def draw_smith(axes: Axes, h: NDArray[np.complex128]) -> None:
    """Draw H(jw), shape (n,), on a Smith chart: the circles are those of r and x in Z = z0 (r + jx).

    References
    ----------
    P. H. Smith, "Transmission line calculator", Electronics 12 (1939), 29-31.
    """
    h = h[np.isfinite(h)]
    half = min(max(1.18, 1.08 * float(np.max(np.abs(h), initial=0))), 5.0)
    axes.set_facecolor(ACTIVE_COLOUR)
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
    axes.add_patch(Rectangle((0, 0), 0, 0, color=ACTIVE_COLOUR, label="forbidden: |H| > 1"))
    axes.set(xlim=(-half, half), ylim=(-half, half), xlabel="Re H", ylabel="Im H", aspect="equal")
    axes.legend(loc="upper right", fontsize=7, facecolor="white", frameon=True)
