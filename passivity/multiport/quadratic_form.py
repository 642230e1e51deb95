"""Symmetric matrices over Q: are they positive semidefinite, and if not, in which direction?

A Hermitian matrix U + jV is written as the symmetric [[U, -V], [V, U]], which acts on (Re v, Im v).
"""

from flint import fmpq, fmpq_mat


def is_semidefinite(a: fmpq_mat) -> bool:
    """Whether x^T a x >= 0 for all x: as det(t + a) has real roots only, that is when no coefficient is negative.

    Examples
    --------
    >>> is_semidefinite(fmpq_mat(2, 2, [1, 2, 2, 4])), is_semidefinite(fmpq_mat(2, 2, [1, 2, 2, 3]))
    (True, False)
    """
    return all(c >= 0 for c in (-a).charpoly().coeffs())


def negative_direction(a: fmpq_mat) -> list[fmpq] | None:
    """A vector x with x^T a x < 0, None if there is none: Lagrange's reduction to a sum of squares.

    Examples
    --------
    >>> negative_direction(fmpq_mat(2, 2, [1, 2, 2, 3]))
    [1, -2/3]
    """
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
