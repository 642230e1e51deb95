"""Method of characteristics by the histories of waves: whole steps, or interpolation between them."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.baseline.kernel.histories import advance_moc
from tline.study.baseline.loads import Euler, scattering, trapezoid
from tline.study.baseline.method import BaselineRun
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
) -> BaselineRun:
    """Characteristics: what arrives is what was sent one delay ago.

    Without interpolation the delays are rounded to whole steps: the wave speeds are adjusted. `offset` adds to n; with
    `whole` all lines count as that many steps late, and the rest of the delay, whatever it is, is the fraction.
    """
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / (n + offset)
    steps, delays = count_steps(scene, dt), delays_of(scene) / dt
    late = np.maximum(np.round(delays) if weights is nearest else np.floor(delays + 1e-9), 1).astype(int)
    late = late if whole is None else np.full(len(late), whole)
    taps = np.array([weights(f) for f in (0.0 * delays if weights is nearest else delays - late)])
    within(2 * len(late) * (steps + late.max()), MOST_KEPT)
    net = scattering(scene, list(nodes.values()), dt, rule)
    loop = partial(advance_moc, net, late, taps)
    return stepped(scene, loop, dt, steps, [node.excitations for node in nodes.values()])
