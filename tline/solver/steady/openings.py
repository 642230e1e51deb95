"""Openings of elements that move them by themselves, at which none moves in the steady state."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.elements import PlacedLaw

if TYPE_CHECKING:
    from tline.solver.steady.steady_state import Before

REGULATOR, DISC = 0.3, 1.0  # start of the search
SHUT = 1e-7  # a smaller opening is shut
STEPS, LONGEST = 60, 1.5  # of Newton's method, for the logarithm of an opening
DIFFERENCE = 1e-6  # of the logarithm, for slopes
SETTLED, ROUNDED = 1e-13, 1e-8  # of a step; below the second one it need not become shorter


def openings_at_rest(elements: Sequence[PlacedLaw]) -> dict[str, float]:
    """Openings where all is at rest: those given, or else wide open regulators and shut discs."""
    found = {}
    for element in elements:
        if element.governor is not None:
            usual = 0.0 if element.governor.inertia else 1.0
            found[element.where] = usual if element.governor.start is None else element.governor.start
    return found


def still(elements: Sequence[PlacedLaw], solve: "Callable[[dict[str, float]], Before]") -> "Before":
    """Steady state in which openings do not move, or are at an end to which they are driven.

    `solve` gives the steady state under openings by place.
    """
    moving = [element for element in elements if element.governor is not None]
    openings = {e.where: REGULATOR if e.governor and not e.governor.inertia else DISC for e in moving}
    openings |= {e.where: e.governor.start for e in moving if e.governor and e.governor.start is not None}
    free = [e for e in moving if e.governor and e.governor.start is None]
    before = solve(openings)
    if not free:
        return before
    low, last, worst = np.log(SHUT), np.inf, free[0]
    y = np.log([openings[e.where] for e in free])

    def at(y: NDArray) -> "tuple[Before, NDArray]":
        found = solve(openings | {e.where: _opening(value) for e, value in zip(free, y.tolist(), strict=True)})
        return found, np.array([_drive(e, found) for e in free])

    for _ in range(STEPS):
        before, drive = at(y)
        held = ((y >= 0.0) & (drive >= 0.0)) | ((y <= low) & (drive <= 0.0))
        moved = np.flatnonzero(~held)
        if not moved.size:
            return before
        worst = free[int(np.argmax(np.abs(drive) * ~held))]
        slopes = np.empty((len(free), len(moved)))
        for k, j in enumerate(moved):
            beside = y.copy()
            beside[j] -= DIFFERENCE
            slopes[:, k] = (drive - at(beside)[1]) / DIFFERENCE
        step = np.clip(np.linalg.lstsq(slopes[moved], drive[moved])[0], -LONGEST, LONGEST)
        size = float(np.abs(step).max())
        if size <= SETTLED or (size <= ROUNDED and size >= last):
            return before
        y[moved] = np.clip(y[moved] - step, low, 0.0)
        last = size
    if (settled := _in_turn(at, y)) is not None:
        return settled
    raise InputError(worst.where, "no opening is found at which it keeps its value", "its opening, or start = 'rest'")


def _in_turn(at: "Callable[[NDArray], tuple[Before, NDArray]]", y: NDArray) -> "Before | None":
    """One opening after the other until none moves any more, or nothing; one that rises lowers its own drive."""
    from scipy.optimize import brentq

    low = np.log(SHUT)
    for _ in range(STEPS):
        begun = y.copy()
        for k in range(y.size):

            def drive(value: float, k: int = k) -> float:
                y[k] = value
                return at(y)[1][k]

            y[k] = low if drive(low) <= 0.0 else 0.0 if drive(0.0) >= 0.0 else brentq(drive, low, 0.0, xtol=SETTLED)
        if np.abs(y - begun).max() <= ROUNDED:
            return at(y)[0]
    return None


def _opening(y: float) -> float:
    return float(np.exp(y)) if y > np.log(SHUT) else 0.0


def _drive(element: PlacedLaw, before: "Before") -> float:
    governor, through = element.governor, before.through.get(element.where, 0.0)
    assert governor is not None
    seen = [before.effort.get(node or "", 0.0) for node in (element.from_node, element.to_node)]
    each = zip((governor.here, governor.there, governor.through), (*seen, through), strict=True)
    return (
        sum(gain * (value - kept) for (gain, kept), value in each if gain)
        - governor.own * before.openings[element.where]
    )
