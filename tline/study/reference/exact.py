"""Effort and flow of a linear scene, exact to any number of digits."""

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from math import ceil, log2
from typing import Any

import numpy as np
from flint import arb, ctx
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss.law import MOST_BITS, MOST_DIGITS
from tline.scene.load import Switch
from tline.scene.scene import Scene
from tline.study.reference.motion import rational
from tline.study.reference.network import ReferenceNetwork, decimal
from tline.study.reference.rays import Begun, arrivals, instant, lattice, sampled

FEW_BITS = 64
GUARD_DIGITS = 15  # digits carried beyond those asked


@dataclass(frozen=True)
class Exact:
    """Effort and flow at a probe, Pa and m³/s or V and A."""

    u: tuple[Decimal, ...]
    y: tuple[Decimal, ...]

    @property
    def efforts(self) -> NDArray:
        """Efforts as floats, rounded once."""
        return np.array(self.u, float)

    @property
    def flows(self) -> NDArray:
        """Flows as floats, rounded once."""
        return np.array(self.y, float)


class Solution:
    """Exact solution at a probe of a scene that starts at rest, by its rays; with switches, by its lattice.

    Lines are lossless, loads linear, sources of straight, exponential or sine pieces; floats count as their shortest
    decimals.

    Rays are computed in ball arithmetic: every number comes with an error bound, and the working precision is
    doubled until the bounds are small enough for the digits asked.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=9, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 3}},
    ... )
    >>> solution = Solution(scene, "far")
    >>> solution.fronts.tolist(), solution.at([2, 4, 6]).efforts.tolist()
    ([1.0, 3.0, 5.0, 7.0], [0.5, 0.75, 0.875])
    """

    def __init__(self, scene: Scene, probe: str):
        if scene.start != "rest":
            raise InputError("start", "exact solutions start at rest", "'rest'", f"'{scene.start}'")
        self.network, self.probe = ReferenceNetwork(scene), probe
        self.z0 = self.network.z0[self.network.seen_by(probe)[0]]
        self._switched = any(isinstance(load, Switch) for load in scene.loads.values())
        self._arrivals: dict[int, tuple[Begun, Begun]] = {}

    @property
    def fronts(self) -> NDArray:
        """Instants at which jumps or corners of the sources pass the probe, on any path, in order, s."""
        if self._switched:
            raise InputError("loads", "the fronts that switches send out are not known", "a scene without switches")
        return np.array(sorted({instant for wave in self._arriving(FEW_BITS) for instant, _ in wave}), float)

    def at(self, times: Iterable[Any], digits: int = 20) -> Exact:
        """Effort and flow at the probe; for arguments see `exact`."""
        instants = [instant(t) for t in times]
        self._check(instants, digits)
        if self._switched:
            found = lattice(self.network.scene, instants, self.probe)
            u, y = ([_divided(v, digits) for v in values] for values in found)
        else:
            order = sorted(set(instants))
            u, y = (dict(zip(order, values, strict=True)) for values in self._decimals(order, digits))
            u, y = [u[t] for t in instants], [y[t] for t in instants]
        z0 = _divided(self.z0, digits)
        largest = max(map(abs, [*u, *(z0 * v for v in y)]))
        return Exact(rounded(u, largest, digits), rounded(y, largest / z0, digits))

    def _check(self, instants: list[Fraction], digits: int) -> None:
        if not 1 <= digits <= MOST_DIGITS:
            raise InputError("digits", "not in range", f"1 to {MOST_DIGITS}", f"{digits}")
        if not instants:
            raise InputError("times", "there are none", "at least one instant")
        end = decimal(self.network.scene.t_end)
        for t in (min(instants), max(instants)):
            if not 0 <= t <= end:
                raise InputError("times", "not in the run", f"0 to {float(end):g} s", f"{float(t):g} s")

    def _arriving(self, bits: int) -> tuple[Begun, Begun]:
        if bits not in self._arrivals:
            with ctx.workprec(bits):
                self._arrivals[bits] = arrivals(self.network, self.probe, decimal(self.network.scene.t_end))
        return self._arrivals[bits]

    def _decimals(self, order: list[Fraction], digits: int) -> tuple[list[Decimal], ...]:
        bits = ceil(digits * log2(10)) + FEW_BITS
        while bits <= MOST_BITS:
            begun = self._arriving(bits)
            with ctx.workprec(bits):
                a, b = (sampled(wave, order) for wave in begun)
                u = [(p + q) / 2 for p, q in zip(a, b, strict=True)]
                y = [(p - q) / (2 * rational(self.z0)) for p, q in zip(a, b, strict=True)]
                if _sharp([*a, *b], arb(10) ** -(digits + 1)):
                    return decimals(u, digits), decimals(y, digits)
            bits *= 2
        raise InputError("digits", f"cannot be had with {MOST_BITS} bits", "fewer", f"{digits}")


def exact(scene: Scene, times: Iterable[Any], probe: str, digits: int = 20) -> Exact:
    """Compute the exact solution of a scene once; for scenes and method see `Solution`.

    Errors of u and z0 y are below 10^-digits (1 to 1000) of the largest of them at these times, s, in any order; at a
    jump the value is that before it.
    """
    return Solution(scene, probe).at(times, digits)


def _sharp(values: list[Any], share: Any) -> bool:
    """Whether all bounds are below that share of the largest value."""
    largest = max(abs(v.mid()) for v in values)
    return all(v.is_finite() and v.rad() <= largest * share for v in values)


def decimals(values: Iterable[arb], digits: int) -> list[Decimal]:
    """Midpoints, to more than a number of digits."""
    return [Decimal(v.mid().str(digits + GUARD_DIGITS, radius=False)) for v in values]


def _divided(value: Fraction, digits: int) -> Decimal:
    with localcontext() as context:
        context.prec = digits + GUARD_DIGITS
        return Decimal(value.numerator) / Decimal(value.denominator)


def rounded(values: list[Decimal], largest: Decimal, digits: int) -> tuple[Decimal, ...]:
    """Round to a number of digits of the largest."""
    with localcontext() as context:
        context.prec = digits + GUARD_DIGITS
        return tuple(v.quantize(Decimal(1).scaleb(largest.adjusted() - digits)) if largest else v for v in values)
