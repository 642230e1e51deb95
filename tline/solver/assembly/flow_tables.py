"""Tables of what loss elements by a law of flow take of the wave that they see."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.loss.flow_law import FlowLaw, PowerLaw

LOWEST, HIGHEST, POINTS = -10, 32, 64  # octaves of a wave, Pa, and points in each
WEAKEST = -30  # octave from which a law that is a power is tabled for all strengths at once
STEPS, SOLVED = 100, 1e-14
LEAST = 1e-300


def flow_table(law: FlowLaw, z0: float, length: float) -> tuple[NDArray, float]:
    """Entries of a loss element of that length as `LossElements` has them, and c, so that |w| is looked up at c |w|.

    In the right units of flow and wave all lines with one power have the same table.
    """
    if isinstance(law, PowerLaw) and not law.square:
        n = law.exponent
        scale = (law.strength * length / (2 * z0)) ** (1 / (n - 1)) / (2 * z0)
        return _tabled(PowerLaw(1.0, 0.0, n), 0.5, 1.0, WEAKEST), scale
    return _tabled(law, z0, length, LOWEST), 1.0


@lru_cache(4096)
def _tabled(law: FlowLaw, z0: float, length: float, lowest: int) -> NDArray:
    """log2 of e/w over log2 |w|; e/w is between 0 and 1, so the element stays passive.

    The flow in 2 z0 y + length F(y) = w is found by Newton's steps on logarithms, halved where F jumps.
    """
    octaves = np.arange(lowest * POINTS, HIGHEST * POINTS + 1) / POINTS
    w = 2.0**octaves
    low, high = np.full(len(w), np.log(LEAST)), np.log(w / (2 * z0))
    x = high.copy()
    for _ in range(STEPS):
        y = np.exp(x)
        drop, slope = (length * each for each in law(y))
        whole = 2 * z0 * y + drop
        low, high = np.where(whole < w, x, low), np.where(whole < w, high, x)
        newton = x - np.log(whole / w) * whole / ((2 * z0 + slope) * y)
        before, x = x, np.where((newton >= low) & (newton <= high), newton, (low + high) / 2)
        if np.abs(x - before).max() <= SOLVED * np.abs(x).max():
            break
    y = np.exp(x)
    drop = length * law(y)[0]
    met = np.abs(2 * z0 * y + drop - w) <= 1e-9 * w  # else the flow stays where F jumps
    share = np.where(met, drop, w - 2 * z0 * y) / w
    return np.concatenate([[octaves[0], POINTS, len(w)], np.log2(np.clip(share, LEAST, 1.0))])
