"""Deflection of bristles under a prescribed velocity, from reversal to reversal."""

from math import sin
from typing import NamedTuple

import numpy as np

from friction.kernel.law import BUDGET, DONE, STALLED, TANH, Law, respond
from friction.kernel.radau import CHECKS, NODES, STAGES, dense, radau
from tline.compiled.structure import Floats, Floats2, Integers
from tline.compiled.unit import function, unit

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
