"""Scene as arrays, written by the assembly and read by the kernel: without names and units.

A line end is numbered 2 * line (end 1) or 2 * line + 1 (end 2). Each line owns two buffers of ``delay`` slabs; a slab
is s samples. An end reads the wave that arrives and writes the one it sends back into the same place, in one buffer;
each time a line's slot wraps, its ends change buffers. So every buffer slot is consumed and refilled exactly once per
delay, and nothing is ever copied along a line.

Nodes coupled without delay, through a state space, form a group. A node alone is one too.

The two buffers of a line are one ring of twice its delay D: in slab t end 1 works at place t, end 2 at t + D. Waves p
slabs from end 1 in slab t are found at t - p (from end 1) and t + p (from end 2). Losses act there, in place.
"""

from typing import Annotated, NamedTuple

from tline.compiled.structure import Flags, Floats, Floats2, Floats3, Floats4, Integers, Integers2

SQUARE, POWER, SWAMEE_JAIN, TABULATED = range(4)  # kinds of friction along a line
CELL_ORDER = 2  # at most: the friction of cells in place of half diamonds is of second order in any case
PARTS = 8  # of a wave in a cell, between jumps; beyond that jumps are projected


class Tools(NamedTuple):
    """Matrices of the basis."""

    c: Floats  # (s,)
    to_points: Floats2  # (s, s)
    to_legendre: Floats2  # (s, s)
    radau: Floats2  # (s, s)
    gauss: Floats2  # (2, s) nodes and weights on [0, 1]


class Laws(NamedTuple):
    """Elements whose flow is no linear function of the effort across them; E elements, by group."""

    first: Integers  # (G + 1,) those of group g are first[g] to first[g + 1]
    kind: Integers  # (E,)
    states: Integers  # (E,) number of states
    from_node: Integers  # (E,) node of the group from which its flow counts, -1 for the reference
    to_node: Integers  # (E,) node to which it counts
    excitation_row: Integers  # (E,) row of its control signal, -1 where that is constant
    control: Floats  # (E,) control signal where it is constant
    at: Integers  # (E,) place of its first constant
    constants: Floats
    state_at: Integers  # (E,) place of its state, -1 for none
    governor: Integers  # (E,) place of the constants of the governor of its opening, -1 for none
    governor_state: Integers  # (E,) place of its opening, rate of the opening, and least flow so far
    governed: Flags  # (G,) whether a group has such elements
    source_impedance: Floats  # (E,) behind which each is seen, > 0
    before: Floats  # (E,) wave e + ρ i into it before t = 0
    impedance: Floats  # (N,) Thévenin impedance of each node beside branches, 0 if its effort is held
    pocket: Flags  # (N,) whether elements alone determine its effort
    pockets: Flags  # (G,) whether a group has such nodes
    effort: Floats  # (N,) before t = 0
    record_row: Integers  # (E,) row in the record of the wave e + ρ i into it, or of what drives a store; -1 for none
    tools: Tools
    step: float  # slab width, s


class Memory(NamedTuple):
    """Memory and leakage of lines in cells: the same circuit in each column of cells, one above the other in time.

    Its input is w = a + sign b: a - b for the flow through a series impedance, a + b for the effort over a shunt.
    Its output e is subtracted: a becomes a - e, b becomes b - sign e.
    """

    first: Integers  # (rows of diamonds + 1,) those of row r are first[r] to first[r + 1]
    sign: Floats  # (circuits,) -1 in series, 1 across
    modes: Integers  # (circuits,)
    at: Integers2  # (circuits, 2) place of a circuit's maps: inside, and for the first and the last column
    maps: Floats  # D (r, r), C (r, modes), B (modes, r), decay (modes,) of e = D w + C x, x' = B w + decay x
    state_at: Integers  # (circuits,) place of its states, shape (columns, modes)
    rest: Floats2  # (rows of diamonds, 2) share left by cells, as in `at`, of the difference of waves from polynomials
    states: int  # of all


