"""Networks of R, L and C between nodes, reduced to what lies between those that stay."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from passivity import RationalFunction
from tline.scene.rational import MOST_STATES


@dataclass(eq=False)
class Branch:
    """An impedance between two nodes, and the names of the elements it is made of."""

    nodes: tuple[str, str]
    impedance: RationalFunction
    names: list[str]

    @property
    def name(self) -> str:
        """Names of all its elements."""
        return " + ".join(self.names)

    def other(self, node: str) -> str:
        """The node at the other end."""
        return self.nodes[self.nodes[0] == node]


def element(kind: str, value: float) -> RationalFunction:
    """Impedance of R, L or C, exact for the decimal typed."""
    exact = Fraction(repr(value))
    numerator, denominator = {"R": ([exact], [1]), "L": ([exact, 0], [1]), "C": ([1], [exact, 0])}[kind]
    return RationalFunction.from_coefficients(numerator, denominator)


def reduced(branches: Iterable[Branch], kept: Collection[str]) -> list[Branch]:
    """Branches between kept nodes: others are taken away where two branches meet, in series, or run side by side.

    What cannot be taken away so, or would be of a higher degree than a load may have, is left as it is.

    Examples
    --------
    >>> R, C = Branch(("a", "x"), element("R", 50.0), ["R"]), Branch(("0", "x"), element("C", 1e-9), ["C"])
    >>> [(branch.nodes, branch.name) for branch in reduced([R, C], {"a", "0"})]
    [(('a', '0'), 'R + C')]
    """
    at: dict[str, list[Branch]] = defaultdict(list)
    for branch in branches:
        for node in branch.nodes:
            at[node].append(branch)
    waiting = [node for node in at if node not in kept]
    while waiting:
        node = waiting.pop()
        _side_by_side(at, node)
        if len(at[node]) != 2:
            continue
        one, two = at[node]
        ends, total = (one.other(node), two.other(node)), (one.impedance + two.impedance).reduced()
        if total.degree > MOST_STATES or ends[0] == ends[1] or node in ends:
            continue
        both = Branch(ends, total, one.names + two.names)
        for end, old in zip(ends, (one, two), strict=True):
            at[end] = [both if branch is old else branch for branch in at[end]]
        del at[node]
        waiting += [end for end in ends if end not in kept]
    return list({id(branch): branch for there in at.values() for branch in there}.values())


def _side_by_side(at: dict[str, list[Branch]], node: str) -> None:
    """Merge branches from a node to the same other node."""
    found: dict[str, Branch] = {}
    for branch in at[node]:
        there = branch.other(node)
        before = found.setdefault(there, branch)
        if before is branch:
            continue
        beside = before.impedance.parallel(branch.impedance).reduced()
        if beside.degree > MOST_STATES:
            return
        found[there] = Branch((node, there), beside, before.names + branch.names)
        at[there] = [found[there] if b is before else b for b in at[there] if b is not branch]
        at[node] = [found[there] if b is before else b for b in at[node] if b is not branch]


def as_load(impedance: RationalFunction) -> dict[str, Any]:
    """A load of that impedance as in a scene file: R, L and C in series or side by side where it is that.

    Examples
    --------
    >>> as_load(element("R", 50.0).parallel(element("C", 1e-9)))
    {'kind': 'parallel', 'resistance': 50.0, 'capacitance': 1e-09}
    """
    impedance = impedance.reduced()
    if impedance.degree == 0:
        return {"kind": "resistor", "resistance": float(impedance.at_zero())}
    p, q = impedance.numerator, impedance.denominator
    series, parallel = _parts(p, q), _parts(q, p)
    if series:
        keys = ("inductance", "resistance", "capacitance")
        values = [series[0], series[1], 1 / series[2] if series[2] else Fraction(0)]
    elif parallel:
        keys = ("capacitance", "resistance", "inductance")
        values = [parallel[0], *(1 / part if part else Fraction(0) for part in parallel[1:])]
    else:
        return {"kind": "impedance", "numerator": [str(a) for a in p], "denominator": [str(a) for a in q]}
    given = {key: float(value) for key, value in zip(keys, values, strict=True) if value}
    order = ("resistance", "inductance", "capacitance")
    return {"kind": "series" if series else "parallel"} | {key: given[key] for key in order if key in given}


def _parts(p: Sequence[Fraction], q: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction] | None:
    """a, b, c of p/q = a s + b + c/s, all at least zero; None if it is not that."""
    power = len(q) - 1
    if power > 1 or any(q[1:]) or len(p) > power + 2:
        return None
    a, b, c = [Fraction(0)] * (3 - len(p) - (power == 0)) + [x / q[0] for x in p] + [Fraction(0)] * (power == 0)
    return (a, b, c) if min(a, b, c) >= 0 else None
