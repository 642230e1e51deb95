"""Order and slab width of a run: as the user fixed them, or fine enough for what the scene holds."""

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from math import ceil, lcm
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.families import MOST as MOST_FAMILIES
from tline.solver.description.families import leads
from tline.solver.description.nodes import NONE
from tline.wording import place

ORDER = 5
FIT = 1e-7
HELD = 0.5  # cycles per slab up to which circuits hold
BAND = 2.0  # cycles per slab beyond which they are not asked to
LOSS_ELEMENTS, ALL_LOSS_ELEMENTS = 64, 2**31
POINTS = 2  # of a slab, at least, in the time scale of what is to be resolved
SLABS_PER_DELAY, SLABS_PER_RUN = 4, 500  # at least, where they cost little
SLABS_FOR_FRONTS = 20_000  # at most, to give the short pieces of waveforms slabs of their own
CHEAP = 1e7  # line-end samples computed without asking whether that fine is needed
CHEAP_IN_BLOCKS = 1e9  # the same where a slab divides all delays: without fronts inside slabs some hundred times faster
MOST_KEPT = 4e7  # samples on the lines or in the record that are kept without asking
LARGEST = 4e8  # samples on the lines at once
MOST_SLABS = 1e9
MOST_MARKS = 100  # jumps, corners and switches that are worth a slab that divides their instants
FINER = 20  # times, that a slab may be narrower than needed to divide all delays
ROOMY = 16  # times that a slab is longer than lumped lines take to settle: so often a front may pass them unharmed
WHOLE = 1e-12  # a delay this near to whole slabs, relatively, is whole


class Resolution(NamedTuple):
    """How finely a scene is computed, and what that leaves out."""

    s: int
    h: float
    notes: tuple[str, ...] = ()
    blind: bool = False  # whether an oscillation may pass unseen, so that no comparison with another order tells
    sections: Mapping[str, int] = NONE  # of each lumped line
    settle: float = 0.0  # time in which these settle after a front, or that a convolution blurs beside a jump, s
    fit: float = FIT  # tolerance of the circuits of lossy lines, relative
    band: float = HELD  # of these, cycles per slab at which it ends, at least
    layers: float = 0.0  # of the largest wave: what is followed of what decays behind fronts; 0 for nothing
    loss_elements: int = ALL_LOSS_ELEMENTS  # of one law in the longest line, at most, and in others by their delay
    convolved: bool = False  # whether waves are convolutions, and laws of lines what they are

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
    """Order and slab width of a scene, if they are not given, and notes on what is too fast for them.

    `sections` are those of lumped lines, which ask for no slabs. A slab is to be longer, if the lines allow it, than
    the time in which lumped lines settle after a front.

    Raises
    ------
    InputError
        The waves under way would not fit in memory, or the run has too many slabs or ends within the first.
    """
    lines, fixed, t_end = description.lines, description.scene.solver, description.t_end
    delays = {name: line.delay for name, line in lines.items() if name not in sections}
    s = s or fixed.order or ORDER
    by_hand = h is None and fixed.slab is not None
    loss_elements = LOSS_ELEMENTS if h is None and not by_hand else ALL_LOSS_ELEMENTS
    scales = description.time_scales
    h = h or float(fixed.slab or 0.0) or _slab(description, delays, scales, settle)
    _check(t_end, delays, s, h, by_hand)
    chosen = Resolution(s, h, sections=sections, settle=settle, loss_elements=loss_elements)
    notes = [
        f"{where}: its time scale of {scale:.3g} s is shorter than the slab of {h:.3g} s; "
        "what is faster than the slab is damped, not resolved"
        for where, (scale, _) in scales.items()
        if scale < chosen.resolved
    ]
    blind = any(period < chosen.resolved for _, period in scales.values())
    return chosen._replace(notes=tuple(notes), blind=blind)


def _slab(
    description: Description, lines: Mapping[str, float], scales: Mapping[str, tuple[float, float]], settle: float
) -> float:
    """A slab that is fine enough for what the scene holds, if that is affordable; lines are given by their delays."""
    delays, t_end = [*lines.values()], description.t_end
    lossy = [delay for name, delay in lines.items() if description.lines[name].losses is not None]
    shortest, breaks = min(delays), _breaks(description)
    few = len(breaks) <= MOST_MARKS
    resolved = min([shortest / SLABS_PER_DELAY, *(scale for scale, _ in scales.values())])
    fronts = [max(gap, t_end / SLABS_FOR_FRONTS) for gap in _gaps(description)]
    affordable = min(_affordable(description, delays, CHEAP), shortest)
    least = max(affordable, min(ROOMY * settle, min(shortest, t_end) / SLABS_PER_DELAY))
    many = [] if lossy else [t_end / SLABS_PER_RUN]  # to lines with losses slabs are dear
    wanted = max(min([resolved, *many, *fronts]), least)
    cheap = _affordable(description, delays, CHEAP if lossy else CHEAP_IN_BLOCKS)
    if lossy and (h := _slab_for_segments(description, delays, max(resolved, least), cheap)):
        return h
    marks = [t for t in breaks if t > 0] if few else []
    parts = _dividing(delays, lossy, marks, wanted, cheap)
    if not parts and breaks and few:  # fronts inside slabs, exact in any slab, and slabs with fronts cost
        wanted = max(resolved, least)
    parts = parts or 1
    return shortest / (parts * ceil(shortest / parts / wanted - WHOLE))


