"""Efforts of pockets: of parts that shut valves and check valves cut off, so that no flow determines them.

A valve without flow bounds the difference of efforts across it: by the opening drop of a check valve, by nothing at one
that is shut. Of all efforts within these bounds a pocket has the given start, or else the least at which nothing opens
toward it, as if it had been filled from there, or the largest at which nothing opens out of it; but the nearest to that
of a neighbour where these are below the reference, or do not exist, and to that of the reference where no neighbour is
known.
"""

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.given import kinds_numbered
from tline.solver.description.groups import parts
from tline.solver.kernel.network import Laws as Elements

WITHIN = 1e-4  # of the largest effort: accuracy required of a start


def held_drops(elements: Elements) -> tuple[NDArray, NDArray]:
    """Least and largest drop without flow through each element; both zero where balance alone stops it."""
    low, high = np.zeros(len(elements.kind)), np.zeros(len(elements.kind))
    for e, kind in enumerate(kinds_numbered(elements.kind.tolist())):
        constants, control = elements.constants[elements.at[e] :], max(float(elements.control[e]), 0.0)
        low[e], high[e] = kind.holds(constants, control)
    return low, high


def settled(
    effort: NDArray,
    known: NDArray,
    start: NDArray,
    ends: tuple[NDArray, NDArray],
    passing: NDArray,
    drops: tuple[NDArray, NDArray],
) -> tuple[NDArray, NDArray]:
    """Efforts of parts, with those of pockets.

    Balances of flows give the efforts (parts,), which something that is not an edge determines if they are known; a
    pocket starts with `start`, or nan. Edges join parts, -1 for the reference; flow passes some, or would if it were
    driven, and none within the drops, least and largest. Also those parts whose start would open a valve.
    """
    n = len(effort)
    u = np.append(effort, 0.0)
    from_group, to_group = (np.where(end < 0, n, end) for end in ends)
    group = parts(from_group[passing], to_group[passing], n + 1)
    fixed = np.zeros(group.max() + 1, bool)
    fixed[group[np.append(known, True)]] = True
    if fixed.all():
        return effort, np.empty(0, int)
    lies = u[from_group] - u[to_group]
    blocked = ~passing & (group[from_group] != group[to_group])
    holding = [each[blocked] for each in (group[from_group], group[to_group], *(drop - lies for drop in drops))]
    beside = list(zip(from_group[blocked], to_group[blocked], strict=True))
    shift, opened = np.zeros(len(fixed)), []
    largest = np.abs(u).max()
    for part in np.argsort(np.isnan(start), kind="stable"):  # those with a start come first
        g = int(group[part])
        if fixed[g]:
            continue
        low, high = _bounds(holding, shift, fixed, g)
        if not np.isnan(start[part]):
            shift[g] = np.clip(start[part] - u[part], low, max(low, high))
            opened += [part] if abs(start[part] - u[part] - shift[g]) > WITHIN * largest else []
        else:
            least = low if np.isfinite(low) else high
            near = np.clip(_beside(u, group, shift, fixed, beside, g), low, max(low, high))
            shift[g] = least if np.isfinite(least) and u[part] + least >= min(0.0, u[part] + near) else near
        fixed[g] = True
    return effort + shift[group[:-1]], np.array(opened, int)


def _bounds(holding: list[NDArray], shift: NDArray, fixed: NDArray, g: int) -> tuple[float, float]:
    """Bounds of the shift of a group: shortest paths to it and from it, by way of groups that are not fixed.

    Elements that hold join a group to another, with the least and the largest excess of the effort of the first.
    """
    least, most = np.where(fixed, shift, -np.inf), np.where(fixed, shift, np.inf)
    from_group, to_group, low, high = holding
    for _ in range(len(fixed)):
        before = least.copy(), most.copy()
        with np.errstate(invalid="ignore"):
            np.fmin.at(most, from_group, most[to_group] + high)
            np.fmin.at(most, to_group, most[from_group] - low)
            np.fmax.at(least, from_group, least[to_group] + low)
            np.fmax.at(least, to_group, least[from_group] - high)
        least[fixed] = most[fixed] = shift[fixed]
        if np.array_equal(least, before[0]) and np.array_equal(most, before[1]):
            break
    return float(least[g]), float(most[g])


def _beside(u: NDArray, group: NDArray, shift: NDArray, fixed: NDArray, beside: list, g: int) -> float:
    """The shift that gives a group the effort of a neighbour, of the reference at last."""
    found = [pair if group[pair[0]] == g else pair[::-1] for pair in beside if g in (group[pair[0]], group[pair[1]])]
    found = [(own, by) for own, by in found if fixed[group[by]]]
    if not found:
        return -float(u[np.flatnonzero(group == g)[0]])
    own, by = min(found, key=lambda pair: pair[1] == len(u) - 1)
    return float(u[by] + shift[group[by]] - u[own])
