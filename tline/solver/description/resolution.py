"""Order and slab width of a run: given by the user, or chosen for the scene.

Very short lines may be lumped; the error of that is measured afterwards.
"""

from collections.abc import Iterable, Mapping
from itertools import pairwise
from math import floor, inf, isfinite, log2, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.nodes import NONE
from tline.solver.description.slab import (
    ORDER,
    SLABS_PER_DELAY,
    WHOLE,
    breaks_of,
    cell_of,
    relative_work,
    slab_of,
    whole_slabs,
)
from tline.words.wording import place

FIT, ROUGH = 1e-7, 1e-5  # of circuits of lossy lines; where delays are rounded
POINTS = 2  # of a slab, at least, in the time scale of what is to be resolved
FIRST_ROUNDED, LEAST_FIRST, MOST_FIRST = 3e4, 200, 5e3  # line-end samples of a first run, and slabs; slabs at most
LARGEST = 4e8  # samples on the lines at once, or in the record
MOST_SLABS = 1e9
SHORT = 1 / 8  # of the slab that suits all other lines
SETTLED = 1  # slab, within which a group has to settle after a front
MOST_STATES = 12  # of a group


class Resolution(NamedTuple):
    """Order, slab width and simplifications of a run."""

    s: int
    h: float
    notes: tuple[str, ...] = ()
    blind: bool = False  # whether an oscillation may be missed by all orders, so that comparing them is no evidence
    sections: Mapping[str, int] = NONE  # number of LC sections of each lumped line
    settle: float = 0.0  # time in which these settle after a front, or that a convolution blurs beside a jump, s
    fit: float = FIT  # tolerance of the circuits of lossy lines, relative
    layers: float = 0.0  # smallest decay behind a front that is followed, relative to the largest wave; 0 for none
    same: float = 0.0  # of the largest wave: pieces that continue each other so well are one, and always by rounding
    exact: bool = True  # whether waves are convolutions, where a scene is one for that; else lines have cells
    diamonds: bool = True  # whether friction is in diamonds where lines neither remember nor leak; else in cells
    cell: float = 0.0  # width of these cells, s; 0 for diamonds, and for cells as wide as slabs
    convolved: bool = False  # whether slabs are chosen for convolutions; by hand they may be any
    near: int = 8  # slabs of a convolution behind a front, from where on they may be twice as wide
    plain: bool = False  # whether switches move at the nearest edges and sources are means over slabs: no fronts
    rounded: bool = False  # whether delays are whole slabs, one at least: those nearest to what they are

    @property
    def resolved(self) -> float:
        """Shortest time scale that is resolved, s."""
        return self.h * min(POINTS / self.s, 1.0) * (1 - 1e-9)


def resolution(
    description: Description,
    s: int | None = None,
    h: float | None = None,
    sections: Mapping[str, int] = NONE,
    settle: float = 0.0,
) -> Resolution:
    """Choose order and slab width of a scene, unless given, with notes on parts too fast for them.

    `sections` are those of lumped lines, which do not limit slabs. If the other lines allow it, a slab is longer than
    the time in which lumped lines settle after a front.
    """
    fixed, t_end, kept = description.scene.solver, description.t_end, not_lumped(description, sections)
    delays = description.columns.delay[kept]
    s = 1 if fixed.rounded else s or fixed.order or ORDER
    by_hand = h is None and fixed.slab is not None
    scales = description.time_scales
    h = h or float(fixed.slab or 0.0)
    if fixed.rounded and not h:  # a power of two times the shortest delay, cheap, and many
        wanted, shortest = max(2 * len(delays) / FIRST_ROUNDED, 1 / MOST_FIRST) * t_end, float(delays.min())
        h = min(shortest * 2.0 ** floor(log2(wanted / shortest)), t_end / LEAST_FIRST)
    h = h or slab_of(description, kept, scales, settle)
    _check(description, kept, s, h, by_hand)
    cell = 0.0 if by_hand or (description.diamonds and s > 1) else cell_of(description, s, h)
    chosen = Resolution(s, h, sections=sections, settle=settle, cell=cell)
    if fixed.rounded:  # cells are of second order in their width, so of first order in the slab
        chosen = chosen._replace(cell=sqrt(float(delays.max()) * h), plain=True, rounded=True, fit=ROUGH)
    notes = [
        f"{where}: its time scale of {scale:.3g} s is shorter than the slab of {h:.3g} s; "
        "what is faster than the slab is damped, not resolved"
        for where, (scale, _) in scales.items()
        if scale < chosen.resolved
    ]
    blind = any(period < chosen.resolved for _, period in scales.values())
    return chosen._replace(notes=tuple(notes), blind=blind)


def cell_in(description: Description, chosen: Resolution) -> float:
    """Width of the cells of friction of a run, s; 0 for diamonds."""
    in_diamonds = chosen.diamonds and description.diamonds and chosen.s > 1 and not chosen.cell
    return 0.0 if in_diamonds else max(chosen.cell, chosen.h)


def not_lumped(description: Description, sections: Mapping[str, int]) -> NDArray:
    """Which lines are not lumped, shape (L,)."""
    if not sections:
        return np.ones(len(description.lines), bool)
    return np.array([name not in sections for name in description.lines], bool)


