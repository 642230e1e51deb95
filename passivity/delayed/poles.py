"""Poles in Re s > 0 of a factor without delays and roots, which no exponential can cancel.

Multiplied out, F = n/(f g) with f a polynomial in s alone. Near a root r of f, |F| grows without bound if n/g stays
away from 0 there, which a ball around r shows. Where n vanishes too, as in (exp(-s) - exp(-2))/(s - 2), it does not.
"""

from collections.abc import Iterator
from typing import NamedTuple

from flint import acb, arb, ctx, fmpz_mpoly, fmpz_poly

from passivity.budget import spend
from passivity.calculus.expand import Expansion, Pair
from passivity.calculus.graph import Graph, Value
from passivity.polynomial.roots import roots_on_axis
from passivity.polynomial.sign import squarefree
from passivity.status import Kind

_BITS = 256
_MAX_DEGREE = 60


class Pole(NamedTuple):
    """A pole, or for an impedance a zero, in a ball in Re s >= 0."""

    place: acb
    word: str


def find_pole(kind: Kind, graph: Graph, value: Value) -> Pole | None:
    """A pole in Re s > 0 or, of a reflection, on the axis; of an impedance also a zero in Re s > 0."""
    expansion = Expansion(graph, value[1])
    whole = expansion.of(value).reduced()
    for word, x in (("pole", whole), ("zero", whole.inverse())):
        f = _alone(x.q)
        if not 0 < f.degree() <= _MAX_DEGREE or (word == "zero" and kind is Kind.BR):
            continue
        rest = Pair(x.p, x.q / expansion.univariate(f))
        for root in _roots(kind, f):
            if _stays_away(expansion, rest, root):
                return Pole(root, word)
    return None


def _alone(d: fmpz_mpoly) -> fmpz_poly:
    """The factor of a polynomial that is free of all generators but s."""
    by_generators: dict[tuple, dict[int, int]] = {}
    for exponents, c in d.to_dict().items():
        by_generators.setdefault(tuple(exponents[1:]), {})[int(exponents[0])] = int(c)
    found = fmpz_poly([])
    for powers in by_generators.values():
        found = found.gcd(fmpz_poly([powers.get(k, 0) for k in range(max(powers) + 1)]))
    return found


def _roots(kind: Kind, f: fmpz_poly) -> Iterator[acb]:
    """Balls around the roots in Re s > 0 and, for a reflection, those on the axis; one of each pair."""
    for factor, _ in squarefree(f):
        if factor.degree() < 1:
            continue
        spend(100 * len(factor) ** 2 * (factor.height_bits() + _BITS), f"the roots of degree {factor.degree()}")
        with ctx.workprec(_BITS):
            roots: list = factor.complex_roots()
        yield from (root for root, _ in roots if root.real > 0 and not root.imag < 0)
        if kind is Kind.BR and not factor[0]:
            yield acb(0)
        for found, _ in roots_on_axis(factor) if kind is Kind.BR else ():
            root = found.refined(_BITS)
            with ctx.workprec(2 * _BITS):
                yield acb(0, arb(root.low).union(arb(root.high)).sqrt())


def _stays_away(expansion: Expansion, rest: Pair, root: acb) -> bool:
    """Whether a function has no zero in a small ball around a point, nor is infinite there."""
    with ctx.workprec(_BITS):
        size = abs(root).upper() if root != 0 else arb(1)
        room = arb(0, (size * arb(2) ** (16 - _BITS)).upper())
        s = acb(root.real + room, root.imag + room)
        there = expansion.value(rest.p, s) / expansion.value(rest.q, s)
    return bool(there.is_finite() and there != 0)
