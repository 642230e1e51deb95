"""Efforts and flows in equilibrium: laws of elements and lossy lines between parts of a network, solved by Newton.

The unknowns are an effort of each free part, and of each law the effort it sees behind an impedance r of its own,
a = drop + r·flow. Drop and flow are smooth functions of a even where a valve is shut or a check valve has no loss.

References
----------
E. Todini, S. Pilati: A gradient method for the analysis of pipe networks (1987), whose unknowns are flows and heads.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

STEPS, HALVINGS = 400, 40
SPARE, CLOSE = 1e-15, 1e-10  # residuals, relative to the largest effort: where to stop, and what will do
LEAST = 1e-12  # slope of a drop, in units of the impedance, that is taken for a law which has none at rest
LEAK = 1e-14  # conductance of a part, in those units, that gives it an effort where nothing else does
LEAKS = 10.0 ** np.arange(0, -14, -1)  # the same on the way to a state that is not found at once
SMALL = 300  # unknowns
STARTS = 10.0 ** np.arange(0, -7, -1)  # efforts over the largest
NOTHING = 1e-12  # of the largest effort, or of 1 where nothing drives: so little is at rest
TIED = 1e-13  # of what else ties a part, where that is not enough to tell its effort
CORRECTIONS, EXACT = 2, 1e-9  # of linear systems


class EdgeLaws(NamedTuple):
    """Laws between parts, by edge."""

    from_node: NDArray  # (edges,) part from which the flow counts, -1 for the reference
    to_node: NDArray  # (edges,) part to which it counts
    impedance: NDArray  # (edges,) r, of the size of drop/flow, > 0
    solved: Callable[[NDArray], tuple[NDArray, NDArray, NDArray, NDArray]]  # a -> drop, flow, and their slopes over a


class Balance(NamedTuple):
    """What was found."""

    effort: NDArray  # (parts,)
    flow: NDArray  # (edges,)
    rest: NDArray  # (edges,) what is left of each law, relative to the largest effort
    leak: NDArray  # (parts,) flow that only the leak takes


def balanced(laws: EdgeLaws, given: NDArray, conductance: NDArray, driven: NDArray) -> Balance:
    """Efforts at which all flows balance.

    Parameters
    ----------
    laws : EdgeLaws
    given : ndarray, shape (parts,)
        Effort where it is prescribed, else nan.
    conductance, driven : ndarray, shape (parts,)
        To the reference; flow of sources.
    """
    starts = _starts(laws, given, conductance, driven)
    tried = []
    for start in starts:
        found = _newton(laws, given, conductance, driven, LEAK, start)
        if found.balance.rest.max(initial=0.0) <= CLOSE:
            return found.balance
        tried.append(found.balance)
    at = starts[0]
    for leak in LEAKS:  # all tight things leak, less and less
        at = _newton(laws, given, conductance, driven, leak, at)[:2]
    again = _newton(laws, given, conductance, driven, LEAK, at)
    return min(*tried, again.balance, key=lambda balance: balance.rest.max(initial=0.0))


class _Found(NamedTuple):
    a: NDArray  # (edges,)
    effort: NDArray  # (parts,)
    balance: Balance


def _starts(laws: EdgeLaws, given: NDArray, conductance: NDArray, driven: NDArray) -> list[tuple[NDArray, NDArray]]:
    """Efforts a behind the impedances and efforts of parts to begin with, the least unbalanced first."""
    effort = np.where(np.isnan(given), 0.0, given)
    held = ~np.isnan(given)
    effort[~held] = given[held].mean() if held.any() else 0.0
    largest, r = _largest(laws, effort, driven), _mean(laws.impedance)
    starts = [np.full(len(laws.from_node), share * largest) for share in STARTS]

    def unbalance(a: NDArray) -> float:
        drop, flow, _, _ = laws.solved(a)
        rest, balance = _rests(laws, effort, drop, flow, conductance * effort - driven)
        return max(np.abs(rest).max(), r * np.abs(balance[~held]).max(initial=0.0))

    return [(a, effort) for a in sorted(starts, key=unbalance)]


def _mean(impedance: NDArray) -> float:
    return float(np.exp(np.log(impedance).mean()))


def _largest(laws: EdgeLaws, effort: NDArray, driven: NDArray) -> float:
    return max(np.abs(effort).max(initial=0.0), _mean(laws.impedance) * np.abs(driven).max(initial=0.0)) or 1.0


def _rests(laws: EdgeLaws, effort: NDArray, drop: NDArray, flow: NDArray, out: NDArray) -> tuple[NDArray, NDArray]:
    """What is left of laws, and of flows out of each part with those that are given."""
    ends, out = np.append(effort, 0.0), np.append(out, 0.0)
    np.add.at(out, laws.from_node, flow)
    np.add.at(out, laws.to_node, -flow)
    return drop - (ends[laws.from_node] - ends[laws.to_node]), out[:-1]


def _newton(
    laws: EdgeLaws,
    given: NDArray,
    conductance: NDArray,
    driven: NDArray,
    leaking: float,
    start: tuple[NDArray, NDArray],
) -> _Found:
    """Newton's steps from a start, halved until what is left falls."""
    n, count = len(given), len(laws.from_node)
    free = np.flatnonzero(np.isnan(given))
    number = np.full(n + 1, -1)  # the last one is the reference
    number[free] = count + np.arange(len(free))
    r = _mean(laws.impedance)
    leak = np.full(n, leaking / r)
    a, effort = start
    largest = _largest(laws, np.where(np.isnan(given), 0.0, given), driven)

    def unbalance(a: NDArray, effort: NDArray) -> tuple[NDArray, float, float, NDArray, NDArray, NDArray]:
        drop, flow, steep, slope = laws.solved(a)
        rest, balance = _rests(laws, effort, drop, flow, (conductance + leak) * effort - driven)
        whole = np.concatenate([rest, r * balance[free]])
        scale = max(np.abs(drop).max(), np.abs(effort).max(), r * np.abs(flow).max(), NOTHING * largest)
        return whole, float(np.abs(whole).max()), float(scale), flow, steep, slope

    whole, worst, scale, flow, steep, slope = unbalance(a, effort)
    for _ in range(STEPS):
        if worst <= SPARE * scale:
            break
        entries, rows, columns = _jacobian(laws, number, count, free, steep, slope, r, r * (conductance + leak))
        step = _solved(entries, rows, columns, count, whole)
        share = 1.0
        for _ in range(HALVINGS):
            b, level = a - share * step[:count], effort.copy()
            level[free] -= share * step[count:]
            now = unbalance(b, level)
            if now[1] < worst:
                break
            share /= 2
        else:
            break
        a, effort, (whole, worst, scale, flow, steep, slope) = b, level, now
    stuck = np.where(np.isnan(given), leak * effort, 0.0)
    return _Found(a, effort, Balance(effort, flow, np.abs(whole[:count]) / scale, stuck))


