"""Inductors of SPICE netlists that K couples: two of them, or any number by their matrix."""

from collections.abc import Iterable, Iterator
from itertools import combinations, pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.interchange.deck import Card
from tline.interchange.netlist import Netlist
from tline.scene.multiport import TIGHTEST

NO_INDUCTANCE = 1e-12  # of a winding's: what is left of it beside the windings before
MOST_WINDINGS = 16


class Coupling(NamedTuple):
    """A pair of windings by name in lower case, the card that couples them, and how much."""

    card: Card
    names: tuple[str, str]
    value: float


def names_coupled(cards: Iterable[Card]) -> Iterator[str]:
    """Inductors that the cards couple, in lower case."""
    for card in cards:
        if card.kind == "K":
            yield from (word.lower() for word in (card.words if "=" in card.words else card.words[:-1]))


def couplings(card: Card) -> list[Coupling]:
    """All pairs that a K couples."""
    plain, assigned = card.assigned(0)
    *names, value = [*plain, *assigned.get("k", [])] or [""]
    if not 2 <= len(names) <= MOST_WINDINGS or assigned.keys() - {"k"}:
        raise card.refuse("couples other than inductors", "K1 L1 L2 0.9", f"'{' '.join(card.words):.40}'")
    coupling = card.value(value)
    if abs(coupling) > 1:
        raise card.refuse("a coupling that no windings have", "from -1 to 1", f"{coupling:g}")
    return [Coupling(card, (a.lower(), b.lower()), coupling) for a, b in combinations(names, 2)]


def add_coupled(given: list[Coupling], net: Netlist) -> None:
    """Let inductors that are coupled, directly or through others, be part of the scene."""
    groups: dict[str, list[str]] = {}
    missing = {name for coupling in given for name in coupling.names} - net.windings.keys()
    for card, names, _ in given:
        if missing.intersection(names):
            got = ", ".join(sorted(missing.intersection(names)))
            net.found.mistakes.append(card.refuse("no such inductor", "the names of L", f"'{got:.40}'"))
            continue
        one, other = (groups.setdefault(name, [name]) for name in names)
        if one is not other:
            one += other
            groups |= dict.fromkeys(other, one)
    for names in {id(group): group for group in groups.values()}.values():
        own = [coupling for coupling in given if {*coupling.names} <= {*names}]
        with net.found.gathered():
            if len(own) == 1:
                _pair(own[0], net)
            else:
                _windings(names, own, net)


def _pair(coupling: Coupling, net: Netlist) -> None:
    """Two inductors as one element; without leakage, or nearly so, a transformer beside what magnetises it."""
    card, names, value = coupling
    if names[0] == names[1]:
        raise card.refuse("couples one inductor with itself", "two")
    (one, first), (two, second) = (net.windings[name] for name in names)
    if abs(value) <= TIGHTEST:
        table = {"inductance": [one, two], "signed_coupling": value}
        net.two_port(card, (first, second), "coupled inductors", **table)
        return
    magnetising, leakage = one * value**2, one * (1 - value**2)
    if leakage:
        inner = f"{card.name}.leakage"
        net.between(card, (first[0], inner), {"kind": "inductor", "inductance": leakage}, inner)
        first = inner, first[1]
    net.between(card, first, {"kind": "inductor", "inductance": magnetising}, f"{card.name}.magnetising")
    net.two_port(card, (first, second), "transformer", signed_ratio=value * sqrt(one / two))


def _windings(names: list[str], given: list[Coupling], net: Netlist) -> None:
    """Windings of which each is an inductance of its own in a row with ideal windings over those before it.

    With the inductances L = M D Mᵀ, M unit lower triangular, the voltage of winding i is the sum of M_ik times that of
    inductance D_k, whose current is that of winding k and M_ik times those of the windings behind.
    """
    card, size = given[0].card, len(names)
    if size > MOST_WINDINGS:
        raise card.refuse("too many coupled inductors", f"at most {MOST_WINDINGS}", f"{size}")
    L = np.diag([net.windings[name][0] for name in names])
    for coupling in given:
        i, k = map(names.index, coupling.names)
        if i == k or L[i, k]:
            raise coupling.card.refuse("couples what is coupled already", "each pair once", " ".join(coupling.names))
        L[i, k] = L[k, i] = coupling.value * sqrt(L[i, i] * L[k, k])
    M, D = _factors(L)
    if D.min() < 0:
        raise card.refuse("couplings that no windings have together", "a matrix of inductances without negative energy")
    own = {k: f"{card.name}.{names[k]}" for k in range(size)}
    across: dict[int, tuple[str, str]] = {}
    for i, name in enumerate(names):
        first, last = net.windings[name][1]
        behind = [k for k in range(i) if M[i, k] and D[k]]
        parts = [*behind, *([i] if D[i] else [])]
        nodes = [first, *(f"{own[i]}.{n}" for n in range(1, len(parts))), last]
        for k, ends in zip(parts, pairwise(nodes), strict=True):
            if k == i:
                across[i] = ends
                net.between(card, ends, {"kind": "inductor", "inductance": float(D[i])}, f"{own[i]}.l")
            else:
                ratio = float(M[i, k])
                net.two_port(card, (ends, across[k]), "transformer", f"{own[i]}.{names[k]}", signed_ratio=ratio)


def _factors(L: NDArray) -> tuple[NDArray, NDArray]:
    """M and D; what is less than rounding of D is zero."""
    n, rest = len(L), L.copy()
    M, D = np.eye(n), np.zeros(n)
    for k in range(n):
        D[k] = rest[k, k] if abs(rest[k, k]) > NO_INDUCTANCE * L[k, k] else 0.0
        if D[k] > 0:
            M[k:, k] = rest[k:, k] / D[k]
            rest -= D[k] * np.outer(np.append(np.zeros(k), M[k:, k]), np.append(np.zeros(k), M[k:, k]))
        elif np.abs(rest[k + 1 :, k]).max(initial=0.0) > sqrt(NO_INDUCTANCE) * L.max():
            D[k] = -1.0
            break
    return M, D
