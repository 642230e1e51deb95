"""Data structures of slabs in pieces, in addition to a network and its state.

A jump or corner of a source, or a switch that moves, is a front. A slab with fronts inside is held as pieces, each a
polynomial of degree s - 1 in Legendre coefficients; places are in slab time, 0 to 1. A slab that begins with a front is
marked as a new start: on a line with a fractional rest its start becomes a breakpoint too.
"""

from typing import Annotated, NamedTuple

from tline.compiled.structure import Flags, Floats, Floats2, Floats3, Integers, Integers2
from tline.solver.kernel.network import Run, Tools

LIVE, PEAK, MERGED, DISSOLVED, DROPPED, NOTED, DONE, LATE, FEWER = range(9)  # places in the counts
SCALE, LOST, BEGIN, END, ANEW = range(5)  # places in the sizes
SAME_MAP = -1  # row of an event that begins a piece and moves nothing
CUT = 1e300  # size of such an event; a move is larger than anything
MERGE = 1e-11  # slabs; fronts nearer than this to each other are one
CONTINUED = 1e-13  # of the largest wave; pieces that continue each other so well need no breakpoint
WIDER = 4.0  # times that each cut behind a front is farther away than the one before


class Systems(NamedTuple):
    """State spaces from Thévenin waves to efforts, by row of the network's maps: dx/dt = A x + b w, u = c x + d w."""

    at: Integers  # (rows,) place of each system's first entry
    entries: Floats  # matrices [A b; c d] of shape (n + k, n + k), one after the other
    settling_at: Integers  # (rows,) place of its map over the time in which its group settles
    settling: Floats  # maps from (Thévenin waves, state) to (efforts, next state)


class Events(NamedTuple):
    """Events at groups in order of time: switches that move, and pieces that begin where laws kink."""

    first: Integers  # (G + 1,) those of group g are first[g] to first[g + 1], in order of time
    at: Floats  # instants, in slabs
    row: Integers  # row of the map from then on, or SAME_MAP
    due: Integers  # (G,) the next one of each group


class ExcitationRows(NamedTuple):
    """Rows of the excitation that belong to each group: of its nodes, and of its elements."""

    first: Integers  # (G + 1,)
    row: Integers


class PiecesUnderWay(NamedTuple):
    """Slabs under way that are held in pieces, one a row."""

    of_slab: Integers  # (slabs in the wave buffers,) row, -1 for a slab in one piece
    before: Integers  # (2 L,) row of the slab that arrived last
    last: Annotated[Floats2, "ends s"]  # the last piece that left an end
    width: Annotated[Floats, "ends"]  # and its width; 0 if unknown
    number: Annotated[Integers, "rows"]  # of pieces
    anew: Annotated[Floats, "rows"]  # size of the front at the slab's start, 0 for none
    start: Annotated[Floats2, "rows most+1"]  # edges
    size: Annotated[Floats2, "rows most"]  # of the front at each start
    coef: Annotated[Floats3, "rows most s"]
    free: Integers  # (rows,) those behind the first LIVE are free


class Log(NamedTuple):
    """Recorded pieces."""

    where: Annotated[Integers2, "places 2"]  # row of the record, slab
    span: Annotated[Floats2, "places 2"]  # start and end in slab time
    values: Annotated[Floats3, "places 2 s"]  # arriving and leaving waves


class Steps(NamedTuple):
    """A piece in which a group settles, in several steps."""

    edges: Annotated[Floats, "steps+1"]
    ends: Floats  # (2,) of the piece
    values: Annotated[Floats3, "nodes steps s"]
    wave: Annotated[Floats, "nodes_s"]  # of one step
    out: Annotated[Floats2, "1 s"]


class Workspace(NamedTuple):
    """Workspace for the largest group, with at most m pieces."""

    place: Annotated[Floats, "fronts"]  # of the fronts that meet
    size: Floats  # of each
    edges: Annotated[Floats, "m+1"]  # of the pieces
    own: Annotated[Floats, "m+1"]  # of the pieces of one wave
    outer: Annotated[Floats, "m+1"]  # without those that only settling needs
    unsettled: Annotated[Flags, "m"]
    span: Annotated[Floats2, "given 2"]  # of a wave that is given
    given: Annotated[Floats2, "given s"]
    arrived: Annotated[Floats3, "ends m s"]
    u: Annotated[Floats3, "nodes m s"]
    control: Annotated[Floats3, "elements m s"]  # control signals
    into: Annotated[Floats3, "elements m s"]  # waves into laws, or drives of stores
    coef: Annotated[Floats2, "m+1 s"]
    whole: Annotated[Floats, "s"]
    part: Annotated[Floats, "s"]
    stages: Annotated[Floats2, "stages columns"]  # states * s, and columns of their equations
    steps: Steps
    left: Annotated[Floats3, "ends m s"]  # waves that leave half diamonds
    pair_edges: Annotated[Floats2, "2 given+1"]  # of two slabs that meet in a diamond
    pair: Annotated[Floats3, "2 given s"]  # of these


class Fronts(NamedTuple):
    """Data of slabs in pieces."""

    lull: int  # slabs without a front after which to go back to blocks
    most: int  # pieces of a slab under way
    at_node: int
    step: float  # slab width h
    fractional: int  # whether a front at the start of a slab needs to be followed
    settle: Floats  # (G,) slabs that a group with lumped lines takes to settle after a front, else 0
    settled: Floats  # (G,) instant at which it will have, in slabs; one slab after a front where cuts are graded
    graded: Flags  # (G,) whether slabs are cut behind fronts ever farther away, for what decays there at any rate
    nearest: float  # slabs from a front to the first of these cuts
    same: float  # of the largest wave; pieces that continue each other so well need no breakpoint
    rest: Floats  # (L,) fractional rest of each delay
    tools: Tools
    systems: Systems
    events: Events
    excitations: ExcitationRows
    pieces: PiecesUnderWay
    work: Workspace
    log: Log
    counts: Integers  # (9,) the last is of a slab: pieces without those that only settling needs
    sizes: (
        Floats  # (5,) largest wave so far, largest front dropped, the piece in which no flow was found, and of a slab
    )
    # the front at its start


class Sources(NamedTuple):
    """The sources' parts of the Thévenin waves in slabs that hold fronts of theirs."""

    first: Integers  # (rows + 1,) the slabs of excitation row k are first[k] to first[k + 1]
    due: Integers  # (rows,) the next one of each
    slab: Integers
    anew: Flags  # whether it begins with a front
    begin: Integers  # (slabs + 1,) its pieces
    start: Floats
    stop: Floats
    coef: Floats2  # (pieces, s)


class FrontRun(NamedTuple):
    """Data of a loop over slabs in pieces."""

    run: Run
    fronts: Fronts
    sources: Sources
