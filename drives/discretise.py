"""Steps of a linear run, exact where inputs are linear in time.

z = (x, u, du/dt) obeys z' = F z, so z(t + h) = exp(F h) z(t) for any h. A quadratic form integrates to another one:
the integral of z'Qz over a step is z(t)'G z(t) with G(2h) = G(h) + E(h)'G(h)E(h), E(2h) = E(h)^2; the first, short step
by C. F. Van Loan, Computing integrals involving the matrix exponential, 1978, doi:10.1109/TAC.1978.1101743.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import frexp

import numpy as np
from flint import arb, arb_mat, ctx, fmpq, fmpq_mat
from numpy.typing import NDArray

from drives.torque import Torque
from tline.errors import InputError

ACCURATE, NEGLIGIBLE = 60, -150  # bits of an entry, or its size beside the largest one
MOST_BITS = 1 << 14


def joined(a: fmpq_mat, b: fmpq_mat) -> fmpq_mat:
    """F of z' = F z for x' = a x + b u and u linear in time."""
    n, m = b.nrows(), b.ncols()
    top = [[*left, *right, *[0] * m] for left, right in zip(a.tolist(), b.tolist(), strict=True)]
    middle = [[int(k == n + m + i) for k in range(n + 2 * m)] for i in range(m)]
    return fmpq_mat(top + middle + [[0] * (n + 2 * m)] * m)


def step_matrix(f: fmpq_mat, h: float) -> NDArray[np.float64]:
    """exp(F h) - 1, each entry within 1 ulp unless it is negligible beside the largest.

    Without the 1 short steps lose nothing: the state's change is computed, not the state.

    Examples
    --------
    >>> float(step_matrix(fmpq_mat([[-500]]), 1e-6)[0, 0])
    -0.0004998750208307294
    """
    unit = arb_mat([[int(i == k) for k in range(f.ncols())] for i in range(f.nrows())])
    return _refined(lambda: (arb_mat(f) * arb(h)).exp() - unit)


def energy_matrix(f: fmpq_mat, q: fmpq_mat, h: float) -> NDArray[np.float64]:
    """G with z(t)'G z(t) the integral of z'Q z over a step h.

    Examples
    --------
    >>> float(energy_matrix(fmpq_mat([[-500]]), fmpq_mat([[1000]]), 1.0)[0, 0])
    1.0
    """
    n = f.nrows()
    largest = max(abs(float(int(x.p) / int(x.q))) for x in f.entries()) * n * h
    halvings = max(frexp(largest)[1] + 1, 0)
    start = [[*row, *right] for row, right in zip((-1 * f.transpose()).tolist(), q.tolist(), strict=True)]
    start += [[fmpq(0)] * n + row for row in f.tolist()]

    def compute() -> arb_mat:
        both = (arb_mat(fmpq_mat(start)) * (arb(h) / 2**halvings)).exp().tolist()
        e = arb_mat([row[n:] for row in both[n:]])
        g = e.transpose() * arb_mat([row[n:] for row in both[:n]])
        for _ in range(halvings):
            g, e = g + e.transpose() * g * e, e * e
        return g

    return _refined(compute)


@dataclass(frozen=True)
class Legs:
    """The way from sample to sample, cut at the corners of the inputs."""

    lengths: NDArray[np.float64]  # s, shape (n,)
    inputs: NDArray[np.float64]  # inputs at the start of each leg, then their slopes, shape (n, 2m)
    sampled: NDArray[np.bool_]  # which of the n + 1 ends of legs are samples

    def groups(self) -> Iterator[tuple[float, NDArray[np.intp]]]:
        """Each length that occurs, with the legs that have it."""
        for length in np.unique(self.lengths):
            yield float(length), np.flatnonzero(self.lengths == length)


def legs(inputs: tuple[Torque, ...], step: float, samples: int) -> Legs:
    """Legs of a run with these inputs."""
    aligned = [one.aligned(step) for one in inputs]
    grid = np.arange(samples, dtype=np.float64) * step
    corners = np.array([time for one in aligned for time in one.times if time < grid[-1]])
    marks = np.union1d(grid, corners)
    sampled = np.isin(marks, grid)
    lengths = np.where(sampled[:-1] & sampled[1:], step, np.diff(marks))
    values, slopes = zip(*(one.pieces(marks[:-1]) for one in aligned), strict=True)
    return Legs(lengths, np.column_stack([*values, *slopes]), sampled)


def propagate(a: fmpq_mat, b: fmpq_mat, x0: NDArray, way: Legs) -> NDArray[np.float64]:
    """States of x' = a x + b u at all ends of legs, shape (legs + 1, n)."""
    f, n = joined(a, b), a.nrows()
    moves, which, forced = [], np.empty(len(way.lengths), int), np.empty((len(way.lengths), n))
    for length, chosen in way.groups():
        matrix = step_matrix(f, length)[:n]
        which[chosen], forced[chosen] = len(moves), way.inputs[chosen] @ matrix[:, n:].T
        moves.append(matrix[:, :n].copy())
    found = np.empty((len(which) + 1, n))
    found[0], x, lost = x0, x0, np.zeros(n)
    for k, (move, push) in enumerate(zip(which.tolist(), forced, strict=True), 1):
        change = moves[move] @ x + push - lost
        found[k] = new = x + change
        x, lost = new, (new - x) - change  # Kahan's sum: rounding does not grow with the number of steps
    return found


def _refined(compute: Callable[[], arb_mat]) -> NDArray[np.float64]:
    """Compute with ever more bits until the result is accurate, and return it in floats."""
    bits = 256
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            found = compute()
            entries = found.entries()
            small = max((x.abs_upper() for x in entries), default=arb(0)) * arb(2) ** NEGLIGIBLE
            if all(x.rel_accuracy_bits() >= ACCURATE or x.abs_upper() <= small for x in entries):
                return np.array([float(x.mid()) for x in entries]).reshape(found.nrows(), found.ncols())
        bits *= 2
    raise InputError("step", "too long for these numbers", "a step that spans fewer time constants")
