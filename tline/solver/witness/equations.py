"""Flows of elements by their own equations, as a textbook writes them, from efforts and the clock.

Nothing here knows of slabs, waves or kinks, nor how the solver brings a law into a circuit: what both could have wrong
is the scene alone.
"""

from collections.abc import Callable
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.given import ElementLaw, Ratio, Shape

Function = Callable[[NDArray, NDArray], NDArray]  # flow at instants and efforts across
Law = Callable[[NDArray], NDArray]  # flow at efforts, fully open
HOTTEST = 700.0  # times the thermal voltage, beyond which nothing conducts so much


class Flow(NamedTuple):
    """An element whose flow is a function of the effort across it and of time."""

    at: Function


class Impedance(NamedTuple):
    """An element with den(D) e = num(D) i, D the derivative: coefficients, highest power first."""

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]


class Volume(NamedTuple):
    """A vessel or tank behind an orifice: what it holds as a function of the effort inside, and the orifice."""

    held: Callable[[NDArray], NDArray]
    capacity: float


Equation = Flow | Impedance | Volume


def equation_of(element: Any) -> Equation | None:
    """Of a load or link; None where its flow is not a matter of the efforts across it, or what it does is not known."""
    kind = element.kind
    if kind in ("open", "closed"):
        return Flow(lambda t, e: 0.0 * e)
    if kind == "resistor":
        return _resistance(float(element.resistance))
    if kind in ("switch", "valve"):
        return _switch(float(element.before), float(element.after), float(element.time))
    if kind in ("inductor", "capacitor", "series", "parallel", "impedance"):
        return _impedance(element.ratio)
    law = getattr(element, "law", None)
    return None if law is None else _of_law(law())


def _resistance(r: float) -> Flow | None:
    return Flow(lambda t, e: e / r) if r else None


def _switch(before: float, after: float, instant: float) -> Flow | None:
    if before == 0.0 or after == 0.0:
        return None
    return Flow(lambda t, e: e / np.where(t < instant, before, after))


def _impedance(ratio: Ratio) -> Impedance | Flow | None:
    if ratio.degree == 0:
        return _resistance(ratio.at_zero())
    size = max(map(abs, ratio.numerator)), max(map(abs, ratio.denominator))
    if max(size) > 10**300:
        return None
    return Impedance(tuple(map(float, ratio.numerator)), tuple(map(float, ratio.denominator)))


def over_time(shape: Shape | None, t: NDArray) -> NDArray | float:
    """An opening or scale, 1 without one."""
    return 1.0 if shape is None else np.maximum(shape.value(t, t), 0.0)


def rooted(drop: NDArray, capacity: NDArray | float) -> NDArray:
    """Flow through an orifice."""
    return capacity * np.sign(drop) * np.sqrt(np.abs(drop))


def _of_law(law: ElementLaw) -> Equation | None:
    beyond, *c = law.constants
    if law.governor is not None:
        return None
    if law.kind in ("gas", "tank"):
        return _volume(law.kind, beyond, c)
    found = LAWS[law.kind](c) if law.kind in LAWS else None
    if found is None:
        return None

    def flow(t: NDArray, e: NDArray) -> NDArray:
        across = -e if law.reverse else e
        passed = over_time(law.factor, t) * found(across - beyond)
        return -passed if law.reverse else passed

    return Flow(flow)


def _orifice(c: list[float]) -> Law | None:
    capacity, one_way = c
    if capacity == inf:
        return None
    return lambda d: rooted(np.maximum(d, 0.0) if one_way else d, capacity)


def _relief(c: list[float]) -> Law | None:
    capacity, opens, band = c
    if capacity == inf:
        return None
    return lambda d: rooted(np.maximum(d, 0.0), capacity) * np.clip((d - opens) / band, 0.0, 1.0)


def _leak(c: list[float]) -> Law:
    flow, pressure, exponent = c
    return lambda d: flow * (np.maximum(d, 0.0) / pressure) ** exponent


def _demand(c: list[float]) -> Law:
    flow, pressure, exponent = c
    return lambda d: flow * np.clip(d / pressure, 0.0, 1.0) ** exponent


def _diode(c: list[float]) -> Law:
    saturation, thermal = c
    return lambda d: saturation * np.expm1(np.minimum(d / thermal, HOTTEST))


def _table(c: list[float]) -> Law:
    efforts, flows = np.array(c[1:]).reshape(2, -1)
    if (np.diff(efforts) <= 0.0).any():
        efforts = efforts + 1e-15 * np.ptp(efforts) * np.arange(len(efforts))  # where it is upright
    first, last = ((flows[k + 1] - flows[k]) / (efforts[k + 1] - efforts[k]) for k in (0, -2))

    def flow(d: NDArray) -> NDArray:
        beyond = last * np.maximum(d - efforts[-1], 0.0) + first * np.minimum(d - efforts[0], 0.0)
        return np.interp(d, efforts, flows) + beyond

    return flow


def _volume(kind: str, beyond: float, c: list[float]) -> Volume:
    if kind == "tank":
        capacity, per_effort = c
        return Volume(lambda p: per_effort * (p - beyond), capacity)
    capacity, outside, at_zero, exponent = c

    def held(p: NDArray) -> NDArray:
        """Liquid in place of gas: none where the gas fills what it does without effort."""
        absolute = np.maximum(1.0 + (p - beyond) / outside, 1e-12)
        return -at_zero * absolute ** (-1.0 / exponent)

    return Volume(held, capacity)


LAWS: dict[str, Callable[[list[float]], Law | None]] = {
    "quadratic": _orifice, "relief": _relief, "leak": _leak, "demand": _demand, "diode": _diode, "table": _table
}  # fmt: skip