class Diamonds(NamedTuple):
    """Lines that lose all along, advanced slab by slab in diamonds; K modes on a triangle, M points in it."""

    line: Integers  # (rows,)
    row: Integers  # (L,) of a line with half diamonds, or -1
    at_group: Flags  # (G,) whether such a line ends there
    rest: Floats  # (rows,) fractional rest of the delay
    kind: Integers  # (rows,)
    constants: Floats2  # (rows, 5) r, k, c, n or ρ, and roughness: see `tline.solver.kernel.diamonds.full`
    tables: Floats
    table_at: Integers  # (rows,) place of a row's table
    tools: Tools  # of the order of friction, that of waves or a low one in cells: r
    weight: Floats  # (s,) of the points of a slab
    sent: Floats2  # (K, s) modes of the sent wave, over the triangle
    seen: Floats2  # (K, s) of the arriving one
    inside: Floats2  # (K, K) by which modes of friction lower those of the flow
    values: Floats2  # (M, K) of modes at the points
    moments: Floats2  # (K, M) modes of values at the points
    gained: Floats3  # (2, s, K) gain of the arriving wave by friction, at the points, and projected
    left: Floats3  # (2, s, K) loss of the leaving one
    ends: Floats4  # (rows of shift, 2, s, s) a rest of a slab in the next one, and the rest of a slab
    exact: float  # of the largest wave: changes that end an iteration
    cell: Integers  # (rows,) slabs of each wave in a cell of friction, or 0: diamonds of a slab, and half ones at nodes
    over: Floats  # (rows,) slabs of the delay that whole cells leave
    begin: Floats  # (s,) of a polynomial's values at the points, its value where its slab begins
    jump: float  # of the largest wave of a cell: jumps between slabs that are to part it
    steady: Floats2  # (rows, 4) beside cells, before t = 0: a - b and a + b as sent, then d, and its friction
    memory: Memory


class Blocks(NamedTuple):
    """Numbers of slabs that groups and lines are advanced at once."""

    stride: int  # of those that are far from short lines
    step: int  # of the others, meanwhile
    far_groups: Integers
    near_groups: Integers
    far_lines: Integers  # in which nothing arrives within a stride
    near_lines: Integers
    far_cells: Integers  # rows of diamonds
    near_cells: Integers
    waits: Flags  # (L,) whether a line is far


class Network(NamedTuple):
    """The constant arrays of a scene; L lines, N nodes, s points per slab."""

    delay: Integers  # (L,) whole slabs of a line's delay, >= 1
    offset: Integers  # (L,) first sample of a line's two buffers
    shift_row: Integers  # (L,) row in shift for the fractional rest of the delay, -1 if there is none
    shift: Floats4  # (rows, 2, s, s) matrices that act on the slab arriving now and on the one before it
    first: Integers  # (N + 1,) the ends at node k are ends[first[k]:first[k + 1]]; a group's nodes need not have any
    ends: Integers  # (2 L,)
    weight: Floats  # (2 L,) share of an arriving wave in the node's Thévenin wave
    excitation_row: Integers  # (N,) row of the source's part of that wave, -1 for none
    group: Integers  # (G + 1,) nodes group[g] to group[g + 1] are advanced together; most groups have one
    load_at: Integers  # (G,) place of the group's first state, -1 for one without a map
    step_row: Integers  # (G,) row of the group's map over a slab; switches that move rewrite it
    step_at: Integers  # (rows,) place of a map in step
    step_states: Integers  # (rows,) its number of states n
    step_whole: Flags  # (rows,) whether it sees q = s points of a slab at once, or q = 1, one after the other
    step: Floats  # maps (p q + n)² from (waves of p nodes and laws, state) to (p efforts, next state)
    record_row: Integers  # (2 L,) row in the record of an end, -1 if it is not recorded
    effort_row: Integers  # (N,) row in the record of a node's effort, or -1
    laws: Laws
    passed: Floats  # (L,) share of a wave that arrives, of lines that only delay and attenuate; else 1
    moved: Floats  # (2 L,) gain of a wave by a steady flow on its way to an end: beside cells only its changes count
    diamonds: Diamonds
    blocks: Blocks


