"""Method of characteristics by the histories of waves: whole steps, or interpolation between them."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.nodes import nodes_of
from tline.study.baseline.loads import Euler, scatter, scattering, trapezoid
from tline.study.baseline.method import Trace
from tline.study.baseline.steps import MOST_KEPT, count_steps, delays_of, shortest_delay, stepped, within

Weights = Callable[[float], tuple[float, float, float, float]]


def nearest(f: float) -> tuple[float, float, float, float]:
    """Weights of the samples 1 step late, on time, 1 and 2 steps early; here f is 0."""
    return 0.0, 1.0, 0.0, 0.0


def linear(f: float) -> tuple[float, float, float, float]:
    """The wave a fraction f of a step before the sample on time, on a straight line."""
    return 0.0, 1.0 - f, f, 0.0


def cubic(f: float) -> tuple[float, float, float, float]:
    """The same on Lagrange's cubic."""
    return (
        -f * (1 - f) * (2 - f) / 6,
        (1 + f) * (1 - f) * (2 - f) / 2,
        (1 + f) * f * (2 - f) / 2,
        -(1 + f) * f * (1 - f) / 6,
    )


def moc(
    scene: Scene,
    n: float,
    rule: Callable[[NDArray, NDArray], Euler] = trapezoid,
    weights: Weights = nearest,
    offset: float = 0.0,
    whole: int | None = None,
) -> Trace:
    """Characteristics: what arrives is what was sent one delay ago.

    Without interpolation the delays are rounded to whole steps: the wave speeds are adjusted. `offset` adds to n; with
    `whole` all lines count as that many steps late, and the rest of the delay, whatever it is, is the fraction.
    """
    nodes, dt = nodes_of(scene), shortest_delay(scene) / (n + offset)
    steps, delays = count_steps(scene, dt), delays_of(scene) / dt
    late = np.maximum(np.round(delays) if weights is nearest else np.floor(delays + 1e-9), 1).astype(int)
    late = late if whole is None else np.full(len(late), whole)
    taps = np.array([weights(f) for f in (0.0 * delays if weights is nearest else delays - late)])
    within(2 * len(late) * (steps + late.max()), MOST_KEPT)
    net = scattering(scene, list(nodes.values()), dt, rule)
    loop = partial(advance_moc, net, late, taps)
    return stepped(scene, loop, dt, steps, [node.drives for node in nodes.values()])


@njit(cache=True, error_model="numpy")
def advance_moc(net, late, taps, drive, seen, steps, record):
    """Lines by their histories: all that was sent from an end, after as many zeros as the longest delay takes."""
    ends, m, pad = 2 * len(late), net.x_x.shape[1], np.max(late) + 2
    history = np.zeros((ends, steps + 1 + pad))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends):
            at = k + pad - late[e // 2]
            arriving[e] = 0.0
            for j in range(4):
                if taps[e // 2, j] != 0.0:
                    arriving[e] += taps[e // 2, j] * history[e ^ 1, at + 1 - j]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        history[:, k + pad] = sent
        record[:, k] = u[seen]
