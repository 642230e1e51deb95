"""Frequencies at which an eigenvalue of the Hermitian form crosses a level: eigenvalues of a pencil on the axis.

F(s) = R + S^T X + X~ S + X~ Q X with X = (sI - A)^-1 B is singular where, with the level taken off R,

    P(s) = [[Q, A^T + s, S], [A - s, 0, B], [S^T, B^T, R]]

is. The pencil is that of the Hamiltonian matrix, but needs no inverse of R, which for networks without direct losses
is singular.

References
----------
S. Boyd, V. Balakrishnan, P. Kabamba, "A bisection method for computing the H-infinity norm of a transfer matrix",
Mathematics of Control, Signals and Systems 2 (1989), 207-219, doi:10.1007/BF02551385.
S. Grivet-Talocia, "Passivity enforcement via perturbation of Hamiltonian matrices", IEEE Transactions on Circuits and
Systems I 51 (2004), 1755-1769, doi:10.1109/TCSI.2004.834527.
"""

from typing import Any, NamedTuple

import numpy as np

from passivity.multiport.float_system import FloatSystem

SAFETY = 10  # errors by which an eigenvalue may be off the axis and still counts as on it


class Crossing(NamedTuple):
    """A frequency, and the error that the residual of the eigenpair allows it to first order."""

    w: float
    error: float


def crossings(system: FloatSystem, level: float) -> list[Crossing]:
    """Where an eigenvalue of F may cross a level, in rising order; at poles on the axis too.

    Examples
    --------
    >>> from passivity.multiport.state_space import StateSpace
    >>> from passivity.status import Kind
    >>> system = FloatSystem.of(Kind.PR, StateSpace.from_entries([[-1]], [[1]], [[1]], [["-1/5"]]))
    >>> [round(x.w, 12) for x in crossings(system, 0.0)]  # 1/(1 + w^2) = 1/5
    [2.0]
    """
    from scipy.linalg import eig

    p, e = _pencil(system, level)
    pairs: Any = eig(p, -e, left=True, right=True, homogeneous_eigvals=True)
    (top, bottom), left, right = pairs
    finite = abs(bottom) * (1 / np.finfo(float).eps) > abs(top)
    s, left, right = top[finite] / bottom[finite], left[:, finite], right[:, finite]
    turned = e @ right
    size = np.linalg.norm(right, axis=0)
    residual = np.linalg.norm(p @ right + turned * s, axis=0)
    residual += np.finfo(float).eps * (np.linalg.norm(p) + abs(s)) * size
    slope = abs(np.sum(left.conj() * turned, axis=0))
    with np.errstate(divide="ignore"):
        error = residual * np.linalg.norm(left, axis=0) / slope
    known = (s.imag >= 0) & (abs(s.real) <= SAFETY * error) & (error < abs(s))
    return sorted(Crossing(float(w), float(x)) for w, x in zip(s.imag[known], error[known], strict=True))


def _pencil(system: FloatSystem, level: float) -> tuple[np.ndarray, np.ndarray]:
    """P(0) and dP/ds, the inputs scaled to what they do."""
    a, b, (q, s, r) = system.a, system.b, system.popov
    n, m = b.shape
    r = r - level * np.eye(m)
    scale = 1 / (max(np.linalg.norm(b), np.linalg.norm(s), np.sqrt(np.linalg.norm(r))) or 1)
    zero, unit, none = np.zeros((n, n)), np.eye(n), np.zeros((n, m))
    p = [[q, a.T, s * scale], [a, zero, b * scale], [s.T * scale, b.T * scale, r * scale**2]]
    return np.block(p), np.block([[zero, unit, none], [-unit, zero, none], [none.T, none.T, np.zeros((m, m))]])
