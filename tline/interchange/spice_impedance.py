"""R, L and C of SPICE netlists, with models, factors, begins and parasitics, and inductors that K couples."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from itertools import combinations, pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import Netlist
from tline.interchange.spice_expression import AMPERES, number
from tline.scene.multiport import TIGHTEST

KINDS = {"R": ("resistor", "resistance"), "L": ("inductor", "inductance"), "C": ("capacitor", "capacitance")}
VALUE = {"R": ("r", "res"), "L": ("l", "ind"), "C": ("c", "cap")}
COEFFICIENTS = ("tc", "tc1", "tc2", "tce")  # of temperature, which is the nominal one
PARASITIC = ("rser", "lser", "rpar", "cpar")
NO_MATTER = {  # None, or the value that changes nothing
    "noisy": None, "tol": None, "pwr": None, "ac": None, "v": None, "irms": None, "ipk": None, "mfg": None,
    "type": None, "pn": None, "temp": None, "dtemp": 0.0, "vc1": 0.0, "vc2": 0.0, "kf": None, "af": None,
    "tnom": None, "tref": None, "level": None,
}  # fmt: skip
NO_INDUCTANCE = 1e-12  # of a winding's: rest of it beside the windings before
MOST_WINDINGS = 16


def value_of(card: Card, net: Netlist) -> float:
    """The value of R, L or C, with its factors."""
    plain, assigned = card.assigned(2)
    words = [word for word in plain if word.lower() != "off"]
    words += [word for key in VALUE[card.kind] for word in assigned.pop(key, [])]
    models = [model for word in words if (model := _model(card, net, word))]
    values = [word for word in words if not _model(card, net, word)]
    if len(values) > 1 or len(models) > 1 or not words:
        raise card.refuse(
            "its value is not given once", "two nodes and a number, a model, or both", f"'{' '.join(plain):.40}'"
        )
    if values and number(values[0]) is not None and values[0].lower().endswith(AMPERES):
        raise card.refuse("a value in ampere, or in HSPICE one of 1e-18", "1e-18 where that is meant", values[0])
    value = card.value(values[0]) if values else 0.0
    if models:
        value = _by_model(card, models[0], value if values else None, assigned)
    factors = {key: _number(card, assigned.pop(key, ["1"]), key) for key in ("m", "scale")}
    if min(factors.values()) <= 0:
        raise card.refuse("M and SCALE are not above zero", "1")
    _check_harmless(card, {key: words for key, words in assigned.items() if key not in PARASITIC}, net)
    return value * factors["scale"] * (factors["m"] if card.kind == "C" else 1 / factors["m"])


def _model(card: Card, net: Netlist, word: str) -> Card | None:
    """The model of that name, if it is the name of one."""
    if number(word) is None and word[0] not in "{'\"" and word.lower() not in card.parameters:
        with suppress(InputError):
            return net.model(card, word)
    return None


def _number(card: Card, words: list[str], key: str) -> float:
    if len(words) != 1:
        raise card.refuse(f"{key.upper():.40} is not one number", f"{key.upper():.40}=1", f"'{' '.join(words):.40}'")
    return card.value(words[0])


def _check_harmless(card: Card, given: Mapping[str, list[str]], net: Netlist) -> None:
    """Refuse parameters that change the value; temperature coefficients have no effect at the nominal temperature."""
    for key, words in given.items():
        if key in COEFFICIENTS and any(map(card.value, words)):
            net.found.note(card.where, f"{key.upper()} is skipped: it is at its nominal temperature")
        elif key not in COEFFICIENTS and (key != "ic" or card.kind == "R"):
            neutral = NO_MATTER.get(key, ...)
            if neutral is ... or (neutral is not None and any(card.value(word) != neutral for word in words)):
                problem = f"{key.upper()} other than {neutral:g}" if isinstance(neutral, float) else f"{key:.40}"
                got = f"'{' '.join(words):.40}'"
                raise card.refuse(f"{problem} is not known here", "two nodes and a number", got)


def _by_model(card: Card, model: Card, value: float | None, own: dict[str, list[str]]) -> float:
    """A value by itself, by width and length, or the model's own."""
    model.of_kind(*map(str.upper, VALUE[card.kind]))
    said = {key: _number(model, words, key) for key, words in model.assigned(2)[1].items()}
    said = {"narrow": 0.0, "defw": 1e-5, "cjsw": 0.0} | said
    bent = [key for key in ("vc1", "vc2") if said.get(key)]
    if bent:
        raise model.refuse(f"{bent[0].upper()} other than 0 is not known here", "a constant value")
    size = {key: _number(card, own.pop(key), key) - said["narrow"] for key in ("l", "w") if key in own}
    if value is not None:
        if said.get("r", 1.0) != 1:
            raise model.refuse("a factor of R beside a value", "R=1, or no value", f"{said['r']:g}")
        return value
    length, width = size.get("l", 0.0), size.get("w", said["defw"] - said["narrow"])
    if length > 0 and width > 0 and card.kind == "R" and "rsh" in said:
        return said["rsh"] * length / width
    if length > 0 and width > 0 and card.kind == "C" and "cj" in said:
        return said["cj"] * length * width + 2 * said["cjsw"] * (length + width)
    for key in VALUE[card.kind]:
        if key in said:
            return said[key]
    raise card.refuse("has no value, nor a length on a model with one per square", "two nodes and a number")


