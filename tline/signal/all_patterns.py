"""Statistical eyes: how likely each effort is at each instant, for all patterns of independent bits at once.

At an instant t of a bit a linear channel shows base + sum of b_k h_k with cursors h_k = p(t + kT) of its pulse response
and bits b_k of 0 or 1, each as likely. That is the middle, base + sum of h_k / 2, and for each cursor +-h_k/2: the
density of all but the main one is the convolution of two halves for each, and of the noise's. It is symmetric, so ones
and zeros come as near to the middle as each other.

References
----------
V. Stojanovic, M. Horowitz, "Modeling and analysis of high-speed links", IEEE Custom Integrated Circuits Conference
(2003), 589-594, DOI 10.1109/CICC.2003.1249467.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, check_kind
from tline.presentation import Presentation, plain
from tline.scene.medium import Medium
from tline.signal.bits import FINE
from tline.signal.density import LEVELS, TAILS, density
from tline.signal.pulse import PulseResponse
from tline.units import to_si
from tline.words.wording import shown

SMALLEST = 1e-15  # smallest error rate of densities


@dataclass(frozen=True, eq=False, repr=False)
class StatisticalEye(Presentation):
    """Statistical eye within half a bit of the sampling instant, at an error rate and below.

    Attributes
    ----------
    period : float
        Time of a bit, s.
    ber : float
        The bit error rate of the contour.
    t : ndarray, shape (65,)
        From the sampling instant, s.
    ones, zeros : ndarray, shape (65,)
        Effort that ones fall below, and zeros rise above, only with that probability.
    bathtub : ndarray, shape (65,)
        Bit error rate of a receiver that samples at these instants, against the threshold.
    levels, misread : ndarray, shape (129,)
        Thresholds from the middle of zeros to that of ones at the sampling instant, and the bit error rate with each.
    instant : float
        The sampling instant, in the middle of the eye, after the begin of a sent bit, s.
    threshold : float
        Half way between ones and zeros there.
    width : float
        Time for which the bathtub is below the error rate, s.
    dfe : ndarray, shape (m,)
        Taps of the decision feedback equaliser, in the probe's quantity.
    pulse : PulseResponse
        Behind the other equalisers.
    """

    period: float
    ber: float
    t: NDArray
    ones: NDArray
    zeros: NDArray
    bathtub: NDArray
    levels: NDArray
    misread: NDArray
    instant: float
    threshold: float
    width: float
    dfe: NDArray
    pulse: PulseResponse
    picture = "tline.pictures.signals:plot_statistical_eye"

    def text_lines(self) -> Iterator[str]:
        """Height, width, feedback and sampling instant, and the missing part of the response."""
        unit, bits = self.medium.units["effort"], f"bits of {self.period:.6g} s"
        yield f"all patterns of {bits} at '{self.pulse.probe}', with an error rate of {self.ber:g}"
        yield f"height {self.height:.6g} {unit} around {self.threshold:.6g} {unit}, width {self.width:.6g} s"
        yield f"signal over all that disturbs it {self.margin:.3g} dB"
        if len(self.dfe):
            yield "fed back " + ", ".join(f"{tap:.4g} {unit}" for tap in self.dfe)
        yield f"sampled {self.instant:.6g} s after the begin of a bit at the source"
        yield f"later than the response was computed, bits add up to {self.pulse.missing:.2g} {unit}"
        if self.pulse.unmeasured:
            yield f"what frequencies above the samples may change: some {self.pulse.unmeasured:.2g} {unit}"

    def to_dict(self) -> dict[str, Any]:
        """Eye and its curves in SI units."""
        names = "height width instant threshold ber period dfe t ones zeros bathtub levels misread margin"
        told = {name: getattr(self, name) for name in names.split()}
        return plain(
            told
            | {"missing": self.pulse.missing, "unmeasured": self.pulse.unmeasured, "unit": self.medium.units["effort"]}
        )

    @property
    def medium(self) -> Medium:
        """Words and units."""
        return self.pulse.medium

    @property
    def title(self) -> str:
        """Title of the scene."""
        return self.pulse.title

    @property
    def height(self) -> float:
        """Opening at the sampling instant: ones less zeros; at or below zero the eye is closed."""
        middle = len(self.t) // 2
        return float(self.ones[middle] - self.zeros[middle])

    @property
    def margin(self) -> float:
        """Signal over disturbance at the error rate, 20 log(A_s/A_ni), dB; `operating_margin` is that of a standard."""
        signal = float(self.levels[-1] - self.levels[0]) / 2
        disturbed = signal - self.height / 2
        return float(20 * np.log10(signal / disturbed)) if signal > 0 < disturbed else np.inf if signal > 0 else -np.inf


def statistical_eye(
    pulse: PulseResponse,
    ber: float | str = 1e-12,
    *,
    dfe: int = 0,
    noise: float | str = 0.0,
    jitter: float | str = 0.0,
    sinusoidal: float | str = 0.0,
    duty_cycle: float | str = 0.0,
    aggressors: Sequence[PulseResponse] = (),
) -> StatisticalEye:
    """The eye that independent bits open, each zero or one with the same probability.

    Parameters
    ----------
    pulse : PulseResponse
        Of the channel, with the equalisers that are there.
    ber : float or str
        Bit error rate of height, width and contours, from 1e-15 to below 0.5.
    dfe : int
        Taps of a decision feedback equaliser, which takes away just the cursors behind the main one, >= 0.
    noise : float or str
        Standard deviation at the receiver, >= 0, in the probe's quantity.
    jitter : float or str
        Standard deviation of the sampling instant, >= 0, s; it rounds the bathtub, not the contours.
    sinusoidal : float or str
        Amplitude of a sinusoidal jitter of it, >= 0, s.
    duty_cycle : float or str
        Distortion of the duty cycle, by which every other edge is late, >= 0, s.
    aggressors : sequence of PulseResponse
        Of neighbours that send bits of their own at the same instants, at the same probe.

    Raises
    ------
    InputError
        A number out of range.

    Examples
    --------
    >>> pulse = PulseResponse(1e-9, np.array([[0.8] * 64, [0.2] * 64]), 0.0, 0.0)
    >>> found = statistical_eye(pulse)
    >>> round(found.height, 3), round(found.threshold, 3)  # 0.8 less 0.2, around 0.5
    (0.6, 0.5)
    >>> round(statistical_eye(pulse, dfe=1).height, 3)
    0.8
    """
    for each in (pulse, *aggressors):
        check_kind("pulse", each, PulseResponse)
    rate, spread = to_si(ber, "", "ber"), to_si(noise, None, "noise")
    times = {"jitter": jitter, "sinusoidal": sinusoidal, "duty_cycle": duty_cycle}
    shaken = {name: to_si(time, "s", name) for name, time in times.items()}
    if not SMALLEST <= rate < 0.5:
        raise InputError("ber", "no error rate of an eye", f"{SMALLEST:g} to 0.5", shown(ber))
    most = dict.fromkeys(times, pulse.period) | {"dfe": len(pulse.u), "noise": np.inf}
    for name, value in (shaken | {"dfe": dfe, "noise": spread}).items():
        if not 0 <= value < most[name]:
            raise InputError(name, "out of range", f"from 0 to below {most[name]:g}", f"{value:g}")
    flat = np.pad(pulse.u.ravel(), 2 * FINE)
    peak = int(flat.argmax())
    taps = _cursors(flat, peak)[1][:dfe]
    about = _Density(flat, [np.pad(x.u.ravel(), 2 * FINE) for x in aggressors], taps, spread)
    opening = np.array([about.opening(j, rate) for j in range(peak - FINE, peak + FINE + 1)])
    best = peak - FINE + _middle_of_the_widest(opening)
    if dfe:
        taps = _cursors(flat, best)[1][:dfe]
        about = _Density(flat, about.others, taps, spread)
    around = range(best - FINE // 2, best + FINE // 2 + 1)
    base = pulse.base + sum(each.base for each in aggressors)
    middles = base + np.array([about.middle(j) for j in around])
    halves = np.array([about.opening(j, rate) for j in around]) / 2
    threshold = float(middles[FINE // 2])
    rates = np.array([about.error_rate(j, threshold - m) for j, m in zip(around, middles, strict=True)])
    bathtub = _jittered(rates, *(time * FINE / pulse.period for time in shaken.values()))
    levels = np.linspace(-1, 1, 2 * FINE + 1) * flat[best] / 2
    misread = np.array([about.error_rate(best, level) for level in levels])
    width = _span(bathtub, rate) * pulse.period / FINE
    t, instant = np.arange(-(FINE // 2), FINE // 2 + 1) * pulse.period / FINE, (best - 2 * FINE) * pulse.period / FINE
    ones, zeros, levels = middles + halves, middles - halves, levels + threshold
    return StatisticalEye(
        pulse.period, rate, t, ones, zeros, bathtub, levels, misread, instant, threshold, width, taps, pulse
    )


def best_ffe(pulse: PulseResponse, before: int, after: int, *, dfe: int = 0) -> NDArray:
    """Taps of a sender's equaliser that open the eye of the worst pattern widest, their moduli adding up to 1.

    Parameters
    ----------
    pulse : PulseResponse
        Of the channel, with the equalisers that are there.
    before, after : int
        Taps in front of the main one and behind it, >= 0.
    dfe : int
        Cursors behind the main one that a decision feedback equaliser takes away, >= 0.

    Returns
    -------
    ndarray, shape (before + 1 + after,)
        The best of all: main cursor less the moduli of the others is the aim of a linear program.

    Examples
    --------
    >>> pulse = PulseResponse(1e-9, np.array([[1.0] * 64, [0.5] * 64]), 0.0, 0.0)
    >>> best_ffe(pulse, 0, 1).round(3)  # 2/3 and -1/3: cursors 2/3, 0, -1/6
    array([ 0.667, -0.333])
    """
    from scipy.optimize import linprog

    if min(before, after, dfe) < 0:
        raise InputError("ffe", "a number of taps below zero", "at least 0")
    m, flat, best = before + 1 + after, pulse.u.ravel(), (-np.inf, np.eye(before + 1 + after)[before])
    peak = int(flat.argmax())
    for j in range(peak - FINE // 2, peak + FINE // 2 + 1, FINE // 16):
        cursors = flat[j % FINE :: FINE]
        n, main = len(cursors) + m - 1, j // FINE + before
        if not before <= main < n:
            continue
        shifted = np.zeros((n, m))
        for k in range(m):
            shifted[k : k + len(cursors), k] = cursors
        rest = np.delete(shifted, range(main, min(main + dfe + 1, n)), 0)
        r, ones = len(rest), np.ones((1, m))  # unknown are the taps, bounds of their moduli, and of the other cursors
        rows: list[list[NDArray]] = [[s * rest, np.zeros((r, m)), -np.eye(r)] for s in (1, -1)]
        rows += [[s * np.eye(m), -np.eye(m), np.zeros((m, r))] for s in (1, -1)]
        up = np.block([*rows, [0 * ones, ones, np.zeros((1, r))]])
        aim = np.concatenate([-shifted[main], np.zeros(m), np.ones(r)])
        found = linprog(
            aim, up, np.append(np.zeros(len(up) - 1), 1.0), bounds=[(None, None)] * m + [(0, None)] * (m + r)
        )
        if found.status == 0 and -found.fun > best[0]:
            best = -found.fun, found.x[:m]
    return best[1] + 0.0  # no -0


def _cursors(flat: NDArray, j: int) -> tuple[NDArray, NDArray]:
    """Cursors in front of an instant, nearest first, and those behind it."""
    return flat[j - FINE :: -FINE] if j >= FINE else flat[:0], flat[j + FINE :: FINE]


class _Density:
    """Distribution of all bits but the main one and of noise about the middle, at instants of the pulse response."""

    def __init__(self, flat: NDArray, others: Sequence[NDArray], taps: NDArray, noise: float):
        self.flat, self.others, self.taps, self.noise = flat, others, taps, noise
        most = np.sum([np.abs(x).reshape(-1, FINE).sum(0) for x in (flat, *others)], axis=0).max()
        self.step = ((most + np.abs(taps).sum()) / 2 + TAILS * noise) / LEVELS or 1.0
        self.sums: dict[int, NDArray] = {}

    def middle(self, j: int) -> float:
        """Half the sum of all cursors, those of neighbours too, less the feedback."""
        return float(sum(x[j % FINE :: FINE].sum() for x in (self.flat, *self.others)) - self.taps.sum()) / 2

    def below(self, j: int) -> NDArray:
        """Probability of less than each level, shape (2 LEVELS + 1,)."""
        if j not in self.sums:
            before, after = _cursors(self.flat, j)
            after = after.copy()
            after[: len(self.taps)] -= self.taps
            cursors = np.concatenate([before, after, *(x[j % FINE :: FINE] for x in self.others)])
            found = density(cursors / 2, self.noise, self.step)
            self.sums[j] = np.cumsum(found) - found / 2
        return self.sums[j]

    def opening(self, j: int, ber: float) -> float:
        """The main cursor less twice the disturbance that is exceeded with that probability alone."""
        below = self.below(j)
        k = int(np.searchsorted(below, ber))
        return float(self.flat[j] + 2 * (k - LEVELS) * self.step)

    def error_rate(self, j: int, threshold: float) -> float:
        """Error rate for ones and zeros alike often, against a threshold above the middle."""
        levels, below, half = np.arange(-LEVELS, LEVELS + 1) * self.step, self.below(j), self.flat[j] / 2
        ones = np.interp(threshold - half, levels, below, 0.0, 1.0)
        zeros = np.interp(-threshold - half, levels, below, 0.0, 1.0)  # by symmetry
        return float(ones + zeros) / 2


def _middle_of_the_widest(opening: NDArray) -> int:
    """Middle of where the eye is open around the highest, or the highest of a closed one."""
    k = int(opening.argmax())
    closed = np.flatnonzero(opening <= 0)
    if opening[k] <= 0:
        return k
    first = closed[closed < k].max(initial=-1) + 1
    last = closed[closed > k].min(initial=len(opening)) - 1
    return int(first + last) // 2


def _jittered(rates: NDArray, spread: float, amplitude: float, apart: float) -> NDArray:
    """Average error rates over random and sinusoidal timing jitter and duty-cycle distortion, in sample steps."""
    from scipy.special import ndtr

    parts = (
        (TAILS * spread, lambda x: ndtr(x / spread)),
        (amplitude, lambda x: np.arcsin(np.clip(x / amplitude, -1, 1)) / np.pi + 0.5),
        (apart / 2, lambda x: np.clip(x + apart / 2 + 0.5, 0, 1) / 2),  # of the part left of the middle
    )
    for farthest, below in parts:
        if farthest:
            reach = int(np.ceil(farthest)) + 1
            left = np.diff(below(np.arange(-reach, 1) - 0.5))  # tails keep their digits there
            weights = np.concatenate([left, [1 - 2 * left.sum()], left[::-1]])
            rates = np.convolve(np.pad(rates, reach, constant_values=0.5), weights, "valid")  # there are other bits
    return rates


def _span(rates: NDArray, ber: float) -> float:
    """Number of instants around the middle with rates up to `ber`; their logarithm is straight between two."""
    middle, logs = len(rates) // 2, np.log(np.maximum(rates, SMALLEST))
    if rates[middle] > ber:
        return 0.0
    span = 0.0
    for side in (logs[middle::-1], logs[middle:]):
        above = np.flatnonzero(side > np.log(ber))
        if not len(above):
            span += len(side) - 1
            continue
        low, high = side[above[0] - 1 : above[0] + 1]
        span += above[0] - 1 + (np.log(ber) - low) / (high - low)
    return float(span)
