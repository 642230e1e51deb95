"""What happens inside a line, from the waves that entered at its ends and what they lose on the way.

With a = a1(t - x/c) - A and b = b2(t - (l - x)/c) + B, the losses A and B so far grow along each wave's own way by what
the line takes at the places it passes, dA = (p + g) dx and dB = (p - g) dx, with p the drop per metre and g = z0 times
the leakage per metre. Both follow by Picard's iteration on a lattice of places and instants, with the trapezoidal rule
along the ways, and are of second order in its step; a front that is met costs up to half of what a cell takes.
"""

from dataclasses import dataclass
from functools import partial
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import Foster
from tline.solver.description.circuits import Circuits, circuits_of, fit_of
from tline.solver.description.description import describe
from tline.solver.description.given import Stretches
from tline.solver.result.dense_output import NOISE, drawable, highest
from tline.solver.result.merged import CutRecord
from tline.solver.result.result import LineRecord, Result
from tline.words.wording import place

CELLS = 16
INSTANTS = 2000  # at least, where extremes on a lossless line are looked for; slab ends are among them
MOST_INSTANTS = 20_000  # of a lattice, if it has more than one cell
ROUGHLY = 1e-5  # tolerance of circuits where a run had none
CLOSE, MOST_ROUNDS = 1e-6, 200  # of the largest wave, where the iteration ends


