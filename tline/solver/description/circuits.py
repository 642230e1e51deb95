"""Circuits in place of the exact laws of lossy lines, and their maps over a slab."""

from collections.abc import Mapping
from functools import lru_cache
from math import ceil, floor, inf, log, log10, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss import ConstantLoss, Foster, Law, Realisation, Sum, realise
from tline.loss.law import Shape
from tline.loss.realise import FINEST
from tline.solver.description.lines import Line
from tline.solver.radau import Basis

HELD, BAND = 0.5, 2.0  # cycles per slab: up to which circuits hold, and beyond which they are not asked to
CYCLES_PER_RUN = 0.1  # at which the band of a circuit begins, at most
STEP = 2.0  # its upper end is a power of this over its lower end, so that many runs share a circuit
PLACES, WORST = 200, 0.1  # at which shares are looked at; tolerance of a shape that hardly counts, at most
FEW_LAWS = 8  # laws that are fitted one by one
NONE = np.empty(0)


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

    Examples
    --------
    >>> fit_of(t_end=10, h=1e-3, tolerance=1e-6)
    Fit(low=0.01, high=2621.44, tolerance=1e-06, fastest=12566.370614359172)
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


def circuit_of(law: Law, fit: Fit, many: bool) -> tuple[Foster, float]:
    """A circuit, as it is if the law is one that is no faster than the band, and its error."""
    return (_constant(law.loss, law.storage), 0.0) if isinstance(law, ConstantLoss) else _fitted(law, fit, many)


@lru_cache
def _constant(loss: float, storage: float) -> Foster:
    return Foster(loss, storage, NONE, NONE)


@lru_cache
def _fitted(law: Law, fit: Fit, many: bool) -> tuple[Foster, float]:
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
        found = _of_shape(alike, *decades, min(max(10.0**digits, FINEST), WORST)).circuit
        circuit = Foster(law.loss, law.storage, size * found.strengths, rate * found.rates)
        error = float(np.max(np.abs(circuit.at(s) / exact - 1)))
        if error <= fit.tolerance:
            break
    return circuit, error


@lru_cache
def _of_shape(law: Law, low: int, high: int, tolerance: float) -> Realisation:
    """Circuit of a shape over decades, Hz in units of its own."""
    return realise(law, (10.0**low, 10.0**high), tolerance)


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
