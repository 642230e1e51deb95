"""Response of a lossy line to a step, ramp or impulse, and to a source in a lossy scene, to any number of digits."""

from collections.abc import Callable, Iterable
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, inf, isfinite, isinf, log, log2
from typing import Any

import numpy as np
from flint import acb, arb, ctx
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss.law import BALLS
from tline.loss.line import LossyLine
from tline.scene.load import NoFlow
from tline.scene.rational import Resistor
from tline.scene.refuse import refuse_cavities, refuse_heights
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.study.reference.exact import Exact, decimals, rounded
from tline.study.reference.motion import rational
from tline.study.reference.network import decimal, straight
from tline.study.reference.rays import instant
from tline.words.wording import place

MOST_DIGITS, MOST_PASSAGES, MOST_TERMS = 100, 1_000, 100_000
CONVERGENCE = log(3.89)  # of Talbot's sum: its error falls by this for each node
SPARE_BITS, SPARE_TERMS = 64, 5
ROUNDS = 6  # of a quarter more nodes each

Pair = tuple[Any, Any]
Transform = Callable[[acb], Pair]


class Drive(IntEnum):
    """Excitation from t = 0 on: its transform is 1/s to this power."""

    IMPULSE = 0
    STEP = 1
    RAMP = 2


def lossy_response(
    line: LossyLine,
    times: Iterable[Any],
    position: float,
    *,
    source: float,
    load: float,
    drive: Drive = Drive.STEP,
    digits: int = 20,
) -> Exact:
    """Effort and flow on a lossy line, at rest before t = 0, between a source with a resistance and a resistive load.

    Parameters
    ----------
    line : LossyLine
        The doubles it is made of count as exact.
    times : iterable of Fraction, float, int or str
        Instants, s, above 0; a float counts as its shortest decimal.
    position : float
        From end 1, where the source is: 0 to the line's length, m.
    source, load : float
        Resistances, ohm or Pa s/m³, from 0; the load up to infinity (an open end).
    drive : Drive
        Effort behind the source's resistance: unit step, unit slope, or unit impulse (whose response is given
        between fronts: jumps of the step response are impulses there).
    digits : int
        1 to 100: errors of u and of Zc·y are below 10^-digits of the largest of them at these times, Zc taken at s =
        1/t of the last. Two sums of Talbot, the second with a quarter more nodes, agree to that, and the second is
        returned.

    Raises
    ------
    InputError
        A bad argument, more than 1000 passages of a wave or 100000 over all times, or digits out of reach.

    Notes
    -----
    With reflections ρ at the ends, u = Zc/(Zc + Rs) Σ (ρs ρl)^k (e^-Γ(2kl + x) + ρl e^-Γ(2(k+1)l - x)) V. Each term is
    a pure delay, shifted out exactly, times a function that is analytic off the negative real axis (see `Law`); a
    Talbot contour round that axis then converges geometrically, from just after the front on. A line without a delay
    needs no expansion. The sums are computed in balls, which bound their rounding; the comparison
    shows the truncation error.

    References
    ----------
    L. N. Trefethen, J. A. C. Weideman, T. Schmelzer, BIT Numerical Mathematics 46 (2006) 653-670,
    doi:10.1007/s10543-006-0077-9: the contour.

    Examples
    --------
    >>> from tline.loss import ConstantLoss
    >>> line = LossyLine(ConstantLoss(20, 250e-9), ConstantLoss(0, 100e-12), length=0.2)
    >>> print(lossy_response(line, ["1.5e-9"], 0.2, source=50, load=50, digits=12).u[0])
    0.4805612853383
    """
    asked = _checked(line, times, position, source, load, digits)
    nodes = ceil(digits * log(10) / CONVERGENCE) + 8
    with ctx.workprec(ceil(digits * log2(10)) + ceil(1.25**ROUNDS * nodes) + SPARE_BITS):
        passages = _terms(line, max(asked), position, source, load, drive)
        instants = [rational(t) for t in asked]
        passed = [(i, t - delay, f) for i, t in enumerate(instants) for delay, f in passages if t - delay > 0]
        if len(passed) > MOST_TERMS:
            raise InputError("times", "too many, or too late", f"{MOST_TERMS} passages in all", f"{len(passed)}")
        zc = line.waves(acb(1 / max(instants)), BALLS)[1].real
        contour = _contour(nodes)
        parts = [_inverse(transform, since, contour) for _, since, transform in passed]
        open_ones = list(range(len(parts)))
        for _ in range(ROUNDS):
            nodes = ceil(1.25 * nodes)
            contour = _contour(nodes)
            before = {j: parts[j] for j in open_ones}
            for j in open_ones:
                parts[j] = _inverse(passed[j][2], passed[j][1], contour)
            sums = _sums(parts, [i for i, _, _ in passed], len(asked))
            bound = max(max(abs(u.mid()), abs((zc * y).mid())) for u, y in sums) * arb(10) ** -digits / len(passages)
            open_ones = [j for j, old in before.items() if not _close(parts[j], old, zc, bound)]
            if not open_ones:
                u, y = (decimals(values, digits) for values in zip(*sums, strict=True))
                return Exact(*(rounded(values, max(map(abs, values)), digits) for values in (u, y)))
    raise InputError("digits", "cannot be had for this line", "fewer", f"{digits}")


