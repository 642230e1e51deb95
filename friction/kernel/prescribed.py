"""Deflection of bristles under a given velocity, from reversal to reversal, by Radau IIA collocation of order 9."""

from math import sin
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre

from friction.kernel.law import BUDGET, DONE, STALLED, TANH, Law, respond, slip_share, steady
from tline.compiled.structure import Floats, Floats2, Integers
from tline.compiled.unit import function, unit

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


SAFETY, ORDER = 0.9, STAGES + 1  # of the dense output's local error
SHORTEST = 1e-14  # of the time of an interval's end


class Course(NamedTuple):
    """Velocity over time: cubics in the time since their start, and a sine; intervals of constant sign."""

    start: Floats  # (pieces,)
    cubic: Floats2  # (pieces, 4) rising powers
    amplitude: float
    omega: float
    phase: float
    edges: Floats  # (n + 1,)
    piece: Integers  # (n,)
    sign: Integers  # (n,)


class PrescribedRun(NamedTuple):
    """Law under a prescribed motion, and the workspace of its steps."""

    law: Law
    course: Course
    z0: float
    allowed: float  # error of a step, m
    times: Floats
    velocity: Floats  # there
    out: Floats2  # (times, 2) z and F_f
    steps: Integers  # (1,)
    z: Floats
    v: Floats
    g: Floats
    f: Floats
    matrix: Floats2


def prescribed_run(
    law: Law, course: Course, z0: float, allowed: float, times: Floats, velocity: Floats
) -> PrescribedRun:
    """Make a run with samples at `times`."""
    out, steps, v = np.zeros((times.size, 2)), np.zeros(1, np.int64), np.zeros(STAGES + 2)
    more = np.zeros(STAGES + 1), v, np.zeros_like(v), np.zeros(STAGES), np.zeros((STAGES, STAGES + 1))
    return PrescribedRun(law, course, z0, allowed, times, velocity, out, steps, *more)


@function
def velocity_at(course, piece, t):
    """The velocity while a piece lasts."""
    cubic, since = course.cubic, t - course.start[piece]
    v = cubic[piece, 0] + since * (cubic[piece, 1] + since * (cubic[piece, 2] + since * cubic[piece, 3]))
    if course.amplitude != 0.0:
        v += course.amplitude * sin(course.omega * t + course.phase)
    return v


@unit
def deflect(run: PrescribedRun, budget: int) -> int:
    """Deflection and friction at all samples; returns the status."""
    law, course, times, out, z, v = run.law, run.course, run.times, run.out, run.z, run.v
    row, h, status = 0, course.edges[course.edges.size - 1], DONE
    z[0] = run.z0
    for n in range(course.sign.size if law.kind != TANH else 0):
        t, end, s, piece = course.edges[n], course.edges[n + 1], course.sign[n], course.piece[n]
        while row < times.size and times[row] <= t:
            out[row, 0] = z[0]
            row += 1
        while t < end and s != 0:
            if run.steps[0] >= budget:
                return BUDGET
            run.steps[0] += 1
            last = h >= 0.999 * (end - t)
            step = end - t if last else h
            for i in range(STAGES + 1):
                v[i] = velocity_at(course, piece, t + NODES[i] * step)
            v[STAGES + 1] = velocity_at(course, piece, t + CHECKS[1] * step)
            error = radau(law, s, step, run)
            factor = (
                0.25 if error < 0.0 else min(5.0, max(0.2, SAFETY * (run.allowed / (error + 1e-300)) ** (1.0 / ORDER)))
            )
            if error < 0.0 or error > run.allowed:
                h = factor * step
                if h < SHORTEST * end:
                    return STALLED
                continue
            while row < times.size and times[row] <= t + step:
                out[row, 0] = dense(z, (times[row] - t) / step)
                row += 1
            h = max(h, factor * step) if last else factor * step
            t, z[0] = end if last else t + step, z[STAGES]
    for i in range(times.size):
        if i >= row and law.kind != TANH:
            out[i, 0] = z[0]
        out[i, 1] = respond(law, 1.0 if run.velocity[i] >= 0.0 else -1.0, run.velocity[i], out[i, 0])[0]
    return status
