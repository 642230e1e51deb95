"""Statistics of an eye: crossings of its threshold, and hits of a mask in its middle."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, check_kind
from tline.signal.all_patterns import StatisticalEye
from tline.signal.eye_diagram import Eye
from tline.units import to_si
from tline.words.wording import shown


class Jitter(NamedTuple):
    """Spread of the crossings of the threshold, s.

    Attributes
    ----------
    peak_to_peak, rms : float
        Largest distance of two crossings, and standard deviation; 0 where nothing crosses.
    """

    peak_to_peak: float
    rms: float


class Mask(NamedTuple):
    """A hexagon around the sampling instant and the threshold: of full height over the middle half of its width.

    Attributes
    ----------
    width : float
        From corner to corner, s.
    height : float
        In the probe's quantity.
    """

    width: float
    height: float

    @property
    def corners(self) -> NDArray:
        """Times from the sampling instant and efforts from the threshold, shape (7, 2), the last as the first."""
        w, h = self.width / 2, self.height / 2
        return np.array([(-w, 0), (-w / 2, h), (w / 2, h), (w, 0), (w / 2, -h), (-w / 2, -h), (-w, 0)])

    def edge(self, t: NDArray) -> NDArray:
        """Upper edge over the threshold at times from the sampling instant, 0 beside the mask."""
        return np.clip(2 - 4 * np.abs(t) / self.width, 0.0, 1.0) * self.height / 2


def mask_of(width: float | str, height: float | str, seen: Eye | StatisticalEye, unit: str | None = None) -> Mask:
    """A mask for an eye.

    Parameters
    ----------
    width : float or str
        Above zero, at most a bit; s.
    height : float or str
        Above zero, in the probe's quantity.
    seen : Eye or StatisticalEye
    unit : str, optional
        Of the height; that of a plain number if not given.

    Raises
    ------
    InputError
        A number out of range.
    """
    w, h = to_si(width, "s", "mask"), to_si(height, unit, "mask")
    if not 0 < w <= seen.period:
        raise InputError(
            "mask", "its width is none within a bit", f"above zero, at most {seen.period:g} s", shown(width)
        )
    if not 0 < h < np.inf:
        raise InputError("mask", "its height is not above zero", "more than 0", shown(height))
    return Mask(w, h)


def crossings(seen: Eye) -> NDArray:
    """Instants at which the eye crosses its threshold, from half a bit behind the sampling instant, within half a bit.

    Parameters
    ----------
    seen : Eye

    Returns
    -------
    ndarray
        In s, one for each crossing of the pattern, in order of time.
    """
    return (_crossed(seen) - seen.instant) % seen.period - seen.period / 2


def _crossed(seen: Eye) -> NDArray:
    """Instants at which the pattern crosses the threshold, s."""
    check_kind("seen", seen, Eye)
    above = np.append(seen.u.ravel(), seen.u[0, 0]) - seen.threshold
    k = np.flatnonzero((above[:-1] > 0) != (above[1:] > 0))
    return (k + above[k] / (above[k] - above[k + 1])) * seen.period / seen.u.shape[1]


def jitter(seen: Eye) -> Jitter:
    """Return the spread of the crossings of the threshold.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.signal.eye_diagram import eye
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "1.5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 0, "resistance": 50}},
    ... )
    >>> round(jitter(eye(scene, "far", "1 ns", "0.2 ns", "0010111")).peak_to_peak, 18)  # matched
    0.0
    """
    t = crossings(seen)
    return Jitter(float(np.ptp(t)), float(np.std(t))) if t.size else Jitter(0.0, 0.0)


def mask_hits(seen: Eye, mask: Mask) -> int:
    """Number of bits of the pattern that touch a mask.

    Parameters
    ----------
    seen : Eye
    mask : Mask

    Returns
    -------
    int
        Bits whose curve has an instant inside the hexagon.
    """
    check_kind("seen", seen, Eye)
    check_kind("mask", mask, Mask)
    n, fine = seen.u.shape
    t = np.append(np.arange(n * fine) / fine * seen.period, _crossed(seen))  # edges may be too steep for the instants
    u = np.append(seen.u.ravel(), np.full(len(t) - n * fine, seen.threshold))
    bit = np.floor((t - seen.instant) / seen.period + 0.5)
    within = t - seen.instant - bit * seen.period
    return len(np.unique(bit[np.abs(u - seen.threshold) < mask.edge(within)] % n))


def mask_margin(seen: StatisticalEye, mask: Mask) -> float:
    """Least distance of the contours of a statistical eye from a mask, below zero where they enter it.

    Parameters
    ----------
    seen : StatisticalEye
    mask : Mask

    Returns
    -------
    float
        In the probe's quantity.
    """
    check_kind("seen", seen, StatisticalEye)
    check_kind("mask", mask, Mask)
    t = np.append(seen.t, np.array([-1, 1]) * mask.width / 4)  # its corners
    within = np.abs(t) <= mask.width / 2
    above = np.minimum(seen.ones - seen.threshold, seen.threshold - seen.zeros)
    return float((np.interp(t, seen.t, above) - mask.edge(t))[within].min())
