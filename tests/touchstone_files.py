"""Touchstone files of networks that are known by formula; run as a program it writes those of scenes/."""

from pathlib import Path

import numpy as np

from passivity import RationalFunction

ANTENNA = "25 + 1/(1/200 + 1/(2n*s) + 3p*s) + 1/(1/120 + 1/(1n*s) + 1.5p*s)"
ANTENNA_FEED = 0.7e-9  # s, of 50 ohm
SHIPPED = Path(__file__).parents[1] / "scenes" / "antenna.s1p"
FILTER = SHIPPED.with_name("filter.s2p")
FILTER_L, FILTER_C, FILTER_R, FILTER_ESR = 16e-9, 3.2e-12, 1.0, 0.5  # Butterworth's for some 1 GHz in 50 ohm, lossy


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


def of_chain(chain, z0=50.0):
    """S, shape (n, 2, 2), of chain matrices [[A, B], [C, D]] of such numbers, u1 = A u2 + B i and i1 = C u2 + D i."""
    (A, B), (C, D) = chain
    A, B, C, D = np.broadcast_arrays(A, B / z0, C * z0, D)
    rows = [[A + B - C - D, 2 * (A * D - B * C)], [2 + 0 * A, B + D - A - C]]
    return np.moveaxis(np.array(rows) / (A + B + C + D), 2, 0)


def stretch(f, z, delay):
    """S of a lossless line."""
    x = 2j * np.pi * f * delay
    return of_chain([[np.cosh(x), z * np.sinh(x)], [np.sinh(x) / z, np.cosh(x)]])


def low_pass(f):
    """S of capacitor, inductor, capacitor, with their losses."""
    s = 2j * np.pi * f
    y, z = s * FILTER_C / (1 + s * FILTER_C * FILTER_ESR), FILTER_R + s * FILTER_L
    return of_chain([[1 + z * y, z], [y * (2 + z * y), 1 + z * y]])


def write_ports(path, f, S, decimals=17, z0=50):
    """S of several ports, shape (n, p, p)."""
    S = np.swapaxes(S, 1, 2) if S.shape[1] == 2 else S  # S21 comes before S12
    numbers = [" ".join(f"{v.real:.{decimals}f} {v.imag:.{decimals}f}" for v in each.ravel()) for each in S]
    rows = (f"{x:.0f} {row}" for x, row in zip(f, numbers, strict=True))
    Path(path).write_text("\n".join([f"# Hz S RI R {z0}", *rows, ""]), encoding="utf-8")


def write_filter(path):
    """As an instrument of five digits would see it."""
    f = frequencies(6e9, 150)
    write_ports(path, f, low_pass(f), 5)


if __name__ == "__main__":
    write_antenna(SHIPPED)
    write_filter(FILTER)
