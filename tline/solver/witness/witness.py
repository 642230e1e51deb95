"""Check of a run to a tolerance against the scene's equations and against plain first-order runs.

A plain run is of first order, and cuts, grades, lumps and follows nothing.

It spreads the action of switches, laws and sources over slabs, so only means are accurate: integrals are compared over
windows, with the difference of two plain runs as their error.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import islice
from math import ceil, inf, log2, sqrt

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, NoFlowError
from tline.solver.description.description import Description
from tline.solver.description.resolution import Resolution, short_lines
from tline.solver.description.slab import cells_in
from tline.solver.result.result import ProbeResult, Result
from tline.solver.run import run
from tline.solver.witness.nodes import lines_at, watched
from tline.solver.witness.seen import Doubt, Seen, balance_doubts, line_doubts, store_doubts

WINDOWS = 8  # windows of integration in the run
SHARE_OF_RUNS = 0.05  # cost of plain runs, relative to the samples of all runs
LEAST_SAMPLES, MOST_SAMPLES = 2e3, 2e6  # limits of that cost
CELLS = 10  # cells of lines with memory that cost as much as a sample
INSTANTS = 128  # samples of a mean over a window
FEWEST_SLABS = 16  # slabs in a window at least
CAUTION = 4.0  # allowed difference, over that of the two plain runs
FAINT = 1e-4  # relative to the largest wave: a difference always allowed
KNOWS = 0.1  # relative to the amplitude: plain runs that differ by more are no evidence


def plain_doubts(description: Description, result: Result) -> Iterator[Doubt]:
    """Yield probes whose means over windows differ from those of plain runs by more than these differ."""
    h = _slab(description, result)
    if h is None:
        return
    try:
        plain = [Resolution(1, h / k, fit=FAINT, plain=True) for k in (1, 2)]
        coarse, fine = (run(description, chosen) for chosen in plain)
    except (InputError, NoFlowError):  # a plain run may fail, which is no evidence against the other
        return
    window = description.t_end / WINDOWS
    late = h / 2 / window + 1 / INSTANTS  # shift of a jump, relative to a window, common to both plain runs
    largest = max(float(np.abs([probe.a, probe.b]).max()) for probe in fine.probes.values())
    for name, probe in result.probes.items():
        told = [_means(each.probes[name], description.t_end) for each in (coarse, fine, result)]
        for letter, one, other, given in zip("uy" if probe.has_flow else "u", *told, strict=False):
            size = float(np.ptp(getattr(fine.probes[name], letter)))
            faint = FAINT * largest / (probe.record.z0 if letter == "y" else 1.0)
            apart = float(np.abs(one - other).max()) + late * size + faint
            off = np.abs(given - other)
            if apart <= KNOWS * size and off.max() > CAUTION * apart:
                what = f"the mean of {letter} is not that of a plain run"
                yield f"probes.{name}", float(off.argmax() * window), what


def _slab(description: Description, result: Result) -> float | None:
    """Widest slab that suits all lines; None if runs with it and with half of it cost too much."""
    attempts = result.accuracy.attempts if result.accuracy else ()
    affordable = min(max(SHARE_OF_RUNS * sum(attempt.samples for attempt in attempts), LEAST_SAMPLES), MOST_SAMPLES)
    shortest = min(line.delay for line in description.lines.values())
    slabs = affordable / (6 * len(description.lines))
    least = max(ceil(description.t_end / shortest), FEWEST_SLABS * WINDOWS)
    if slabs < least:
        return None
    widest = min(shortest, description.t_end / (FEWEST_SLABS * WINDOWS))
    cells = 5 * cells_in(description, widest) / CELLS  # of both runs, which four times as many have on half the slab
    narrower = min(slabs / least, sqrt(affordable / cells) if cells else inf)
    return widest / 2 ** int(log2(max(narrower, 1.0)))


def _means(probe: ProbeResult, t_end: float) -> NDArray:
    """Means of effort and flow over windows, shape (2, windows)."""
    t = (np.arange(WINDOWS * INSTANTS) + 0.5) / (WINDOWS * INSTANTS) * t_end
    seen = probe.at(t)
    return np.array([each.reshape(WINDOWS, INSTANTS).mean(axis=1) for each in (seen.u, seen.y)])


class Witness:
    """Checker of some nodes of a scene; made before its runs, which must record the waves that it needs.

    Lines that are `kept` anyway are not lumped; `lines` are those whose waves it needs.
    """

    def __init__(self, description: Description, kept: Collection[str] = ()):
        lumped, _ = short_lines(description, kept)
        self.description, self.nodes = description, watched(description, lumped)
        self.lines, probes = lines_at(self.nodes, description), description.probes.values()
        self._given_out = {(name, end) for name in kept for end in (0, 1)}
        self._given_out |= {(at.line, end) for at in probes for end in (0, 1) if at.line and at.share != 1 - end}

    def heard(self, result: Result) -> Result:
        """Return the result, marked as not meeting its tolerance where it does not fit the scene's equations.

        Ends of lines that are not given out are looked at as they were computed, and more closely where that leaves a
        doubt.
        """
        accuracy = result.accuracy
        if accuracy is None or not accuracy.met:
            return result
        computed = {(name, end) for name in result.lines for end in (0, 1)} - self._given_out
        if computed and not any(self._doubts(result, computed)):
            return result
        for where, t, what in islice(self._doubts(result), 1):
            limit = f"two methods disagree at {where} at {t:.6g} s: {what}"
            result = replace(result, accuracy=replace(accuracy, limit=limit))
        return result

    def _doubts(self, result: Result, computed: Collection[tuple[str, int]] = ()) -> Iterator[Doubt]:
        assert result.accuracy is not None
        assert result.accuracy.tol is not None
        seen = Seen(result, self.description, result.accuracy.tol, computed)
        yield from balance_doubts(seen, self.nodes)
        yield from line_doubts(seen)
        yield from store_doubts(seen, [one for one in self.nodes if one.stores and one.held is None])
        if self.description.switched or self.description.elements:
            yield from plain_doubts(self.description, result)
