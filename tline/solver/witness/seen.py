"""Residuals of a result in the equations of lines, nodes and stores, at random instants, and their allowances.

Lines and nodes without memory are checked at random instants, stores of energy or volume over random windows.

An element with a state relates effort and flow by derivatives. Multiplied by a bump φ that vanishes at both ends of a
window with its derivatives, and integrated by parts, its equation contains none: den(D) e = num(D) i gives
∫ e·den(-D) φ = ∫ i·num(-D) φ, and i = dS/dt gives ∫ i·φ = -∫ S·φ'.
"""

from collections.abc import Collection, Iterator
from functools import cache, cached_property
from itertools import chain
from random import Random

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.given import Ratio, Volume
from tline.solver.result.result import Result
from tline.solver.result.wave import Wave
from tline.solver.witness.nodes import Balance, Term

INSTANTS, WINDOWS = 64, 4  # random instants and windows, one in each of as many equal parts of the run
SLABS = 100  # slabs in a window at most: the longer it is, the less an error of effort matters
POINTS = leggauss(5)  # quadrature in a piece of a window
MARGIN = 3.0  # allowed error of efforts and flows over the tolerance
NODE_ROUNDING = 1e-10  # relative to the efforts and flows at a node, since flows are small differences of waves
FAINT = 1e-6  # relative to the largest effort in the scene; smaller signals are not checked
MOST_ASIDE = 4  # instants that may fail: polynomials beside fronts, at line ends without probes
MOST_WINDOWS = 1  # windows that may fail
MOST_DEGREE = 4  # of an impedance


class Windows:
    """Intervals of integration of one width: their instants, one interval after another, and quadrature weights."""

    def __init__(self, edges: list[NDArray]):
        x, w = POINTS
        pieces = np.array([len(each) - 1 for each in edges])
        start, stop = np.concatenate([each[:-1] for each in edges]), np.concatenate([each[1:] for each in edges])
        half, middle = (stop - start)[:, None] / 2, (stop + start)[:, None] / 2
        self.t, self._weight = (middle + half * x).ravel(), (half * w).ravel()
        self.begin, self.width = np.array([each[0] for each in edges]), float(edges[0][-1] - edges[0][0])
        self.share = (self.t - np.repeat(self.begin, pieces * len(x))) / self.width  # of its window, in 0 to 1
        self._first = (np.cumsum(pieces) - pieces) * len(x)

    def integral(self, values: NDArray) -> NDArray:
        """Integral over each window."""
        return np.add.reduceat(self._weight * values, self._first)