def _checked(
    line: LossyLine, times: Iterable[Any], position: float, source: float, load: float, digits: int
) -> list[Fraction]:
    asked = [instant(t) for t in times]
    if not asked or min(asked) <= 0:
        raise InputError("times", "none or not above 0", "instants after 0 s", f"{[float(t) for t in asked[:3]]}")
    if not 0 <= position <= line.length:
        raise InputError("position", "not on the line", f"0 to {line.length:g} m", f"{position}")
    if not (isfinite(source) and source >= 0):
        raise InputError("source", "no passive resistance", "a finite number from 0 on", f"{source}")
    if not load >= 0:
        raise InputError("load", "no passive resistance", "a number from 0 on", f"{load}")
    if not 1 <= digits <= MOST_DIGITS:
        raise InputError("digits", "not in range", f"1 to {MOST_DIGITS}", f"{digits}")
    if float(max(asked)) > MOST_PASSAGES * line.delay > 0:
        expected = f"at most {MOST_PASSAGES * line.delay:g} s"
        raise InputError("times", "too many passages", expected, f"{float(max(asked)):g} s")
    return asked


def _terms(
    line: LossyLine, end: Fraction, x: float, source: float, load: float, drive: Drive
) -> list[tuple[arb, Transform]]:
    """Delays, and transforms of effort and flow without them, of all passages until the end."""
    slowness = (acb(line.series.storage) * line.shunt.storage).real.sqrt()
    far = line.length

    def waves(s: acb) -> tuple[acb, acb, acb, acb, acb]:
        """Return the first wave's effort, Γ, Zc, and the reflections at source and load."""
        gamma, zc = line.waves(s, BALLS)
        at_load = acb(1) if isinf(load) else (load - zc) / (zc + load)
        return zc / (zc + source) / s ** int(drive), gamma, zc, (source - zc) / (zc + source), at_load

    if slowness == 0:

        def everything(s: acb) -> Pair:
            first, gamma, zc, at_source, at_load = waves(s)
            a = first * (-gamma * x).exp() / (1 - at_source * at_load * (-2 * gamma * far).exp())
            b = a * at_load * (-2 * gamma * (arb(far) - x)).exp()
            return a + b, (a - b) / zc

        return [(arb(0), everything)]

    def passage(k: int) -> tuple[arb, Transform]:
        path = k * arb(far) + x if k % 2 == 0 else (k + 1) * arb(far) - x

        def transform(s: acb) -> Pair:
            first, gamma, zc, at_source, at_load = waves(s)
            u = first * at_load ** ((k + 1) // 2) * at_source ** (k // 2)
            u *= (path * (s * slowness - gamma)).exp()
            return u, u / zc if k % 2 == 0 else -u / zc

        return path * slowness, transform

    return [passage(k) for k in range(floor(float(end) / line.delay) + 2)]


def _sums(parts: list[Pair], instants: list[int], count: int) -> list[Pair]:
    u, y = [arb(0)] * count, [arb(0)] * count
    for i, (more_u, more_y) in zip(instants, parts, strict=True):
        u[i], y[i] = u[i] + more_u, y[i] + more_y
    return list(zip(u, y, strict=True))


def _close(new: Pair, old: Pair, zc: arb, bound: arb) -> bool:
    """Whether two results agree for certain, rounding included."""
    return abs(new[0] - old[0]) <= bound and abs((new[1] - old[1]) * zc) <= bound


def _contour(nodes: int) -> list[tuple[acb, acb]]:
    """Points s·t, and weights times t, of the midpoint rule on a Talbot contour."""
    n, found = 2 * ((nodes + 1) // 2), []
    for k in range(n // 2):
        theta = (2 * k + 1) * arb.pi() / n
        angle = arb("0.6407") * theta
        cot = angle.cot()
        z = n * acb(arb("0.5017") * theta * cot - arb("0.6122"), arb("0.2645") * theta)
        slope = acb(arb("0.5017") * (cot - angle * (1 + cot * cot)), arb("0.2645"))
        found.append((z, z.exp() * slope * 2))
    return found


def _inverse(transform: Transform, t: arb, contour: list[tuple[acb, acb]]) -> Pair:
    """Compute both inverse Laplace transforms at t > 0."""
    u, y = arb(0), arb(0)
    for z, weight in contour:
        at_u, at_y = transform(z / t)
        u, y = u + (weight * at_u).imag, y + (weight * at_y).imag
    return u / t, y / t


class LossySolution:
    """Effort and flow at a probe at an end, from rest, to any number of digits.

    The scene has one line with linear losses, a source of straight pieces behind a resistance at one end, and a
    resistor, or nothing, at the other.
    """

    def __init__(self, scene: Scene, probe: str):
        if len(scene.lines) != 1 or len(scene.sources) != 1 or len(scene.loads) > 1 or scene.links:
            raise InputError("lines", "not one line with one source and one load at most", "such a scene")
        if scene.start != "rest":
            raise InputError("start", "exact solutions start at rest", "'rest'", f"'{scene.start}'")
        refuse_cavities(scene.lines, "exact solutions")
        refuse_heights(scene, "exact solutions")
        ((name, line),) = scene.single_lines.items()
        ((given, source),) = scene.sources.items()
        if line.losses is None or not line.losses.linear:
            raise InputError(place("lines", name), "its losses are not linear", "such as a resistance")
        if not source.is_effort or source.at not in line.nodes:
            raise InputError(place("sources", given), "no effort at an end", "a voltage or pressure source")
        far = line.nodes[1 - line.nodes.index(source.at)]
        for key, load in scene.loads.items():
            if not isinstance(load, Resistor | NoFlow) or load.at != far:
                raise InputError(place("loads", key), "no resistor at the end without the source", "a resistor")
        at = scene.probes[probe].at
        if at is None:
            raise InputError(place("probes", probe), "stands within the line", "at = …")
        self._line, self._delay = line.losses.exact, decimal(line.parameters.delay or 0.0)
        self._source = float(source.resistance or 0.0)
        self._load = next((float(load.resistance) for load in scene.loads.values() if isinstance(load, Resistor)), inf)
        self._position = 0.0 if at == source.at else self._line.length
        self._end = decimal(scene.t_end)
        self._parts = _parts(source.value, self._end, place("sources", given))

    @property
    def fronts(self) -> NDArray:
        """Instants at which jumps or corners of the source pass the probe, in order, s."""
        first = self._delay if self._position else Fraction(0)
        starts = {start + first for start, _, _ in self._parts}
        hops = int((self._end - min(starts)) / (2 * self._delay)) + 1
        return np.array(sorted({t + 2 * k * self._delay for t in starts for k in range(hops)}), float)

    def at(self, times: Iterable[Any], digits: int = 20) -> Exact:
        """Effort and flow at the probe; for arguments see `lossy_response`."""
        instants = [instant(t) for t in times]
        u, y = ([Decimal(0)] * len(instants) for _ in range(2))
        for start, drive, factor in self._parts:
            late = [k for k, t in enumerate(instants) if t > start]
            if not late:
                continue
            since = [instants[k] - start for k in late]
            ends = {"source": self._source, "load": self._load, "drive": drive, "digits": digits}
            found = lossy_response(self._line, since, self._position, **ends)
            size = Decimal(factor.numerator) / Decimal(factor.denominator)
            for k, effort, flow in zip(late, found.u, found.y, strict=True):
                u[k], y[k] = u[k] + size * effort, y[k] + size * flow
        return Exact(tuple(u), tuple(y))


def _parts(shape: Shape, end: Fraction, where: str) -> list[tuple[Fraction, Drive, Fraction]]:
    """Steps and ramps that add up to a waveform: start, kind and size of each."""
    pieces = straight(shape, end)
    if pieces is None:
        raise InputError(where, "its waveform is curved", "straight pieces")
    parts = [(Fraction(0), Drive.STEP, pieces[0][1])]
    for (start, first, slope), (then, level, steep) in pairwise(pieces):
        assert then is not None
        before = first + slope * (then - start) if start is not None else first
        parts += [(then, Drive.STEP, level - before), (then, Drive.RAMP, steep - slope)]
    return [part for part in parts if part[2] and part[0] < end]
