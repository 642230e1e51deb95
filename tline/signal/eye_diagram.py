"""Eye diagrams: response of a probe to a bit pattern, bit laid upon bit, and its opening."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.frequency.response import source_named
from tline.presentation import Presentation, plain
from tline.scene.ibis.element import Ibis
from tline.scene.medium import ELECTRICAL, MEDIA, Medium
from tline.scene.scene import Scene
from tline.scene.shape import Constant
from tline.signal.bits import FINE, above_zero, edge_within, levels_of, pattern_of, probed
from tline.signal.pulse import MISSING, PulseResponse, one_bit
from tline.solver.simulate import simulate

MARCHED = 4096  # bits of a pattern that are sent one by one
LATE = 64  # bits, the largest delay of such a pattern in the search
SETTLED = 1e-6  # of the largest value: of a response to one bit, what may come later


@dataclass(frozen=True, eq=False, repr=False)
class Eye(Presentation):
    """Response of a probe to a bit pattern that is sent again and again.

    Attributes
    ----------
    bits : ndarray of bool, shape (n,)
        The pattern.
    period : float
        Time of a bit, s.
    u : ndarray, shape (n, 64)
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
        Zeros and ones, at least one of each; or "prbs7", 9, 11, 15, 20, 23, 31. At most 65536 bits, and 4096 where
        they are sent one by one: the first of a longer pseudo-random pattern.
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
    Where answers of one source add up, one bit is sent, and its answers to all bits of the pattern, sent for ever, are
    added. Otherwise, and where a bit is not forgotten in 512, the pattern is sent twice, and the second round measured;
    a delay of up to 64 bits between source and probe is then found by where the eye opens highest.

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
    pattern, driver = pattern_of(bits), _driver(scene, source)
    table = scene.table()
    if driver is None:
        if rise is None:
            raise InputError("rise", "is missing", "the time of a change from level to level")
        name, edge = source_named(scene, source), edge_within(rise, T)
        levels = levels_of(scene, name, low, high)
        if answer := _answer(scene, probe, name, T, edge, levels, tol, progress):
            first = max(int(answer.u.argmax()) // FINE - 1, 0)
            found = _measured(pattern, T, answer.to_pattern(pattern), range(first, first + 3))
            return replace(found, probe=probe, medium=MEDIA[scene.medium], title=scene.title)
        pattern = _marched(pattern, bits)
        points = _points(np.tile(pattern, 2), T, edge, *levels)
        table["sources"][name]["value"] = {"shape": "piecewise linear", "points": points}
    else:
        if rise is not None:
            raise InputError("rise", f"'{driver}' has edges of its own", "none")
        pattern = _marched(pattern, bits)
        table["loads"][driver] |= {"bits": 2 * "".join("1" if bit else "0" for bit in pattern), "bit": T, "begin": 0.0}
    start = "rest" if driver is None else scene.start
    table |= {"t_end": 2 * len(pattern) * T, "start": start, "probes": {probe: table["probes"][probe]}, "measures": {}}
    seen = simulate(scene.with_changes(**table), tol=tol, progress=progress).probes[probe]
    t = T * (len(pattern) + np.arange(len(pattern) * FINE) / FINE)
    found = _measured(pattern, T, seen.at(t).u.reshape(-1, FINE), range(min(LATE, len(pattern))))
    return replace(found, probe=probe, medium=MEDIA[scene.medium], title=scene.title)


def _marched(pattern: NDArray, bits: str) -> NDArray:
    """Bits that are sent one by one: of a long pseudo-random pattern the first."""
    if len(pattern) > MARCHED and not bits.startswith("prbs"):
        raise InputError("bits", "too many to be sent one by one", f"at most {MARCHED}", f"{len(pattern)} bits")
    return pattern[:MARCHED]


def _answer(scene: Scene, probe: str, driver: str, *asked: Any) -> PulseResponse | None:
    """The response to one bit, where answers to bits add up and are over soon."""
    others = [source.value for name, source in scene.sources.items() if name != driver]
    if not all(isinstance(value, Constant) and value.level == 0 for value in others):
        return None
    try:
        found = one_bit(scene, probe, driver, *asked, allowed=SETTLED)
    except InputError:  # not linear, or what the run of the pattern refuses as well
        return None
    return found if abs(found.missing) <= MISSING * np.abs(found.u).max() else None


def _driver(scene: Scene, name: str | None) -> str | None:
    """The driver of that name, or the only one where there is no source beside it; None if a source is meant."""
    drivers = [own for own, load in scene.loads.items() if isinstance(load, Ibis) and load.bits is not None]
    if name is None and len(drivers) == 1 and all(("sources", own) in scene.parts for own in scene.sources):
        return drivers[0]
    return name if name in drivers else None


def _points(pattern: NDArray, T: float, edge: float, low: float, high: float) -> list[list[float]]:
    """Corners of the pattern; a change begins with its bit."""
    points = [[0.0, high if pattern[0] else low]]
    for k in np.flatnonzero(np.diff(pattern)) + 1:
        before, after = (low, high) if pattern[k] else (high, low)
        points += [[float(k * T), before], [float(k * T + edge), after]]
    return points


def _measured(pattern: NDArray, T: float, u: NDArray, late: range) -> Eye:
    """The eye where it opens highest, over some delays of the pattern in bits, sampled in its middle."""
    ones = np.concatenate([np.roll(u, -k, axis=0)[pattern].min(axis=0) for k in late])
    zeros = np.concatenate([np.roll(u, -k, axis=0)[~pattern].max(axis=0) for k in late])
    opening = ones - zeros
    highest = int(opening.argmax())
    threshold, middle, width = float(ones[highest] + zeros[highest]) / 2, float(highest), 0.0
    if opening[highest] > 0:
        above = np.minimum(ones - threshold, threshold - zeros)
        before, after = _crossing(above[highest::-1]), _crossing(above[highest:])
        middle, width = highest + (after - before) / 2, (before + after) * T / FINE
    one, zero = (float(np.interp(middle, np.arange(len(ones)), level)) for level in (ones, zeros))
    return Eye(pattern, T, u, (late[0] * FINE + middle) * T / FINE, one, zero, threshold, width)


def _crossing(above: NDArray) -> float:
    """Place at which values that begin above zero first fall to it, in instants."""
    below = np.flatnonzero(above <= 0)
    if not below.size:
        return float(len(above) - 1)
    k = int(below[0])
    return float(k - 1 + above[k - 1] / (above[k - 1] - above[k]))