def _jacobian(
    laws: EdgeLaws, number: NDArray, count: int, free: NDArray, steep: NDArray, slope: NDArray, r: float, own: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Entries, rows and columns: laws first, then balances of the free parts."""
    edges = np.arange(count)
    entries, rows, columns = [np.maximum(steep, LEAST)], [edges], [edges]
    for end, sign in ((laws.from_node, 1.0), (laws.to_node, -1.0)):
        at = number[end]
        seen = at >= 0
        entries += [np.full(seen.sum(), -sign), r * sign * slope[seen]]
        rows += [edges[seen], at[seen]]
        columns += [at[seen], edges[seen]]
    parts = number[free]
    return (
        np.concatenate([*entries, own[free]]),
        np.concatenate([*rows, parts]),
        np.concatenate([*columns, parts]),
    )


def _solved(entries: NDArray, rows: NDArray, columns: NDArray, count: int, whole: NDArray) -> NDArray:
    """Newton's step; the first unknowns, so many as there are laws, stand on the diagonal of a block of their own.

    In large networks these are eliminated, which leaves a symmetric pattern of parts alone: a quarter of the time and
    a sixth of the memory. What that loses where a drop is nearly flat is won back by a correction, or else all is
    solved at once.
    """
    n = len(whole)
    if n <= SMALL:
        matrix = np.zeros((n, n))
        np.add.at(matrix, (rows, columns), entries)
        try:
            return np.linalg.solve(matrix, whole)
        except np.linalg.LinAlgError:
            return np.linalg.lstsq(matrix, whole)[0]
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import splu

    matrix = coo_array((entries, (rows, columns)), shape=(n, n)).tocsr()
    if n == count:  # all efforts are given
        return whole / matrix.diagonal()
    own, of_ends = matrix[:count, :count].diagonal(), matrix[:count, count:]
    of_flows = matrix[count:, :count].multiply(1 / own[None, :]).tocsr()
    left = (matrix[count:, count:] - of_flows @ of_ends).tocsc()
    try:
        parts, cut_off = splu(left, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}), False
    except RuntimeError:  # parts that only a leak ties down
        tied = left + diags_array(TIED * np.abs(left.diagonal())).tocsc()
        parts, cut_off = splu(tied, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}), True
    step = np.zeros(n)
    for _ in range(CORRECTIONS):
        rest = whole - matrix @ step
        level = parts.solve(rest[count:] - of_flows @ rest[:count])
        step += np.concatenate([(rest[:count] - of_ends @ level) / own, level])
    exact = np.abs(whole - matrix @ step).max() <= EXACT * np.abs(whole).max()
    return step if exact or cut_off else splu(matrix.tocsc()).solve(whole)
