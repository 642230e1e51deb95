"""Where fronts are no longer followed: slabs in pieces are projected on whole slabs."""

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, times
from tline.solver.kernel.fronts.send import release
from tline.solver.kernel.fronts.structures import DROPPED, LOST, FrontRun
from tline.solver.kernel.losses.passing import passing
from tline.solver.kernel.polynomials import project


@function
def collapse(pieces, row, tools, counts, sizes, whole):
    """Project a slab in pieces on the whole slab, and give its row back. Counts what that loses."""
    clear(whole)
    for j in range(pieces.number[row]):
        a, b = pieces.start[row, j], pieces.start[row, j + 1]
        project(pieces.coef[row, j], a, b, 0.0, 1.0, tools.gauss, whole)
        if j > 0:
            counts[DROPPED] += 1
            sizes[LOST] = max(sizes[LOST], pieces.size[row, j])
    release(pieces, row, counts)


@function
def attenuate(pieces, row, share):
    """Leave a share of a slab in pieces."""
    pieces.anew[row] *= share
    for j in range(pieces.number[row]):
        pieces.size[row, j] *= share
        for i in range(pieces.coef.shape[2]):
            pieces.coef[row, j, i] *= share


@unit
def collapse_at_losses(job: FrontRun) -> int:
    """Attenuate slabs in pieces that pass loss elements, where that is all; else project them on slabs in one piece."""
    fronts, network, state, losses = job.fronts, job.run.network, job.run.state, job.run.network.losses
    pieces, tools, counts, sizes, whole = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes, fronts.work.whole
    waves, s = state.waves, whole.size
    for r in range(losses.line.size):
        line = losses.line[r]
        ring = 2 * network.delay[line]
        t = state.side[line] * network.delay[line] + state.slot[line]
        for k in range(losses.first[r], losses.first[r + 1]):
            for slab in passing(t, losses.place[k], ring):
                o = network.offset[line] + slab * s
                row = pieces.of_slab[o // s]
                if row >= 0 and losses.passed[r] > 0.0:
                    attenuate(pieces, row, losses.passed[r])
                elif row >= 0:
                    counts[DROPPED] += pieces.anew[row] > 0.0
                    sizes[LOST] = max(sizes[LOST], pieces.anew[row])
                    collapse(pieces, row, tools, counts, sizes, whole)
                    times(tools.to_points, whole, 0, waves[o : o + s])
                    pieces.of_slab[o // s] = -1
    return 0
