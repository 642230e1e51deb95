"""The coupled drives assembled in another way: Lagrange's equations with a multiplier, solved point by point.

Coordinates q = (phi1, phi2, s1, s2, x_k), where s1 and s2 are the belt's positions on the two sides of the pulley;
(M s^2 + C s + K) q + G' lambda = Q with G q = s1 - s2 - 2 c x_k = 0. The multiplier is the tension of the belt. Nothing
is eliminated by hand. Works in fractions and in mpmath.
"""

from fractions import Fraction

import mpmath


class Numbers:
    """The parameters of drives, as one kind of number."""

    def __init__(self, drives, kind):
        left, right, b1, b2, p = drives.left, drives.right, drives.left_belt, drives.right_belt, drives.pulley
        self.j, self.b, self.r = (
            [kind(getattr(x, n)) for x in (left, right)] for n in ("inertia", "friction", "radius")
        )
        self.stiffness, self.damping = ([kind(getattr(x, n)) for x in (b1, b2)] for n in ("stiffness", "damping"))
        self.k, self.m, self.c = kind(p.stiffness), kind(p.mass), kind(p.cosine)


def precise(x):
    return mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator


def system(n, s):
    """Matrix of the unknowns phi1, phi2, s1, s2, x_k, lambda."""
    z1, z2 = (k + b * s for k, b in zip(n.stiffness, n.damping, strict=True))
    r1, r2 = n.r
    zero = s * 0
    return [
        [n.j[0] * s * s + n.b[0] * s + r1 * r1 * z1, zero, -r1 * z1, zero, zero, zero],
        [zero, n.j[1] * s * s + n.b[1] * s + r2 * r2 * z2, zero, -r2 * z2, zero, zero],
        [-r1 * z1, zero, z1, zero, zero, zero + 1],
        [zero, -r2 * z2, zero, z2, zero, zero - 1],
        [zero, zero, zero, zero, n.k + getattr(n, "m", 0) * s * s, -2 * n.c],
        [zero, zero, zero + 1, zero - 1, -2 * n.c, zero],
    ]


def respond(n, s, torque):
    """Outputs at s for a unit T1 (torque 0) or T2 (torque 1)."""
    matrix = system(n, s)
    right = [s * 0] * 6
    right[torque] = s * 0 + (1 if torque else -1)
    phi1, phi2, _, _, x_k, multiplier = solve(matrix, right)
    tension = -multiplier  # the force on s1 is -F of belt 1
    return {
        "x_k": x_k,
        "tension": tension,
        "w1": s * phi1,
        "w2": s * phi2,
        "phi1": phi1,
        "phi2": phi2,
        "belt_speed": s * (n.r[0] * phi1 + n.r[1] * phi2) / 2,
    }


def solve(matrix, right):
    """Gauss and Jordan, with the largest pivot."""
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    size = len(rows)
    for k in range(size):
        best = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(size):
            if i != k and rows[i][k] != 0:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[-1] for row in rows]
