"""Efforts of a group in the pieces of one slab."""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.fronts.advance import happen_until
from tline.solver.kernel.fronts.settle import collocate, collocate_finely, map_of
from tline.solver.kernel.fronts.structures import BEGIN, END, MERGE, FrontRun
from tline.solver.kernel.laws.passing import pass_laws
from tline.solver.kernel.scatter import load


@unit
def respond_by_map(job: FrontRun, g: int, piece: int, m: int) -> int:
    """Turn the Thévenin waves of a piece at a group with a map into efforts; the piece is the slab if m is 1."""
    run, fronts = job.run, job.fronts
    network, systems, wave, s = run.network, fronts.systems, run.work.u, fronts.tools.c.size
    edges, x, k, r = fronts.work.edges, network.load_at[g], network.group[g + 1] - network.group[g], network.step_row[g]
    n, width = network.step_states[r], edges[piece + 1] - edges[piece]
    states = run.state.load[x : x + n]
    if m == 1 or n == 0:
        load(run, g, s, network.step, network.step_at[r])
    elif not fronts.work.unsettled[piece]:
        collocate(fronts, systems.at[r], k, fronts.step * width, wave, states, run.work.row)
    elif abs(width - fronts.settle[g]) < MERGE:
        load(run, g, s, systems.settling, systems.settling_at[r])
    else:
        collocate_finely(run, fronts, systems.at[r], k, width, fronts.settle[g], states)
    return 0


@unit
def respond_with_laws(job: FrontRun, g: int, piece: int, m: int) -> int:
    """Respond at a group with a map and laws."""
    run, fronts = job.run, job.fronts
    network, edges, r = run.network, fronts.work.edges, run.network.step_row[g]
    n, h = network.step_states[r], fronts.step * (edges[piece + 1] - edges[piece])
    ports = network.group[g + 1] - network.group[g] + network.laws.first[g + 1] - network.laws.first[g]
    own = n > 0 and m > 1
    if own:
        map_of(fronts, fronts.systems.at[r], ports, n, h, run.work.map)
    pass_laws(run, g, fronts.tools.c.size, h, np.int64(own))
    return 0


@function
def respond_piece(job, g, piece, m):
    """Turn the Thévenin waves of one of m pieces at a group, in the workspace of slabs, into the nodes' efforts."""
    run, fronts = job.run, job.fronts
    network, edges, s = run.network, fronts.work.edges, fronts.tools.c.size
    count = network.laws.first[g + 1] - network.laws.first[g]
    for e in range(count):
        for i in range(s):
            run.work.control[e, i] = fronts.work.control[e, piece, i]
    if network.load_at[g] < 0 and count > 0:
        width = fronts.step * (edges[piece + 1] - edges[piece])
        pass_laws(run, np.int64(g), s, width, np.int64(0))
    elif count > 0:
        invoke(run.units.respond_with_laws, (job, np.int64(g), np.int64(piece), m))
    elif network.load_at[g] >= 0:
        invoke(run.units.respond, (job, np.int64(g), np.int64(piece), m))
    for e in range(count):
        for i in range(s):
            fronts.work.into[e, piece, i] = run.work.into[e, i]


@function
def respond(job, g, slab, m):
    """Turn the Thévenin waves of m pieces at a group into the nodes' efforts; switches move where pieces begin.

    A piece for which no flow is found ends it, and is kept in mind.
    """
    run, fronts = job.run, job.fronts
    network, s, wave = run.network, fronts.tools.c.size, run.work.u
    edges, u, k = fronts.work.edges, fronts.work.u, network.group[g + 1] - network.group[g]
    for piece in range(m):
        happen_until(network, fronts.events, fronts.counts, g, slab + edges[piece])
        for p in range(k):
            for i in range(s):
                wave[p * s + i] = u[p, piece, i]
        respond_piece(job, g, piece, m)
        for p in range(k):
            for i in range(s):
                u[p, piece, i] = wave[p * s + i]
        if not np.isfinite(wave[s - 1]):
            fronts.sizes[BEGIN], fronts.sizes[END] = edges[piece], edges[piece + 1]
            return
