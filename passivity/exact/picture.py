"""Z(jw) in the plane with its forbidden half, the Smith chart, the reflection against 1; of several ports the worst.

Functions of z are drawn over the angle of z = exp(jθ).
"""

import math
import sys
from itertools import pairwise
from typing import Any

import numpy as np
from flint import acb, fmpz_poly
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from passivity.calculus.search import Search
from passivity.discrete import angle
from passivity.errors import ExpressionError
from passivity.exact.margin import Margin, Margins
from passivity.floats.system import FloatSystem, first_grid, floats
from passivity.rational.function import RationalFunction
from passivity.rational.state_space import StateSpace
from passivity.status import Kind
from passivity.verdict import Network, Verdict
from tline.style import COLOURS, FAINT, INK, cells_of, styled

POINTS = 1200
MOST_DECADES = 307.0  # decades of a frequency
DECADES_BEYOND = 1.5  # below the smallest and above the largest modulus of a pole or zero
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ACTIVE_COLOUR = "#F7DFD0"  # where |H| > 1
_LEVELS = (0.2, 0.5, 1.0, 2.0, 5.0)
_CURVE, _BAD = COLOURS[:2]
_GRID = "#B8B8B8"
_OFF_POLES = 1 + 1e-9
_HIGHEST = 30  # times the median: beyond, near a pole, the curve leaves the picture
_MOST_STATES = 60  # up to which there are POINTS frequencies
_NAMES = {Kind.PR: "eigenvalues of (Z + Zᴴ)/2", Kind.BR: "singular values of S"}
_WORST = {Kind.PR: "the smallest", Kind.BR: "the largest"}


