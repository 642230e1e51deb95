"""Five stability maps: their parameters, and the runs and predictions of each method.

All runs are one line of delay 1 and z0 = 1, shaken for two transits by random currents and then left alone.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.baseline import BASELINES
from tline.study.baseline.explicit import (
    Weights,
    cubic,
    fdtd,
    lax_wendroff,
    linear,
    moc,
    pointwise,
    slabs_pointwise,
    upwind,
)
from tline.study.baseline.method import COURANT, backward_euler, forward_euler, trapezoid
from tline.study.charts import boundaries as theory

CELLS, LATE, STEPS = 20, 8, 10  # per transit: grid cells; steps of methods that interpolate; steps beside a load
SLABS_LATE = 2  # whole slabs per transit in maps over their order
SHARE = 2 / 3  # R/(R + z0) of the integrated load
SOURCE = 0.5  # reflection of the source in the map of an active load
SHAKEN = 2.0
TONES = range(1, 21)  # whole waves during the excitation
BLOWN_UP = 1e200  # amplitude at which growth is certain
FADED = 1e-3  # of the largest peak so far: below, the tolerances of the integrators dominate
FLAT = 1e-2  # growth per transit that counts as zero where nothing decays
Measure = Callable[[float], tuple[NDArray, NDArray]]


@dataclass(frozen=True)
class Strip:
    """Method along the axis of a map: a run at x gives instants and efforts, theory a growth rate per transit."""

    label: str
    run: Measure
    predict: Callable[[float], float]
    every: int = 1  # which points of the axis are run: methods that take long skip some


@dataclass(frozen=True)
class Map:
    """Parameter and the methods that are run over it."""

    name: str
    title: str
    axis: str
    x: NDArray
    level: float  # growth rate at which a method counts as unstable
    strips: list[Strip]


def line(transits: float, *, near: float = np.inf, far: dict[str, Any] | None = None, tones: bool = False) -> Scene:
    """Build a line between a source of resistance `near` and a load, open where there is none.

    Slabs carry straight pieces between travelling breakpoints exactly; `tones` give them curves to project as well.
    """
    rng = np.random.default_rng(4)
    t = np.linspace(0.0, SHAKEN, 41)
    points = np.stack([t, np.r_[0.0, rng.normal(size=39), 0.0]], axis=1).tolist()
    waves = [{"shape": "piecewise linear", "points": points}]
    waves += [
        {"shape": "sine", "amplitude": rng.normal(), "frequency": k / SHAKEN, "until": SHAKEN}
        for k in TONES[: None if tones else 0]
    ]
    own = {"at": "near", "kind": "current"}
    return Scene(
        medium="electrical",
        t_end=transits,
        lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
        sources={
            f"shaker{k}": own | {"value": wave} | ({"resistance": near} if k == 0 and np.isfinite(near) else {})
            for k, wave in enumerate(waves)
        },
        loads={"far": {"at": "far", **far}} if far else {},
        probes={"far": {"at": "far"}},
    )


def rate(t: NDArray, u: NDArray) -> float:
    """Growth rate per transit: slope of the logarithm of the peaks, over the later half of the bounded ones."""
    with np.errstate(invalid="ignore"):
        beyond = ~(np.abs(u) < BLOWN_UP)
    end = int(np.argmax(beyond)) if beyond.any() else len(u)
    size = max(min(round(SHAKEN / t[1]), end // 8), 1)
    peaks = np.abs(u[: end // size * size]).reshape(-1, size).max(axis=1)
    faded = peaks < FADED * np.maximum.accumulate(peaks)
    peaks = peaks[: int(np.argmax(faded)) if faded.any() else None]
    late = peaks[len(peaks) // 2 :]
    if len(late) < 2:
        return -np.inf  # it is gone at once
    return float(np.polyfit(np.arange(len(late)) * size * t[1], np.log(late), 1)[0])


def _baseline(solve: Callable[..., Any], scene: Scene, n: float, **settings: Any) -> tuple[NDArray, NDArray]:
    trace = solve(scene, n, **settings)
    return trace.t, trace.u["far"]


def slabs(scene: Scene, order: int, slab: float) -> tuple[NDArray, NDArray]:
    """Run the production method at slab ends, without a check of the loads for passivity."""
    from tline.solver.assembly.assemble import assemble
    from tline.solver.loop.march import march

    cut = scene.model_copy(update={"solver": type(scene.solver).model_validate({"order": order, "slab": slab})})
    assembly = assemble(describe(cut), {"line"})
    n = int(np.ceil(float(scene.t_end) / slab - 1e-9))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        record, _ = march(assembly, n)
    return np.arange(n + 1) * slab, np.append(0.0, record[1].mean(axis=0)[order - 1 :: order])


def courant(points: int) -> Map:
    """Map of grid methods beyond Courant 1."""

    lossless = line(60.0)

    def on_grid(solve: Callable[..., Any]) -> Measure:
        return lambda C: _baseline(solve, lossless, CELLS / C, courant=C)

    return Map(
        "courant",
        "Courant number: lossless line, 20 cells",
        "Courant number (slabs: width over that of a cell)",
        np.linspace(0.5, 1.5, points),
        FLAT,
        [
            Strip("upwind", on_grid(upwind), lambda C: theory.upwind(C, CELLS)),
            Strip("Lax-Wendroff", on_grid(lax_wendroff), lambda C: theory.lax_wendroff(C, CELLS)),
            Strip("FDTD leapfrog", on_grid(fdtd), lambda C: theory.leapfrog(C, CELLS)),
            *(
                Strip(f"slabs, s = {s}", lambda C, s=s: slabs(line(60.0, tones=True), s, C / CELLS), lambda C: 0.0)
                for s in (1, 5, 8)
            ),
        ],
    )


def load_rate(points: int) -> Map:
    """Map of integrators of a load, by step times the rate of the load."""

    step = 1 / STEPS

    def behind(near: float, x: float, tones: bool = False) -> Scene:
        capacitance = 1.5 * step / x  # of rate (1 + 1/2)/C beside 2 ohm behind z0 = 1
        far = {"kind": "parallel", "resistance": 2, "capacitance": capacitance}
        return line(60.0, near=near, far=far, tones=tones)

    def by(rule: Callable[..., Any], near: float) -> Measure:
        return lambda x: _baseline(moc, behind(near, x), STEPS, rule=rule)

    return Map(
        "load_rate",
        "Stiff load: R beside C, 10 steps per transit",
        "time step × rate of the load",
        np.linspace(0.05, 4.0, points),
        FLAT,
        [
            Strip("forward Euler", by(forward_euler, 1.0), lambda x: theory.euler_load(x, STEPS)),
            Strip(
                "forward Euler, lossless source",
                by(forward_euler, np.inf),
                lambda x: theory.euler_loop(x, STEPS, SHARE),
            ),
            Strip("backward Euler", by(backward_euler, 1.0), lambda x: theory.backward_load(x, STEPS)),
            Strip("trapezoid", by(trapezoid, 1.0), lambda x: theory.trapezoid_load(x, STEPS)),
            *(
                Strip(
                    f"slabs, s = {s}, lossless source",
                    lambda x, s=s: slabs(behind(np.inf, x, True), s, step),
                    lambda x: 0.0,
                )
                for s in (1, 5, 8)
            ),
        ],
    )


def fraction(points: int) -> Map:
    """Map of the interpolation of arriving waves, and their extrapolation beyond the adjacent samples."""

    lossless = line(400.0)

    def strip(label: str, weights: Weights) -> Strip:
        return Strip(
            label,
            lambda f: _baseline(moc, lossless, LATE + f, weights=weights, whole=LATE),
            lambda f: theory.delay_roots(weights(f), LATE, LATE + f),
        )

    return Map(
        "fraction",
        "Fraction of a step in the delay: lossless line, 8 steps and a fraction per transit",
        "fraction; inside 0 … 1 interpolation, outside extrapolation",
        np.linspace(-0.5, 1.5, points),
        FLAT,
        [
            strip("MOC, linear", linear),
            strip("MOC, cubic", cubic),
            *(
                Strip(
                    f"slabs, s = {s}",
                    lambda f, s=s: slabs(line(100.0, tones=True), s, 1 / (LATE + f)),
                    lambda f: 0.0,
                    2,
                )
                for s in (1, 5, 8)
            ),
        ],
    )


def order(points: int, *, projected: bool) -> Map:
    """Map of slabs of every order over the fraction of a slab in the delay: pointwise, or projected."""
    from tline.solver.radau import basis

    lossless = line(300.0 if projected else 4000.0, tones=projected)

    def strip(s: int) -> Strip:
        def predict(f: float) -> float:
            maps = basis(s).shift(f) if projected else pointwise(basis(s), f)
            return theory.slab_matrix(*maps, SLABS_LATE, SLABS_LATE + f)

        def run(f: float) -> tuple[NDArray, NDArray]:
            if projected:
                return slabs(lossless, s, 1 / (SLABS_LATE + f))
            return _baseline(slabs_pointwise, lossless, SLABS_LATE + f, order=s, offset=0.0)

        return Strip(f"s = {s}", run, predict, 4 if projected else 1)

    how = "projected (the production method)" if projected else "read off pointwise"
    return Map(
        "order_projected" if projected else "order_pointwise",
        f"Order of slabs, the delayed wave {how}: lossless line, 2 slabs and a fraction per transit",
        "fraction of a slab in the delay",
        np.linspace(0.01, 0.99, points),
        FLAT,
        [strip(s) for s in range(1, 9)],
    )


def loop_gain(points: int) -> Map:
    """Map of an active load: the true wave grows as ln|H_s H_2|/(2T)."""

    near = (1 + SOURCE) / (1 - SOURCE)

    def resistance(g: float) -> float:
        return (1 + g / SOURCE) / (1 - g / SOURCE)

    def scene(g: float, transits: float, tones: bool = False) -> Scene:
        ohms = {"kind": "impedance", "numerator": [resistance(g)], "denominator": [1]}
        return line(transits, near=near, far=ohms, tones=tones)

    def strip(name: str, predict: Callable[[float], float] = theory.gain, transits: float = 600.0, every=1) -> Strip:
        method = BASELINES[name]
        return Strip(method.label, lambda g: _baseline(method.solve, scene(g, transits), STEPS), predict, every)

    courant = np.floor(COURANT * STEPS + 1e-9) / STEPS
    cells = round(courant * STEPS)
    return Map(
        "loop_gain",
        "Active load: negative resistance, source of reflection 1/2, 10 steps per transit",
        "loop gain Hₛ·H₂",
        np.linspace(0.55, 1.5, points),
        0.0,
        [
            *map(strip, ("moc_trapezoid", "moc_linear", "moc_cubic", "upwind", "lax_wendroff")),
            strip("pade", transits=100.0, every=10),
            strip("fdtd", lambda g: theory.leapfrog_chain(1 / near, 1 / resistance(g), courant, cells)),
            strip("lumped_pi", lambda g: theory.pi_chain(1 / near, 1 / resistance(g), STEPS), 100.0, 5),
            strip("lumped_t", lambda g: theory.t_chain(1 / near, 1 / resistance(g), STEPS), 100.0, 5),
            *(
                Strip(f"slabs, s = {s}", lambda g, s=s: slabs(scene(g, 100.0, True), s, 0.4), theory.gain, 2)
                for s in (1, 5, 8)
            ),
        ],
    )


MAPS: dict[str, Callable[[int], Map]] = {
    "courant": courant,
    "load_rate": load_rate,
    "fraction": fraction,
    "order_pointwise": partial(order, projected=False),
    "order_projected": partial(order, projected=True),
    "loop_gain": loop_gain,
}
