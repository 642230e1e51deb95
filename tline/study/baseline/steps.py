"""Delays, impedances, steps and samples of a scene as all baseline methods take them, and the limits of their work."""

import time
from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.study.baseline.method import BaselineRun

MOST_WORK = 2e9  # cells times steps
MOST_KEPT = 1e8  # samples
HALF = 0.5  # of a step, by which methods that interpolate miss the shortest delay: the worst case
COURANT = 0.9  # of methods that would be exact, or could not run, at 1


def delays_of(scene: Scene) -> NDArray:
    """Delay of each line, s."""
    return np.array([line.parameters.delay or 0.0 for line in scene.lines.values()])


def impedances_of(scene: Scene) -> NDArray:
    """Characteristic impedance of each line."""
    return np.array([line.parameters.z0 for line in scene.lines.values()])


def decays_of(scene: Scene) -> NDArray:
    """Resistance over inductance of each line."""
    series = [line.losses.exact.series if line.losses else None for line in scene.lines.values()]
    return np.array([law.loss / law.storage if law else 0.0 for law in series])


def shortest_delay(scene: Scene) -> float:
    """The shortest delay, s."""
    return float(delays_of(scene).min())


def count_steps(scene: Scene, dt: float) -> int:
    """Steps of width dt until the end time, the last one whole."""
    return ceil(scene.t_end / dt - 1e-9)


def cells_of(scene: Scene, dt: float, courant: float) -> NDArray:
    """Cells of each line, as many as the Courant number allows."""
    return np.maximum(np.floor(courant * delays_of(scene) / dt + 1e-9), 1).astype(int)


def sections_of(scene: Scene, n: float) -> NDArray:
    """Sections of each line, n on the shortest."""
    sections = np.ceil(n * delays_of(scene) / shortest_delay(scene) - 1e-9).astype(int)
    within(float(sections.max()) ** 2, MOST_KEPT)
    return sections


def within(work: float, most: float) -> None:
    """Refuse a number of operations or samples beyond the most allowed."""
    if work > most:
        problem = f"takes {work:.2g} numbers, for the delays are far apart or the run is long"
        raise InputError("n", problem, f"at most {most:.0e}")


def probed(scene: Scene) -> list[int]:
    """Numbers of the nodes that the probes see."""
    names = list(dict.fromkeys(name for line in scene.lines.values() for name in line.nodes))
    return [names.index(str(probe.at)) for probe in scene.probes.values()]


def sampled(parts: list, t: NDArray, dt: float) -> NDArray:
    """Sum of waveforms; at a jump the value before it."""
    return sum((factor * waveform.value(t, t - 1e-9 * dt) for waveform, factor in parts), np.zeros(len(t)))


def stepped(scene: Scene, loop: Callable[..., None], dt: float, steps: int, parts: list) -> BaselineRun:
    """Sample the sources and run a compiled loop, which is compiled before the clock starts."""
    seen, t = np.array(probed(scene)), np.arange(steps + 1) * dt
    within((steps + 1) * (len(parts) + len(seen)), MOST_KEPT)
    record = np.zeros((len(seen), steps + 1))
    loop(np.zeros((len(parts), 1)), seen, 0, record)
    begun = time.perf_counter()
    loop(np.array([sampled(row, t, dt) for row in parts]), seen, steps, record)
    seconds = time.perf_counter() - begun
    return BaselineRun(t, dict(zip(scene.probes, record, strict=True)), seconds)
