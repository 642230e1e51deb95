"""Efforts from the Thévenin waves at a group with laws, by the unit that the group needs; flows of laws each alone."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Integers
from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.network import Crossing, Run


@function
def pass_laws(run, g, n, h, own):
    """Turn the waves of n samples into efforts; slabs, or pieces, are h wide, with an `own` map or not."""
    if run.network.laws.governed[g]:
        invoke(run.units.govern, (run, g, n, h, own))
    elif run.network.load_at[g] >= 0:
        invoke(run.units.circuit, (run, g, n, h, own))
    else:
        invoke(run.units.crossing, (run, g, n, h))


@function
def note_states(run, e, column):
    """Keep the first state of an element, or its opening that moves by itself, and its last one; zeros without."""
    laws, states, row = run.network.laws, run.state.load, run.network.laws.record_row[e]
    at = laws.state_at[e] if laws.state_at[e] >= 0 else laws.governor_state[e]
    run.record[row, 1, column] = states[at] if at >= 0 else 0.0
    run.record[row + 1, 1, column] = states[at + max(laws.states[e], 1) - 1] if at >= 0 else 0.0


@function
def is_watched(laws, g):
    """Whether the record keeps a state of a group, so that it is to be advanced slab by slab."""
    for e in range(laws.first[g], laws.first[g + 1]):
        if laws.record_row[e] >= 0 and max(laws.state_at[e], laws.governor_state[e]) >= 0:
            return True
    return False


@function
def note_laws(run, g, n, column):
    """Keep the waves into laws, and beside them the states in which these leave them."""
    laws, record, into = run.network.laws, run.record, run.work.into
    for e in range(laws.first[g], laws.first[g + 1]):
        row, k = laws.record_row[e], e - laws.first[g]
        for i in range(n if row >= 0 else 0):
            record[row, 0, column + i] = into[k, i]
            note_states(run, e, column + i)


@function
def control(run, g, start, n):
    """Gather the control signals of a group's elements at n samples."""
    laws, excitation, signal = run.network.laws, run.excitation, run.work.control
    for k in range(laws.first[g + 1] - laws.first[g]):
        e = laws.first[g] + k
        row = laws.excitation_row[e]
        for i in range(n):
            signal[k, i] = excitation[row, start + i] if row >= 0 else laws.control[e]


@unit
def pass_block(run: Run, g: int, here: int, n: int, column: int) -> int:
    """Turn the Thévenin waves of n samples of slabs into efforts, from sample `here` of the excitation on."""
    control(run, g, here, n)
    pass_laws(run, g, n, run.network.laws.step, np.int64(0))
    note_laws(run, g, n, column + here)
    return 0


class Through(NamedTuple):
    """E elements, each behind an effort v and an impedance z; flow and slope are the results."""

    law: Integers  # (E,) addresses of their units
    at: Integers  # (E,) places of their constants
    control: Floats  # (E,)
    v: Floats
    z: Floats
    flow: Floats
    slope: Floats
    crossing: Crossing


@unit
def through(elements: Through) -> int:
    """Flow through each element without a state, and its slope."""
    crossing, law, at, z = elements.crossing, elements.law, elements.at, elements.z
    for e in range(law.size):
        crossing.v[0], crossing.control[0] = elements.v[e], elements.control[e]
        invoke(law[e], (crossing, at[e], np.int64(1), z[e]))
        elements.flow[e], elements.slope[e] = crossing.flow[0], crossing.slope[0]
    return 0
