"""Bit patterns, their times and levels."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.medium import MEDIA
from tline.scene.scene import Scene
from tline.units import to_si
from tline.words.wording import nearest, shown

FINE = 64  # instants in a bit
LONGEST = 2**16  # bits
FEEDBACK = {7: 6, 9: 5, 11: 9, 15: 14, 20: 3, 23: 18, 31: 28}  # of patterns: x^n + x^m + 1


def prbs(order: int, length: int | None = None) -> NDArray:
    """Return a pseudo-random pattern with every run of `order` bits but zeros once.

    Parameters
    ----------
    order : int
        n of the polynomial x^n + x^m + 1: 7, 9, 11, 15, 20, 23 or 31.
    length : int, optional
        Bits that are wanted of the 2^n - 1, after which the pattern comes again.

    Raises
    ------
    InputError
        There is no such pattern.

    References
    ----------
    ITU-T O.150, "General requirements for instrumentation for performance measurements on digital transmission
    equipment", 1996.

    Examples
    --------
    >>> prbs(9).sum(), len(prbs(9)), len(prbs(31, 1000))
    (np.int64(256), 511, 1000)
    """
    if not isinstance(order, int) or order not in FEEDBACK:
        raise InputError("order", "no pseudo-random pattern", ", ".join(map(str, FEEDBACK)), shown(order))
    bits, back = [True] * order, FEEDBACK[order]
    wanted = 2**order - 1 if length is None else length
    while len(bits) < wanted:
        bits.append(bits[-order] ^ bits[-back])
    return np.array(bits[:wanted])


def prbs7() -> NDArray:
    """The pseudo-random pattern x⁷ + x⁶ + 1, of 127 bits."""
    return prbs(7)


def probed(scene: Scene | str | Path, probe: str) -> Scene:
    """The scene, if it has that probe."""
    scene = as_scene(scene)
    if probe not in scene.probes:
        raise InputError("probe", "no such probe", nearest(probe, list(scene.probes)), shown(probe))
    return scene


def above_zero(value: float | str, where: str, unit: str | None = "s") -> float:
    """A number above zero, in SI units."""
    if not 0 < (number := to_si(value, unit, where)) < np.inf:
        raise InputError(where, "not positive", "more than 0", shown(value))
    return number


def edge_within(rise: float | str, T: float) -> float:
    """Time of a change, within a bit."""
    edge = to_si(rise, "s", "rise")
    if not 0 < edge <= T:
        raise InputError("rise", "not a time within a bit", f"above zero, at most {T:g} s", shown(rise))
    return edge


def levels_of(scene: Scene, source: str, low: float | str, high: float | str) -> tuple[float, float]:
    """Levels of zeros and ones of a source, in SI units."""
    unit = MEDIA[scene.medium].units["effort" if scene.sources[source].is_effort else "flow"]
    return to_si(low, unit, "low"), to_si(high, unit, "high")


def pattern_of(bits: str) -> NDArray:
    """Read a pattern: zeros and ones, or the name of a pseudo-random one."""
    if (found := re.fullmatch(r"prbs(\d{1,2})", bits)) and (order := int(found[1])) in FEEDBACK:
        return prbs(order, min(LONGEST, 2**order - 1))
    if not re.fullmatch(r"[01]{2,}", bits) or len({*bits}) != 2 or len(bits) > LONGEST:
        expected = f"zeros and ones, both of them, at most {LONGEST}; or 'prbs7' and the like"
        raise InputError("bits", "not a bit pattern", expected, shown(bits))
    return np.array([bit == "1" for bit in bits])
