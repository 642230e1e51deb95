"""A period, the common measure of a copy's delays, cut in slabs so that all fronts pass at their edges.

Fronts of a source leave at breaks of its waveform and meet nodes whole periods later. So if the breaks' places in the
period are edges of slabs, every wave is smooth in every slab of every copy, for any delays. The copies of a batch are
the last axis of all arrays: they are side by side in memory, so that they are advanced together.
"""

from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import Shape
from tline.solver.radau import Basis

Floats = NDArray[np.float64]
MOST_BREAKS = 12


def breaks_of(description: Description) -> Floats:
    """Instants after t = 0 at which a waveform jumps or bends, s."""
    instants = np.unique(np.concatenate([np.empty(0), *description.breaks]))
    instants = instants[(instants > 0) & (instants < description.t_end)]
    if len(instants) > MOST_BREAKS:
        problem = "their waveforms have too many jumps and corners for many runs"
        raise InputError("sources", problem, f"at most {MOST_BREAKS}", f"{len(instants)}")
    return instants


def front_places(breaks: Floats, unit: Floats) -> Floats:
    """Places at which fronts pass nodes, from the begin of a period to its end, as shares, shape (fronts, copies).

    Breaks leave at instants, s; `unit` is the period of each copy, s.

    Examples
    --------
    >>> front_places(np.array([1.0, 4.5]), np.array([2.0, 3.0])).T.round(3).tolist()
    [[0.0, 0.25, 0.5, 1.0], [0.0, 0.333, 0.5, 1.0]]
    """
    places = breaks[:, None] / unit % 1.0
    places = np.sort(np.where((places < EDGE) | (places > 1 - EDGE), 0.0, places), axis=0)
    return np.vstack([np.zeros(len(unit)), places, np.ones(len(unit))])


def slab_edges(fronts: Floats, parts: int, growth: float) -> Floats:
    """Edges of the slabs in a period, as shares of it, shape (slabs + 1, copies); some may be of no width.

    The first slab after any front is no wider than it would be were there no fronts.

    Fronts have the shape (fronts, copies), as shares of the period; without fronts it would have `parts` slabs. Behind
    a front each slab is wider than the one before by the factor `growth`.

    Examples
    --------
    >>> slab_edges(np.array([[0.0], [0.4], [1.0]]), 3, 2.0).T.round(3).tolist()
    [[0.0, 0.133, 0.4, 0.486, 0.657, 1.0]]
    """
    width = np.diff(fronts, axis=0)
    widest = width.max(axis=1)
    count = widest * parts if growth == 1 else np.log1p(widest * (growth**parts - 1)) / np.log(growth)
    count = np.maximum(np.ceil(count - EDGE).astype(int), 1)
    parted = [np.cumsum(growth ** np.arange(n)) for n in count]
    cuts = [np.concatenate([[0.0], ends[:-1] / ends[-1]])[:, None] for ends in parted]
    return np.vstack([*(a + b * cut for a, b, cut in zip(fronts[:-1], width, cuts, strict=True)), fronts[-1:]])


def driven_waves(
    drives: list[list[tuple[Shape, Floats]]], order: Basis, unit: Floats, edges: Floats, n: int, t_end: float
) -> Floats:
    """Sources' parts of Thévenin waves at all points of n periods, or of fewer, of which the last one repeats.

    Drives of each node with sources are waveforms and their shares (batches, B); edges have the shape (batches, slabs +
    1, B), waves (batches, nodes, periods, slabs, s, B).
    """
    shapes = [waveform for parts in drives for waveform, _ in parts]
    last = max((float(shape.breaks(t_end).max(initial=0.0)) for shape in shapes), default=0.0)
    if all(_settled(shape, last, t_end) for shape in shapes):
        n = min(n, ceil(last / unit.min()) + 1)
    start, width = edges[:, None, :-1, None], np.diff(edges, axis=1)[:, None, :, None]
    unit, period = unit[:, None, None, None], np.arange(n)[:, None, None, None]
    inside = (period + start + width / 2) * unit
    t = inside + width * unit * (order.c[:, None] - 0.5)
    waves = np.zeros((len(t), len(drives), *t.shape[1:]))
    for k, parts in enumerate(drives):
        for shape, share in parts:
            waves[:, k] += share[:, None, None, None] * shape.value(t, inside)
    return waves


def _settled(waveform: Shape, last: float, t_end: float) -> bool:
    """Whether a waveform is constant after the last break."""
    t = np.array([last, max(t_end, last)])
    return waveform.fastest() == inf and np.ptp(waveform.value(t, np.array(last + t_end))) == 0.0
