"""Touchstone files of one-ports that are known by formula; run as a program it writes scenes/antenna.s1p."""

from pathlib import Path

import numpy as np

from passivity import RationalFunction

ANTENNA = "25 + 1/(1/200 + 1/(2n*s) + 3p*s) + 1/(1/120 + 1/(1n*s) + 1.5p*s)"
ANTENNA_FEED = 0.7e-9  # s, of 50 ohm
SHIPPED = Path(__file__).parents[1] / "scenes" / "antenna.s1p"


def frequencies(highest=5e9, n=250):
    return np.linspace(highest / n, highest, n)


def behind_cable(impedance, f, delay, z0=50.0):
    """Reflection of an expression in s, seen through a lossless cable of z0."""
    Z = RationalFunction.from_expression(impedance)
    values = np.array([Z(2j * np.pi * x) for x in f])
    return (values - z0) / (values + z0) * np.exp(-4j * np.pi * f * delay)


def write(path, f, values, decimals=17):
    rows = (f"{x:.0f} {v.real:.{decimals}f} {v.imag:.{decimals}f}" for x, v in zip(f, values, strict=True))
    Path(path).write_text("\n".join(["# Hz S RI R 50", *rows, ""]), encoding="utf-8")


def write_antenna(path):
    """Two resonances at the end of a cable, as an instrument of five digits would see them."""
    f = frequencies(4e9, 200)
    write(path, f, behind_cable(ANTENNA, f, ANTENNA_FEED), 5)


if __name__ == "__main__":
    write_antenna(SHIPPED)