def impedance(card: Card, net: Netlist) -> None:
    """Add R, L or C to the scene, with LTspice's series and parallel parasitics."""
    kind, key = KINDS[card.kind]
    first, second, value = net.node(card.words[0]), net.node(card.words[1]), value_of(card, net)
    if card.kind == "R" and value == 0:
        net.short(card, (first, second))
        return
    if first == second:
        net.found.note(card.where, "skipped, for both its ends are at one node")
        return
    if value <= 0:
        raise card.refuse("its value is not above zero", "more than 0", f"{value:g}")
    given = card.assigned(2)[1]
    parasitic = {key: _number(card, given[key], key) for key in PARASITIC if key in given and card.kind != "R"}
    if min(parasitic.values(), default=0.0) < 0:
        raise card.refuse("a parasitic value below zero", "0 or more")
    for key_beside, table in (("rpar", ("resistor", "resistance")), ("cpar", ("capacitor", "capacitance"))):
        if size := parasitic.get(key_beside):
            net.between(card, (first, second), {"kind": table[0], table[1]: size}, f"{card.name}.{key_beside}")
    begin = _at_begin(card, net, (first, second))
    for key_within, table in (("rser", ("resistor", "resistance")), ("lser", ("inductor", "inductance"))):
        if size := parasitic.get(key_within):
            inner = f"{card.name}.{key_within}"
            net.between(card, (first, inner), {"kind": table[0], table[1]: size}, inner)
            first = inner
    if card.kind == "L" and card.name.lower() in net.coupled:
        if begin:
            raise card.refuse("a current at t = 0 in a coupled inductor", "IC=0", f"{begin:g}")
        net.windings[card.name.lower()] = value, (first, second)
        return
    if begin and card.kind == "C":
        inner = f"{card.name}.ic"
        net.source(card, (first, inner), {"kind": "voltage", "value": begin}, inner)
        first = inner
    elif begin:
        net.source(card, (second, first), {"kind": "current", "value": begin}, f"{card.name}.ic")
    net.between(card, (first, second), {"kind": kind, key: value})


def _at_begin(card: Card, net: Netlist, ends: tuple[str, str]) -> float:
    """Voltage of C or current of L at t = 0."""
    given = card.assigned(2)[1].get("ic") if card.kind in "LC" else None
    if given is None:
        return net.at_begin(ends) if card.kind == "C" and net.tran.uic else 0.0
    if not net.tran.uic:
        net.found.note(card.where, "its IC is skipped, for .tran has no UIC")
        return 0.0
    return _number(card, given, "ic")


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
    """Add inductors that are coupled, directly or through others, to the scene."""
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
    """Add two coupled inductors as one element, or as a transformer and a magnetising inductance if leakage is tiny."""
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
    """Add windings, each an inductance in series with ideal windings coupled to those before it.

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
    """Factors M and D of L; entries of D below rounding are zero."""
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
