"""Natural oscillations of a scene: zeros of its characteristic function, located, not read off a curve."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from tline.errors import InputError, check_kind
from tline.scene.file import as_scene
from tline.scene.refuse import refuse_losses
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.stability.growth import (
    MOST_SAMPLES,
    SAMPLES,
    Box,
    Characteristic,
    UncountableError,
    right_of_all,
    zeros,
)

DEEP = 3.0  # decay exp(-DEEP) in the shortest delay; faster decay is not an oscillation
LOWEST = 1e-9  # relative to the highest frequency; slower is not an oscillation
ABOVE = 1e-3  # per shortest delay: right edge of the search where nothing can grow
NEUTRAL = 1e-9  # per shortest delay; smaller growth or decay is rounding
UNDAMPED = 1e-12  # relative to |s|; a smaller real part is rounding
MOST_WORK = 3e10  # entries of all matrices times their size


class Resonance(NamedTuple):
    """One natural oscillation exp(st).

    Attributes
    ----------
    s : complex
        Exponent, 1/s; Im s > 0, or Im s = 0 for growth without oscillation.
    """

    s: complex

    @property
    def frequency(self) -> float:
        """Frequency of the oscillation, Hz."""
        return self.s.imag / (2 * np.pi)

    @property
    def quality(self) -> float:
        """Quality factor |s|/(-2 Re s), energy over loss per radian; infinite without loss, negative if it grows."""
        return abs(self.s) / (-2 * self.s.real) if abs(self.s.real) > UNDAMPED * abs(self.s) else np.inf

    @property
    def decay_time(self) -> float:
        """Time in which the amplitude falls by a factor e, s; infinite if it stays, negative if it grows."""
        return -1 / self.s.real if abs(self.s.real) > UNDAMPED * abs(self.s) else np.inf

    def __str__(self) -> str:
        if self.decay_time < 0:
            return f"{self.frequency:.6g} Hz, grow by a factor e in {-self.decay_time:.4g} s"
        if np.isinf(self.decay_time):
            return f"{self.frequency:.6g} Hz, undamped"
        return f"{self.frequency:.6g} Hz, Q = {self.quality:.4g}, decays by a factor e in {self.decay_time:.4g} s"


def resonances(scene: Scene | str | Path, highest: float) -> list[Resonance]:
    """Natural oscillations up to a frequency, slowest first, and growth without oscillation.

    Sources are silent: ideal efforts are shorts, ideal flows are open. They are counted by the argument principle and
    polished; those that decay by more than exp(-3) within the shortest delay are left out.

    Parameters
    ----------
    scene : Scene, or the path of a file
        Lossless lines between linear nodes.
    highest : float
        Frequency, Hz, above zero.

    Raises
    ------
    InputError
        The scene is too large, or a bad frequency.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "a"}},
    ...     lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    ...     loads={"end": {"at": "b", "kind": "short"}},
    ... )
    >>> [f"{mode.frequency:.4g}" for mode in resonances(scene, 1e9)]  # quarter waves
    ['2.5e+08', '7.5e+08']
    """
    scene = as_scene(scene)
    refuse_losses(scene, "its oscillations are not searched")
    description = describe(scene)
    D = Characteristic(description)
    check_kind("highest", highest, int, float)
    if not 0 < highest < np.inf:
        raise InputError("highest", "not a positive frequency", "hertz", f"{highest}")
    top = 2 * np.pi * highest * D.second
    step = 1 / (SAMPLES * 2 * D.delays.sum())
    if top / step > MOST_SAMPLES or top / step * D.size**3 > MOST_WORK:
        raise InputError(
            "highest", "too many waves on the lines to be searched", "a lower frequency", f"{highest:.4g} Hz"
        )
    try:
        right = right_of_all(D, top, ABOVE) if description.active else ABOVE
        found = zeros(D.log, Box(-DEEP, right, -1.3e-4 * top, top * (1 + 1e-7)), step)
    except UncountableError:
        raise InputError("scene", "its oscillations lie too close together to be told apart") from None
    if not description.active:  # a double zero on the axis is found beside it, and nothing passive grows
        found = [complex(min(z.real, 0.0), z.imag) for z in found]
    turning = [z / D.second for z in found if z.imag > LOWEST * top]
    growing = [complex(z.real) / D.second for z in found if abs(z.imag) <= LOWEST * top and z.real > NEUTRAL]
    return [Resonance(s) for s in sorted(growing + turning, key=lambda s: s.imag)]