class State(NamedTuple):
    """State of a run: waves under way, and states of loads."""

    waves: Floats  # (samples,) all buffers
    slot: Integers  # (L,) slab of the buffers that is due
    side: Integers  # (L,) 0: end 1 uses the first buffer and end 2 the second; 1: the other way round
    before: Floats2  # (2 L, s) the slab that arrived last, as sent; used where delays have a fractional rest
    load: Floats  # of all groups, one after the other
    memory: Floats  # of all circuits in cells
    halves: Floats2  # (2 L, M) friction loss at the points of the half diamonds at line ends
    since: Integers  # (rows of diamonds,) slabs since the cells of a line were advanced


class Units(NamedTuple):
    """Addresses of the compiled units that a network needs beside the loop; 0 where it has no use for one."""

    advance: int  # blocks of slabs
    scatter: int  # a group in a block
    laws: int  # groups with laws in a block
    delay: int  # fractional rests of delays
    crossing: int  # groups with one law and nothing else
    circuit: int  # other groups with laws
    hold: int  # efforts in them that nothing determines
    govern: int  # groups whose elements move their openings themselves
    law: Integers  # (E,) of each element: its law, or its store
    diamonds: int  # lines that lose all along
    halves: int  # groups at which such lines end
    settle: int  # friction at these groups, with the waves that they send
    answer: int  # the efforts there
    diamonds_in_pieces: int  # the same where slabs are in pieces
    halves_in_pieces: int
    answer_in_piece: int
    constants: int  # the same lines where waves are constants
    rectangle: int  # a part of a diamond
    remember: int  # the circuits of a cell
    pieces: int  # a group in a slab in pieces
    arrive: int  # the wave that arrives there
    depart: int  # the wave that leaves
    respond: int  # groups with a map and without laws, in pieces of a slab
    respond_with_laws: int  # groups with both


class Crossing(NamedTuple):
    """Input and output of an element's law at n samples."""

    constants: Floats  # of all elements
    v: Annotated[Floats, "n"]  # effort of the Thévenin source
    control: Annotated[Floats, "n"]  # control signal
    flow: Annotated[Floats, "n"]  # its flow i
    slope: Annotated[Floats, "n"]  # di/dv


DIVIDED, MISSES, SPENT = range(3)  # places in the division of a store


class Store(NamedTuple):
    """Input, output and workspace of an element's store at the s points of a slab."""

    constants: Floats  # of all elements
    states: Floats  # of all groups
    tools: Tools
    v: Annotated[Floats, "s"]  # effort of the Thévenin source
    control: Annotated[Floats, "s"]
    flow: Annotated[Floats, "s"]  # into the store; nan at the last point if none was found
    drive: Annotated[Floats, "s"]  # driving effort, in excess of that of the store
    y: Annotated[Floats, "s"]
    slope: Annotated[Floats, "s"]  # dX/dy
    rate: Annotated[Floats, "s"]  # dX/dt
    first: Annotated[Floats, "s"]
    safe: Annotated[Floats, "s"]
    rest: Annotated[Floats, "s"]
    system: Annotated[Floats2, "s s+1"]
    coef: Annotated[Floats, "s"]  # Legendre coefficients, as the next three
    piece: Annotated[Floats, "s"]
    kept: Annotated[Floats, "s"]
    whole: Annotated[Floats, "s"]
    integral: Annotated[Floats, "s+1"]
    constant: Annotated[Floats, "1"]
    division: Annotated[Integers, "3"]  # whether slabs are divided where a step is too long, one was, and parts tried


class CircuitWork(NamedTuple):
    """Workspace of a circuit with laws; M coupled points, law by law."""

    given: Annotated[Floats, "M"]  # waves that nodes and states send to laws
    aimed: Annotated[Floats, "M"]  # waves into laws
    start: Annotated[Floats, "M"]
    safe: Annotated[Floats, "M"]  # last waves on the path
    trial: Annotated[Floats, "M"]
    sent: Annotated[Floats, "M"]  # waves out of them
    flow: Annotated[Floats, "M"]
    other: Annotated[Floats, "M"]
    slope: Annotated[Floats, "M"]  # of flows without a state over waves
    drive: Annotated[Floats, "M"]  # of stores
    rest: Annotated[Floats, "M"]
    answer: Annotated[Floats2, "M s"]
    system: Annotated[Floats2, "M M+1"]
    control: Annotated[Floats2, "elements s"]
    kept: Annotated[Floats2, "elements kept"]  # states
    waves: Floats  # (E s,) last waves into all elements, with which the next search begins
    held: Floats  # (N,) last efforts
    part: Annotated[Integers, "nodes"]  # of the group that a pocket joins, by its first
    width: Annotated[Integers, "1"]  # of the map
    largest: Annotated[Floats, "1"]  # wave of the whole run, or 0 where it is not known


