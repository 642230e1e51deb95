"""Bounce diagram of a scene with one line: travelling fronts, the jump of each, and the levels between them."""

import heapq
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tline.errors import InputError
from tline.scene.heights import words
from tline.scene.load import Switch
from tline.scene.refuse import refuse_cavities, refuse_coupled, refuse_losses
from tline.scene.scene import Scene
from tline.solver.result.dense_output import drawable
from tline.solver.result.result import Result
from tline.solver.result.wave import LineRecord, Wave
from tline.style import DOWN, FAINT, INK, UP, figure, styled
from tline.units import handy

MOST_LEGS = 12
FEEBLE = 1e-3  # relative to the range of the waves; smaller jumps, and smaller bends within a delay, are not fronts
DISTINCT_SLABS = 2.0  # slabs; fronts closer than this cannot be resolved
AFTER, NEARBY = 1e-8, 1e-4  # of a slab: as good as at its edge; for slopes
SAME_INSTANT = 1e-9  # relative to the run; fronts that start closer than this are one
FLAT = 1e-6  # relative to the largest effort; smaller ones are zero
ROOM = 0.03  # of the diagram's height, for a number
LETTER = 0.028  # of the line's length, for a letter of a number
SHARES = (0.42, 0.3, 0.54, 0.22, 0.62, 0.14)  # positions of its number along a leg, the best first
ENOUGH = 0.65  # of a leg, length that can carry a number


class Front(NamedTuple):
    """Front that leaves an end of the line."""

    end: int  # 0: end 1, 1: end 2
    t: float
    jump: float  # of the effort; NaN where another front is too close for the slabs to tell


class Stay(NamedTuple):
    """Interval in which no front leaves or reaches an end."""

    end: int
    start: float
    stop: float
    first: float  # effort just after the start
    last: float  # effort just before the stop


class Bounces(NamedTuple):
    """Contents of a bounce diagram, in SI unless scaled."""

    delay: float
    until: float  # last instant of the diagram
    fronts: list[Front]
    stays: list[Stay]

    def scaled(self, second: float, effort: float) -> "Bounces":
        """Convert to other units of time and effort."""
        fronts = [Front(end, t / second, jump / effort) for end, t, jump in self.fronts]
        stays = [Stay(end, p / second, q / second, u / effort, v / effort) for end, p, q, u, v in self.stays]
        return Bounces(self.delay / second, self.until / second, fronts, stays)


def only_line(scene: Scene) -> str:
    """Name of the scene's only line."""
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
            if stop - start > SAME_INSTANT * until:
                first = sum(_beside(wave, start, after=True)[0] for wave in waves) / 2
                last = sum(_beside(wave, stop, after=False)[0] for wave in waves) / 2
                stays.append(Stay(end, start, stop, first, last))
    return Bounces(record.delay, until, fronts, stays)


def _fronts(scene: Scene, record: LineRecord, nodes: tuple[str, str], t_end: float) -> list[Front]:
    """First legs, in the order of their starts."""
    sources = [(float(t), source.terminals) for source in scene.sources.values() for t in source.value.breaks(t_end)]
    moving = [element for _, element in scene.placed if isinstance(element, Switch)]
    starts = sources + [(float(switch.time), switch.terminals) for switch in moving]
    waiting = [(t, end) for t, at in starts if 0 <= t < t_end for end in (0, 1) if nodes[end] in at]
    heapq.heapify(waiting)
    fronts: list[Front] = []
    largest = max(float(np.ptp([wave.before, *wave.values.ravel()])) for wave in (record.a1, record.b2))
    while waiting and len(fronts) < MOST_LEGS:
        t, end = heapq.heappop(waiting)
        if any(front.end == end and abs(front.t - t) < SAME_INSTANT * t_end for front in fronts):
            continue
        wave = record.b2 if end else record.a1
        (before, slope_before), (after, slope_after) = (_beside(wave, t, after=late) for late in (False, True))
        bend = abs(slope_after - slope_before) * record.delay
        if max(abs(after - before), bend) <= FEEBLE * largest:
            continue  # absorbed: it carries nothing on
        # the other wave does not jump along this leg, so u = (a + b)/2 jumps by half
        fronts.append(Front(end, t, (after - before) / 2 if abs(after - before) > FEEBLE * largest else 0.0))
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
    return any(end == front.end and SAME_INSTANT * front.t < abs(t - front.t) < DISTINCT_SLABS * h for t, end in seen)


def _beside(wave: Wave, t: float, after: bool) -> tuple[float, float]:
    """Value and slope just after or just before t, continued from the nearest slab that lies wholly on that side."""
    place, last = t / wave.h, len(wave.values) - 1
    slab = int(np.ceil(place - AFTER)) if after else int(np.floor(place + AFTER)) - 1
    if slab < 0:
        return wave.before, 0.0
    slab = min(slab, last)
    here, ahead = wave.basis.evaluation([place - slab, place - slab + NEARBY]) @ wave.values[slab]
    return float(here), float((ahead - here) / (NEARBY * wave.h))


