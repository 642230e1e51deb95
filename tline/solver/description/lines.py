"""Lines in numbers, one for each mode of coupled conductors, and circuits in place of exact laws; where probes are."""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from math import ceil, floor, inf, log, log10, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import ConstantLoss, Foster, Law, Sum, realise
from tline.loss.flow_law import FlowLaw, side_by_side
from tline.loss.law import Shape
from tline.loss.line import Losses
from tline.loss.realise import FINEST
from tline.solver.description.given import End, Height, PipeTable, Scene, SceneLine
from tline.solver.radau import Basis
from tline.words.wording import place

HELD, BAND = 0.5, 2.0  # cycles per slab: up to which circuits hold, and beyond which they are not asked to
CYCLES_PER_RUN = 0.1  # at which the band of a circuit begins, at most
STEP = 2.0  # its upper end is a power of this over its lower end, so that many runs share a circuit
PLACES, WORST = 200, 0.1  # at which shares are looked at; tolerance of a shape that hardly counts, at most
FEW_LAWS = 8  # laws that are fitted one by one
REALISED = lru_cache(realise)  # shapes, over whole decades


class Conductor(NamedTuple):
    """One of several coupled conductors, or a mode of two: weights of their currents in its own, and the end."""

    weights: tuple[float, ...]
    end: int
    ends: tuple[End, End]

    @property
    def parts(self) -> tuple[NDArray, NDArray, float]:
        """Voltage and current per u and y of modes; and z0 with the other conductors at zero, or of the mode."""
        modes, weights = self.ends[0].modes, np.array(self.weights)
        z0 = 1 / float(weights @ modes.admittance @ weights)
        return weights @ modes.T / (weights @ weights), np.linalg.inv(modes.T) @ weights, z0


class ProbePlace(NamedTuple):
    """Where a probe is."""

    line: str  # '' at a node where none ends
    share: float  # of the delay
    height: Height
    conductor: Conductor | None = None
    node: str | None = None  # where no line ends

    @property
    def lines(self) -> list[str]:
        """Lines recorded by the probe: those of all modes at a conductor."""
        at = self.conductor
        if self.node is not None:
            return []
        return [self.line] if at is None else [node.removesuffix(", end 1") for node in at.ends[0].modal]


def probes_of(scene: Scene, coupled: Mapping[str, tuple[End, End]], inside: bool = False) -> dict[str, ProbePlace]:
    """Probes of a scene by name; those inside lossy lines are refused if not allowed."""
    found = {}
    for name, probe in scene.probes.items():
        where = scene.probed_line(name)
        if where is None:
            found[name] = ProbePlace("", 0.0, scene.height(name), node=probe.at)
            continue
        if where in coupled:
            end = next(k for k, end in enumerate(coupled[where]) if probe.at in end.conductors)
            # currents of a conductor: i, (i1 - i2)/2 in the differential mode, i1 + i2 in the common mode
            first, second = {"differential": (0.5, -0.5), "common": (1.0, 1.0), None: (1.0, 0.0)}[probe.mode]
            weights = {probe.beside: second, probe.at: first}
            each = tuple(weights.get(node, 0.0) for node in coupled[where][end].conductors)
            conductor = Conductor(each, end, coupled[where])
            found[name] = ProbePlace(where, float(end), scene.height(name), conductor)
            continue
        line = scene.lines[where]
        share = probe.fraction(line)
        if line.losses is not None and 0.0 < share < 1.0 and not inside:
            problem = f"inside {place('lines', where)}, which has losses"
            raise InputError(place("probes", name, "position"), problem, "that scene in stretches")
        found[name] = ProbePlace(where, share, scene.height(name))
    return found


class Line(NamedTuple):
    """A line from its end 1, at the first node, to its end 2."""

    nodes: tuple[str, str]
    z0: float  # as a front meets it, Pa s/m³ or ohm
    delay: float  # s
    losses: Losses | None

    @property
    def dispersive(self) -> bool:
        """Whether it does more to waves than to delay and attenuate them."""
        return self.losses is not None and not self.losses.distortionless

    @property
    def instant(self) -> bool:
        """Whether it loses nothing, or effort by its flow alone, at once, and otherwise only delays."""
        if self.losses is None:
            return True
        series, shunt = self.losses.exact.series, self.losses.exact.shunt
        return isinstance(series, ConstantLoss) and isinstance(shunt, ConstantLoss) and not shunt.loss


