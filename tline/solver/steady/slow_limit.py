"""What linear equations (A + s B) z = f tend to as s goes to zero: where a slow rise from rest leads.

Where A is singular, as in loops of inductances or at efforts that only capacitances tell, z + s z' with A z = f and
A z' + B z = 0 is what is left of the first orders: each combination of the rows of A that vanishes tells B z = 0.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SMALL, LARGE = 300, 1500  # unknowns: dense at once; and dense at all, where the matrix is singular
SINGULAR = 1e-13  # of the largest singular value
CONTRADICTORY = 1e-11  # of what is known
INVOLVED = 1e-3  # of the largest entry of a null vector
ROUNDS = 4  # in which rows and columns are scaled


class Limit(NamedTuple):
    """The solution, and rows that contradict each other or columns that nothing determines; none of them is best."""

    z: NDArray
    rows: NDArray
    columns: NDArray


class Pencil:
    """The equations, collected row by row.

    Attributes
    ----------
    rows, columns : list of str
        What each equation and each unknown belongs to.
    known : list of float
        f.
    """

    def __init__(self) -> None:
        self.rows: list[str] = []
        self.columns: list[str] = []
        self.known: list[float] = []
        self._entries: list[tuple[int, int, float, float]] = []

    def unknowns(self, names: Iterable[str]) -> NDArray:
        """Numbers of new unknowns."""
        first = len(self.columns)
        self.columns += names
        return np.arange(first, len(self.columns))

    def row(
        self,
        where: str,
        entries: Iterable[tuple[int, float]],
        slow: Iterable[tuple[int, float]] = (),
        known: float = 0.0,
    ) -> int:
        """Number of a new equation with these entries of A and of B."""
        at = len(self.rows)
        self._entries += [(at, int(column), float(value), 0.0) for column, value in entries if value]
        self._entries += [(at, int(column), 0.0, float(value)) for column, value in slow if value]
        self.rows.append(where)
        self.known.append(known)
        return at

    def matrices(self) -> "tuple[Sparse, Sparse, NDArray]":
        """A, B and f."""
        table = np.array(self._entries).reshape(-1, 4)
        rows, columns = table[:, :2].astype(int).T
        return Sparse(rows, columns, table[:, 2]), Sparse(rows, columns, table[:, 3]), np.array(self.known)


class Sparse(NamedTuple):
    """A square matrix by its entries; those at one place add up."""

    rows: NDArray
    columns: NDArray
    values: NDArray

    def __matmul__(self, z: NDArray) -> NDArray:
        return np.bincount(self.rows, self.values * z[self.columns], len(z))

    def plus(self, rows: NDArray, columns: NDArray, values: NDArray) -> "Sparse":
        """With more entries."""
        more = zip(self, (rows, columns, values), strict=True)
        return Sparse(*(np.concatenate(each) for each in more))

    def scaled(self, row: NDArray, column: NDArray) -> "Sparse":
        """With scaled rows and columns."""
        return self._replace(values=self.values * row[self.rows] * column[self.columns])

    def dense(self, n: int) -> NDArray:
        """As an array, shape (n, n)."""
        matrix = np.zeros((n, n))
        np.add.at(matrix, (self.rows, self.columns), self.values)
        return matrix


def slow_limit(A: Sparse, B: Sparse, f: NDArray) -> Limit:
    """The limit of z as s goes to zero from above."""
    n, none = len(f), np.zeros(0, int)
    row, column = _scales(A, n)
    A, B, f = A.scaled(row, column), B.scaled(row, column), f * row
    z = _regular(A, f) if n > SMALL else None
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
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    n = len(f)
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