class Seen:
    """Efforts and flows of a result at instants `t`: random ones, or those of windows beside what is `known` there.

    At ends of lines that are `computed` ones, waves are the polynomials of the run.
    """

    def __init__(
        self,
        result: Result,
        description: Description,
        tol: float,
        computed: Collection[tuple[str, int]] = (),
        t: NDArray | None = None,
        known: "Seen | None" = None,
    ):
        self.result, self.description, self.tol, self._known = result, description, tol, known
        self._computed = computed
        self.t = _one_in_each(INSTANTS) * description.t_end if t is None else t
        self._waves: dict[tuple[str, int], tuple[NDArray, NDArray]] = {}
        self._ends: dict[tuple[str, int], tuple[NDArray, NDArray]] = {}
        self._allowed: dict[str, tuple[float, float]] = {}
        self._places: dict[tuple[int, int, float], tuple[NDArray, NDArray]] = {}
        self.at_node = {
            node: (name, end)
            for name in result.lines
            if name in description.lines
            for end, node in enumerate(description.lines[name].nodes)
        }

    def windows(self) -> tuple[Windows, "Seen"]:
        """Random windows, each in pieces between slab ends and fronts, and what is seen there."""
        windows = Windows(list(self._edges()))
        return windows, Seen(self.result, self.description, self.tol, self._computed, windows.t, self)

    def _edges(self) -> Iterator[NDArray]:
        t_end, h = self.description.t_end, self.result.resolution.h
        width = min(t_end / WINDOWS, SLABS * h)
        lines = self.result.lines.values()
        fronts = [wave.breakpoints() for line in lines for wave in (line.a1, line.b1, line.a2, line.b2)]
        known = np.concatenate([np.empty(0), *fronts])
        for begin in _one_in_each(WINDOWS) * (t_end - width * WINDOWS):
            end = begin + width
            slabs = np.arange(np.ceil(begin / h), np.floor(end / h) + 1) * h
            inside = known[(known > begin) & (known < end)]
            yield np.sort(np.clip(np.concatenate([[begin, end], slabs, inside]), begin, end))

    def waves(self, name: str, end: int) -> tuple[NDArray, NDArray]:
        """Waves at an end of a line, toward end 2 and toward end 1."""
        if (name, end) not in self._waves:
            a, b = self.recorded(name, end)
            self._waves[name, end] = self.values(a), self.values(b)
        return self._waves[name, end]

    def recorded(self, name: str, end: int) -> tuple[Wave, Wave]:
        """Waves at an end of a line, toward end 2 and toward end 1, as functions of time."""
        record = self.result.lines[name]
        if (name, end) in self._computed:
            return (record.a2, record.b2) if end else (record.a1, record.b1)
        return record.at_end2 if end else record.at_end1

    def values(self, wave: Wave, late: float = 0.0) -> NDArray:
        """Values of a wave that passed `late` seconds ago.

        Places in slabs, and polynomials there, are the same for all waves without fronts.
        """
        t = self.t - late
        if len(wave.pieces.slab):
            return wave(t)
        key = wave.basis.s, len(wave.values), late
        if key not in self._places:
            place = np.maximum(t, 0.0) / wave.h
            slab = np.minimum(place.astype(int), len(wave.values) - 1)
            self._places[key] = slab, wave.basis.evaluation(np.minimum(place - slab, 1.0))
        slab, weights = self._places[key]
        found = np.einsum("ij,ij->i", wave.values[slab], weights)
        return np.where(t < 0, wave.before, found) if late else found

    def end(self, name: str, end: int) -> tuple[NDArray, NDArray]:
        """Effort at an end of a line, and flow out of the line there."""
        if (name, end) not in self._ends:
            (a, b), z0 = self.waves(name, end), self.result.lines[name].z0
            self._ends[name, end] = (a + b) / 2, (a - b) / (2 * z0 if end else -2 * z0)
        return self._ends[name, end]

    def reads(self, one: Balance) -> bool:
        """Whether all lines that the balance of a node needs are recorded."""
        beyond = {term.beyond for term in (*one.flows, *one.stores)} - {None}
        return all(name in self.result.lines for name, _ in one.ends) and beyond <= self.at_node.keys()

    @cached_property
    def largest(self) -> float:
        """Largest effort at any recorded line end."""
        if self._known:
            return self._known.largest
        return max((float(np.abs(self.end(*at)[0]).max()) for at in self.at_node.values()), default=0.0)

    def conducts(self, one: Balance) -> float:
        """Sum of 1/z0 of the line ends at a node."""
        return sum(1 / self.result.lines[name].z0 for name, _ in one.ends)

    def efforts(self, one: Balance) -> NDArray:
        """Effort at a node as each of its line ends has it, shape (ends, instants)."""
        return np.array([self.end(*at)[0] for at in one.ends])

    def out(self, one: Balance) -> NDArray:
        """Flow out of the lines at a node."""
        return np.sum([self.end(*at)[1] for at in one.ends], axis=0)

    def allowed(self, one: Balance) -> tuple[float, float]:
        """Allowed errors of the effort at a node and of the flow out of the lines; where nothing moves, of 1."""
        if one.name not in self._allowed:
            gauge = next((term.weight for term in (*one.flows, *one.stores) if term.weight), 0.0)
            flows = sum(float(np.abs(self.end(*at)[1]).max()) for at in one.ends)
            conducts = self.conducts(one)
            size = max(float(np.abs(self.efforts(one) - gauge).max()), flows / conducts, FAINT * self.largest or 1.0)
            share = NODE_ROUNDING + (MARGIN * self.tol if self.largest else 0.0)
            least = self._known.allowed(one) if self._known else (0.0, 0.0)
            effort, flow = share * size + 1e-15 * abs(gauge), share * (size * conducts + flows)
            self._allowed[one.name] = max(effort, least[0]), max(flow, least[1])
        return self._allowed[one.name]

    def across(self, term: Term, u: NDArray) -> tuple[NDArray, float]:
        """Effort across an element at a node of effort u, in its direction, and the sign of its flow from the node."""
        if term.beyond is None:
            return u - term.weight, 1.0
        beyond = self.end(*self.at_node[term.beyond])[0]
        return (beyond - u, -1.0) if term.reversed else (u - beyond, 1.0)

    def passed(self, one: Balance) -> tuple[NDArray, NDArray]:
        """Bounds of the flow into elements without memory, given the allowed error of efforts (twice between nodes)."""
        u, off = self.efforts(one)[0], self.allowed(one)[0]
        low, high = np.zeros_like(self.t), np.zeros_like(self.t)
        for term in one.flows:
            assert callable(term.equation)
            e, sign = self.across(term, u)
            width = off if term.beyond is None else 2 * off
            flows = np.array([sign * term.equation(self.t, e + d) for d in (-width, 0.0, width)])
            low, high = low + flows.min(axis=0), high + flows.max(axis=0)
        return low, high


@cache
def _one_in_each(parts: int) -> NDArray:
    """Random instants over the end time, one in each of equal parts of the run, in order."""
    random = Random(parts)
    return np.array([(k + random.random()) / parts for k in range(parts)])


Doubt = tuple[str, float, str]  # place and instant of a misfit between a result and the equations, and what it is


