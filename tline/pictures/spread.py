"""Limits of an axis."""


def spread(low: float, high: float) -> tuple[float, float]:
    """Limits of an axis for values from low to high: apart, even if only rounding tells these from each other."""
    largest = max(abs(low), abs(high))
    apart = 0.0 if high - low > 1e-9 * largest else 0.05 * largest or 1.0
    return float(low) - apart, float(high) + apart