class Columns(NamedTuple):
    """Lines as arrays, in their order: L lines between N nodes."""

    nodes: list[str]  # (N,) in the order in which lines name them
    ends: NDArray  # (L, 2) their numbers
    z0: NDArray  # (L,)
    delay: NDArray  # (L,) s
    length: NDArray  # (L,) m; 0 of a line without losses
    resistance: NDArray  # (L,) per metre, to a steady flow
    conductance: NDArray  # (L,) the same
    lossy: NDArray  # (L,) whether there are losses
    dispersive: NDArray  # (L,) whether they do more to waves than to attenuate them
    instant: NDArray  # (L,) whether there are none, or they are effort that the flow takes alone and at once
    laws: list[tuple[NDArray, FlowLaw]]  # of the flow, with arrays of parameters, after the lines that have them

    @property
    def passed(self) -> NDArray:
        """Share of a wave that arrives if all that a line does is to attenuate; else 1, shape (L,)."""
        attenuation = self.length * np.sqrt(self.resistance * self.conductance)
        return np.where(self.lossy & ~self.dispersive, np.exp(-attenuation), 1.0)

    @property
    def pi(self) -> tuple[NDArray, NDArray]:
        """Resistance between the ends and conductance at each, to a steady flow, without friction by laws; (L,) each.

        With r and g of a whole line, x = √(r g): r sinh(x)/x and g tanh(x/2)/x.
        """
        r, g = self.resistance * self.length, self.conductance * self.length
        x = np.sqrt(r * g)
        some = np.where(x > 0, x, 1.0)
        return np.where(x > 0, r * np.sinh(x) / some, r), np.where(x > 0, g * np.tanh(x / 2) / some, g / 2)

    @property
    def falls(self) -> NDArray:
        """Whether effort falls along a line in a steady flow, shape (L,)."""
        found = self.resistance > 0
        for places, law in self.laws:
            found[places] |= law(np.ones(len(places)))[0] > 0
        return found


