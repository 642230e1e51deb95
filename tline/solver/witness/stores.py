"""Whether what is stored at nodes fits what flows there, over windows drawn at random.

An element with a state ties its effort and its flow by derivatives. Multiplied by a bump φ that vanishes at both ends
of a window with its derivatives, and integrated by parts, its equation needs none of either: den(D) e = num(D) i makes
∫ e·den(-D) φ = ∫ i·num(-D) φ, and i = dS/dt makes ∫ i·φ = -∫ S·φ'.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from tline.solver.witness.balance import Doubt
from tline.solver.witness.equations import Equation, Impedance, Volume
from tline.solver.witness.nodes import Balance
from tline.solver.witness.seen import Seen, Window

MOST_ASIDE = 1  # windows that may be wrong
MOST_DEGREE = 4  # of an impedance


class Signals(NamedTuple):
    """Effort across a store and flow into it in a window, and how far they may be off."""

    e: NDArray
    i: NDArray
    off_e: float
    off_i: NDArray


def store_doubts(seen: Seen, nodes: list[Balance]) -> Iterator[Doubt]:
    """Nodes at which what is stored does not fit in more than one window."""
    for one in nodes:
        if not one.stores or one.held is not None or not seen.reads(one):
            continue
        signals = _signals(seen, one)
        parts = ((window, _within(signals, window)) for window in seen.windows)
        wrong = [window for window, part in parts if _misses(one.stores[0].equation, part, window)]
        if len(wrong) > MOST_ASIDE:
            yield Doubt(f"node '{one.name}'", wrong[0].begin, "what is stored there is not what flowed in")


def _signals(seen: Seen, one: Balance) -> Signals:
    store, (low, high), (off_u, off_y) = one.stores[0], seen.passed(one), seen.allowed(one)
    e, sign = seen.across(store, seen.efforts(one)[0])
    i = sign * (seen.out(one) - (low + high) / 2)
    return Signals(e, i, off_u if store.beyond is None else 2 * off_u, (high - low) / 2 + off_y)


def _within(signals: Signals, window: Window) -> Signals:
    return Signals(signals.e[window.at], signals.i[window.at], signals.off_e, signals.off_i[window.at])


def _misses(equation: Equation, signals: Signals, window: Window) -> bool:
    """Whether the equation of a store does not hold in a window."""
    if isinstance(equation, Volume):
        return _misses_volume(equation, signals, window)
    return isinstance(equation, Impedance) and _misses_impedance(equation, signals, window)


def _misses_impedance(equation: Impedance, signals: Signals, window: Window) -> bool:
    degree = max(len(equation.numerator), len(equation.denominator)) - 1
    if degree > MOST_DEGREE:
        return False
    of_e, of_i = (_adjoint(side, degree, window) for side in (equation.denominator, equation.numerator))
    allowed = window.weight @ (np.abs(of_e) * signals.off_e + np.abs(of_i) * signals.off_i)
    return bool(abs(window.weight @ (of_e * signals.e - of_i * signals.i)) > allowed)


def _adjoint(side: tuple[float, ...], degree: int, window: Window) -> NDArray:
    """p(-D) φ, of a bump φ over the window, for p with the highest power first."""
    bump, found = Polynomial([0.0, 4.0, -4.0]) ** (degree + 1), np.zeros_like(window.t)
    for power, factor in enumerate(reversed(side)):
        found += factor * (-1.0 / window.width) ** power * (bump.deriv(power) if power else bump)(window.share)
    return found


def _misses_volume(equation: Volume, signals: Signals, window: Window) -> bool:
    e, i, off_e, off_i = signals
    per_square = equation.capacity**-2.0  # of the loss in the orifice, zero without one
    inside = e - np.sign(i) * i**2 * per_square
    held = equation.held(inside)
    off_held = np.abs(equation.held(inside + off_e + 2 * np.abs(i) * per_square * off_i) - held)
    bump = Polynomial([0.0, 4.0, -4.0]) ** 2
    of_i, of_held = bump(window.share), bump.deriv()(window.share) / window.width
    allowed = window.weight @ (of_i * off_i + np.abs(of_held) * off_held)
    return bool(abs(window.weight @ (of_i * i + of_held * held)) > allowed)
