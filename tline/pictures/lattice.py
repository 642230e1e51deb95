"""The bounce diagram of a scene with one line."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tline.pictures.fronts import Bounces, Front, Stay, bounces
from tline.pictures.style import DOWN, FAINT, INK, UP, figure, styled
from tline.scene.heights import words
from tline.solver.result.result import Result
from tline.units import handy

FLAT = 1e-6  # of the largest effort; a smaller one is zero
ROOM = 0.03  # of the diagram's height, for a number
LETTER = 0.028  # of the line's length, for a letter of a number
SHARES = (0.42, 0.3, 0.54, 0.22, 0.62, 0.14)  # of a leg, where its number may stand, the best first
ENOUGH = 0.65  # of a leg, to carry a number


@styled
def plot_lattice(result: Result) -> Figure:
    """Bounce diagram of a scene with one line: place across, time running down.

    Each leg is a jump or corner of a source or switch on its way from end to end. On it stands what it adds to the
    effort: half the jump of the wave a or b that carries it, as recorded. Beside the ends stands the effort between
    arrivals; two numbers if it changes meanwhile. Legs that carry a corner and no jump are dotted; grey ones have
    another front so near that the slabs do not tell what each carries. At most twelve legs are drawn.

    Parameters
    ----------
    result : Result
        A finished run.

    Returns
    -------
    matplotlib.figure.Figure

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
    """A leg from end to end, or as far as it comes."""
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
    """What a front carries, written on its leg."""

    x: float
    t: float
    jump: float

    @property
    def half_width(self) -> float:
        return LETTER / 2 * len(_text(self.jump, "+"))


def _numbers(shown: Bounces) -> list[_Number]:
    """Where the numbers stand: off each other, and if possible off other legs."""
    placed: list[_Number] = []
    for front in shown.fronts:
        if abs(front.jump) > 0 and shown.until - front.t > ENOUGH * shown.delay:
            forth = 1 - 2 * front.end
            tried = [_Number(front.end + forth * k, front.t + k * shown.delay, front.jump) for k in SHARES]
            placed.append(min(tried, key=lambda number: _covers(number, front, placed, shown)))
    return placed


def _covers(number: _Number, own: Front, placed: list[_Number], shown: Bounces) -> tuple[int, int]:
    """How many numbers and how many other legs it would cover."""
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
    """The effort at an end, beside it."""
    place, side = (1.03, "left") if stay.end else (-0.03, "right")
    first, last = (_text(u if abs(u) > zero else 0.0) for u in (stay.first, stay.last))
    text = first if first == last else f"{first} → {last}"
    axes.text(place, (stay.start + stay.stop) / 2, text, ha=side, va="center")
    if stay.start > 0:
        axes.plot([stay.end, place], [stay.start] * 2, color=FAINT, linewidth=0.8)


def _text(value: float, sign: str = "") -> str:
    """Four digits, with a true minus."""
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
