"""Approximate roots of a polynomial as the natural frequencies of the ladder in Routh's scheme.

With m_k, the quotients of neighbours in Routh's column, f(1/t) = 0 reads

    1 + m_1 t + 1/(m_2 t + 1/(m_3 t + ...)) = 0,

a ladder of inductors and capacitors closed with a resistor of 1. Its matrix is tridiagonal and, in coordinates of equal
energy, skew but for signs: its eigenvalues are far less sensitive than those of the companion matrix.
"""

from itertools import pairwise

from flint import ctx, fmpz_poly

from passivity.one_port.hurwitz import pivots

_FARTHEST = 1000  # binary exponent of a modulus
SHIFT = 256  # where the scheme ends early, it is tried again for f(s - 1/SHIFT)


def approximate_roots(f: fmpz_poly) -> list[complex]:
    """Roots in the right half plane to double precision, as far as they are found, closest to the real axis first.

    Examples
    --------
    >>> [f"{root:.6f}" for root in approximate_roots(fmpz_poly([-2, 1, 1]))]  # (s - 1)(s + 2)
    ['1.000000+0.000000j']
    """
    n = f.degree()
    k = round((f[0].bit_length() - f[n].bit_length()) / n) if f[0] else 0
    if abs(k) > _FARTHEST:
        return []
    f = f(fmpz_poly([0, 1 << k])) if k > 0 else fmpz_poly([c << (-k * (n - i)) for i, c in enumerate(f.coeffs())])
    found = [s * 2.0**k for s in _natural_frequencies(f)]
    if not found:
        f = fmpz_poly([c * SHIFT ** (n - i) for i, c in enumerate(f.coeffs())])(fmpz_poly([-1, 1]))
        found = [(s - 1) / SHIFT * 2.0**k for s in _natural_frequencies(f)]
    return sorted((s for s in found if s.real > 0), key=lambda s: -s.real / abs(s))


def _natural_frequencies(f: fmpz_poly) -> list[complex]:
    import numpy as np

    n, bits = f.degree(), 64 + 4 * f.degree()
    for _ in range(4):
        with ctx.workprec(bits):
            column = list(pivots(f))
            if len(column) == n + 1 and not any(c.contains(0) for c in column):
                m = [a / b for a, b in pairwise(column)]
                resistor = float(1 / abs(m[0]))
                couplings = [float(1 / abs(a * b).sqrt()) for a, b in pairwise(m)]
                signs = np.array([1 if a > 0 else -1 for a in m])
                break
        bits *= 2
    else:
        return []
    matrix = np.diag([-resistor] + [0.0] * (n - 1)) + np.diag(couplings, -1) - np.diag(couplings, 1)
    if not np.isfinite(matrix).all():
        return []
    return [complex(1 / t) for t in np.linalg.eigvals(signs[:, None] * matrix) if t]
