"""The limit of linear equations (A + s B) z = f as s goes to zero: where a slow rise from rest leads.

Where A is singular, as in loops of inductances or at efforts that only capacitances tell, z + s z' with A z = f and
A z' + B z = 0 is what is left of the first orders: each combination of the rows of A that vanishes tells B z = 0.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SMALL, LARGE = 300, 1500  # unknowns: dense at once; and dense at all, where the matrix is singular
REGULAR = 1e12  # condition below which a matrix is not singular
SINGULAR = 1e-13  # of the largest singular value, or pivot
CONTRADICTORY = 1e-11  # of what is known
INVOLVED = 1e-3  # of the largest entry of a null vector
ROUNDS = 4  # in which rows and columns are scaled


class Limit(NamedTuple):
    """The solution, and rows that contradict each other or columns that nothing determines; none of them is best."""

    z: NDArray
    rows: NDArray
    columns: NDArray


class Sparse(NamedTuple):
    """A square matrix by its entries; those at one place add up."""

    rows: NDArray
    columns: NDArray
    values: NDArray

    def __matmul__(self, z: NDArray) -> NDArray:
        return np.bincount(self.rows, self.values * z[self.columns], len(z))

    def plus(self, *others: "Sparse") -> "Sparse":
        """The sum with other matrices."""
        return Sparse(*(np.concatenate(each) for each in zip(self, *others, strict=True)))

    def scaled(self, row: NDArray, column: NDArray) -> "Sparse":
        """The matrix with scaled rows and columns."""
        return self._replace(values=self.values * row[self.rows] * column[self.columns])

    def dense(self, n: int) -> NDArray:
        """The matrix as an array, shape (n, n)."""
        return np.bincount(self.rows * n + self.columns, self.values, n * n).reshape(n, n)


def slow_limit(A: Sparse, B: Sparse, f: NDArray) -> Limit:
    """The limit of z as s goes to zero from above."""
    n, none = len(f), np.zeros(0, int)
    row, column = _scales(A, n)
    A, B, f = A.scaled(row, column), B.scaled(row, column), f * row
    z = _regular(A, f)
    if z is not None:
        return Limit(z * column, none, none)
    if n > LARGE:
        return Limit(np.full(n, np.nan), none, np.arange(n))
    left, values, right = np.linalg.svd(A.dense(n))
    rank = int((values > SINGULAR * values[0]).sum())
    z = right[:rank].T @ ((left[:, :rank].T @ f) / values[:rank])
    if rank == n:
        return Limit(z * column, none, none)
    vanishing, free = left[:, rank:].T, right[rank:].T
    torn = np.abs(vanishing @ f) > CONTRADICTORY * float(np.linalg.norm(f))
    if torn.any():
        return Limit(z * column, _involved(vanishing[torn].T), none)
    told = vanishing @ B.dense(n)
    told /= np.abs(told).max(axis=1, keepdims=True, initial=np.finfo(float).tiny)
    shares = told @ free
    loose, sizes, mixed = np.linalg.svd(shares)
    known = sizes > SINGULAR * n * max(float(sizes[0]), 1.0)
    if not known.all():
        return Limit(z * column, none, _involved(free @ mixed[~known].T))
    z = z - free @ (mixed.T @ ((loose.T @ (told @ z)) / sizes))
    return Limit(z * column, none, none)


def _scales(A: Sparse, n: int) -> tuple[NDArray, NDArray]:
    """Factors of rows and columns that make their largest entries one."""
    row, column, size = np.ones(n), np.ones(n), np.abs(A.values)
    for _ in range(ROUNDS):
        now = size * row[A.rows] * column[A.columns]
        for scale, at in ((row, A.rows), (column, A.columns)):
            largest = np.zeros(n)
            np.maximum.at(largest, at, now)
            scale[largest > 0] /= np.sqrt(largest[largest > 0])
    return row, column


def _regular(A: Sparse, f: NDArray) -> NDArray | None:
    """The solution where the matrix is far from singular."""
    n = len(f)
    if n <= SMALL:
        matrix = A.dense(n)
        try:
            found = np.linalg.solve(matrix, np.column_stack([f, np.eye(n)]))
        except np.linalg.LinAlgError:
            return None
        condition = np.abs(matrix).sum(axis=0).max() * np.abs(found[:, 1:]).sum(axis=0).max()
        return found[:, 0] if condition < REGULAR else None
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    try:
        factors = splu(coo_array((A.values, (A.rows, A.columns)), shape=(n, n)).tocsc())
    except RuntimeError:
        return None
    pivots = np.abs(factors.U.diagonal())
    return factors.solve(f) if pivots.min() > SINGULAR * pivots.max() else None


def _involved(vectors: NDArray) -> NDArray:
    """Places of the entries of null vectors that are not small."""
    size = np.abs(vectors).max(axis=1)
    return np.flatnonzero(size > INVOLVED * size.max())
