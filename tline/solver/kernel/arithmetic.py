"""Small vectors and matrices; loops like these compile many times faster than array expressions."""

from tline.compiled.unit import function

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway


@function
def clear(out):
    """Set to zero; loops like this one compile many times faster than array expressions."""
    for i in range(out.size):
        out[i] = 0.0


@function
def copy(values, out):
    """Copy as many values as there is room for."""
    for i in range(out.size):
        out[i] = values[i]


@function
def times(matrix, values, o, out):
    """Product of a matrix with a part of an array."""
    for i in range(out.size):
        total = 0.0
        for j in range(out.size):
            total += matrix[i, j] * values[o + j]
        out[i] = total


@function
def distance(one, other):
    """Sum of the absolute differences."""
    total = 0.0
    for i in range(one.size):
        total += abs(one[i] - other[i])
    return total


@function
def largest(values, size):
    """Largest of the first absolute values."""
    found = 0.0
    for i in range(size):
        found = max(found, abs(values[i]))
    return found


@function
def weakest(size, low, high):
    """Index of the least of some values."""
    best = low
    for i in range(low, high):
        if size[i] < size[best]:
            best = i
    return best


@function
def eliminate_all(system, size, sides):
    """Solve linear systems by Gauss with pivots; the right sides are their last columns, and become the solutions."""
    for pivot in range(size):
        best = pivot
        for i in range(pivot + 1, size):
            if abs(system[i, pivot]) > abs(system[best, pivot]):
                best = i
        for j in range(pivot, size + sides):
            system[pivot, j], system[best, j] = system[best, j], system[pivot, j]
        for i in range(pivot + 1, size):
            ratio = system[i, pivot] / system[pivot, pivot]
            if ratio != 0.0:
                for j in range(pivot + 1, size + sides):
                    system[i, j] -= ratio * system[pivot, j]
    for pivot in range(size - 1, -1, -1):
        for side in range(size, size + sides):
            for j in range(pivot + 1, size):
                system[pivot, side] -= system[pivot, j] * system[j, side]
            system[pivot, side] /= system[pivot, pivot]


@function
def eliminate(system, size):
    """The same with one right side."""
    eliminate_all(system, size, 1)


@function
def left_of(rest, first, aim, size):
    """Take 1 - aim of the first residuals from the present ones. Returns the largest that is left."""
    largest = 0.0
    for i in range(size):
        rest[i] -= (1.0 - aim) * first[i]
        largest = max(largest, abs(rest[i]))
    return largest