def _check(description: Description, kept: NDArray, s: int, h: float, by_hand: bool) -> None:
    t_end, delays = description.t_end, description.columns.delay[kept]
    samples = 2 * s * float(delays.sum()) / h
    if h <= t_end * (1 + WHOLE) and samples <= LARGEST and t_end / h <= MOST_SLABS:
        return
    names = [name for name, there in zip(description.lines, kept.tolist(), strict=True) if there]
    shortest, longest = (place("lines", names[int(k)]) for k in (delays.argmin(), delays.argmax()))
    if samples > LARGEST:
        problem = f"slabs of {h:.3g} s put {samples:.2g} samples on the lines at once"
        problem, longer = f"{problem}, for {longest} takes {delays.max():.3g} s", "shortest line"
        where, longer = ("solver.slab", "slab") if by_hand else (shortest, longer)
        raise InputError(where, problem, f"at most {LARGEST:.0e}: a longer {longer} or a lower order")
    if h > t_end * (1 + WHOLE):
        at_least = f"at least a slab of {h:.3g} s"
        raise InputError("t_end", "the run ends within the first slab", at_least, f"{t_end:.3g} s")
    if t_end / h > MOST_SLABS:
        problem = f"slabs of {h:.3g} s make a run of {t_end / h:.2g} slabs"
        expected = f"at most {MOST_SLABS:.0e}; no slab is longer than the delay of {shortest}"
        raise InputError("t_end", problem, expected, f"{t_end:.3g} s")


def grid_choice(description: Description, chosen: Resolution) -> dict[str, str | float | None]:
    """Reason for slabs: which delays they divide; and the predicted cost of a run.

    That is in samples without fronts inside slabs, and not predicted beside losses, nor of a convolution.
    """
    h, breaks = chosen.h, breaks_of(description)
    delays = description.columns.delay[not_lumped(description, chosen.sections)].tolist()
    work = relative_work(h, delays, breaks)
    if description.scene.solver.slab == h:
        reason = "slab given"
    elif not whole_slabs(h, delays):
        reason = "part of the shortest delay"
    elif work > 1.0:
        reason = "common tick of delays"
    else:
        reason = "common tick of delays and fronts" if len(breaks) else "common tick of delays"
    if chosen.convolved or description.dispersive:
        return {"reason": reason, "cost": None}
    return {"reason": reason, "cost": 2 * len(delays) * chosen.s * description.t_end / h * work}


def short_lines(description: Description, record: Iterable[str]) -> tuple[list[str], float]:
    """Names of the lines that may be lumped, and the time they take to settle after a front, s.

    `record` names lines that may not be lumped.

    Probed lines stay lines. So do lines at a node with a switch, a non-linear element, a measured
    load or an active resistance, and lines in which a front would ring on for longer than a part of a slab.
    """
    delays = description.columns.delay
    if delays.min() * SLABS_PER_DELAY >= SHORT * delays.max():
        return [], 0.0
    each = description.nodes.items()
    barred = {name for name, node in each if node.switches or node.conductance < 0 or node.measured is not None}
    joints = [link.nodes for link in description.scene.links.values()] + [one.nodes for one in description.elements]
    barred |= {node for joint in joints for node in joint}
    barred |= {node for end in description.ends for node in (*end.conductors, *end.modal)}
    kept = {name for name, line in description.lines.items() if barred & {*line.nodes}}
    kept |= {*record} | description.probed | {name for name, line in description.lines.items() if line.losses}
    while short := _far_shorter(description, kept):
        restless, settle = _restless(description, short)
        if not restless:
            return short, settle
        kept |= restless
    return [], 0.0


def _far_shorter(description: Description, kept: set[str]) -> list[str]:
    """The lines that are far shorter than a slab which suits all others."""
    delays = {name: line.delay for name, line in description.lines.items()}
    floor = min((delays[name] for name in kept), default=inf)
    for longer, bound in pairwise(sorted(set(delays.values()), reverse=True)):
        if bound < floor and bound * SLABS_PER_DELAY < SHORT * longer:
            short = [name for name, delay in delays.items() if delay <= bound]
            try:
                if bound < SHORT * resolution(description, sections=dict.fromkeys(short, 1)).h:
                    return short
            except InputError:  # the others want too much, too
                continue
    return []


def _restless(description: Description, short: list[str]) -> tuple[set[str], float]:
    """Short lines in groups that settle too slowly or are too large, and the settling time of the others, s."""
    sections = dict.fromkeys(short, 1)
    try:
        groups, _ = description.grouped(sections)
    except InputError:  # loads of too high a degree, or too far apart
        return set(short), 0.0
    h = resolution(description, sections=sections).h
    quick = [group.settles(h) for group in groups]
    h = resolution(description, sections=sections, settle=max(filter(isfinite, quick), default=0.0)).h
    found: set[str] = set()
    slowest = 0.0
    for group in groups:
        size, settle = sum(lumped.states for lumped in group.lumped_lines) + 2 * len(group.nodes), group.settles(h)
        if size > MOST_STATES or settle >= SETTLED * h:
            found |= {lumped.name for lumped in group.lumped_lines}
        slowest = max(slowest, settle)
    return found, slowest
