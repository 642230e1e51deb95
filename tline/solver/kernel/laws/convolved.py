"""Laws beside a linear rest with a memory: slab by slab, as its convolution weights send their waves back.

α_k = given_k + Σ S_j β_(k-j): waves from slabs of this block are summed here, all earlier ones are part of the given
waves. S_0 acts at once, in place of the map of a circuit over a slab in Newton's method.
"""

from typing import NamedTuple

from tline.compiled.structure import Floats2, Floats3, Integers
from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.answers import exchange_states
from tline.solver.kernel.laws.circuit import found
from tline.solver.kernel.network import Run


class Convolution(NamedTuple):
    """Convolution of a linear rest at K laws, M = K s points a slab, law by law; a group holds laws coupled without
    delay."""

    run: Run
    weights: Floats3  # (slabs, M, M) S_1, S_2, …
    map_at: Integers  # (groups,) place of (1 + S_0)/2 in the network's maps
    given: Floats2  # (n, M) waves into laws, less S_0 times `rest`
    rest: Floats2  # (n, M) waves out of laws without what is sought
    sent: Floats2  # (n, M) waves out of laws beyond those
    flow: Floats2  # (n, M) through laws
    slope: Floats2  # (n, M) of it over the wave into the law; only of laws without a state
    control: Floats2  # (K, n s)


@function
def recall(job, k, begin):
    """Add to the waves given to slab k the contribution of slabs from `begin` on."""
    weights, sent, given, size = job.weights, job.sent, job.given, job.rest.shape[1]
    for j in range(begin, k):
        for a in range(size):
            total = 0.0
            for b in range(size):
                total += weights[k - j - 1, a, b] * sent[j, b]
            given[k, a] += total


@unit
def advance_convolved(job: Convolution, begin: int, end: int, h: float) -> int:
    """Advance all laws from slab `begin` to `end`. Returns -1, or the slab in which no flow was found."""
    run, laws, s = job.run, job.run.network.laws, job.run.state.before.shape[1]
    work = run.work.circuit
    for k in range(begin, end):
        recall(job, k, begin)
        for g in range(laws.first.size - 1):
            first, m = laws.first[g], laws.first[g + 1] - laws.first[g]
            work.width[0] = m * s
            for a in range(m * s):
                work.given[a] = job.given[k, first * s + a]
                work.control[a // s, a % s] = job.control[first + a // s, k * s + a % s]
            exchange_states(run, g, False)
            if not found(run, g, s, h, run.network.step, job.map_at[g], 0):
                return k
            for a in range(m * s):
                o = first * s + a
                work.waves[o], job.sent[k, o] = work.aimed[a], work.sent[a] - job.rest[k, o]
                job.flow[k, o], job.slope[k, o] = work.flow[a], work.slope[a]
    return -1
