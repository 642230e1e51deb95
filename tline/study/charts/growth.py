"""Error growth: change of a pulse in ten thousand passes along a lightly damped line, method by method.

A pulse runs to and fro between an open end and a source of high resistance. In each round trip the whole line passes by
the far end, so one window of 2T holds all there is. Three numbers describe the error of a method: loss or gain of
amplitude (damping), delay or advance (phase), and the remaining difference after the best shift and scale (dispersion).
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from tline.atomic import write_table
from tline.scene.scene import Scene
from tline.study.charts.picture import OURS, RAISED
from tline.style import COLOURS, DASHES, figure, styled

TRANSITS, QUICK = 10_000, 40
STEPS = 16  # per transit, about as many for all methods
LOSS = 1e-4  # per round trip: 10⁴ transits leave exp(-1/2)
KINDS = ("error", "damping", "phase", "dispersion")
ABOUT = {
    "error": "error: difference / pulse",
    "damping": "damping: amplitude lost or won",
    "phase": "phase: shift in transits",
    "dispersion": "dispersion: change of shape",
}
LOWEST, HIGHEST = 1e-10, 10.0  # drawn


@dataclass(frozen=True)
class GrowthCurve:
    """Errors of one method's pulse, relative to the exact one, after each number of transits."""

    transits: NDArray  # (n,)
    error: NDArray  # (n,) L2 norm of the difference over that of the pulse
    damping: NDArray  # (n,) share of the pulse's L2 norm that is lost; negative where it grew
    phase: NDArray  # (n,) delay in transits, at most 1 to either side
    dispersion: NDArray  # (n,) difference left by the best shift and scale, over the norm of the arriving pulse
    seconds: float  # time stepping of the whole run


def light_line(transits: int) -> Scene:
    """Line of delay 1 between an open end and a resistance that reflects exp(-LOSS) of each wave; one smooth pulse."""
    reflection = np.exp(-LOSS)
    pulse = {"shape": "sine", "amplitude": 0.5, "offset": 0.5, "phase": -np.pi / 2, "frequency": 1.0, "until": 1.0}
    return Scene(
        medium="electrical",
        t_end=float(transits),
        lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
        sources={
            "s": {"at": "near", "kind": "current", "resistance": (1 + reflection) / (1 - reflection), "value": pulse}
        },
        probes={"far": {"at": "far"}},
    )


def exact(scene: Scene, t: NDArray) -> NDArray:
    """Exact effort at the far end, t in the order of time and of one window [2m, 2m + 2), after m round trips."""
    (source,) = scene.sources.values()
    m = np.floor(t[0] / 2 + 1e-9)
    at = t - 2 * m - 1
    sent = 2 / (1 + source.conductance)
    return sent * np.exp(-LOSS * m) * source.value.value(at, at)


