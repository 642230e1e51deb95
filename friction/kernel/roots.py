"""First root of a polynomial that is positive at first."""

from math import inf

from tline.compiled.unit import function

MOST_HALVINGS = 2000


@function
def value(p, t):
    """A polynomial."""
    total = 0.0
    for k in range(p.size - 1, -1, -1):
        total = total * t + p[k]
    return total


@function
def shifted(p, t, q):
    """The polynomial about t into q."""
    for k in range(p.size):
        q[k] = p[k]
    if t != 0.0:
        for k in range(p.size - 1):
            for j in range(p.size - 2, k - 1, -1):
                q[j] += t * q[j + 1]


@function
def first_root_within(p, n, h, q):
    """Find the first root of a polynomial of the first n terms, the last of which may be zero.

    A polynomial of low degree has a long step before it: the search keeps to Fujiwara's bound of its roots, Tôhoku
    Math. J. 10 (1916) 167.
    """
    while n > 1 and p[n - 1] == 0.0:
        n -= 1
    if n <= 5:
        bound = 0.0
        for k in range(1, n):
            bound = max(bound, abs(p[n - 1 - k] / p[n - 1]) ** (1.0 / k))
        h = min(h, 2.01 * bound)
    return first_root(p[:n], h, q)


@function
def first_root(p, h, q):
    """Find the first t in (0, h] where a polynomial that is positive after 0 vanishes; inf if it does not.

    Zero at once if its first term is negative; zeros at 0 itself are divided out. Intervals are halved until a bound
    shows that the polynomial keeps its sign there, or rises or falls throughout.
    """
    zeros = 0
    while zeros < p.size and p[zeros] == 0.0:
        zeros += 1
    if zeros == p.size:
        return inf
    p = p[zeros:]
    if p[0] < 0.0:
        return 0.0
    low, width = 0.0, h
    for _ in range(MOST_HALVINGS):
        if low >= h:
            break
        width = min(width, h - low)
        r = 0.5 * width
        shifted(p, low + r, q)
        rest, rise, power = 0.0, 0.0, 1.0
        for k in range(1, p.size):
            rise += (k if k > 1 else 0.0) * abs(q[k]) * power
            power *= r
            rest += abs(q[k]) * power
        if q[0] > rest:
            low, width = low + width, 2.0 * width
        elif abs(q[1]) > rise or width < 1e-12 * h:
            if value(p, low + width) <= 0.0:
                root = low + r + falling_root(q[: p.size], r)
                return root if low > 0.0 else polished(p, root, width)
            low, width = low + width, 2.0 * width
        else:
            width = r
    return inf


@function
def polished(p, root, width):
    """A root in [0, width] that may be far below it, where its distance to the middle says little: Newton's method."""
    for _ in range(4):
        f = slope = 0.0
        for k in range(p.size - 1, -1, -1):
            slope = slope * root + f
            f = f * root + p[k]
        new = root - f / slope if slope < 0.0 else root
        if not 0.0 <= new <= width:
            break
        root = new
    return root


@function
def falling_root(q, r):
    """The root in [-r, r] of a polynomial positive at one end and negative at the other: Newton's method, guarded."""
    low, high, t = -r, r, 0.0
    for _ in range(100):
        f, slope = 0.0, 0.0
        for k in range(q.size - 1, -1, -1):
            slope = slope * t + f
            f = f * t + q[k]
        if f > 0.0:
            low = t
        else:
            high = t
        new = t - f / slope if slope < 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if new == t or high - low <= 1e-17 * r:
            return new
        t = new
    return t