@styled
def plot_lattice(result: Result) -> Figure:
    """Plot the bounce diagram of a scene with one line: place across, time running down.

    Each leg is a jump or corner of a source or switch on its way from end to end. Its number is its contribution to the
    effort: half the jump of the wave a or b that carries it, as recorded. Numbers next to the ends are the effort
    between arrivals; two numbers if it changes meanwhile. Legs with a corner but no jump are dotted; grey ones are too
    close to another front for the slabs to resolve their jumps. At most twelve legs are drawn.

    Parameters
    ----------
    result : Result
        A finished run.

    Raises
    ------
    InputError
        The scene has several lines.
    """
    found = bounces(result)
    largest = max(abs(u) for stay in found.stays for u in (stay.first, stay.last))
    size, unit = handy(largest, result.medium.shown["effort"])
    second, time_unit = handy(found.until, "s")
    shown = found.scaled(second, size)
    zero = FLAT * largest / size
    picture = figure(7.2, 7.6, result.scene.title)
    axes = picture.subplots()
    for front in shown.fronts:
        _draw_leg(axes, front, shown)
    for number in _numbers(shown):
        _draw_number(axes, number)
    for stay in shown.stays:
        if stay.stop - stay.start > ROOM * shown.until:
            _draw_level(axes, stay, zero)
    (line,) = result.scene.lines.values()
    effort = f"{words(result.scene).effort} [{unit}]"
    _frame(axes, line.nodes, effort, shown.until)
    axes.set_ylabel(f"time [{time_unit}]")
    jumps = [front.jump for front in shown.fronts]
    said = {
        f"on the legs: what the front adds to the {effort}": any(abs(jump) > 0 for jump in jumps),
        "dotted: a corner, where a slope changes": 0.0 in jumps,
        "grey: less than two slabs from another front": any(np.isnan(jump) for jump in jumps),
    }
    axes.set_xlabel("; ".join(text for text, shows in said.items() if shows))
    return picture


def _draw_leg(axes: Axes, front: Front, shown: Bounces) -> None:
    """Draw a leg from end to end, or as far as it travels."""
    forth = 1 - 2 * front.end
    share = min((shown.until - front.t) / shown.delay, 1.0)
    corner = front.jump == 0
    axes.annotate(
        "",
        (front.end + forth * share, front.t + share * shown.delay),
        (front.end, front.t),
        arrowprops={
            "arrowstyle": "-|>" if share == 1.0 else "-",
            "color": _colour(front.jump),
            "linewidth": 1.0 if corner else 1.8,
            "linestyle": ":" if corner else "-",
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 13,
        },
    )


class _Number(NamedTuple):
    """Jump of a front, written on its leg."""

    x: float
    t: float
    jump: float

    @property
    def half_width(self) -> float:
        return LETTER / 2 * len(_text(self.jump, "+"))


def _numbers(shown: Bounces) -> list[_Number]:
    """Place the numbers without overlap, and if possible off other legs."""
    placed: list[_Number] = []
    for front in shown.fronts:
        if abs(front.jump) > 0 and shown.until - front.t > ENOUGH * shown.delay:
            forth = 1 - 2 * front.end
            tried = [_Number(front.end + forth * k, front.t + k * shown.delay, front.jump) for k in SHARES]
            placed.append(min(tried, key=lambda number: _covers(number, front, placed, shown)))
    return placed


def _covers(number: _Number, own: Front, placed: list[_Number], shown: Bounces) -> tuple[int, int]:
    """Count the numbers and the other legs that a number would cover."""
    x, t, _ = number
    height, width = ROOM * shown.until, number.half_width
    numbers = sum(abs(t - other.t) < height and abs(x - other.x) < width + other.half_width for other in placed)
    passing = (leg.t + shown.delay * abs(x - leg.end) for leg in shown.fronts if leg is not own)
    return numbers, sum(abs(t - instant) < height / 2 + shown.delay * width for instant in passing)


def _draw_number(axes: Axes, number: _Number) -> None:
    x, t, jump = number
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    look = {"color": _colour(jump), "fontweight": "bold", "zorder": 5, "bbox": box}
    axes.annotate(_text(jump, "+"), (x, t), ha="center", va="center", **look)


def _colour(jump: float) -> str:
    return UP if jump > 0 else DOWN if jump < 0 else FAINT


def _draw_level(axes: Axes, stay: Stay, zero: float) -> None:
    """Write the effort at an end, next to it."""
    place, side = (1.03, "left") if stay.end else (-0.03, "right")
    first, last = (_text(u if abs(u) > zero else 0.0) for u in (stay.first, stay.last))
    text = first if first == last else f"{first} → {last}"
    axes.text(place, (stay.start + stay.stop) / 2, text, ha=side, va="center")
    if stay.start > 0:
        axes.plot([stay.end, place], [stay.start] * 2, color=FAINT, linewidth=0.8)


def _text(value: float, sign: str = "") -> str:
    """Format four digits, with a true minus."""
    return f"{value:{sign}.4g}".replace("-", "\N{MINUS SIGN}")


def _frame(axes: Axes, nodes: tuple[str, str], effort: str, until: float) -> None:
    axes.set_xlim(-0.46, 1.46)
    axes.set_ylim(until, 0.0)
    for end, name in enumerate(nodes):
        axes.axvline(end, color=INK, linewidth=1.2)
        above = {"xycoords": ("data", "axes fraction"), "ha": "center", "va": "bottom"}
        axes.annotate(f"{name}\n", (end, 1.0), fontweight="bold", **above)
        axes.annotate(effort, (end, 1.005), fontsize=9, **above)
    axes.set_xticks([])
    axes.spines["bottom"].set_visible(False)
