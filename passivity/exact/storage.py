"""Stored energy x^T P x of lossless networks, P exact, and signs of symmetric matrices.

By the Kalman-Yakubovich-Popov lemma a state space is positive real, or bounded real, if there is a P >= 0 for which
L(P) <= 0 (`passivity.rational.state_space.dissipation`). Of a lossless network L(P) = 0. A Hermitian matrix U + jV is
written as the symmetric [[U, -V], [V, U]], which acts on (Re v, Im v).

References
----------
J. C. Willems, "Dissipative dynamical systems, part II", Archive for Rational Mechanics and Analysis 45 (1972), 352-393.
"""

from typing import Any

from flint import fmpq, fmpq_mat, nmod_mat

from passivity.rational.state_space import PRIME, StateSpace, columns, identity, side_by_side
from passivity.status import Kind

_MAX_WORK = 1_000_000_000  # states^3 bits: some seconds


def is_semidefinite(a: fmpq_mat) -> bool:
    """Whether x^T a x >= 0 for all x: as det(t + a) has real roots only, that is when no coefficient is negative."""
    return all(c >= 0 for c in (-a).charpoly().coeffs())


def negative_direction(a: fmpq_mat) -> list[fmpq] | None:
    """Find x with x^T a x < 0 by Lagrange's reduction to a sum of squares; None if a is positive semidefinite."""
    rest, left, squares = a.tolist(), list(range(a.nrows())), []
    while (x := _obvious(rest, left)) is None:
        pivot = max(left, key=lambda i: rest[i][i], default=None)
        if pivot is None or not rest[pivot][pivot]:
            return None
        left.remove(pivot)
        row = [c / rest[pivot][pivot] for c in rest[pivot]]
        squares.append((pivot, row))
        for i in left:
            if factor := rest[i][pivot]:
                rest[i] = [c - factor * r for c, r in zip(rest[i], row, strict=True)]
    for pivot, row in reversed(squares):  # the squares are made zero
        x[pivot] = -sum((row[i] * c for i, c in enumerate(x) if i != pivot), fmpq(0))
    return x


def _obvious(a: list[list[fmpq]], left: list[int]) -> list[fmpq] | None:
    """Find such a direction from a negative diagonal entry, or a zero one with an entry beside it."""
    x = [fmpq(0)] * len(a)
    for i in left:
        if a[i][i] < 0:
            x[i] = fmpq(1)
            return x
        if a[i][i] == 0:
            for j in left:
                if a[i][j]:  # x_i = t, x_j = 1: 2 t a_ij + a_jj
                    x[i], x[j] = -(a[j][j] + 1) / (2 * a[i][j]), fmpq(1)
                    return x
    return None


def lossless_storage(kind: Kind, system: StateSpace) -> tuple[fmpq_mat, fmpq_mat, StateSpace] | None:
    """P, V and the reached part (A1, B1, C V, D) of a system that neither loses nor makes energy, None of another one.

    L(P) = 0 gives P B, and by P A = -A^T P, or -A^T P - C^T C, all P A^k B: where the inputs reach all states, these
    equations leave one P. They are solved modulo a prime first, for mostly there is none.
    """
    from passivity.floats.storage import is_positive

    if system.states**3 * system.bits > _MAX_WORK or not _starts_lossless(kind, *system.matrices):
        return None
    basis, reached = system.reached()
    chosen = reached.independent_columns()
    try:
        if _solved(kind, chosen, *map(_residues, reached.matrices)) is None:
            return None
    except (ValueError, ZeroDivisionError):  # the prime in a denominator, or in a determinant
        pass
    p = _solved(kind, chosen, *reached.matrices)
    return (p, basis, reached) if p is not None and (is_positive(p) or is_semidefinite(p)) else None


def _residues(x: fmpq_mat) -> nmod_mat:
    whole, unit = x.numer_denom()
    return nmod_mat(whole, PRIME) * pow(int(unit), -1, PRIME)


def _starts_lossless(kind: Kind, a: Any, b: Any, c: Any, d: Any) -> bool:
    """Quick necessary conditions: no loss at infinity, symmetry of B^T P B and balance of B^T P A B."""
    px, out = _supplied(kind, a, b, c, d)
    first, second, seen = px.transpose() * b, px.transpose() * (a * b), out * b
    lost = d + d.transpose() if kind is Kind.PR else d.transpose() * d - identity(d.nrows())
    gained = second + second.transpose() + seen.transpose() * seen
    return first == first.transpose() and not any(lost.entries()) and not any(gained.entries())


def _supplied(kind: Kind, a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """P B, and the C of A^T P + P A + C^T C = 0, which is zero of impedances."""
    return (c.transpose(), c * 0) if kind is Kind.PR else (c.transpose() * d * -1, c)


def _solved(kind: Kind, chosen: list[int], a: Any, b: Any, c: Any, d: Any) -> Any:
    """P from the columns of [B, A B, A^2 B, ...] that were chosen; None if there is none."""
    px, out = _supplied(kind, a, b, c, d)
    at, gained = a.transpose(), out.transpose() * out
    x, states, stored = b, [b], [px]
    for _ in range(max(chosen, default=0) // b.ncols()):
        x, px = a * x, at * px * -1 - gained * x
        states.append(x)
        stored.append(px)
    left, right = (columns(side_by_side(blocks, b), chosen).transpose() for blocks in (states, stored))
    p = left.solve(right)  # P^T, and so P
    holds = p == p.transpose() and p * b == stored[0] and not any((p * a + at * p + gained).entries())
    return p if holds else None