def _slab_for_segments(description: Description, delays: list[float], wanted: float, affordable: float) -> float:
    """A slab that divides all delays, where lossy lines are in segments wherever fronts lie; 0 if there is none.

    If waves are sums over fronts, each family of these may have slabs of its own. Else fronts have to lie whole slabs
    apart.
    """
    if not all(line.losses is None or line.losses.linear for line in description.lines.values()):
        return 0.0
    at = np.unique(np.concatenate([[*description.switched.values()], *(changes.at for changes in description.changes)]))
    apart = [] if description.separable else (at[1:] - at[:1]).tolist()
    if len(apart) > MOST_MARKS:
        return 0.0
    shortest = min(delays)
    most = int(shortest / max(wanted / FINER, affordable)) or 1
    parts = common_parts((*delays, *apart), shortest, most)
    h = shortest / (parts * ceil(shortest / parts / wanted - WHOLE)) if parts else 0.0
    return h if h and len(leads(at / h)) <= MOST_FAMILIES else 0.0


def _affordable(description: Description, delays: list[float], cheap: float) -> float:
    """The narrowest slab, s, that neither time nor memory forbids."""
    probed = min(len(description.scene.probes), len(delays))
    stepping = 2 * len(delays) * description.t_end / cheap
    kept = max(4 * probed * description.t_end, 2 * sum(delays)) / MOST_KEPT
    return ORDER * max(stepping, kept)


def _check(t_end: float, delays: dict[str, float], s: int, h: float, by_hand: bool) -> None:
    shortest, longest = (place("lines", choose(delays, key=lambda name: delays[name])) for choose in (min, max))
    samples = 2 * s * sum(delays.values()) / h
    if samples > LARGEST:
        problem = f"slabs of {h:.3g} s put {samples:.2g} samples on the lines at once"
        raise InputError(
            "solver.slab" if by_hand else shortest,
            f"{problem}, for {longest} takes {max(delays.values()):.3g} s",
            f"at most {LARGEST:.0e}: a longer slab or a lower order"
            if by_hand
            else f"at most {LARGEST:.0e}: a longer shortest line or a lower order",
        )
    if h > t_end * (1 + WHOLE):
        at_least = f"at least a slab of {h:.3g} s"
        raise InputError("t_end", "the run ends within the first slab", at_least, f"{t_end:.3g} s")
    if t_end / h > MOST_SLABS:
        problem = f"slabs of {h:.3g} s make a run of {t_end / h:.2g} slabs"
        expected = f"at most {MOST_SLABS:.0e}; no slab is longer than the delay of {shortest}"
        raise InputError("t_end", problem, expected, f"{t_end:.3g} s")


def _gaps(description: Description) -> list[float]:
    """The shortest piece between two breaks of each waveform that has one, s; below rounding it is a jump."""
    pieces = [np.diff(instants) for instants in description.breaks]
    return [float(p.min()) for p in (p[p > WHOLE * description.t_end] for p in pieces) if p.size]


def _breaks(description: Description) -> list[float]:
    """Instants of the jumps, corners and switches of a run, s."""
    instants = [*description.switched.values(), *np.concatenate([np.empty(0), *description.breaks]).tolist()]
    return [t for t in instants if 0 <= t < description.t_end]


def _dividing(delays: list[float], lossy: list[float], marks: list[float], wanted: float, affordable: float) -> int:
    """The fewest parts of the shortest delay that divide all delays and marks, or else some of them; 0 for too many.

    Rather those of lossy lines than others: fronts are not followed past loss elements inside slabs.
    """
    shortest = min(delays)
    most = int(shortest / max(wanted / FINER, affordable)) or 1
    choices = [[*delays, *marks], delays]
    choices += [[shortest, *lossy, *marks], [shortest, *lossy]] if lossy else []
    return next(filter(None, (common_parts(tuple(times), shortest, most) for times in choices)), 0)


@lru_cache  # fractions take long, and runs with other values ask the same
def common_parts(times: tuple[float, ...], unit: float, most: int) -> int:
    """The fewest parts of the unit that divide all times, 0 if it takes more than `most`."""
    parts = 1
    for time in set(times):
        ratio = Fraction(time / unit).limit_denominator(most)
        parts = lcm(parts, ratio.denominator)
        if parts > most or abs(time / unit - ratio) > WHOLE * ratio:
            return 0
    return parts
