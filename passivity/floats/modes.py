"""A quick look at a state space in floating point, by its modes: the lowest place on the axis, and where to refute.

The form is (Z + Z^H)/2, or I - S^H S, with as many roundings as the eigenvectors of A are ill-conditioned: no bounds of
errors. Its suggestions are proved elsewhere.
"""

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from flint import acb, acb_mat, arb, arb_mat, ctx
from numpy.typing import ArrayLike, NDArray

from passivity.ball import of_point
from passivity.floats.system import FloatSystem, first_grid
from passivity.rational.state_space import StateSpace, identity
from passivity.status import Kind

BITS = 120  # of the balls
_MINIMA, _INSIDE, _ROUNDS = 6, 10, 10  # minima that are followed, points around each, and how often
_ENOUGH = 0.01  # part by which a round must lower the lowest value for another to follow
_HALVINGS = 60
_ON_AXIS = 1e-8  # real part of a pole in parts of its modulus
_CLEAR = 1e-10  # of the size of a form, below which its sign is left open
Point = tuple[Fraction, Fraction, list[complex]]  # re and im of s, and a vector, all with few digits


class Modes:
    """D + C (sI - A)^-1 B as a sum over the eigenvalues of A."""

    def __init__(self, system: FloatSystem):
        found: Any = np.linalg.eig(system.a)
        self.system, (self.poles, vectors) = system, found
        self.vectors = vectors
        self.outputs, self.inputs = system.c @ vectors, np.linalg.solve(vectors, system.b.astype(complex))

    @property
    def is_stable(self) -> bool:
        """Whether all eigenvalues of A have negative real parts."""
        return bool((self.poles.real < 0).all())

    def has_pole_near(self, s: complex) -> bool:
        """Whether an eigenvalue of A on the axis, or to the right of it, is not farther than twice the axis."""
        away = self.poles[self.poles.real > -_ON_AXIS * abs(self.poles)] - s / self.system.unit
        return bool((abs(away) <= 2 * s.real / self.system.unit).any())

    def forms(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Hermitian forms at some points, including infinity, shape (k, m, m)."""
        with np.errstate(all="ignore"):
            gains = 1 / (np.asarray(s, complex)[:, None] - self.poles)
            z = self.system.d + (self.outputs * np.nan_to_num(gains)[:, None, :]) @ self.inputs
            mirrored = z.conj().swapaxes(1, 2)
            forms = (z + mirrored) / 2 if self.system.kind is Kind.PR else np.eye(z.shape[1]) - mirrored @ z
        return np.where(np.isfinite(forms).all((1, 2))[:, None, None], forms, 0)

    @cached_property
    def lowest(self) -> tuple[float, float]:
        """Smallest sampled eigenvalue of the form on the axis, and its frequency in the system's unit."""
        w, values = np.zeros(0), np.zeros(0)
        new = np.array(first_grid(self.system))
        for _ in range(_ROUNDS):
            some = np.linalg.eigvalsh(self.forms(1j * np.where(np.isinf(new), 1e300, new)))[:, 0]
            before = values.min(initial=math.inf)
            w, values = np.append(w, new), np.append(values, some)
            if before < math.inf and values.min() > before - _ENOUGH * abs(before):
                break
            order = np.argsort(w)
            w, values = w[order], values[order]
            inner = np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])) + 1
            inner = inner[np.argsort(values[inner])[:_MINIMA]]
            if not len(inner):
                break
            ends = w[inner - 1], np.minimum(w[inner + 1], 4 * w[inner])
            new = np.linspace(*ends, _INSIDE + 2)[1:-1].ravel()
        k = int(np.argmin(values))
        return float(values[k]), float(w[k])

    def suspects(self, w: float) -> Iterator[Point]:
        """Points and vectors with few digits that make the form negative: over the axis at w, then around poles."""
        for points in (_over_axis(w), _around_poles(self.poles)):
            if not points:
                continue
            eigenvalues, vectors = np.linalg.eigh(forms := self.forms(points))
            lowest = eigenvalues[:, 0]
            if lowest.min() >= -_CLEAR * (1 + abs(forms).max()):
                continue
            k = int(np.argmax(lowest <= lowest.min() / 4))
            unit = Fraction(self.system.unit)
            s, vector = points[k], _short(forms[k], vectors[k, :, 0])
            yield Fraction(s.real) * unit, Fraction(s.imag) * unit, vector


def _short(form: NDArray[np.complex128], vector: NDArray[np.complex128]) -> list[complex]:
    """The vector on the coarsest grid on which the form still has half its value."""
    vector = vector / vector[np.argmax(abs(vector))]
    least, bits = (vector.conj() @ form @ vector).real / 2, 1
    while True:
        short = np.round(vector * 2**bits) / 2**bits
        if (short.conj() @ form @ short).real <= least or bits > 50:
            return short.tolist()
        bits *= 2


def _over_axis(w: float) -> list[complex]:
    """Ever closer to a frequency, or ever farther out."""
    if w == math.inf:
        return [complex(2.0**k) for k in range(_HALVINGS)]
    size = 2.0 ** round(math.log2(w)) if w else 1.0
    return [_rounded(size / 2**k, w, size / 2**k) for k in range(_HALVINGS)]


def _around_poles(poles: NDArray[np.complex128]) -> list[complex]:
    """To the right of poles on the axis, and around those to the right of it."""
    found = []
    for p in poles[poles.imag >= 0]:
        size = 2.0 ** round(math.log2(abs(p))) if p else 1.0
        if p.real > _ON_AXIS * size:
            size = 2.0 ** math.floor(math.log2(p.real))
            ring = [complex(re, im) for re in (-1, 0, 1) for im in (-1, 0, 1) if re or im]
            for r in (size / 2, size / 64):
                found += [_rounded(p.real + r * x.real, p.imag + r * x.imag, r) for x in ring]
        elif p.real > -_ON_AXIS * size:
            found += [_rounded(r, p.imag, r) for r in (size / 2**8, size / 2**16)]
    return found


def _rounded(re: float, im: float, size: float) -> complex:
    """On a grid of eighths."""
    return complex(round(re / size * 8) * size / 8, round(im / size * 8) * size / 8)


def is_negative(kind: Kind, system: StateSpace, re: Fraction, im: Fraction, vector: list[complex]) -> bool:
    """Whether v^H (Z + Z^H) v < 0, or |v|^2 < |S v|^2, at s = re + j im: in balls, so that True is a proof."""
    with ctx.workprec(BITS):
        a, b, c, d = (acb_mat(arb_mat(given)) for given in system.matrices)
        v = acb_mat(len(vector), 1, [acb(x.real, x.imag) for x in vector])
        try:
            x = (acb_mat(arb_mat(identity(system.states))) * of_point(re, im) - a).solve(b * v)
        except ZeroDivisionError:
            return False
        pairs = list(zip((d * v + c * x).entries(), v.entries(), strict=True))
        if kind is Kind.PR:
            return bool(sum(((out * given.conjugate()).real for out, given in pairs), arb(0)) < 0)
        return bool(sum((abs(given) ** 2 - abs(out) ** 2 for out, given in pairs), arb(0)) < 0)
