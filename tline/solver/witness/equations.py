"""Flows of elements by their own equations, as a textbook writes them, from efforts and the clock.

Nothing here depends on slabs, waves, kinks, or the solver's treatment of laws in circuits: the scene is the only
input that both share.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.given import ElementLaw, Ratio, Shape, Volume

Flow = Callable[[NDArray, NDArray], NDArray]  # at instants and efforts across


class Impedance(NamedTuple):
    """An element with den(D) e = num(D) i, D the derivative: coefficients, highest power first."""

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]

    @property
    def degree(self) -> int:
        """Larger degree of numerator and denominator."""
        return max(map(len, self)) - 1


Equation = Flow | Impedance | Volume


def equation_of(element: Any) -> Equation | None:
    """Return the equation of a load or link; None if it is unknown or its flow does not follow from its effort."""
    kind = element.kind
    if kind in ("open", "closed"):
        return lambda t, e: 0.0 * e
    if kind == "resistor":
        return _resistance(float(element.resistance))
    if kind in ("switch", "valve"):
        return _switch(float(element.before), float(element.after), float(element.time))
    if kind in ("inductor", "capacitor", "series", "parallel", "impedance"):
        return _impedance(element.ratio)
    law = getattr(element, "law", None)
    return None if law is None else _of_law(law())


def _resistance(r: float) -> Flow | None:
    return (lambda t, e: e / r) if r else None


def _switch(before: float, after: float, instant: float) -> Flow | None:
    if before == 0.0 or after == 0.0:
        return None
    return lambda t, e: e / np.where(t < instant, before, after)


def _impedance(ratio: Ratio) -> Impedance | Flow | None:
    if ratio.degree == 0:
        return _resistance(ratio.at_zero())
    size = max(map(abs, ratio.numerator)), max(map(abs, ratio.denominator))
    if max(size) > 10**300:
        return None
    return Impedance(tuple(map(float, ratio.numerator)), tuple(map(float, ratio.denominator)))


def over_time(shape: Shape | None, t: NDArray) -> NDArray | float:
    """Value of an opening or scale at instants t; 1 without one."""
    return 1.0 if shape is None else np.maximum(shape.value(t, t), 0.0)


def _of_law(law: ElementLaw) -> Equation | None:
    if law.governor is not None:
        return None
    found, beyond = law.of_kind.flow(law.constants), law.constants[0]
    if found is None:
        return law.of_kind.volume(law.constants)

    def flow(t: NDArray, e: NDArray) -> NDArray:
        across = -e if law.reverse else e
        passed = over_time(law.factor, t) * found(across - beyond)
        return -passed if law.reverse else passed

    return flow
