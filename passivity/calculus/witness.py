"""A point where a graph fails to be positive or bounded real: found in floats, shown in balls, kept in a file."""

import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from random import Random
from typing import Any

from flint import acb, ctx

from passivity.ball import of_fraction, of_point
from passivity.calculus.graph import BOUNDED_REAL, Fact, Graph, Value

FORMAT = "passivity witness 1"
MAX_TRIALS = 12  # choices of values for names
_RADII, _ANGLES = 40, (0.0, 0.8, 1.3, 1.5, 1.56, 1.5705)
_FINE = 300  # points near the axis

Witness = dict[str, Any]


def find_witness(
    graph: Graph, value: Value, claim: Fact, text: str, numbers: Mapping[str, Fraction] | None = None
) -> Witness | None:
    """A witness against a claim, values of the names included; None if none was found.

    Examples
    --------
    >>> from passivity.calculus.graph import POSITIVE_REAL
    >>> graph = Graph()
    >>> found = find_witness(graph, graph.sum([graph.s, (Fraction(-1), 0)]), POSITIVE_REAL, "s - 1")
    >>> holds(graph, value=graph.sum([graph.s, (Fraction(-1), 0)]), witness=found)
    True
    """
    order = _needed(graph, value[1])
    for values in _trials(graph):
        with_floats = {name: float(x) for name, x in values.items()}
        for s in _suspects(graph, order, value, claim, with_floats):
            for bits in (6, 14, 40):
                re, im = _short(s.real, bits), _short(s.imag, bits)
                witness = {
                    "format": FORMAT,
                    "text": text,
                    "claim": [str(x) for x in claim],
                    "names": {name: [str(x) for x in fact] for name, fact in graph.names.items()},
                    "numbers": {name: str(x) for name, x in (numbers or {}).items()},
                    "values": {name: str(x) for name, x in values.items()},
                    "s": [str(re), str(im)],
                }
                if re > 0 and holds(graph, value, witness):
                    with ctx.workprec(128):
                        witness["value"] = evaluated(graph, value, _values(witness), _point(witness)).str(
                            20, radius=False
                        )
                    return witness
    return None


def holds(graph: Graph, value: Value, witness: Witness) -> bool:
    """Whether balls show that the claim fails at the witness."""
    values, claim = _values(witness), tuple(witness["claim"])
    for name, x in values.items():
        kind, low, high = graph.names[name]
        if not (low <= x <= high and (kind == "real" or x >= 0 or low < 0)):
            return False
    for bits in (128, 512, 2048):
        with ctx.workprec(bits):
            s = _point(witness)
            found = evaluated(graph, value, values, s)
            if found.is_finite() and s.real > 0:
                if claim == ("disc", "-1", "1"):
                    failed, fine = abs(found) > 1, abs(found) <= 1
                else:
                    failed, fine = found.real < 0, found.real >= 0
                if failed or fine:
                    return bool(failed)
    return False


def _values(witness: Witness) -> dict[str, Fraction]:
    return {name: Fraction(x) for name, x in witness["values"].items()}


def _point(witness: Witness) -> acb:
    return of_point(*map(Fraction, witness["s"]))


def evaluated(graph: Graph, value: Value, values: Mapping[str, Fraction], s: acb) -> acb:
    """The value at a ball, with constants for the names."""
    known = {name: acb(of_fraction(x)) for name, x in values.items()}
    at = _Evaluation(graph, known, s, acb(1), lambda name, x: getattr(x, name)(), lambda c: of_fraction(c))
    return at.value(value, _needed(graph, value[1]))


class _Evaluation:
    """Nodes at one point, or at an array of them, in any arithmetic."""

    def __init__(self, graph: Graph, names: Mapping[str, Any], s: Any, one: Any, function: Any, exact: Any):
        self.graph, self.names, self.s, self.one, self.function, self.exact = graph, names, s, one, function, exact

    def value(self, value: Value, order: list[int]) -> Any:
        """A value, the nodes that it needs one after the other."""
        at: dict[int, Any] = {0: self.one}
        for n in order:
            at[n] = self._node(n, at)
        return at[value[1]] * self.exact(value[0])

    def _node(self, n: int, at: dict[int, Any]) -> Any:
        kind, parts = self.graph.nodes[n]
        exact = self.exact
        if kind == "s":
            return self.s
        if kind == "name":
            return self.names[parts[0]]
        if kind == "sum":
            return sum((at[m] if c == 1 else at[m] * exact(c) for c, m in parts[1:]), at[parts[0][1]])
        if kind == "mul":
            found = self.one
            for m, e in parts:
                found = found * at[m] if e == 1 else found / at[m] if e == -1 else found * at[m] ** e
            return found
        if kind == "ratio":
            p, q = (sum((exact(Fraction(c)) * self.s**k for k, c in enumerate(f)), 0 * self.one) for f in parts)
            return p / q
        scaled = [at[m] * exact(c) for c, m in parts]
        if kind == "line":
            z0, propagation, load = scaled
            wave = self.function("tanh", propagation)
            return z0 * (load + z0 * wave) / (z0 + load * wave)
        return self.function(kind, scaled[0])


