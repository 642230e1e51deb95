"""Polynomials that neighbouring slabs share, where they fit what is known of both."""

from typing import NamedTuple

from tline.structure import Floats2, Floats3, Integers
from tline.unit import function, unit


class Neighbours(NamedTuple):
    """Pairs of neighbouring cells of the two waves at an end of a line, W = 2, and what is made of them.

    Cells hold s points before, p afterwards. A matrix takes the Legendre coefficients of both cells, and the values at
    the three ends of cells that they have, to what a polynomial shared by both is at the points of both.
    """

    coefficients: Floats3  # (W, cells, s)
    ends: Floats2  # (W, cells + 1)
    values: Floats3  # (W, cells, p); what is shared is added
    first: Integers  # (pairs,) cell
    matrix: Integers  # (pairs,) which
    most: Floats2  # (pairs, 2) that the values of either may change
    matrices: Floats3  # (any, 2 s + 3, 2 p), so that the innermost loop is over contiguous values
    change: Floats2  # (W, 2 p)
    total: Floats3  # (W, cells, p)
    shares: Integers  # (cells,) how many were added


@unit
def share(at: Neighbours) -> int:
    """Change the values of cells to those that they share with one neighbour, or the mean of those with both.

    Errors of the two waves may cancel in effort or flow, so both are changed or none.
    """
    waves, cells, points = at.values.shape
    at.total[:], at.shares[:] = 0.0, 0
    for pair in range(at.first.size):
        k = at.first[pair]
        for wave in range(waves):
            change_by(at, wave, k, at.matrices[at.matrix[pair]], at.change[wave])
        if fits(at.change, at.most[pair], points):
            for side in range(2):
                at.shares[k + side] += 1
                for wave in range(waves):
                    for i in range(points):
                        at.total[wave, k + side, i] += at.change[wave, side * points + i]
    for wave in range(waves):
        for k in range(cells):
            if at.shares[k]:
                for i in range(points):
                    at.values[wave, k, i] += at.total[wave, k, i] / at.shares[k]
    return 0


@function
def change_by(at, wave, k, matrix, change):
    """How much the shared polynomial of cells k and k + 1 is beyond their own."""
    s, points = at.coefficients.shape[2], at.values.shape[2]
    for i in range(2 * points):
        change[i] = -at.values[wave, k + i // points, i % points]
    for side in range(2):
        for j in range(s):
            add(change, matrix[side * s + j], at.coefficients[wave, k + side, j])
    for j in range(3):
        add(change, matrix[2 * s + j], at.ends[wave, k + j])


@function
def add(total, row, by):
    """Add a multiple of a row."""
    for i in range(total.size):
        total[i] += by * row[i]


@function
def fits(change, most, points):
    """Whether neither wave changes by more than is expected."""
    for row in change:
        for i in range(2 * points):
            if not abs(row[i]) <= most[i // points]:
                return False
    return True
