"""What happens at a group, in order of time: what is due at an instant happens there, or counts as late."""

from tline.compiled.unit import function
from tline.solver.kernel.fronts.structures import LATE, MERGE, SAME_MAP


@function
def happen(network, events, g):
    """Let the next event of a group happen."""
    row = events.row[events.due[g]]
    if row != SAME_MAP:
        network.step_row[g] = row
    events.due[g] += 1


@function
def happen_until(network, events, counts, g, begin):
    """Let all events of a group happen that are due where a piece begins, given in slabs; moves before it are late."""
    while events.due[g] < events.first[g + 1] and events.at[events.due[g]] <= begin + MERGE:
        i = events.due[g]
        counts[LATE] += events.row[i] != SAME_MAP and events.at[i] < begin - MERGE
        happen(network, events, g)
