"""Storage functions of lossless networks: P >= 0 with x^T P x/2 growing by just the energy that enters; signs.

By the Kalman-Yakubovich-Popov lemma a state space is positive real if there is a P with

    K(P) = [[A^T P + P A, P B - C^T], [B^T P - C, -D - D^T]] <= 0,   P >= 0.

A Hermitian matrix U + jV is written as the symmetric [[U, -V], [V, U]], which acts on (Re v, Im v).

References
----------
J. C. Willems, "Dissipative dynamical systems, part II", Archive for Rational Mechanics and Analysis 45 (1972), 352-393.
"""

from flint import fmpq, fmpq_mat

from passivity.rational.state_space import StateSpace


def is_semidefinite(a: fmpq_mat) -> bool:
    """Whether x^T a x >= 0 for all x: as det(t + a) has real roots only, that is when no coefficient is negative."""
    return all(c >= 0 for c in (-a).charpoly().coeffs())


def negative_direction(a: fmpq_mat) -> list[fmpq] | None:
    """A vector x with x^T a x < 0, None if there is none: Lagrange's reduction to a sum of squares."""
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
    for pivot, row in reversed(squares):  # what is squared is made zero
        x[pivot] = -sum((row[i] * c for i, c in enumerate(x) if i != pivot), fmpq(0))
    return x


def _obvious(a: list[list[fmpq]], left: list[int]) -> list[fmpq] | None:
    """A direction seen on the diagonal, or beside a zero of it."""
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


def lossless_storage(system: StateSpace) -> tuple[fmpq_mat, fmpq_mat, StateSpace] | None:
    """P, V and the reached part (A1, B1, C V, D) of a system that neither loses nor makes energy, None of another one.

    K(P) = 0 means P B = C^T and P A = -A^T P, and so P A^k B = (-A^T)^k C^T: where the inputs reach all states, these
    equations leave one P.
    """
    if any((system.d + system.d.transpose()).entries()) or not _starts_lossless(system):
        return None
    basis, reached = system.reached()
    chosen = reached.independent_columns()
    mirrored = StateSpace(-reached.a.transpose(), reached.c.transpose(), reached.b.transpose(), reached.d)
    left, right = reached.krylov(chosen), mirrored.krylov(chosen)
    p = left.transpose().solve(right.transpose()).transpose()
    if p != p.transpose() or any(kyp(reached, p).entries()) or not is_semidefinite(p):
        return None
    return p, basis, reached


def _starts_lossless(system: StateSpace) -> bool:
    """C B symmetric and C A B skew: necessary and quickly seen."""
    first, second = system.markov(2)
    return first == first.transpose() and second == -second.transpose()


def kyp(system: StateSpace, p: fmpq_mat) -> fmpq_mat:
    """K(P)."""
    a, b, c, d = system.a, system.b, system.c, system.d
    pa, pb = p * a, p * b - c.transpose()
    upper = [[*x, *y] for x, y in zip((pa + pa.transpose()).tolist(), pb.tolist(), strict=True)]
    lower = [[*x, *y] for x, y in zip(pb.transpose().tolist(), (-d - d.transpose()).tolist(), strict=True)]
    return fmpq_mat(upper + lower)