class GovernWork(NamedTuple):
    """Workspace of openings that move; M points of a group's elements, law by law."""

    u: Annotated[Floats, "nodes_s"]  # Thévenin waves of the group
    kept: Annotated[Floats, "all"]  # states of the group
    rate: Annotated[Floats, "M"]  # of openings
    rest: Annotated[Floats, "M"]  # excess of the rate over that to which it leads
    last: Annotated[Floats, "M"]  # the same before
    step: Annotated[Floats, "M"]
    turned: Annotated[Floats, "M"]
    inverse: Annotated[Floats2, "M M"]  # of how the rest answers to rates, about


class DiamondWork(NamedTuple):
    """Workspace of diamonds, and of their halves at the E ends of a group."""

    taken: Annotated[Floats2, "r r"]  # by friction
    along: Annotated[Floats2, "r r"]  # the flow that this leaves
    base: Annotated[Floats2, "r r"]  # the flow at which the next two are
    value: Annotated[Floats2, "r r"]  # of friction
    slope: Annotated[Floats2, "r r"]
    weight: Floats2  # (r, r) times that friction counts
    edges: Annotated[Floats2, "2 parts+1"]  # of the parts of two waves in a cell
    parts: Annotated[Floats3, "4 parts r"]  # of these, and their coefficients before they meet
    slabs: Annotated[Floats2, "2 k_s"]  # of these waves
    rest: Floats  # (1,) share of a wave in a cell that is left beside its polynomial
    cells: Floats2  # (4, cells along a line) waves, times that friction counts, and turns of the flow, of constants
    shape: Annotated[Floats2, "r k_s"]  # Legendre polynomials over a part
    shaped: Annotated[Integers, "1"]  # slabs of that
    tangent: Annotated[Floats3, "3 E M"]  # the same three of half diamonds
    a: Annotated[Floats, "r"]  # a wave in a part of a diamond, or in a cell
    b: Annotated[Floats, "r"]
    coming: Annotated[Floats2, "E s"]  # arriving wave without friction in the triangle
    arrived: Annotated[Floats2, "E s"]  # the same with friction
    tail: Annotated[Floats2, "E s"]  # the rest of a slab
    seen: Annotated[Floats2, "E K"]
    modes: Annotated[Floats2, "E K"]  # of friction
    flow: Annotated[Floats, "K"]
    sent: Annotated[Floats, "s"]
    kept: Annotated[Floats, "all"]  # states of the group
    width: Floats  # (1,) of the piece of a slab
    projected: Annotated[Integers, "E"]  # whether the wave that leaves a half diamond is projected


class Work(NamedTuple):
    """Workspace of a loop, made once for all slabs."""

    tile: int  # slabs that a group is advanced at once, at most
    position: Annotated[Integers, "ends"]  # first sample at which each line end works
    u: Annotated[Floats, "nodes_s"]  # Thévenin waves of a group's nodes, then their efforts, for a tile
    history: Annotated[Floats2, "s tile+1"]
    row: Annotated[Floats, "row"]
    control: Annotated[Floats2, "elements tile_s"]
    into: Annotated[Floats2, "elements tile_s"]  # waves into laws, or drives of stores
    crossing: Crossing
    store: Store
    circuit: CircuitWork
    govern: GovernWork
    map: Annotated[Floats, "map"]  # of a circuit over a piece of a slab
    diamonds: DiamondWork


class Run(NamedTuple):
    """Data of a loop."""

    network: Network
    state: State
    units: Units
    work: Work
    excitation: Floats2  # (rows, samples) shares of the sources in Thévenin waves, and control signals
    record: Floats3  # (rows, 2, samples) waves that arrived at recorded ends, and that left
