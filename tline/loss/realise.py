"""Passive circuit of a law, with as few elements as a tolerance allows."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.loss.foster import Foster
from tline.loss.law import BALLS, Law, positive

if TYPE_CHECKING:
    from passivity import Verdict


BITS = 320  # the matrix pencil loses twice as many digits as the interpolation gains
FINEST = 1e-10  # least tolerance: errors are measured in doubles
MOST_TERMS = 40
SAMPLES = 2_000
ROUNDS, LEVEL = 8, 1.2  # of moving points; largest over smallest peak where that ends
STEEPEST = 1e-3  # smallest peak that counts, relative to the largest


def interpolate(law: Law, w: NDArray) -> tuple[NDArray, NDArray]:
    """Solve for strengths r_k and rates p_k of loss + s·storage + Σ r_k s/(s + p_k) = F(s) at s = ±j w.

    Examples
    --------
    >>> from tline.loss import Foster
    >>> r, p = interpolate(Foster(1, 0, [2, 3], [10, 20]), np.array([1.0, 7.0]))
    >>> r.round(12).tolist(), p.round(12).tolist()
    ([2.0, 3.0], [10.0, 20.0])
    """
    from flint import acb, acb_mat, ctx

    n = len(w)
    with ctx.workprec(BITS):
        s = [acb(0, x) for x in w.tolist()]
        h = [(law.beyond(x, BALLS).mid() - law.loss) / x for x in s]
        both = [
            (a, b.conjugate(), f, g.conjugate()) for a, f in zip(s, h, strict=True) for b, g in zip(s, h, strict=True)
        ]
        loewner = acb_mat(n, n, [(f - g) / (a - b) for a, b, f, g in both])
        shifted = acb_mat(n, n, [(a * f - b * g) / (a - b) for a, b, f, g in both])
        poles = loewner.solve(shifted, algorithm="approx").eig(algorithm="approx")
        p = sorted((-pole.real.mid() for pole in poles), key=float)
        cauchy = acb_mat(n, n, [1 / (x + q) for x in s for q in p])
        r = cauchy.solve(acb_mat(n, 1, h), algorithm="approx")
        strengths = [float(x.real.mid()) for x in r.entries()]
        return np.array(strengths), np.array([float(q) for q in p])


@dataclass(frozen=True)
class Realisation:
    """Circuit and its distance from the law that it replaces.

    Parameters
    ----------
    law : Law
        Exact law.
    circuit : Foster
        Circuit with equal loss (at s = 0 they agree) and equal storage (a front has the same speed).
    band : pair of float
        From low to high, Hz.
    error : float
        Largest |circuit - law|/|law| over the band, from 2000 frequencies evenly spread on a logarithmic scale.
    """

    law: Law
    circuit: Foster
    band: tuple[float, float]
    error: float

    @property
    def verdict(self) -> "Verdict":
        """Proof by `passivity` that the circuit is positive real."""
        return self.circuit.verdict

    def errors(self, frequencies: ArrayLike) -> NDArray:
        """Relative error |circuit - law|/|law| at frequencies, Hz, inside the band or not."""
        s = 2j * math.pi * np.asarray(frequencies, float)
        exact = self.law.at(s)
        return np.abs(self.circuit.at(s) - exact) / np.abs(exact)


def realise(law: Law, band: tuple[float, float], tolerance: float) -> Realisation:
    """Find the circuit with fewest elements that is within the tolerance of a law over a band.

    Parameters
    ----------
    law : Law
    band : pair of float
        From low to high, Hz, above 0. At 0 and at infinity circuit and law agree anyway.
    tolerance : float
        Of |circuit - law|/|law| over the band, 1e-10 to 1. Γ and Zc of a line are then good to half of it for each law.

    Raises
    ------
    InputError
        A bad band or tolerance, or more than 40 terms needed.

    Notes
    -----
    The circuit agrees with the law at 0 and at as many frequencies of the band as there are terms, which makes it
    passive (`interpolate`). These frequencies are moved until the peaks of the error between them are level.
    Each further term divides the error by about exp(π²/ln(16 high/low)), 2.0 for five decades, where the law rises as
    sqrt(s).

    Examples
    --------
    >>> from tline.loss import LaminarFriction
    >>> pipe = LaminarFriction(density=1000, viscosity=1e-3, radius=0.01)
    >>> found = realise(pipe, band=(0.01, 1000), tolerance=1e-4)
    >>> len(found.circuit.rates), found.error < 1e-4, found.verdict.status
    (10, True, <Status.PROVED: 'proved'>)
    """
    low, high = band
    positive(low=low, high=high)
    if low >= high:
        raise InputError("band", "not from low to high", "low < high, Hz", f"{low:g} to {high:g}")
    if not FINEST <= tolerance < 1:
        raise InputError("tolerance", "out of range", f"{FINEST:g} to 1", f"{tolerance}")
    search = _Search(law, 2 * math.pi * low, math.log(high / low))
    for n in range(MOST_TERMS + 1):
        error, r, p = search.best(n, tolerance)
        if error <= tolerance:
            return Realisation(law, Foster(law.loss, law.storage, r, p), (low, high), error)
    expected = f"a larger one or a narrower band than {low:g} to {high:g} Hz"
    raise InputError("tolerance", f"not reached with {MOST_TERMS} terms", expected, f"{tolerance:g}")


class _Search:
    """Circuits with ever more terms; places on the logarithmic scale of frequency go from 0 to 1."""

    def __init__(self, law: Law, start: float, span: float):
        self.law, self.start, self.span = law, start, span
        self.places = np.linspace(0, 1, SAMPLES)
        s = 1j * self._frequencies(self.places)
        self.s, self.exact = s, law.at(s)
        self.size = np.maximum(np.abs(self.exact), np.finfo(float).tiny)  # a law may be zero
        self.edges = np.array([0.0, 1.0])  # the points of interpolation between the ends of the band

    def _frequencies(self, places: NDArray) -> NDArray:
        return self.start * np.exp(self.span * places)

    def best(self, n: int, tolerance: float) -> tuple[float, NDArray, NDArray]:
        """Error, strengths and rates of the circuit with n terms whose peaks of the error are most level."""
        edges = np.interp(np.arange(n + 2) / (n + 1), np.arange(len(self.edges)) / (len(self.edges) - 1), self.edges)
        found = (math.inf, np.empty(0), np.empty(0))
        for k in range(ROUNDS):
            points = edges[1:-1]
            r, p = interpolate(self.law, self._frequencies(points)) if n else found[1:]
            circuit = Foster(self.law.loss, self.law.storage, r, p)
            errors = np.abs(circuit.at(self.s) - self.exact) / self.size
            if errors.max() < found[0]:
                found, self.edges = (float(errors.max()), r, p), edges
            starts = np.concatenate([[0], np.searchsorted(self.places, points)])
            peaks = np.maximum.reduceat(errors, starts)
            hopeless = k > 0 and peaks.min() > tolerance
            if found[0] <= tolerance or hopeless or peaks.max() < LEVEL * peaks.min():
                break
            gaps = np.diff(edges) * np.maximum(peaks, STEEPEST * peaks.max()) ** -0.35  # narrow it under a high peak
            edges = np.concatenate([[0], np.cumsum(gaps) / gaps.sum()])
        return found
