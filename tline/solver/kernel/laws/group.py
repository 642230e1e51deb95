"""Several elements that see each other: Newton's method finds all flows at once, instant by instant."""

import numpy as np

from tline.solver.kernel.arithmetic import eliminate, left_of
from tline.solver.kernel.network import Run
from tline.solver.kernel.newton import CLOSE, FAINT, FARTHEST, LEAST_STRIDE, SPARE, TRIES
from tline.unit import function, invoke, unit


@function
def unbalance(run, g, u, stride, q):
    """Residuals of a group at sample q, and a scale; x has what elements see behind their impedances, then efforts.

    At nodes where nothing else conducts, u is the flow that is driven in, and x the effort.
    """
    laws, crossing, newton, low = run.network.laws, run.work.crossing, run.work.newton, run.network.group[g]
    x, level, flow, slope = newton.x, newton.level, newton.flow, newton.slope
    rest, taken, control, law = newton.rest, newton.taken, run.work.control, run.units.law
    first, n, scale = laws.first[g], laws.first[g + 1] - laws.first[g], 0.0
    nodes = run.network.group[g + 1] - low
    for p in range(nodes):
        taken[p] = 0.0
    for k in range(n):
        e = first + k
        crossing.v[0], crossing.control[0] = x[k], control[k, q]
        invoke(law[e], (crossing, laws.at[e], np.int64(1), laws.source_impedance[e]))
        flow[k], slope[k] = crossing.flow[0], crossing.slope[0]
        if laws.from_node[e] >= 0:
            taken[laws.from_node[e]] += flow[k]
        if laws.to_node[e] >= 0:
            taken[laws.to_node[e]] -= flow[k]
    for p in range(nodes):
        z = laws.impedance[low + p]
        if z >= 0.0:
            level[p], rest[n + p] = u[p * stride + q] - z * taken[p], 0.0
            scale = max(scale, abs(u[p * stride + q]), abs(z * taken[p]))
        else:
            level[p], rest[n + p] = x[n + p], laws.source_impedance[first] * (taken[p] - u[p * stride + q])
    for k in range(n):
        e = first + k
        rest[k] = x[k] - laws.source_impedance[e] * flow[k]
        if laws.from_node[e] >= 0:
            rest[k] -= level[laws.from_node[e]]
        if laws.to_node[e] >= 0:
            rest[k] += level[laws.to_node[e]]
        scale = max(scale, abs(x[k]), abs(laws.source_impedance[e] * flow[k]))
    return scale


@function
def response(run, g, size):
    """The linear system of a Newton step: laws first, then what flows into nodes where nothing else conducts."""
    laws, low, nodes = run.network.laws, run.network.group[g], run.network.group[g + 1] - run.network.group[g]
    slope, rest, system = run.work.newton.slope, run.work.newton.rest, run.work.newton.system
    first, count = laws.first[g], laws.first[g + 1] - laws.first[g]
    for i in range(size):
        for j in range(size):
            system[i, j] = 0.0
        system[i, size] = rest[i]
    for k in range(count):
        system[k, k] = max(1.0 - laws.source_impedance[first + k] * slope[k], FAINT)
    for k in range(count):  # what the flow of element k does to each other
        for end, sign in ((laws.from_node[first + k], 1.0), (laws.to_node[first + k], -1.0)):
            if end < 0:
                continue
            z = laws.impedance[low + end]
            if z < 0.0:
                system[count + end, k] += laws.source_impedance[first] * sign * slope[k]
                system[k, count + end] -= sign
            else:
                for f in range(count):
                    if laws.from_node[first + f] == end:
                        system[f, k] += sign * z * slope[k]
                    if laws.to_node[first + f] == end:
                        system[f, k] -= sign * z * slope[k]
    for p in range(nodes):
        if laws.impedance[low + p] >= 0.0:
            system[count + p, count + p], system[count + p, size] = 1.0, 0.0
        else:
            system[count + p, count + p] += FAINT


@function
def solved(run, g, u, stride, q, aim, size):
    """Newton's method at sample q for 1 - aim of the first residuals. Returns whether it ended at a solution."""
    newton, before, share = run.work.newton, np.inf, 1.0
    x, system = newton.x, newton.system
    for _ in range(TRIES):
        scale = unbalance(run, g, u, stride, q)
        now = left_of(newton.rest, newton.aimed, aim, size)
        if now <= SPARE * scale or (now <= CLOSE * scale and now >= 0.5 * before):
            return True
        if not np.isfinite(now):
            return False
        share = min(1.0, 2.0 * share) if now < before else 0.5 * share
        before = now
        response(run, g, size)
        eliminate(system, size)
        reach = scale
        for i in range(size):
            reach = max(reach, abs(system[i, size]))
        for i in range(size):
            x[i] -= min(share, FARTHEST * scale / reach) * system[i, size]
    return False


@unit
def group(run: Run, g: int, n: int, stride: int) -> int:
    """Turn the Thévenin waves of n samples at a group's nodes, each in a row of that stride, into efforts.

    The laws are monotone, so that residuals and unknowns determine each other (a homeomorphism). Where Newton's full
    steps fail, the residual is led from its first value to zero in smaller parts, which must succeed.
    """
    newton, u = run.work.newton, run.work.u
    nodes = run.network.group[g + 1] - run.network.group[g]
    size = run.network.laws.first[g + 1] - run.network.laws.first[g] + nodes
    x, safe, aimed, level = newton.x, newton.safe, newton.aimed, newton.level
    for i in range(size):
        x[i], safe[i] = 0.0, 0.0
    for q in range(n):
        unbalance(run, g, u, stride, q)
        for i in range(size):
            aimed[i] = newton.rest[i]
        done, part = 0.0, 1.0
        while done < 1.0 and part > LEAST_STRIDE:
            aim = min(done + part, 1.0)
            if solved(run, g, u, stride, q, aim, size):
                done, part = aim, 2.0 * part
                for i in range(size):
                    safe[i] = x[i]
            else:
                part *= 0.25
                for i in range(size):
                    x[i] = safe[i]
        for p in range(nodes):
            u[p * stride + q] = level[p] if done == 1.0 else np.nan
    return 0
