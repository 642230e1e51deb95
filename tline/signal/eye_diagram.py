"""Eye diagrams: response of a probe to a bit pattern, bit laid upon bit, and its opening."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.frequency.response import source_named
from tline.presentation import Presentation, plain
from tline.scene.file import as_scene
from tline.scene.ibis.element import Ibis
from tline.scene.medium import ELECTRICAL, MEDIA, Medium
from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.units import to_si
from tline.words.wording import nearest, shown

FINE = 128  # instants in a bit
LONGEST = 4096  # bits
FEEDBACK = {7: 6, 9: 5, 11: 9, 15: 14, 20: 3, 23: 18, 31: 28}  # of patterns: x^n + x^m + 1
LATE = 64  # bits, the largest delay of the pattern in the search


@dataclass(frozen=True, eq=False, repr=False)
class Eye(Presentation):
    """Response of a probe to a bit pattern, in the second of two rounds.

    Attributes
    ----------
    bits : ndarray of bool, shape (n,)
        The pattern.
    period : float
        Time of a bit, s.
    u : ndarray, shape (n, 128)
        Effort at the probe in each bit's time.
    instant : float
        The sampling instant, in the middle of the eye, after the begin of a sent bit, s.
    ones, zeros : float
        Lowest of the ones and highest of the zeros there.
    threshold : float
        Half way between ones and zeros where the eye is highest.
    width : float
        Time around that instant for which all ones are above the threshold and all zeros below it, s.
    probe : str
        Name of the probe.
    medium : Medium
        Words and units.
    title : str
        Of the scene.
    """

    bits: NDArray
    period: float
    u: NDArray
    instant: float
    ones: float
    zeros: float
    threshold: float
    width: float
    probe: str = ""
    medium: Medium = ELECTRICAL
    title: str = ""
    picture = "tline.pictures.signals:plot_eye"

    def text_lines(self) -> Iterator[str]:
        """Pattern, height, width, jitter and sampling instant."""
        told, unit = self.to_dict(), self.medium.units["effort"]
        yield f"{told['bits']} bits of {self.period:.6g} s at '{self.probe}'"
        yield f"height {self.height:.6g} {unit} around {self.threshold:.6g} {unit}, width {self.width:.6g} s"
        yield f"jitter {told['jitter']:.6g} s from peak to peak, {told['jitter_rms']:.6g} s rms"
        yield f"sampled {self.instant:.6g} s after the begin of a bit at the source"

    def to_dict(self) -> dict[str, Any]:
        """Eye statistics in SI units."""
        from tline.signal.eye_statistics import jitter

        told = {name: getattr(self, name) for name in ("height", "width", "instant", "threshold")}
        told |= {"jitter": jitter(self).peak_to_peak, "jitter_rms": jitter(self).rms}
        return plain(told | {"bits": len(self.bits), "period": self.period, "unit": self.medium.units["effort"]})

    @property
    def height(self) -> float:
        """Opening at the sampling instant: ones less zeros; at or below zero the eye is closed."""
        return self.ones - self.zeros


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
    if order not in FEEDBACK:
        raise InputError("order", "no pseudo-random pattern", ", ".join(map(str, FEEDBACK)), shown(order))
    bits, back = [True] * order, FEEDBACK[order]
    wanted = 2**order - 1 if length is None else length
    while len(bits) < wanted:
        bits.append(bits[-order] ^ bits[-back])
    return np.array(bits[:wanted])


def prbs7() -> NDArray:
    """The pseudo-random pattern x⁷ + x⁶ + 1, of 127 bits."""
    return prbs(7)


def eye(
    scene: Scene | str | Path,
    probe: str,
    period: float | str,
    rise: float | str | None = None,
    bits: str = "prbs7",
    *,
    source: str | None = None,
    low: float | str = 0.0,
    high: float | str = 1.0,
    tol: float | None = None,
    progress: bool = False,
) -> Eye:
    """Drive a source, or a driver of an IBIS file, with a bit pattern, and measure the eye at a probe.

    Parameters
    ----------
    scene : Scene, or the path of a file
    probe : str
        Name of the probe.
    period : float or str
        Time of a bit, s.
    rise : float or str, optional
        Time of a change from level to level, straight, which begins with the bit, s; a driver has edges of its own.
    bits : str
        Zeros and ones, at least one of each, at most 4096; or "prbs7", 9, 11, 15, 20, 23, 31, the first 4096 of it.
    source : str, optional
        Name of the source, or of the load that is a driver; not needed if there is one only.
    low : float or str
        Level of a zero, of the source's quantity.
    high : float or str
        Level of a one.
    tol : float, optional
        Largest error of the probe, relative to its amplitude, instead of the scene's; 1e-6 where there is neither.
    progress : bool
        Show a progress bar on stderr if the run takes more than two seconds.

    Raises
    ------
    InputError
        There is no such probe or source, the bits are no pattern, or the rise takes longer than a bit.

    Notes
    -----
    The pattern is sent twice, and the second round measured, at 128 instants a bit. A delay of up to 64 bits between
    source and probe is found by where the eye opens highest.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "1.5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 0, "resistance": 50}},
    ... )
    >>> found = eye(scene, "far", "1 ns", "0.2 ns", "0010111")
    >>> round(found.height, 9), round(found.width * 1e9, 6)  # matched: nothing but the edges closes it
    (1.0, 1.0)
    """
    scene, T = probed(scene, probe), above_zero(period, "period")
    pattern = _pattern(bits)
    table, driver = scene.table(), _driver(scene, source)
    if driver is None:
        if rise is None:
            raise InputError("rise", "is missing", "the time of a change from level to level")
        name = source_named(scene, source)
        points = _points(np.tile(pattern, 2), T, edge_within(rise, T), *levels_of(scene, name, low, high))
        table["sources"][name]["value"] = {"shape": "piecewise linear", "points": points}
    else:
        if rise is not None:
            raise InputError("rise", f"'{driver}' has edges of its own", "none")
        table["loads"][driver] |= {"bits": 2 * "".join("1" if bit else "0" for bit in pattern), "bit": T, "begin": 0.0}
    start = "rest" if driver is None else scene.start
    table |= {"t_end": 2 * len(pattern) * T, "start": start, "probes": {probe: table["probes"][probe]}, "measures": {}}
    seen = simulate(scene.with_changes(**table), tol=tol, progress=progress).probes[probe]
    t = T * (len(pattern) + np.arange(len(pattern) * FINE) / FINE)
    found = _measured(pattern, T, seen.at(t).u.reshape(-1, FINE))
    return replace(found, probe=probe, medium=MEDIA[scene.medium], title=scene.title)


def _driver(scene: Scene, name: str | None) -> str | None:
    """The driver of that name, or the only one where there is no source beside it; None if a source is meant."""
    drivers = [own for own, load in scene.loads.items() if isinstance(load, Ibis) and load.bits is not None]
    if name is None and len(drivers) == 1 and all(("sources", own) in scene.parts for own in scene.sources):
        return drivers[0]
    return name if name in drivers else None


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


def _pattern(bits: str) -> NDArray:
    if (found := re.fullmatch(r"prbs(\d{1,2})", bits)) and (order := int(found[1])) in FEEDBACK:
        return prbs(order, min(LONGEST, 2**order - 1))
    if not re.fullmatch(r"[01]{2,}", bits) or len({*bits}) != 2 or len(bits) > LONGEST:
        expected = f"zeros and ones, both of them, at most {LONGEST}; or 'prbs7' and the like"
        raise InputError("bits", "not a bit pattern", expected, shown(bits))
    return np.array([bit == "1" for bit in bits])


def _points(pattern: NDArray, T: float, edge: float, low: float, high: float) -> list[list[float]]:
    """Corners of the pattern; a change begins with its bit."""
    points = [[0.0, high if pattern[0] else low]]
    for k in np.flatnonzero(np.diff(pattern)) + 1:
        before, after = (low, high) if pattern[k] else (high, low)
        points += [[float(k * T), before], [float(k * T + edge), after]]
    return points


def _measured(pattern: NDArray, T: float, u: NDArray) -> Eye:
    """The eye where it opens highest, over all delays of the pattern up to some bits, sampled in its middle."""
    late = np.arange(min(LATE, len(pattern)))
    ones = np.concatenate([np.roll(u, -k, axis=0)[pattern].min(axis=0) for k in late])
    zeros = np.concatenate([np.roll(u, -k, axis=0)[~pattern].max(axis=0) for k in late])
    opening = ones - zeros
    highest = int(opening.argmax())
    threshold, middle, width = float(ones[highest] + zeros[highest]) / 2, highest, 0.0
    if opening[highest] > 0:
        above = np.minimum(ones - threshold, threshold - zeros)
        before, after = _crossing(above[highest::-1]), _crossing(above[highest:])
        middle, width = highest + round((after - before) / 2), (before + after) * T / FINE
    return Eye(pattern, T, u, middle * T / FINE, float(ones[middle]), float(zeros[middle]), threshold, width)


def _crossing(above: NDArray) -> float:
    """Place at which values that begin above zero first fall to it, in instants."""
    below = np.flatnonzero(above <= 0)
    if not below.size:
        return float(len(above) - 1)
    k = int(below[0])
    return float(k - 1 + above[k - 1] / (above[k - 1] - above[k]))