class LineTable(Mapping[str, Line]):
    """Lines of a table of pipes, each made only where it is looked up."""

    def __init__(self, table: PipeTable):
        self._table, n, none = table, len(table), np.zeros(len(table))
        lossy = np.zeros(n, bool)
        for rows, _ in table.laws:
            lossy[rows] = True
        places, numbers = (table.nodes, table.ends), (table.z0, table.delay, table.length * lossy, none, none)
        self.columns = Columns(*places, *numbers, lossy, lossy, np.ones(n, bool), table.laws)

    def __getitem__(self, name: str) -> Line:
        return _line(self._table[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)


def lines_of(scene: Scene) -> Mapping[str, Line]:
    """All lines of a scene that carry waves, by name."""
    if isinstance(scene.lines, PipeTable):
        return LineTable(scene.lines)
    return {name: _line(line) for name, line in scene.single_lines.items()}


def _line(line: SceneLine) -> Line:
    parameters = line.parameters
    return Line(line.nodes, parameters.z0, parameters.delay or 0.0, line.losses)


def columns_of(lines: Mapping[str, Line]) -> Columns:
    """Columns of lines, those that differ by their nodes alone being looked at once."""
    if isinstance(lines, LineTable):
        return lines.columns
    known: dict[tuple[float, float, int], int] = {}
    number, first, like, ends = dict[str, int](), list[Line](), list[int](), list[int]()
    for line in lines.values():
        k = known.setdefault((line.z0, line.delay, id(line.losses)), len(first))
        if k == len(first):
            first.append(line)
        like.append(k)
        ends += [number.setdefault(node, len(number)) for node in line.nodes]
    exact = [line.losses.exact if line.losses else None for line in first]
    constants = [(one.length, one.series.loss, one.shunt.loss) if one else (0.0, 0.0, 0.0) for one in exact]
    each = [
        (line.z0, line.delay, *own, line.losses is not None, line.dispersive, line.instant)
        for line, own in zip(first, constants, strict=True)
    ]
    z0, delay, length, r, g, lossy, dispersive, instant = np.array(each, float).reshape(-1, 8)[like].T
    laws = side_by_side([line.losses.flow_law if line.losses else None for line in first], np.array(like, int))
    places = [*number], np.array(ends, int).reshape(-1, 2)
    return Columns(*places, z0, delay, length, r, g, lossy > 0, dispersive > 0, instant > 0, laws)


class Fit(NamedTuple):
    """Band and tolerance of the circuits that approximate the laws of lossy lines."""

    low: float  # Hz, of the band
    high: float  # Hz
    tolerance: float  # relative error of impedance and admittance in the band
    fastest: float  # highest rate at which a law that is a circuit is kept unchanged, 1/s


class Circuits(NamedTuple):
    """Circuits of one line per metre, and their largest relative error in the band."""

    series: Foster
    shunt: Foster
    error: float


def fit_of(t_end: float, h: float, tolerance: float, drive: float = 0.0) -> Fit:
    """Band and tolerance of circuits for a run with slabs of width h.

    `drive` is the shortest time scale of excitations, s; the band includes it, up to `BAND` cycles per slab.
    """
    low, widest = CYCLES_PER_RUN / t_end, BAND / h
    high = min(max(HELD / h, 1 / drive if drive else inf), widest)
    return Fit(low, low * STEP ** max(ceil(log(high / low, STEP)), 2), tolerance, 2 * pi * widest)


def circuits_of(lines: Mapping[str, Line], fit: Fit) -> dict[str, Circuits]:
    """Circuits of all lines that lose something; many laws that differ by scale share the circuits of their shape."""
    losses = {id(line.losses): line.losses for line in lines.values() if line.losses is not None}
    many = len({each.exact.series for each in losses.values()}) > FEW_LAWS
    known: dict[int, Circuits] = {}
    for key, each in losses.items():
        (series, a), (shunt, b) = (circuit_of(law, fit, many) for law in (each.exact.series, each.exact.shunt))
        known[key] = Circuits(series, shunt, max(a, b))
    return {name: known[id(line.losses)] for name, line in lines.items() if line.losses is not None}


@lru_cache
def circuit_of(law: Law, fit: Fit, many: bool) -> tuple[Foster, float]:
    """A circuit, as it is if the law is one that is no faster than the band, and its error."""
    if isinstance(law, ConstantLoss):
        return Foster(law.loss, law.storage, np.empty(0), np.empty(0)), 0.0
    parts = law.laws if isinstance(law, Sum) else (law,)
    if all(isinstance(part, ConstantLoss | Foster) for part in parts):
        fosters = [part for part in parts if isinstance(part, Foster)]
        strengths = np.concatenate([np.empty(0), *(part.strengths for part in fosters)])
        rates = np.concatenate([np.empty(0), *(part.rates for part in fosters)])
        if rates.max(initial=0.0) <= fit.fastest:
            return Foster(law.loss, law.storage, strengths, rates), 0.0
    shapes = [part.shape for part in parts if not isinstance(part, ConstantLoss)]
    if many and len(shapes) == 1 and shapes[0] is not None:
        return _scaled(law, shapes[0], fit)
    found = realise(law, (fit.low, fit.high), fit.tolerance)
    return found.circuit, found.error


def _scaled(law: Law, shape: Shape, fit: Fit) -> tuple[Foster, float]:
    """Circuit of one of many laws that differ by scale: that of their shape over decades that hold the band."""
    alike, rate, size = shape
    decades = floor(log10(fit.low / rate)), ceil(log10(fit.high / rate))
    s = 2j * pi * np.geomspace(fit.low, fit.high, PLACES)
    exact = law.at(s)
    asked = log10(fit.tolerance / float(np.max(size * np.abs(alike.at(s / rate)) / np.abs(exact))))
    for digits in (ceil(asked), floor(asked)):  # the largest share and the largest error are seldom at one place
        found = REALISED(alike, (10.0 ** decades[0], 10.0 ** decades[1]), min(max(10.0**digits, FINEST), WORST)).circuit
        circuit = Foster(law.loss, law.storage, size * found.strengths, rate * found.rates)
        error = float(np.max(np.abs(circuit.at(s) / exact - 1)))
        if error <= fit.tolerance:
            break
    return circuit, error


def one_step(law: Foster, scale: float, order: Basis, h: float) -> NDArray:
    """Matrices of a circuit ζ = scale (loss + Σ r s/(s + p)) over a slab of width h, by Radau IIA.

    With 2 q + ζ q = w and e = w - 2 q, in coordinates in which its states are decoupled: ξ' = -p ξ + v q,
    v² = r p, and q = (w + v·ξ)/(2 + loss + Σ r). That matrix is symmetric.

    Returned are D (s, s), C (s, modes), B (modes, s), decay (modes,), flattened in order: e = D w + C x, x' = B w +
    decay x.
    """
    r, p, s = scale * law.strengths, law.rates, order.s
    through = 2 + scale * law.loss + r.sum()
    v = np.sqrt(r * p)
    rate, modes = np.linalg.eigh(np.diag(p) - np.outer(v, v) / through)
    v = modes.T @ v
    stages = np.linalg.inv(np.eye(s) + h * rate[:, None, None] * order.A)  # (modes, s, s)
    started = stages.sum(axis=2)
    driven = (h * v / through)[:, None, None] * (stages @ order.A)
    direct = np.eye(s) * (1 - 2 / through) - 2 / through * np.einsum("k,kij->ij", v, driven)
    read = -2 / through * (v[:, None] * started).T
    return np.concatenate([direct.ravel(), read.ravel(), driven[:, -1].ravel(), started[:, -1]])
