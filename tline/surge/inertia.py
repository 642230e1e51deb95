"""Inertia of a pump with its motor, where nobody says it."""

RATED_SPEED = 1450 / 60  # Hz, of a motor with four poles at 50 Hz
EFFICIENCY = 0.75


def usual_inertia(power: float, rated_speed: float) -> float:
    """Inertia of impeller with liquid, and motor, kg m², by the power of the shaft, W, and the rated speed, Hz.

    Regressions over many machines: a guess within a factor of two.

    References
    ----------
    A. R. D. Thorley: Fluid Transients in Pipeline Systems, 2nd edition, Professional Engineering Publishing (2004),
    with power in kW and speed in turns per minute: 1.5e7·(P/N³)^0.9556 and 118·(P/N)^1.48.

    Examples
    --------
    >>> round(usual_inertia(75e3, 25.0), 2)
    2.13
    """
    kilowatt, turns = power / 1e3, 60 * rated_speed
    return 1.5e7 * (kilowatt / turns**3) ** 0.9556 + 118 * (kilowatt / turns) ** 1.48
