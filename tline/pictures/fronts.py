"""Fronts that run to and fro on one line: when each leaves an end, what it carries, and the levels between arrivals."""

import heapq
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.scene.refuse import refuse_cavities, refuse_coupled, refuse_losses
from tline.scene.scene import Scene
from tline.scene.switch import Switch
from tline.solver.result.dense_output import AFTER, drawable
from tline.solver.result.result import LineRecord, Result, Wave

MOST_LEGS = 12
FLAT = 1e-3  # of the range of the waves; what jumps by less, and bends by less within a delay, is no front
CLOSE = 2.0  # slabs between fronts that can be told apart
NEARBY = 1e-4  # of a slab, for slopes
SAME = 1e-9  # of the run; fronts that start nearer than this to each other are one


class Front(NamedTuple):
    """A front that leaves an end of the line."""

    end: int  # 0: end 1, 1: end 2
    t: float
    jump: float  # of the effort; NaN where another front is too close for the slabs to tell


class Stay(NamedTuple):
    """An interval in which no front leaves or reaches an end."""

    end: int
    start: float
    stop: float
    first: float  # effort just after the start
    last: float  # effort just before the stop


class Bounces(NamedTuple):
    """All of a bounce diagram, in SI unless scaled."""

    delay: float
    until: float  # the instant up to which the diagram goes
    fronts: list[Front]
    stays: list[Stay]

    def scaled(self, second: float, effort: float) -> "Bounces":
        """The same in other units of time and effort."""
        fronts = [Front(end, t / second, jump / effort) for end, t, jump in self.fronts]
        stays = [Stay(end, p / second, q / second, u / effort, v / effort) for end, p, q, u, v in self.stays]
        return Bounces(self.delay / second, self.until / second, fronts, stays)


def only_line(scene: Scene) -> str:
    """The scene's one line."""
    refuse_losses(scene, "no bounce diagram")
    if len(scene.lines) != 1:
        expected = "a scene with one line"
        raise InputError("lattice", "a bounce diagram shows one line", expected, str(len(scene.lines)))
    refuse_coupled(scene.lines, "a bounce diagram")
    refuse_cavities(scene.lines, "a bounce diagram")
    return next(iter(scene.lines))


def bounces(result: Result) -> Bounces:
    """Follow the jumps and corners of sources and switches of a scene with one line, for the first twelve legs."""
    name = only_line(result.scene)
    record, t_end = drawable(result.lines[name]), float(result.t[-1])
    fronts = _fronts(result.scene, record, result.scene.lines[name].nodes, t_end)
    until = min(fronts[-1].t + 1.35 * record.delay, t_end) if fronts else t_end
    ends = ((record.a1, record.b1), (record.a2, record.b2))
    stays = []
    for end, waves in enumerate(ends):
        times = {0.0, until, *(front.t + record.delay * (front.end != end) for front in fronts)}
        for start, stop in pairwise(sorted(t for t in times if t <= until)):
            if stop - start > SAME * until:
                first = sum(_beside(wave, start, after=True)[0] for wave in waves) / 2
                last = sum(_beside(wave, stop, after=False)[0] for wave in waves) / 2
                stays.append(Stay(end, start, stop, first, last))
    return Bounces(record.delay, until, fronts, stays)


def _fronts(scene: Scene, record: LineRecord, nodes: tuple[str, str], t_end: float) -> list[Front]:
    """The first legs, in the order of their starts."""
    sources = [(float(t), source.terminals) for source in scene.sources.values() for t in source.value.breaks(t_end)]
    moving = [element for _, element in scene.placed if isinstance(element, Switch)]
    starts = sources + [(float(switch.time), switch.terminals) for switch in moving]
    waiting = [(t, end) for t, at in starts if 0 <= t < t_end for end in (0, 1) if nodes[end] in at]
    heapq.heapify(waiting)
    fronts: list[Front] = []
    largest = max(float(np.ptp([wave.before, *wave.values.ravel()])) for wave in (record.a1, record.b2))
    while waiting and len(fronts) < MOST_LEGS:
        t, end = heapq.heappop(waiting)
        if any(front.end == end and abs(front.t - t) < SAME * t_end for front in fronts):
            continue
        wave = record.b2 if end else record.a1
        (before, slope_before), (after, slope_after) = (_beside(wave, t, after=late) for late in (False, True))
        bend = abs(slope_after - slope_before) * record.delay
        if max(abs(after - before), bend) <= FLAT * largest:
            continue  # absorbed: it carries nothing on
        # the other wave does not jump along this leg, so u = (a + b)/2 takes half
        fronts.append(Front(end, t, (after - before) / 2 if abs(after - before) > FLAT * largest else 0.0))
        arrival = t + record.delay
        if arrival < t_end:
            for other in (k for k in (0, 1) if nodes[k] == nodes[1 - end]):
                heapq.heappush(waiting, (arrival, other))
    seen = sorted(
        (front.t + record.delay * k, end) for front in fronts for k, end in ((0, front.end), (1, 1 - front.end))
    )
    return [
        front._replace(jump=np.nan) if front.jump and _is_crowded(front, seen, record.a1.h) else front
        for front in fronts
    ]


def _is_crowded(front: Front, seen: list[tuple[float, int]], h: float) -> bool:
    """Whether another front leaves or reaches the end within two slabs."""
    return any(end == front.end and SAME * front.t < abs(t - front.t) < CLOSE * h for t, end in seen)


def _beside(wave: Wave, t: float, after: bool) -> tuple[float, float]:
    """Value and slope just after or just before t, continued from the nearest slab that lies wholly on that side."""
    place, last = t / wave.h, len(wave.values) - 1
    slab = int(np.ceil(place - AFTER)) if after else int(np.floor(place + AFTER)) - 1
    if slab < 0:
        return wave.before, 0.0
    slab = min(slab, last)
    here, ahead = wave.basis.evaluation([place - slab, place - slab + NEARBY]) @ wave.values[slab]
    return float(here), float((ahead - here) / (NEARBY * wave.h))
