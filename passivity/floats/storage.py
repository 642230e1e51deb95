"""Proof for systems of many ports: a storage function found in floating point and checked in ball arithmetic.

By the bounded real lemma S = D + C (sI - A)^-1 B has all its poles in Re s < 0 and S^H S < I there and on the axis, if

    M(P) = [[A^T P + P A + C^T C, P B + C^T D], [B^T P + D^T C, D^T D - I]] < 0,   P > 0.

P solves a Riccati equation with a little more loss than there is, from the stable subspace of a Hamiltonian matrix.
That is rounded; but the two inequalities are proved of P as it is: T^T X T > 0 proves X > 0 for any matrix T,
and with T from a rounded Cholesky factor of X it is nearly I, so that its diagonal dominates its rows, in balls.

References
----------
J. C. Willems, "Least squares stationary optimal control and the algebraic Riccati equation", IEEE Transactions on
Automatic Control 16 (1971), 621-634, DOI 10.1109/TAC.1971.1099831.
A. J. Laub, "A Schur method for solving algebraic Riccati equations", IEEE Transactions on Automatic Control 24 (1979),
913-921, DOI 10.1109/TAC.1979.1102178.
"""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpq, fmpq_mat
from numpy.typing import NDArray

from passivity.floats.modes import Modes
from passivity.floats.system import FloatSystem, floats, power_of_two
from passivity.rational.state_space import StateSpace, dissipation, identity
from passivity.status import Kind

BITS = 150  # of the balls
LOSSES = 0.3, 0.03, 0.003  # added to the system, in parts of what there is to spare


def as_scattering(z: StateSpace) -> StateSpace | None:
    """S = (Z - z0)(Z + z0)^-1 of impedances, exactly; z0 a power of two near the size of D. None if D + z0 is singular.

    With E = (D + z0)^-1 it is (A - B E C, B E, 2 z0 E C, I - 2 z0 E), bounded real if and only if Z is positive real.
    """
    size = Fraction(power_of_two(np.linalg.norm(floats(z.d), 2)))
    z0 = fmpq(size.numerator, size.denominator)
    try:
        e = (z.d + identity(z.size) * z0).inv()
    except ZeroDivisionError:
        return None
    inputs = z.b * e
    return StateSpace(z.a - inputs * z.c, inputs, e * z.c * (2 * z0), identity(z.size) - e * (2 * z0))


def strict_storage(system: StateSpace, look: Modes | None = None) -> fmpq_mat | None:
    """P with M(P) < 0 and P > 0, None if none was found: S has a singular value of 1, or nearly, or more."""
    look = look or Modes(FloatSystem.of(Kind.BR, system))
    room, _ = look.lowest
    for p in _candidates(look, room) if room > 0 and look.is_stable else ():
        rounded = fmpq_mat(len(p), len(p), [fmpq(*Fraction(float(x)).as_integer_ratio()) for x in p.ravel()])
        if proves(system, rounded):
            return rounded
    return None


def proves(system: StateSpace, storage: fmpq_mat) -> bool:
    """Whether M(P) < 0 and P > 0, P symmetric."""
    with ctx.workprec(BITS):
        gained = dissipation(Kind.BR, *map(arb_mat, (*system.matrices, storage)))
        return storage == storage.transpose() and is_positive(storage) and is_positive(gained * -1)


def is_positive(x: arb_mat | fmpq_mat) -> bool:
    """Whether a symmetric matrix is proved positive definite for all values in its balls."""
    with ctx.workprec(BITS):
        x = arb_mat(x)
        middle = np.array([float(y.mid()) for y in x.entries()]).reshape(x.nrows(), x.nrows())
        if not (np.diag(middle) > 0).all():
            return False
        size = np.sqrt(np.diag(middle))  # rows of one size, else the small ones are lost
        try:
            factor = np.linalg.cholesky(middle / size / size[:, None])
            t = np.linalg.inv(factor) / size
        except np.linalg.LinAlgError:
            return False
        if not np.isfinite(t).all():
            return False
        t = arb_mat(len(t), len(t), t.ravel().tolist())
        rows = (t * x * t.transpose()).tolist()
        return all(2 * abs(row[i]) > sum(map(abs, row), arb(0)) and row[i] > 0 for i, row in enumerate(rows))


def _candidates(look: Modes, room: float) -> Iterator[NDArray]:
    """Solutions of Riccati equations with more and less loss added: of each mode in parts of its own."""
    from scipy.linalg import schur

    system, modes = look.system, look.poles
    a, b, c, d = system.a, system.b, system.c, system.d
    inputs = np.maximum(np.linalg.norm(look.inputs, axis=1), np.finfo(float).tiny)
    gains = 1 / (1j * np.append(modes.imag, 0.0)[:, None] - modes)  # at each resonance, of each mode
    each = (modes.real / inputs) ** 2 / (np.abs(gains * modes.real) ** 2).sum(1).max()
    back = np.linalg.inv(look.vectors)
    lost = (back.conj().T * each @ back).real
    inner = np.linalg.inv(np.eye(len(d)) - d.T @ d)
    drift, gain = a + b @ inner @ d.T @ c, b @ inner @ b.T
    for part in LOSSES:
        given = c.T @ c + c.T @ d @ inner @ d.T @ c + part * room * lost
        try:
            found: Any = schur(np.block([[drift, gain], [-given, -drift.T]]), sort="lhp")
        except np.linalg.LinAlgError:  # eigenvalues too near to the axis to be told apart
            return
        _, u, stable = found
        if stable == len(a):
            p = np.linalg.solve(u[: len(a), : len(a)].T, u[len(a) :, : len(a)].T)
            yield system.scale[:, None] * (p + p.T) / 2 * system.scale / system.unit
