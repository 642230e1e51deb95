"""Stored energy x^T P x of lossless networks, P exact, and signs of symmetric matrices.

By the Kalman-Yakubovich-Popov lemma a state space is positive real, or bounded real, if there is a P >= 0 for which
L(P) <= 0 (`passivity.rational.state_space.dissipation`). Of a lossless network L(P) = 0. A Hermitian matrix U + jV is
written as the symmetric [[U, -V], [V, U]], which acts on (Re v, Im v).

References
----------
J. C. Willems, "Dissipative dynamical systems, part II", Archive for Rational Mechanics and Analysis 45 (1972), 352-393.
P. S. Wang, "A p-adic algorithm for univariate partial fractions", SYMSAC 1981 (fractions from their residues).
"""

from collections.abc import Iterator
from math import isqrt
from typing import Any

from flint import fmpq, fmpq_mat, fmpz, nmod_mat

from passivity.rational.state_space import StateSpace, columns, dissipation, identity, side_by_side
from passivity.status import Kind

_LARGEST = 2**62  # primes modulo which P is found are below
_MAX_WORK = 4_000_000_000  # states^3 times primes: some seconds


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
    equations leave one P.
    """
    from passivity.floats.storage import is_positive

    if not _starts_lossless(kind, system):
        return None
    basis, reached = system.reached()
    p = _from_residues(kind, reached)
    if p is None or any(dissipation(kind, *reached.matrices, p).entries()):
        return None
    return (p, basis, reached) if is_positive(p) or is_semidefinite(p) else None


def _starts_lossless(kind: Kind, system: StateSpace) -> bool:
    """Quick necessary conditions: no loss at infinity, symmetry of B^T P B and balance of B^T P A B."""
    a, b, _, d = system.matrices
    px, out = _supplied(kind, *system.matrices)
    first, second, seen = px.transpose() * b, px.transpose() * (a * b), out * b
    lost = d + d.transpose() if kind is Kind.PR else d.transpose() * d - identity(system.size)
    gained = second + second.transpose() + seen.transpose() * seen
    return first == first.transpose() and not any(lost.entries()) and not any(gained.entries())


def _supplied(kind: Kind, a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """P B, and the C of A^T P + P A + C^T C = 0, which is zero of impedances."""
    return (c.transpose(), c * 0) if kind is Kind.PR else (c.transpose() * d * -1, c)


def _from_residues(kind: Kind, system: StateSpace) -> fmpq_mat | None:
    """Find P of a controllable system from its residues modulo primes; None if no P exists, or only a long one."""
    n, chosen = system.states, system.independent_columns()
    known, modulus, tried = [0] * (n * n), 1, 1
    for number, prime in enumerate(_primes(), 1):
        if n**3 * number > _MAX_WORK:
            return None
        try:
            found = _modulo(kind, system, chosen, prime)
        except (ZeroDivisionError, ValueError):  # a prime in a denominator, or in a determinant
            continue
        if found is None:
            return None
        back = pow(modulus, -1, prime)
        known = [x + modulus * ((int(y) - x) * back % prime) for x, y in zip(known, found.entries(), strict=True)]
        modulus *= prime
        if number >= tried:  # ever later, for most of the work is there
            tried = number + 1 + number // 2
            if (entries := _fractions(known, modulus)) is not None:
                return fmpq_mat(n, n, entries)
    raise AssertionError("there is no last prime")


def _primes() -> Iterator[int]:
    prime = fmpz(_LARGEST)
    while True:
        prime -= 1
        if prime.is_prime():
            yield int(prime)


def _modulo(kind: Kind, system: StateSpace, chosen: list[int], prime: int) -> nmod_mat | None:
    """Return P modulo a prime; None if no P exists."""
    a, b, c, d = (
        nmod_mat(whole, prime) * pow(int(unit), -1, prime)
        for whole, unit in (matrix.numer_denom() for matrix in system.matrices)
    )
    px, out = _supplied(kind, a, b, c, d)
    at, gained = a.transpose(), out.transpose() * out
    x, states, stored = b, [b], [px]
    for _ in range(max(chosen, default=0) // system.size):
        x, px = a * x, at * px * -1 - gained * x
        states.append(x)
        stored.append(px)
    left, right = (columns(side_by_side(blocks, b), chosen).transpose() for blocks in (states, stored))
    p = left.solve(right)  # P^T, and so P
    holds = p == p.transpose() and p * b == stored[0] and not any((p * a + at * p + gained).entries())
    return p if holds else None


def _fractions(residues: list[int], modulus: int) -> list[fmpq] | None:
    """The fractions with short numerators and denominators that have these residues; None if some are long."""
    most, unit, found = isqrt(modulus // 2), 1, []
    for residue in residues:
        last, here, before, now = modulus, residue * unit % modulus, 0, 1
        if 2 * here > modulus:
            here -= modulus
        if abs(here) > most:  # not a whole number over the denominators so far
            here %= modulus
            while here > most:
                quotient = last // here
                last, here, before, now = here, last - quotient * here, now, before - quotient * now
            if abs(now) > most:
                return None
        found.append(fmpq(here, now * unit))
        unit *= abs(now)
        if unit > most:
            return None
    return found
