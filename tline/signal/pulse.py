"""Response of a probe of a linear channel to one bit, and filters at either end of the channel."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.frequency.response import respond, source_named
from tline.scene.medium import ELECTRICAL, MEDIA, Medium
from tline.scene.scene import Scene
from tline.signal.bits import FINE, above_zero, edge_within, levels_of, probed
from tline.solver.simulate import simulate
from tline.units import to_si
from tline.words.wording import shown

BITS = 64, 128, 256, 512  # that the response may last; more while too much is missing
MISSING = 1e-3  # of the largest value: allowed difference of the sum of all cursors from the gain at rest
AT_REST = 1e-9  # of 1/period: s at which the gain at rest is taken


class Filter(NamedTuple):
    """A filter of a receiver by its zeros and poles, both in rad/s, H = gain · Π(s - z)/Π(s - p)."""

    zeros: NDArray
    poles: NDArray
    gain: float

    def at(self, f: NDArray) -> NDArray:
        """Response at frequencies, Hz."""
        from scipy.signal import freqs_zpk

        return freqs_zpk(*self, 2 * np.pi * f)[1]


def ctle(gain: float, zero: float, *poles: float) -> Filter:
    """A continuous-time linear equaliser, as of `PulseResponse.with_ctle`; (93A-22)."""
    w = 2 * np.pi * np.asarray(poles, float)
    if not len(w) or not (w > 0).all() or not zero > 0 or not abs(gain) <= 100:
        raise InputError("ctle", "not an equaliser", "gain of -100 to 100 dB, then a zero and poles above 0 Hz")
    g, w0 = 10 ** (gain / 20), 2 * np.pi * zero
    return Filter(np.array([-g * w0]), -w, float(np.prod(w)) / w0)


def low_pass(bandwidth: float) -> Filter:
    """A receiver's noise filter, Butterworth's of fourth order, by its bandwidth, Hz; (93A-20)."""
    from scipy.signal import buttap

    corner = 2 * np.pi * bandwidth
    return Filter(np.empty(0), corner * buttap(4)[1], corner**4)


@dataclass(frozen=True, eq=False)
class PulseResponse:
    """A probe's answer to a one among zeros, for a channel in which answers add up.

    Attributes
    ----------
    period : float
        Time of a bit, s.
    u : ndarray, shape (n, 64)
        Effort in each bit's time, from the begin of the one on, above that of zeros.
    base : float
        Effort where all bits are zeros.
    missing : float
        Sum of all later cursors, by the gain at rest.
    probe : str
        Name of the probe.
    medium : Medium
        Words and units.
    title : str
        Of the scene.
    unmeasured : float
        Possible effect of frequencies above those of a measured channel, by an estimate.
    """

    period: float
    u: NDArray
    base: float
    missing: float
    probe: str = ""
    medium: Medium = ELECTRICAL
    title: str = ""
    unmeasured: float = 0.0

    def to_pattern(self, bits: NDArray) -> NDArray:
        """Effort in each bit's time of a pattern that is sent for ever, shape (n, 64).

        What is missing of the response counts as spread evenly over earlier bits.

        Examples
        --------
        >>> pulse = PulseResponse(1e-9, np.array([[1.0] * 64, [0.5] * 64]), 0.25, 0.0)
        >>> pulse.to_pattern(np.array([True, True, False])).round(12)[:, 0]
        array([1.25, 1.75, 0.75])
        """
        n = len(bits)
        turns = np.pad(self.u, ((0, -len(self.u) % n), (0, 0))).reshape(-1, n, FINE).sum(0)
        added = np.fft.irfft(np.fft.rfft(bits)[:, None] * np.fft.rfft(turns, axis=0), n, axis=0)
        sums = self.u.sum(0)
        return added + self.base + (sums.mean() + self.missing - sums) * np.mean(bits)

    def with_ffe(self, taps: NDArray | list[float]) -> "PulseResponse":
        """Response behind a feed-forward equaliser at the sender, which sends each bit once for each tap, a bit apart.

        Parameters
        ----------
        taps : array_like, shape (m,)
            Factors of the bit itself, of the bit before, ...; a cursor in front of the main tap is one in front of it.

        Examples
        --------
        >>> pulse = PulseResponse(1e-9, np.array([[1.0] * 64, [0.5] * 64]), 0.0, 0.0)
        >>> pulse.with_ffe([1.0, -0.5]).u[:, 0]
        array([ 1.  ,  0.  , -0.25])
        """
        c = np.atleast_1d(np.asarray(taps, float))
        u = np.zeros((len(self.u) + len(c) - 1, FINE))
        for k, tap in enumerate(c):
            u[k : k + len(self.u)] += tap * self.u
        total, unmeasured = float(c.sum()), self.unmeasured * float(np.abs(c).sum())
        return replace(self, u=u, base=self.base * total, missing=self.missing * total, unmeasured=unmeasured)

    def with_ctle(self, gain: float, zero: float, *poles: float) -> "PulseResponse":
        """Response behind a continuous-time linear equaliser, (g + jf/fz)/((1 + jf/f1)(1 + jf/f2)).

        Parameters
        ----------
        gain : float
            g at rest, in dB, -100 to 100.
        zero : float
            fz, Hz, 1e-4/period to 1e4/period, as are all poles.
        *poles : float
            f1 and perhaps more, Hz, at least one.

        References
        ----------
        IEEE Std 802.3, annex 93A, (93A-22).
        """
        filtering = ctle(gain, zero, *poles)
        for corner in (zero, *poles):
            if not 1e-4 <= corner * self.period <= 1e4:
                expected = f"a zero and poles of {1e-4 / self.period:g} to {1e4 / self.period:g} Hz"
                raise InputError("ctle", "not an equaliser for such bits", expected, f"{corner:g} Hz")
        return self._behind(filtering)

    def with_low_pass(self, bandwidth: float | str) -> "PulseResponse":
        """Response behind a receiver's noise filter, Butterworth's of fourth order.

        Parameters
        ----------
        bandwidth : float or str
            Frequency at which it takes 3 dB, Hz, 0.1/period to 1000/period; 0.75/period in most standards.

        References
        ----------
        IEEE Std 802.3, annex 93A, (93A-20).
        """
        frequency = to_si(bandwidth, "Hz", "low_pass")
        if not 0.1 / self.period <= frequency <= 1000 / self.period:
            expected = f"{0.1 / self.period:g} to {1000 / self.period:g} Hz"
            raise InputError("low_pass", "not a bandwidth for such bits", expected, shown(bandwidth))
        return self._behind(low_pass(frequency))

    def _behind(self, filtering: Filter) -> "PulseResponse":
        """Response behind a filter."""
        from scipy.signal import ZerosPolesGain, lsim

        flat, seconds = np.append(self.u.ravel(), self.u[-1, -1]), self.period / FINE
        zeros, poles = filtering.zeros * seconds, filtering.poles * seconds
        factor = filtering.gain * seconds ** (len(poles) - len(zeros))
        _, u, _ = lsim(ZerosPolesGain(zeros, poles, factor).to_ss(), flat, np.arange(len(flat), dtype=float))
        u, at_rest = u[:-1].reshape(-1, FINE), float(filtering.at(np.zeros(1))[0].real)
        missing = at_rest * (float(self.u.sum(0).mean()) + self.missing) - float(u.sum(0).mean())
        return replace(self, u=u, base=self.base * at_rest, missing=missing)


def pulse_response(
    scene: Scene | str | Path,
    probe: str,
    period: float | str,
    rise: float | str,
    *,
    source: str | None = None,
    low: float | str = 0.0,
    high: float | str = 1.0,
    tol: float | None = None,
    progress: bool = False,
) -> PulseResponse:
    """Send one bit through a linear scene, all other sources silent.

    Parameters
    ----------
    scene : Scene, or the path of a file
    probe : str
        Name of the probe.
    period : float or str
        Time of a bit, s.
    rise : float or str
        Time of a change from level to level, straight, which begins with the bit, s.
    source : str, optional
        Name of the source; not needed if there is one only.
    low, high : float or str
        Levels of a zero and a one, of the source's quantity.
    tol : float, optional
        Largest error of the probe, relative to its amplitude, instead of the scene's; 1e-6 where there is neither.
    progress : bool
        Show a progress bar on stderr if the run takes more than two seconds.

    Raises
    ------
    InputError
        There is no such probe or source, the rise takes longer than a bit, or the scene is not linear.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "1.5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 0, "resistance": 50}},
    ...     loads={"r": {"at": "far", "kind": "resistor", "resistance": 50}},
    ... )
    >>> pulse_response(scene, "far", "1 ns", "0.25 ns").u[:4, 32].round(9)  # in the middle of each bit
    array([0. , 0. , 0.5, 0. ])
    """
    scene, T = probed(scene, probe), above_zero(period, "period")
    driver = source_named(scene, source)
    levels = levels_of(scene, driver, low, high)
    return one_bit(scene, probe, driver, T, edge_within(rise, T), levels, tol, progress)


def one_bit(
    scene: Scene,
    probe: str,
    driver: str,
    T: float,
    edge: float,
    levels: tuple[float, float],
    tol: float | None,
    progress: bool,
    allowed: float = MISSING,
) -> PulseResponse:
    """Send one bit through a linear scene, for as long as what is missing is more than allowed of the largest value."""
    (zero, one), table = levels, scene.table()
    gain = float(respond(scene, np.array([AT_REST / T]), driver)[probe].u[0].real)  # refuses non-linear scenes
    points = [[0.0, 0.0], [edge, one - zero], [T, one - zero], [T + edge, 0.0]]
    for name, each in table["sources"].items():
        each["value"] = {"shape": "piecewise linear", "points": points} if name == driver else 0.0
    table |= {"start": "rest", "probes": {probe: table["probes"][probe]}, "measures": {}}

    def seen(n: int) -> NDArray:
        run = simulate(scene.with_changes(**table | {"t_end": n * T}), tol=tol, progress=progress)
        return run.probes[probe].at(T * np.arange(n * FINE) / FINE).u.reshape(n, FINE)

    u, missing = until_settled(seen, gain * (one - zero), allowed)
    return PulseResponse(T, u, gain * zero, missing, probe, MEDIA[scene.medium], scene.title)


def until_settled(seen: Callable[[int], NDArray], total: float, allowed: float = MISSING) -> tuple[NDArray, float]:
    """Return the response in enough bits, shape (n, 64), for a small sum of later cursors, and that sum."""
    u, missing = np.empty((0, FINE)), 0.0
    for n in BITS:
        u = seen(n)
        missing = total - float(u.sum(0).mean())
        if max(abs(missing), np.abs(u[-1]).max()) <= allowed * np.abs(u).max():
            break
    return u, missing
