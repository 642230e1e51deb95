"""Zeros of 1 + sign exp(-2Ts) H2(s), by Newton's method from a grid of floats: beside certified counts."""

import numpy as np

from passivity import RationalFunction
from passivity.rational.evaluate import exact

GRID = 40


def rightmost_roots(h2: RationalFunction, delay, sign: int, count: int = 6) -> list[complex]:
    """Those with the largest real parts, upper half plane, rightmost first; one may be missed."""
    h2 = h2.reduced()
    a, b = (np.array([float(int(c)) for c in reversed(f.coeffs())] or [0.0]) for f in (sign * h2.p, h2.q))
    twice = 2 * float(exact(delay, "delay"))
    moduli = {float(abs(r)) for f in (np.polyadd(a, b), b) for r in np.roots(f) if r}
    scales = np.array(sorted(moduli | ({2 * np.pi / twice} if twice else set())) or [1.0])
    x = np.concatenate([-np.geomspace(1e-3, 3, GRID // 2), np.geomspace(1e-3, 3, GRID // 2)])
    s = (scales[:, None, None] * (x[:, None] + 1j * np.linspace(0, count + 2, 3 * GRID))).ravel()
    last = s
    with np.errstate(all="ignore"):
        for _ in range(60):
            z = np.exp(-twice * s)
            f = np.polyval(b, s) + np.polyval(a, s) * z
            slope = np.polyval(np.polyder(b), s) + (np.polyval(np.polyder(a), s) - twice * np.polyval(a, s)) * z
            last, s = s, s - f / slope
        s = s[np.isfinite(s) & (np.abs(s - last) <= 1e-12 * np.abs(s))]
    s.imag = np.where(np.abs(s.imag) < 1e-9 * np.abs(s), 0, np.abs(s.imag))
    found: list[complex] = []
    for root in sorted(map(complex, s), key=lambda root: (-float(f"{root.real:.9g}"), root.imag)):
        if all(abs(root - other) > 1e-7 * abs(root) for other in found):
            found.append(root)
            if len(found) == count:
                break
    return found