def compare(arrived: NDArray, expected: NDArray) -> tuple[float, float, float, float]:
    """Error, damping, phase (in units of half the window) and dispersion of one window against the exact one."""
    n = len(arrived)
    twice = np.where((np.arange(n // 2 + 1) == 0) | (2 * np.arange(n // 2 + 1) == n), 1.0, 2.0)
    R, E, omega = np.fft.rfft(arrived), np.fft.rfft(expected), np.pi * np.arange(n // 2 + 1)
    norm, own = np.sqrt(twice @ np.abs(E) ** 2), np.sqrt(twice @ np.abs(R) ** 2)
    cross = twice * E.conj() * R
    late = np.linspace(-1, 1, 4096, endpoint=False)
    shift = late[np.argmax(np.real(np.exp(1j * np.outer(late, omega)) @ cross))]
    for _ in range(4):  # Newton's steps to where the correlation is largest
        turned = cross * np.exp(1j * omega * shift)
        slope, bend = -np.imag(omega @ turned), -np.real(omega**2 @ turned)
        shift -= slope / bend if bend < 0 else 0.0
    fitted = E * np.exp(-1j * omega * shift)
    fitted *= np.real(twice @ (fitted.conj() * R)) / norm**2
    left = np.sqrt(twice @ np.abs(R - fitted) ** 2) / own if own else 1.0
    return float(np.sqrt(twice @ np.abs(R - E) ** 2) / norm), float(1 - own / norm), float(shift), float(left)


def methods(*, quick: bool = False) -> dict[str, Callable[[Scene], tuple[NDArray, NDArray, float]]]:
    """Methods by label: from a scene to instants, efforts at the far end, and seconds; without `solve_ivp` if quick."""
    from tline.study.baseline import BASELINES
    from tline.study.baseline.explicit import slabs_pointwise
    from tline.study.baseline.method import BaselineRun

    def method(run: Callable[[Scene, float], BaselineRun], scene: Scene) -> tuple[NDArray, NDArray, float]:
        t, u, seconds = run(scene, STEPS)
        return t, u["far"], seconds

    names = ["moc_linear", "moc_cubic", "upwind", "lax_wendroff", "fdtd"]
    names += [] if quick else ["lumped_t", "lumped_pi", "pade"]
    found: dict[str, Callable] = {BASELINES[name].label: partial(method, BASELINES[name].run) for name in names}
    found["slabs, pointwise, s = 4"] = lambda scene: method(lambda s, n: slabs_pointwise(s, n // 4), scene)
    return found | {f"slabs, s = {s}": partial(_slabs, order=s) for s in (3, 5, 8)}


def _slabs(scene: Scene, order: int) -> tuple[NDArray, NDArray, float]:
    """Run the production method with half a slab left over in every delay, so that it has to project."""
    from tline.solver.simulate import UnresolvedWarning, simulate

    slab = 1 / (STEPS // order + 0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        run = simulate(Scene(**scene.model_dump(by_alias=True) | {"solver": {"order": order, "slab": slab}}))
    t = np.arange(int(run.t[-1] * 2 * STEPS)) / (2 * STEPS)
    return t, run.probes["far"].at(t).u, run.seconds


def error_growth(*, quick: bool = False, progress: bool = False) -> dict[str, GrowthCurve]:
    """Run all methods and compare the remaining pulses.

    Parameters
    ----------
    quick : bool
        40 transits in place of ten thousand, and no differential equations.
    progress : bool
        Show a progress bar on stderr if it takes more than two seconds.

    Returns
    -------
    dict of str to GrowthCurve
        By the method's label.
    """
    from tqdm import tqdm

    transits = QUICK if quick else TRANSITS
    scene = light_line(transits)
    windows = np.unique(np.geomspace(1, transits // 2 - 1, 30).astype(int))
    curves = {}
    for label, run in tqdm(methods(quick=quick).items(), disable=not progress, delay=2, unit="method"):
        t, u, seconds = run(scene)
        size = round(2 / t[1])
        with np.errstate(over="ignore", invalid="ignore"):
            told = [
                compare(u[m * size : (m + 1) * size], exact(scene, t[m * size : (m + 1) * size]))
                for m in windows
                if np.abs(u[m * size : (m + 1) * size]).max() < 1e100
            ]
        error, damping, phase, dispersion = np.array(told).T
        curves[label] = GrowthCurve(2.0 * windows[: len(told)], error, damping, phase, dispersion, seconds)
    return curves


def save(curves: dict[str, GrowthCurve], path: str | Path) -> None:
    """Write all numbers as CSV."""
    rows = (
        (label, int(transits), *(float(getattr(curve, kind)[k]) for kind in KINDS))
        for label, curve in curves.items()
        for k, transits in enumerate(curve.transits)
    )
    write_table(path, ("method", "transits", *KINDS), rows)


@styled
def draw(curves: dict[str, GrowthCurve]) -> Figure:
    """Draw four panels over the number of transits, logarithmic."""
    picture = figure(10.0, 8.6, f"A pulse on a lightly damped line, {STEPS} steps per transit")
    panels = picture.subplots(2, 2, sharex=True, sharey=True)
    own = [label for label in curves if label.startswith("slabs, s")]
    others = [label for label in curves if label not in own]
    looks = {label: {"color": OURS[k], "linewidth": 2.6} for k, label in enumerate(own)} | {
        label: {"color": COLOURS[k % 7], "linestyle": DASHES[k // 7 + 1], "linewidth": 1.4}
        for k, label in enumerate(others)
    }
    for axes, kind in zip(panels.flat, KINDS, strict=True):
        for label, look in looks.items():
            size = np.clip(np.abs(getattr(curves[label], kind)), LOWEST, HIGHEST)
            axes.loglog(curves[label].transits, size, label=label, **look)
        axes.set_title(ABOUT[kind], loc="left")
        axes.set_ylim(LOWEST, HIGHEST)
        axes.grid(True, which="major")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(numticks=9))
            axis.set_minor_locator(NullLocator())
            axis.set_major_formatter(lambda value, _: "10" + str(round(np.log10(value))).translate(RAISED))
    for axes in panels[1]:
        axes.set_xlabel("transits")
    picture.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9)
    return picture
