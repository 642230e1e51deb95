"""The unit in which people read a set of values."""

from tline.units import engineering, to_si


def handy(largest: float, unit: str) -> tuple[float, str]:
    """Size in SI and name of the unit for values up to `largest`: `unit`, with a prefix where it takes one.

    Times of a second and more stay in seconds, heights in metres.

    Examples
    --------
    >>> handy(0.0042, "A"), handy(7e5, "bar"), handy(3600.0, "s")
    ((0.001, 'mA'), (100000.0, 'bar'), (1.0, 's'))
    """
    if unit == "m" or (unit == "s" and largest >= 1):
        return 1.0, unit
    name = engineering(largest, unit).partition(" ")[2]
    return to_si(f"1 {name}", None), name


def spread(low: float, high: float) -> tuple[float, float]:
    """Limits of an axis for values from low to high: apart, even if only rounding tells these from each other."""
    largest = max(abs(low), abs(high))
    apart = 0.0 if high - low > 1e-9 * largest else 0.05 * largest or 1.0
    return float(low) - apart, float(high) + apart