def balance_doubts(seen: Seen, nodes: list[Balance]) -> Iterator[Doubt]:
    """Yield nodes whose balance fails at more than a few instants."""
    for one in nodes:
        if not seen.reads(one):
            continue
        efforts, (off_u, off_y) = seen.efforts(one), seen.allowed(one)
        where = f"node '{one.name}'"
        yield from _doubt(seen, np.ptp(efforts, axis=0) > 2 * off_u, where, "efforts of lines that meet there differ")
        if one.held is not None:
            wrong = np.abs(efforts[0] - one.held(seen.t)) > off_u
            yield from _doubt(seen, wrong, where, "the effort is not the one that is prescribed")
        elif not one.stores:
            (low, high), out = seen.passed(one), seen.out(one)
            wrong = (out < low - off_y) | (out > high + off_y)
            yield from _doubt(seen, wrong, where, "what flows in does not flow out")


def line_doubts(seen: Seen) -> Iterator[Doubt]:
    """Yield lossless lines whose arriving waves are not the delayed ones, in results and in computed polynomials."""
    mixed = {*chain(*seen.description.mixed.values())}
    for name, record in seen.result.lines.items():
        line = seen.description.lines.get(name)
        if line is None or line.losses is not None or name in mixed:
            continue
        computed = (record.a1, record.a2), (record.b2, record.b1)
        for side, (sent, arrived) in enumerate(computed):
            given = seen.recorded(name, side)[side]
            wrong = _is_another(seen, given, seen.waves(name, 1 - side)[side], line.delay)
            if wrong.sum() > MOST_ASIDE and given is not sent:
                wrong &= _is_another(seen, sent, arrived(seen.t), line.delay)
            yield from _doubt(seen, wrong, f"lines.{name}", "a wave does not arrive as it left")


def _is_another(seen: Seen, sent: Wave, now: NDArray, delay: float) -> NDArray:
    """At which random instants a wave that arrives differs from the one sent a delay before."""
    then = seen.values(sent, delay)
    size = max(float(np.abs(now).max()), FAINT * seen.largest)
    return np.abs(now - then) > (4 * seen.tol + NODE_ROUNDING) * size


def _doubt(seen: Seen, wrong: NDArray, where: str, what: str) -> Iterator[Doubt]:
    if wrong.sum() > MOST_ASIDE:
        yield where, float(seen.t[wrong][0]), what


def store_doubts(seen: Seen, nodes: list[Balance]) -> Iterator[Doubt]:
    """Yield nodes whose stored quantity does not match its inflow in more than one window."""
    read = [one for one in nodes if seen.reads(one)]
    windows, there = seen.windows() if read else (None, seen)
    for one in read:
        assert windows is not None
        equation = one.stores[0].equation
        if isinstance(equation, Volume):
            wrong = _misses_volume(equation, windows, *_signals(there, one))
        elif isinstance(equation, Ratio) and equation.degree <= MOST_DEGREE:
            wrong = _misses_impedance(equation, windows, *_signals(there, one))
        else:
            continue
        if wrong.sum() > MOST_WINDOWS:
            yield f"node '{one.name}'", float(windows.begin[wrong][0]), "what is stored there is not what flowed in"


def _signals(seen: Seen, one: Balance) -> tuple[NDArray, NDArray, float, NDArray]:
    """Effort across a store and flow into it in all windows, and their allowed errors."""
    store, (low, high), (off_u, off_y) = one.stores[0], seen.passed(one), seen.allowed(one)
    e, sign = seen.across(store, seen.efforts(one)[0])
    i = sign * (seen.out(one) - (low + high) / 2)
    return e, i, off_u if store.beyond is None else 2 * off_u, (high - low) / 2 + off_y


def _misses_impedance(
    equation: Ratio, windows: Windows, e: NDArray, i: NDArray, off_e: float, off_i: NDArray
) -> NDArray:
    """In which windows the equation of an impedance fails."""
    of_e, of_i = (_adjoint(side, equation.degree, windows) for side in (equation.denominator, equation.numerator))
    allowed = windows.integral(np.abs(of_e) * off_e + np.abs(of_i) * off_i)
    return np.abs(windows.integral(of_e * e - of_i * i)) > allowed


def _adjoint(side: tuple[float, ...], degree: int, windows: Windows) -> NDArray:
    """Return p(-D) φ for a bump φ over each window and a polynomial p, highest power first."""
    found = np.zeros_like(windows.t)
    for power, factor in enumerate(reversed(side)):
        found += factor * (-1.0 / windows.width) ** power * _bump(degree + 1, power)(windows.share)
    return found


@cache
def _bump(power: int, derivative: int) -> Polynomial:
    return (Polynomial([0.0, 4.0, -4.0]) ** power).deriv(derivative)


def _misses_volume(equation: Volume, windows: Windows, e: NDArray, i: NDArray, off_e: float, off_i: NDArray) -> NDArray:
    """In which windows a volume that follows from the effort is not the integral of the flow."""
    per_square = equation.capacity**-2.0  # of the loss in the orifice, zero without one
    inside = e - np.sign(i) * i**2 * per_square
    held = equation.held(inside)
    off_held = np.abs(equation.held(inside + off_e + 2 * np.abs(i) * per_square * off_i) - held)
    of_i, of_held = _bump(2, 0)(windows.share), _bump(2, 1)(windows.share) / windows.width
    allowed = windows.integral(of_i * off_i + np.abs(of_held) * off_held)
    return np.abs(windows.integral(of_i * i + of_held * held)) > allowed