@styled
def draw_verdict(verdict: Verdict, margins: Margins, z0: float = 1.0, ax: Axes | None = None) -> Any:
    """A figure: Z(jw) beside the forbidden half plane, the Smith chart, and |H(jw)| against z0 with its largest value.

    On `ax` the Smith chart alone.
    """
    if not sys.float_info.min <= z0 < math.inf:
        raise ExpressionError("z0", "too large or too small to be drawn", "a number from 1e-307 to 1e308")
    x, values = _on_axis(verdict, [m.frequency for m in margins if m is not None])
    value = verdict.witness.value if verdict.witness else None
    values = np.append(values, complex(value) if isinstance(value, acb) and value.is_finite() else np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        h = values if verdict.kind is Kind.BR else np.where(np.isinf(values), 1, (values - z0) / (values + z0))
    (*values, point), (*h, there) = values, h
    axis = "(e^jθ), θ > 0" if verdict.is_discrete else "(jω), ω > 0"
    width, columns = (13.0, 3) if verdict.kind is Kind.PR else (9.5, 2)
    title = f"{verdict.kind.value}{verdict.region}: {verdict.status.value}"
    drawn, cells = cells_of(ax, width, 4.6, columns=columns, title=title)
    *plane, smith, size = [None, ax, None] if ax is not None else cells
    draw_smith(smith, np.array(h), axis, there)
    if ax is None:
        for axes in plane:
            _impedance_plane(axes, np.array(values), margins.input, axis, point)
        against = "" if verdict.kind is Kind.BR else f" against z0 = {z0:.6g}"
        _size(size, x, np.abs(h), margins.reflection, against, verdict.is_discrete)
    return drawn


def _on_axis(verdict: Verdict, also: list[float]) -> tuple[NDArray, NDArray]:
    """Frequencies, or angles, and the values there."""
    x, s = np.unique([*np.linspace(0, math.pi, POINTS), *also]) if verdict.is_discrete else np.zeros(0), None
    if verdict.function is not None:
        verdict.function.to_floats()
        x = x if len(x) else frequencies(verdict.function, also)
        s = np.exp(1j * x) if verdict.is_discrete else 1j * x
        return x, np.array([verdict.function(one) for one in s])
    search = Search(verdict.question, {})
    x = x[1:-1] if len(x) else np.geomspace(search.low * 1e4, search.high / 1e5, POINTS)
    return x, search.values(1j * (np.tan(x / 2) if verdict.is_discrete else x))


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


def _impedance_plane(axes: Axes, z: NDArray[np.complex128], margin: Margin | None, axis: str, witness: complex) -> None:
    z = z[np.isfinite(z)]
    if not len(z):
        z = np.zeros(1, complex)
    middle = np.median(np.abs(z)) or 1.0
    near = z[np.abs(z) <= 20 * middle]  # near a pole the curve leaves every picture
    shown: NDArray[np.complex128] = np.array([*near, *[witness] * bool(np.abs(witness) <= 20 * middle)])
    left, right = _range(np.append(shown.real, 0.0), middle)
    bottom, top = _range(shown.imag, middle)
    axes.axvspan(min(left, -0.08 * (right - left)), 0, color=_BAD, alpha=0.15, linewidth=0, label="forbidden: Re Z < 0")
    axes.plot(
        z.real,
        z.imag,
        color=_CURVE,
        linewidth=1.7,
        label=f"Z{axis}",
        marker="." if np.ptp(shown) == 0 else "",
    )
    _mark(axes, witness)
    if margin is not None and math.isfinite(margin.value):
        axes.axvline(margin.value, color=INK, linestyle="--", linewidth=1, label=f"smallest Re Z = {margin.value:.4g}")
    axes.set(xlim=(min(left, -0.08 * (right - left)), right), ylim=(bottom, top))
    axes.set(xlabel="Re Z  [unit of Z]", ylabel="Im Z  [unit of Z]")
    axes.grid()
    axes.legend(loc="best", fontsize=8)


def _mark(axes: Axes, witness: complex) -> None:
    if not np.isnan(witness):
        axes.plot([witness.real], [witness.imag], "o", color=INK, markersize=5, label="witness")


def _range(values: NDArray, scale: float) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    room = 0.06 * (high - low) or 0.5 * scale
    return low - room, high + room


def _size(axes: Axes, w: NDArray, h: NDArray, margin: Margin | None, against: str, discrete: bool) -> None:
    largest = margin.value if margin is not None else math.inf
    top = min(max(1.12, 1.12 * float(np.max(h[np.isfinite(h)], initial=0))), 5.0)
    axes.axhspan(1, top, color=_BAD, alpha=0.15, linewidth=0, label="forbidden: |H| > 1")
    axes.axhline(1, color=_BAD, linewidth=1.2)
    name = "|H(e^jθ)|" if discrete else "|H(jω)|"
    axes.plot(w, h, color=_CURVE, linewidth=1.7, label=name)
    if margin is not None and math.isfinite(largest):
        axes.axhline(largest, color=INK, linestyle="--", linewidth=1, label=f"largest: {largest:.6g}")
        if w[0] <= margin.frequency <= w[-1]:
            axes.plot([margin.frequency], [largest], "o", color=INK, markersize=5)
    axes.set(xlim=(w[0], w[-1]), ylim=(0, top), ylabel=name + against)
    _label_axis(axes, discrete)
    axes.legend(loc="lower left", fontsize=8)


def _label_axis(axes: Axes, discrete: bool) -> None:
    """Decades of frequencies, or angles; and a grid."""
    if discrete:
        axes.set(xlabel="angle θ of z = exp(jθ)  [rad]")
    else:
        axes.set(xlabel="angular frequency ω  [rad/s]", xscale="log")
        axes.xaxis.set_major_formatter(lambda x, _: f"10{str(round(math.log10(x))).translate(_RAISED)}")
    axes.grid()


def draw_smith(
    axes: Axes, h: NDArray[np.complex128], axis: str = "(jω), ω > 0", witness: complex = complex("nan")
) -> None:
    """Draw H(jw), shape (n,), on a Smith chart: the circles are those of r and x in Z = z0 (r + jx).

    References
    ----------
    P. H. Smith, "Transmission line calculator", Electronics 12 (1939), 29-31.
    """
    h = h[np.isfinite(h)]
    half = min(max(1.18, 1.08 * float(np.nanmax(np.abs([*h, witness, 0])))), 5.0)
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
    axes.plot(h.real, h.imag, color=_CURVE, linewidth=1.7, marker=dot, label=f"H{axis}")
    _mark(axes, witness)
    axes.add_patch(Rectangle((0, 0), 0, 0, color=ACTIVE_COLOUR, label="forbidden: |H| > 1"))
    axes.set(xlim=(-half, half), ylim=(-half, half), xlabel="Re H", ylabel="Im H", aspect="equal")
    axes.legend(loc="upper right", fontsize=7, facecolor="white", frameon=True)


@styled
def draw_worst(verdict: Verdict, ax: Axes | None = None) -> Any:
    """A figure: all eigenvalues or singular values, the worst heavy, and that at the witness, on `ax` or a new one."""
    kind, network, bound = verdict.kind, verdict.function, float(verdict.kind is Kind.BR)
    try:
        w = _grid(verdict)
        x = np.array([angle(one) for one in w]) if verdict.is_discrete else w
        values = _values(kind, network, np.exp(1j * x) if verdict.is_discrete else 1j * w)
    except (OverflowError, np.linalg.LinAlgError):
        expected = "numbers within the range of floats"
        raise ExpressionError("plot", "too large or too small to be drawn", expected) from None
    title = f"{kind.value}{verdict.region}, {verdict.ports} port{'s' * (verdict.ports > 1)}: {verdict.status.value}"
    drawn, (axes,) = cells_of(ax, 8.0, 4.6, title=title)
    axes.plot(x, values[:, 1:], color=FAINT, linewidth=0.9)
    worst, usual = values[:, 0], float(np.median(np.abs(values))) or 1.0
    axes.plot(x, worst, color=_CURVE, linewidth=1.9, label=f"{_WORST[kind]} of the {_NAMES[kind]}")
    shown = [bound, *np.clip(worst, -_HIGHEST * usual, _HIGHEST * usual)]
    if verdict.witness is not None:
        s = complex(verdict.witness.re, verdict.witness.im)
        there, place = float(_values(kind, network, np.array([s]))[0, 0]), abs(s.imag)
        place = abs(np.angle(s)) if verdict.is_discrete else min(max(place, w[0]), w[-1])
        axes.plot([place], [there], "o", color=INK, label=f"at the witness {verdict.witness.variable} = {s:.4g}")
        shown.append(there)
    room = 0.1 * (max(shown) - min(shown)) or 0.1
    low, high = min(shown) - room, max(shown) + room
    axes.axhspan(bound, high if bound else low, color=_BAD, alpha=0.15, linewidth=0, label="forbidden")
    axes.axhline(bound, color=_BAD, linewidth=1.2)
    axes.set(xlim=(x[0], x[-1]), ylim=(max(low, 0) if bound else low, high), ylabel=_NAMES[kind])
    _label_axis(axes, verdict.is_discrete)
    axes.legend(loc="best", fontsize=8)
    return drawn


def _grid(verdict: Verdict) -> NDArray:
    """Frequencies that show all poles."""
    network = verdict.function if verdict.in_s is None else verdict.in_s.function
    if isinstance(network, StateSpace):
        many = network.states > _MOST_STATES
        system = FloatSystem.of(verdict.kind, network) if network.states else None
        w = np.array([w * system.unit for w in first_grid(system) if 0 < w < math.inf] if system else [])
    else:
        many, w = False, frequencies(RationalFunction(network.fraction[1], fmpz_poly([1])), [])
    points, (low, high) = POINTS // 4 if many else POINTS, (w.min(), w.max()) if len(w) else (0.01, 100.0)
    even = np.tan(np.linspace(0, math.pi, points + 2)[1:-1] / 2) if verdict.is_discrete else []
    return np.unique([*w, *np.geomspace(low, high, points), *even]) * _OFF_POLES


def _values(kind: Kind, network: Network, points: NDArray) -> NDArray:
    """Eigenvalues or singular values at points, shape (n, m), the worst first."""
    if isinstance(network, StateSpace):
        a, b, c, d = map(floats, network.matrices)
        z = np.array([d + c @ np.linalg.solve(s * np.eye(len(a)) - a, b) for s in points])
    else:
        z = np.array([network(s) for s in points])
    if not np.isfinite(z).all():
        raise OverflowError
    if kind is Kind.BR:
        return np.linalg.svd(z, compute_uv=False)
    return np.linalg.eigvalsh((z + z.conj().swapaxes(1, 2)) / 2)
