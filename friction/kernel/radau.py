"""Radau IIA collocation of order 9 on one bristle whose velocity is prescribed."""

import numpy as np
from numpy.polynomial import Legendre

from friction.kernel.law import slip_share, steady
from tline.compiled.unit import function

# Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section IV.5: L-stable
STAGES = 5
MOST_ITERATIONS, ENOUGH = 12, 1e-15
NODES = np.append(0.0, (np.sort((Legendre.basis(STAGES) - Legendre.basis(STAGES - 1)).roots().real) + 1.0) / 2.0)
NODES[-1] = 1.0
# dense output: the polynomial through the beginning and all stages; where it misses the equation is the error estimate
BARYCENTRIC = np.array([1.0 / np.prod(own - np.delete(NODES, j)) for j, own in enumerate(NODES)])


def _vanishing(nodes):
    """The polynomial with these roots, as a series that loses nothing between 0 and 1."""
    return Legendre.fromroots(nodes, domain=[0.0, 1.0])


BASIS = [_vanishing(np.delete(NODES, j)) for j in range(STAGES + 1)]
BASIS = [each / each(own) for each, own in zip(BASIS, NODES, strict=True)]  # 1 at one node, 0 at all others
CHECKS = np.array([0.0, 0.5 * (NODES[-1] + NODES[-2])])
AT, SLOPE = (np.array([[each(c) for each in some] for c in CHECKS]) for some in (BASIS, [p.deriv() for p in BASIS]))
MISSED = _vanishing(NODES[1:])  # shape of the defect: zero at all stages
PER_DEFECT = np.abs(MISSED.integ(lbnd=0.0)(np.linspace(0.0, 1.0, 101))).max() / np.abs(MISSED(CHECKS))
STAGE = [_vanishing(np.delete(NODES[1:], j)) for j in range(STAGES)]
A = np.array(
    [[each.integ(lbnd=0.0)(c) / each(own) for own, each in zip(NODES[1:], STAGE, strict=True)] for c in NODES[1:]]
)


@function
def bristle_rate(law, s, v, g, z):
    """ż, and its derivative in z."""
    share, steep, _ = slip_share(law, s, z, g)
    slip = law.sigma0 * s * v / g
    return v - share * slip * z, -(share + steep * z) * slip


@function
def radau(law, s, h, work):
    """One step from stage 0; velocities of all stages and checks are known. Returns the error estimate, -1 if it fails.

    Newton's method: for bristles that slip at any deflection the equations are linear, and one iteration solves them.
    """
    z, v, g, matrix = work.z, work.v, work.g, work.matrix
    for i in range(v.size):
        g[i] = steady(law, v[i])[0]
    for i in range(1, STAGES + 1):
        z[i] = z[0]
    linear, size = law.z_ba < 0.0, abs(z[0])
    for _ in range(MOST_ITERATIONS):
        for j in range(STAGES):
            f, f_z = bristle_rate(law, s, v[j + 1], g[j + 1], z[j + 1])
            work.f[j] = f
            for i in range(STAGES):
                matrix[i, j] = (1.0 if i == j else 0.0) - h * A[i, j] * f_z
        for i in range(STAGES):
            matrix[i, STAGES] = z[0] - z[i + 1]
            for j in range(STAGES):
                matrix[i, STAGES] += h * A[i, j] * work.f[j]
        eliminate(matrix)
        change = 0.0
        for i in range(STAGES):
            z[i + 1] += matrix[i, STAGES]
            change, size = max(change, abs(matrix[i, STAGES])), max(size, abs(z[i + 1]))
        if linear or change <= ENOUGH * size:
            return defect(law, s, h, work)
    return -1.0


@function
def defect(law, s, h, work):
    """Estimate the error of the dense output: its defect at two instants, integrated, less the part damped by slip."""
    worst = 0.0
    for k in range(CHECKS.size):
        z = slope = 0.0
        for j in range(STAGES + 1):
            z += AT[k, j] * work.z[j]
            slope += SLOPE[k, j] * (work.z[j] - work.z[0])  # the slopes of all add up to 0
        at = 0 if k == 0 else STAGES + 1
        f, f_z = bristle_rate(law, s, work.v[at], work.g[at], z)
        worst = max(worst, PER_DEFECT[k] * abs(slope - h * f) / (1.0 + h * abs(f_z)))
    return worst


@function
def eliminate(matrix):
    """Solve the equations whose right-hand side is the last column, by rows with the largest pivot; in place."""
    n = matrix.shape[0]
    for i in range(n):
        pivot = i
        for j in range(i + 1, n):
            if abs(matrix[j, i]) > abs(matrix[pivot, i]):
                pivot = j
        for j in range(i, n + 1):
            matrix[i, j], matrix[pivot, j] = matrix[pivot, j], matrix[i, j]
        for j in range(i + 1, n):
            factor = matrix[j, i] / matrix[i, i]
            for k in range(i + 1, n + 1):
                matrix[j, k] -= factor * matrix[i, k]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            matrix[i, n] -= matrix[i, j] * matrix[j, n]
        matrix[i, n] /= matrix[i, i]


@function
def dense(z, at):
    """The deflection at a share of the step, between 0 and 1."""
    above = below = 0.0
    for j in range(STAGES + 1):
        if at == NODES[j]:
            return z[j]
        weight = BARYCENTRIC[j] / (at - NODES[j])
        above += weight * z[j]
        below += weight
    return above / below
