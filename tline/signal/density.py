"""Densities of sums of independent symbols, at levels evenly apart between a cursor and its negative, and of noise.

References
----------
B. K. Casper, M. Haycock, R. Mooney, "An accurate and efficient analysis method for multi-Gb/s chip-to-chip signaling
schemes", Symposium on VLSI Circuits (2002), 54-57, DOI 10.1109/VLSIC.2002.1015043.
IEEE Std 802.3, annex 93A, (93A-39) to (93A-45).
"""

import numpy as np
from numpy.typing import NDArray

LEVELS = 2000  # of the density, on either side of its middle
HALVINGS = 12  # halvings of their distance, to that on which the smallest cursors are summed
SMALL = 0.01  # of the noise: cursors that are added to it; of 5000 of them a tail of 1e-15 is then too large by 1 %
TAILS = 9.0  # standard deviations of noise that are kept


def density(cursors: NDArray, noise: float, step: float, symbols: int = 2) -> NDArray:
    """Probability of each multiple of a step, shape (2 LEVELS + 1,), all within LEVELS of them.

    Parameters
    ----------
    cursors : ndarray, shape (n,)
        Largest value of each symbol.
    noise : float
        Standard deviation.
    step : float
        Distance of levels, in units of the cursors.
    symbols : int
        Levels of a symbol, >= 2.

    Examples
    --------
    >>> found = density(np.array([0.5, 0.25]), 0.0, 0.01)
    >>> at = np.flatnonzero(found > 1e-12) - LEVELS
    >>> at.tolist(), found[found > 1e-12].tolist()
    ([-75, -25, 25, 75], [0.25, 0.25, 0.25, 0.25])
    """
    sizes, noise = without_small(cursors, noise, symbols)
    sizes, found, fine = np.sort(sizes), np.ones(1), step / 2**HALVINGS
    for h, reach in zip(sizes, _reaches(sizes), strict=True):  # small ones first, on levels as near as these are few
        while fine < step and reach > LEVELS * fine:
            found, fine = _coarser(found), 2 * fine
        found = _spread(found, h / fine, symbols)
        beyond = max(len(found) // 2 - LEVELS, 0)
        found = found[beyond : len(found) - beyond]
    for _ in range(round(np.log2(step / fine))):
        found = _coarser(found)
    found, levels = np.pad(found, LEVELS)[len(found) // 2 :][: 2 * LEVELS + 1], np.arange(-LEVELS, LEVELS + 1) * step
    excess = float(found @ levels**2 - sizes @ sizes * power(symbols))  # of variance, by parts between levels
    noise = max(noise**2 - excess, 0.0) ** 0.5
    if noise:
        k = levels / noise
        bell = np.exp(-(k**2) / 2)
        reach = min(int(TAILS * noise / step) + 1, LEVELS)
        found = np.convolve(found, (bell / bell.sum())[LEVELS - reach : LEVELS + reach + 1], "same")
    return found


def without_small(cursors: NDArray, noise: float, symbols: int = 2) -> tuple[NDArray, float]:
    """Sizes of cursors but for those that are small beside the noise, and the noise with these."""
    sizes = np.abs(cursors)
    kept = sizes >= SMALL * noise
    return sizes[kept], float(np.hypot(noise, np.linalg.norm(sizes[~kept]) * power(symbols) ** 0.5))


def largest(cursors: NDArray) -> float:
    """Sum of symbols that is exceeded with less than 3e-18, by W. Hoeffding, DOI 10.1080/01621459.1963.10500830."""
    return float(_reaches(np.abs(cursors))[-1]) if len(cursors) else 0.0


def _reaches(sizes: NDArray) -> NDArray:
    return np.minimum(np.cumsum(sizes), TAILS * np.sqrt(np.cumsum(sizes**2)))


def power(symbols: int) -> float:
    """Mean square of symbols from -1 to 1; (93A-29)."""
    return (symbols + 1) / (3 * (symbols - 1))


def _spread(density: NDArray, by: float, symbols: int) -> NDArray:
    """Spread a distribution to both sides by a number of levels, between two of them in parts that keep the mean.

    Examples
    --------
    >>> _spread(np.ones(1), 1.25, 2).tolist()
    [0.125, 0.375, 0.0, 0.375, 0.125]
    """
    n, middle = len(density), int(by) + 1
    wide = np.zeros(n + 2 * middle)
    for symbol in range(symbols):
        whole, part = divmod(by * (2 * symbol / (symbols - 1) - 1), 1.0)
        at = middle + int(whole)
        wide[at : at + n] += (1 - part) / symbols * density
        if part:
            wide[at + 1 : at + 1 + n] += part / symbols * density
    return wide


def _coarser(density: NDArray) -> NDArray:
    """Move a distribution to every other level, each level between by halves to its neighbours.

    Examples
    --------
    >>> _coarser(np.array([0.25, 0.5, 0.25])).tolist()
    [0.125, 0.75, 0.125]
    """
    wide = np.pad(density, len(density) // 2 % 2)
    found, between = wide[::2].copy(), wide[1::2] / 2
    found[:-1] += between
    found[1:] += between
    return found
