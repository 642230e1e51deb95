"""Where loss elements find the waves that meet at them, and how many are worked on at once."""

from tline.compiled.unit import function

ABREAST = 64  # loss elements advanced together


@function
def passing(t, p, ring):
    """Where in a line's ring the slabs stand that meet p half slabs from end 1, in slab t or half a slab later."""
    a, b = t - (p >> 1), t + ((p + 1) >> 1)
    if a < 0:
        a += ring
    if b >= ring:
        b -= ring
    return a, b