def _needed(graph: Graph, root: int) -> list[int]:
    """What a node is made of, and itself, in order, without 1."""
    seen: set[int] = set()
    stack = [root]
    while stack:
        n = stack.pop()
        if n and n not in seen:
            seen.add(n)
            stack += graph.inner(n)
    return sorted(seen)


def _trials(graph: Graph) -> Iterator[dict[str, Fraction]]:
    """Values for the names: round ones, then random ones over decades; opaque functions are constants."""
    random = Random(0)
    for k in range(MAX_TRIALS if graph.names else 1):
        values = {}
        for name, (_, low, high) in graph.names.items():
            size = Fraction(round(10 ** random.uniform(-2, 2) * 64) + 1, 64) if k else Fraction(1)
            if low == high:
                x = low
            elif high == math.inf:
                x = low + size if low > -math.inf else size * random.choice((1, -1) if k else (1,))
            else:
                x = (
                    high - size
                    if low == -math.inf
                    else low + (high - low) * Fraction(random.randint(1, 7) if k else 4, 8)
                )
            values[name] = x
        yield values


def _suspects(graph: Graph, order: list[int], value: Value, claim: Fact, names: dict[str, float]) -> Iterator[complex]:
    """Points of a grid where floats see the claim fail, the worst first."""
    import numpy as np

    scales = [
        abs(float(c))
        for n in order
        if graph.nodes[n][0] in ("sum", "exp", "tanh", "line")
        for c, _ in graph.nodes[n][1]
    ]
    scales = [x for x in (*scales, *map(abs, names.values())) if 1e-30 < x < 1e30] or [1.0]
    low, high = 1e-3 / max(1.0, *scales), 1e3 / min(1.0, *scales)
    radii = np.geomspace(low, high, _RADII)
    s = (radii[:, None] * np.exp(1j * np.array(_ANGLES))).ravel()
    fine = np.geomspace(low, high, _FINE)
    s = np.concatenate([s, fine * (1e-6 + 1j)])

    def function(name: str, x: Any) -> Any:
        return getattr(np, name)(x)

    with np.errstate(all="ignore"):
        found = _Evaluation(graph, names, s, np.ones_like(s), function, float).value(value, order) * np.ones_like(s)
        wrong = np.abs(found) - 1 if claim == BOUNDED_REAL else -found.real / np.abs(found)
    wrong = np.where(np.isfinite(wrong), wrong, -np.inf)
    worst = np.argsort(-wrong)[:6]
    yield from (complex(s[k]) for k in worst if wrong[k] > 1e-12)


def _short(x: float, bits: int) -> Fraction:
    if not x:
        return Fraction(0)
    grid = Fraction(2) ** (math.frexp(x)[1] - bits)
    return round(Fraction(x) / grid) * grid


def check_file(witness: Witness) -> str | None:
    """None if a witness, as its file is read, shows that its text lacks the property; else what is wrong."""
    from passivity.calculus.read import read

    try:
        need = witness["format"] == FORMAT and witness["claim"] in (["disc", "0", "inf"], ["disc", "-1", "1"])
        names: dict[str, Fact] = {name: _allowed(fact) for name, fact in witness["names"].items()}
        graph = Graph(names)
        value = read(graph, witness["text"], {name: Fraction(x) for name, x in witness["numbers"].items()})
        return None if need and holds(graph, value, witness) else "balls do not show that the claim fails there"
    except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError) as error:
        return f"not a witness: {error}"


def _allowed(fact: list[str]) -> Fact:
    kind, low, high = fact
    return kind, *(float(x) if x in ("inf", "-inf") else Fraction(x) for x in (low, high))
