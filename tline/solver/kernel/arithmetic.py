"""Small vectors and matrices; loops like these compile many times faster than array expressions.

Where Newton's methods of the kernel stop.

Polynomials on intervals, held by their Legendre coefficients.
"""

from tline.compiled.unit import function

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway
ROUNDED = 1e-12  # of the largest value: smaller changes, flows and shifts are none
BEST_RESIDUAL = 4e-15  # relative to the efforts, at which Newton's method stops
ACCEPTED_RESIDUAL = 1e-10  # relative to the efforts, if no step reduces it
STEPS, ULPS = 80, 4e-16  # of a scalar Newton, and the relative change at which it ends
TRIES = 40  # Newton steps for a part of the way
FAINT = 1e-9  # step for the response of waves that answer to nothing
LOOKS, HALVINGS = 4, 60  # at a slab for roots, per point; and of an interval with a root
STEP_ROUNDING = 1e-9  # of a look


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
    """Solve a system with one right-hand side by elimination."""
    eliminate_all(system, size, 1)


@function
def left_of(rest, first, aim, size):
    """Subtract 1 - aim of the first residuals from the present ones. Returns the largest remainder."""
    largest = 0.0
    for i in range(size):
        rest[i] -= (1.0 - aim) * first[i]
        largest = max(largest, abs(rest[i]))
    return largest


@function
def series(coef, y):
    """Sum of a Legendre series at y, -1 to 1."""
    total, last, here = coef[0], 1.0, y
    for k in range(1, coef.size):
        total += coef[k] * here
        last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)
    return total


@function
def project(coef, a, b, p, q, gauss, out):
    """Add the part of a polynomial on [a, b] to its projection on [p, q]; a restriction is exact."""
    low, high = max(a, p), min(b, q)
    if high <= low:
        return
    for i in range(gauss.shape[1]):
        since = (high - low) * gauss[0, i]  # low: places in narrow intervals are known better than instants
        value = gauss[1, i] * (high - low) / (q - p) * series(coef, 2.0 * (low - a + since) / (b - a) - 1.0)
        y = 2.0 * (low - p + since) / (q - p) - 1.0
        out[0] += value
        last, here = 1.0, y
        for k in range(1, out.size):
            out[k] += (2 * k + 1) * value * here
            last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)


@function
def integrated(coef, factor, out):
    """Legendre coefficients of the integral from 0 of a polynomial on [0, 1], times a factor."""
    clear(out)
    out[0] = 0.5 * factor * coef[0]
    for k in range(coef.size):
        term = 0.5 * factor * coef[k] / (2 * k + 1)
        out[k + 1] += term
        if k > 0:
            out[k - 1] -= term


@function
def fallen(coef, level, start):
    """Place behind `start` at which a polynomial on [0, 1] first falls below a level, as sampled; else 1."""
    looks, low = LOOKS * coef.size, start
    for k in range(int(start * looks) + 1, looks + 1):
        high = k / looks
        if series(coef, 2.0 * high - 1.0) < level:
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if series(coef, 2.0 * middle - 1.0) < level:
                    high = middle
                else:
                    low = middle
            return high
        low = high
    return 1.0


@function
def after(place, s):
    """The next look at a slab, beyond this one however it is rounded."""
    return min((int(place * LOOKS * s + STEP_ROUNDING) + 1) / (LOOKS * s), 1.0)


@function
def exchange_part(values, at, count, kept, give):
    """Put `count` values from position `at` on aside, or give them back."""
    for i in range(count):
        if give:
            values[at + i] = kept[i]
        else:
            kept[i] = values[at + i]