@dataclass(frozen=True, eq=False)
class Inside:
    """Waves and effort inside a recorded line.

    Attributes
    ----------
    record : LineRecord
        Waves at its ends.
    t : ndarray, shape (instants,)
        Where extremes are looked for, s.
    lost : ndarray, shape (2, cells + 1, instants), or None
        What losses take from a and give to b at places apart by equal delays; None of a lossless line.
    cells : int
        How many such stretches the line has.
    """

    record: LineRecord
    t: NDArray
    lost: NDArray | None
    cells: int

    @property
    def places(self) -> NDArray:
        """Shares of the delay at which extremes are looked for."""
        return np.arange(self.cells + 1) / self.cells

    def waves(self, t: NDArray, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.record.waves(t, share)
        if self.lost is None or share in (0.0, 1.0):
            return a, b
        j = min(int(share * self.cells), self.cells - 1)
        weight = share * self.cells - j
        A, B = (1 - weight) * self.lost[:, j] + weight * self.lost[:, j + 1]
        return a - np.interp(t, self.t, A), b + np.interp(t, self.t, B)

    def effort(self, t: NDArray, share: float) -> NDArray:
        """Effort, Pa or V, at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.waves(t, share)
        return (a + b) / 2

    def extremes(self, slab_ends: NDArray) -> NDArray:
        """Effort before t = 0, lowest and highest effort, shape (3, places)."""
        seen = []
        for share in self.places.tolist():
            way = self.record.delay * share  # waves are as they were at slab ends a way ago
            late = [slab_ends, slab_ends + way, slab_ends + self.record.delay - way, self.t]
            at = np.unique(np.concatenate(late))
            at = at[at <= slab_ends[-1]]
            u, effort = self.effort(at, share), partial(self.effort, share=share)
            noise, width = NOISE * float(np.abs(u).max()), float(np.diff(at).max(initial=0.0))
            seen.append((u[0], *(highest(effort, at, u, sign, noise, width)[0] for sign in (-1, 1))))
        return np.array(seen).T


@dataclass(frozen=True, eq=False)
class InStretches:
    """The same inside a line in stretches.

    Attributes
    ----------
    cut : Stretches
    stretches : list of Inside
        From end 1 on.
    """

    cut: Stretches
    stretches: "list[Inside]"

    @property
    def places(self) -> NDArray:
        """Shares of the delay at which extremes are looked for."""
        parts = zip(self.cut.shares[:-1], self.cut.widths, self.stretches, strict=True)
        inner = [float(begin) + width * each.places[:-1] for begin, width, each in parts]
        return np.concatenate([*inner, [1.0]])

    def waves(self, t: NDArray, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t and a place given as a share of the delay, from 0 to 1."""
        k, part = self.cut.stretch_at(share)
        return self.stretches[k].waves(t, part)

    def effort(self, t: NDArray, share: float) -> NDArray:
        """Effort at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.waves(t, share)
        return (a + b) / 2

    def extremes(self, slab_ends: NDArray) -> NDArray:
        """Effort before t = 0, lowest and highest effort, shape (3, places)."""
        seen = [each.extremes(slab_ends) for each in self.stretches]
        return np.concatenate([seen[0], *(each[:, 1:] for each in seen[1:])], axis=1)


def inside(result: Result, line: str, cells: int = CELLS) -> Inside | InStretches:
    """The inside of a line that was recorded.

    Parameters
    ----------
    result : Result
        Of ``simulate(scene, record=[line])``.
    line : str
        Name of a single line.
    cells : int, from 1
        Stretches at whose ends losses are known; fewer where the run is far longer than the delay.

    Raises
    ------
    InputError
        The line was not recorded, or takes so much that the iteration does not end.

    References
    ----------
    R. Courant, D. Hilbert: Methods of Mathematical Physics II (1962), V.6: iteration along characteristics.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"near": {"at": "near"}},
    ...     lines={"c": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns", "length": 1, "resistance": 50}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"r": {"at": "far", "kind": "resistor", "resistance": 100}}, start="steady",
    ... )
    >>> middle = inside(simulate(scene, record=["c"]), "c").effort(np.array([30e-9]), 0.5)
    >>> print(middle.round(6))  # 1 V over 50 + 50 + 100 ohm, 125 of these from the middle on
    [0.625]
    """
    if line not in result.lines:
        raise InputError("path", f"line '{line}' was not recorded", "simulate(scene, record=[…]) with it")
    record = result.lines[line]
    if isinstance(record, CutRecord) and result.parts is not None:
        parts = zip(record.cut.lines, record.cut.widths, strict=True)
        return InStretches(record.cut, [_inside(result.parts, name, ceil(cells * width)) for name, width in parts])
    return _inside(result, line, cells)


def _inside(result: Result, line: str, cells: int) -> Inside:
    record = drawable(result.lines[line])
    single = result.scene.single_lines.get(line)
    if line not in result.circuits and (single is None or single.losses is None):
        n, parts = result.slabs.number, ceil(INSTANTS / result.slabs.number)
        return Inside(record, np.arange(n * parts + 1) * (result.slabs.width / parts), None, cells)
    t_end = float(result.t[-1])
    cells = max(min(cells, int(MOST_INSTANTS * record.delay / t_end)), 1)
    t = record.delay / cells * np.arange(ceil(t_end / record.delay * cells) + 1)
    return Inside(record, t, _lost(result, line, record, cells, t), cells)


def _circuits(result: Result, line: str, step: float) -> Circuits:
    """What stands for the laws of a line that was computed with the laws themselves."""
    return circuits_of({line: describe(result.scene).lines[line]}, fit_of(float(result.t[-1]), step, ROUGHLY))[line]


def _lost(result: Result, line: str, record: LineRecord, cells: int, t: NDArray) -> NDArray:
    """What losses take from a and give to b, A and B at places and instants."""
    losses = result.scene.single_lines[line].losses
    assert losses is not None
    cell = losses.exact.length / cells
    circuits = result.circuits.get(line) or _circuits(result, line, t[1])
    (entered1, _), (_, entered2) = record.at_end1, record.at_end2
    a0 = np.stack([entered1(t - j * t[1]) for j in range(cells + 1)])
    b0 = np.stack([entered2(t - (cells - j) * t[1]) for j in range(cells + 1)])
    size = max(np.abs(a0).max(), np.abs(b0).max())
    A = B = np.zeros_like(a0)
    for _ in range(MOST_ROUNDS):
        a, b = a0 - A, b0 + B
        y = (a - b) / (2 * record.z0)
        drop = cell * _taken(circuits.series, y, t[1]) + losses.friction(y)[0] / cells
        leak = cell * record.z0 * _taken(circuits.shunt, (a + b) / 2, t[1])
        before, A, B = (A, B), _along(drop + leak), _along((drop - leak)[::-1])[::-1]
        change = max(np.abs(new - old).max() for new, old in zip((A, B), before, strict=True))
        if change <= CLOSE * size:
            return np.stack([A, B])
    raise InputError(place("lines", line), "loses too much for what is inside it to be found", "shorter lines")


def _along(taken: NDArray) -> NDArray:
    """Sum of what cells take along the way from the first place on, one cell an instant; steady before the first."""
    total = np.zeros_like(taken)
    for j in range(1, len(taken)):
        behind = total[j - 1] + taken[j - 1] / 2
        total[j] = np.append(behind[0], behind[:-1]) + taken[j] / 2
    return total


def _taken(law: Foster, z: NDArray, step: float) -> NDArray:
    """What a law without its storage takes per metre of flows or efforts z, straight lines between instants."""
    taken = law.loss * z
    for strength, rate in zip(law.strengths, law.rates, strict=True):
        from scipy.signal import lfilter

        decay = np.exp(-rate * step)
        mean = -np.expm1(-rate * step) / (rate * step)
        slow, _ = lfilter([1 - mean, mean - decay], [1, -decay], z, zi=mean * z[:, :1])
        taken = taken + strength * (z - slow)
    return taken
