"""Rewritings of a function: with each part occurring once, or as a line with its termination."""

from collections.abc import Iterator
from fractions import Fraction
from math import prod
from typing import Any

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from passivity.calculus.graph import UNIT, ZERO, Graph, Value
from passivity.polynomial.roots import to_fmpq
from passivity.verifier import added

MAX_TERMS = 40  # of sums that are multiplied out

Rewriting = tuple[bool, Value, list[int]]  # of the inverse instead; the value; nodes that are not looked into
Line = tuple[Value, Value, Value]  # z0, propagation, load
Reading = tuple[bool, int, Line, list[int]]  # as before, of 1 or -1 times a line


def rewritings(graph: Graph, n: int) -> Iterator[Rewriting]:
    """Other ways to write a node, the promising first; then its inverse, if it is a product."""
    yield from _written(graph, n)
    if graph.nodes[n][0] == "mul":
        inverse = graph.inverse((Fraction(1), n))[1]
        yield from ((not upside_down, value, cut) for upside_down, value, cut in _written(graph, inverse))


def _written(graph: Graph, n: int) -> Iterator[Rewriting]:
    powers = graph.powers(n)
    sums = sorted((b for b in powers if graph.nodes[b][0] == "sum"), reverse=True)
    yield from _cayley(graph, powers, sums)
    yield from _parallel(graph, powers, sums)
    yield from _of_two(graph, powers, sums)
    yield from _cancelled(graph, powers, sums)
    if not graph.moves[n]:
        return
    yield from _spread(graph, powers, [b for b in sums if graph.moves[b]])
    yield from _together(graph, powers, sums)


def _together(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """A factor that is a sum over the common denominator of its terms, where that leaves fewer of these."""
    for base in sums:
        terms = graph.nodes[base][1]
        under = [{b: -e for b, e in graph.powers(m).items() if e < 0 and graph.nodes[b][0] == "sum"} for _, m in terms]
        if below := {b: max(each.get(b, 0) for each in under) for b in sorted(set().union(*under))}:
            over = _powered(graph, below)
            above = graph.sum([graph.product([term, over]) for term in terms])
            if len(graph.terms(above[1])) < len(terms):
                rest = _powered(graph, {b: e for b, e in powers.items() if b != base})
                e = powers[base]
                yield False, graph.product([above, over, rest], [e, -e, 1]), list(below)


def _cancelled(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """Cancel common factors of sums in N and D, once these are multiplied out as polynomials in their atoms."""
    above, below = ({b: abs(powers[b]) for b in sums if powers[b] * sign > 0} for sign in (1, -1))
    if not above or not below or sum(len(graph.terms(b)) * abs(powers[b]) for b in sums) > MAX_TERMS:
        return
    inside, atoms, known = {m for b in sums for m in graph.terms(b)}, [], list(sums)
    bases = {b for m in inside for b in graph.powers(m) if graph.nodes[b][0] == "sqrt"}
    squares = {b: graph.powers(m) for b in bases for c, m in graph.nodes[b][1] if c == 1 and m}
    for b in known:
        for base, e in [each for m in graph.terms(b) for each in _rooted(graph.powers(m), squares).items()]:
            if e > 0 and graph.nodes[base][0] == "sum" and inside.issuperset(graph.terms(base)):
                known += [base] * (base not in known)
            elif (base, e > 0) not in atoms:
                atoms.append((base, e > 0))
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(atoms))], Ordering.lex)
    of_atom = dict(zip(atoms, ring.gens(), strict=True))

    def polynomial(b: int, power: int) -> fmpq_mpoly:
        if power < 0 or b not in known:
            return of_atom[b, power > 0] ** abs(power)
        products = ((c, _rooted(graph.powers(m), squares)) for m, c in graph.terms(b).items())
        terms = (prod((polynomial(*each) for each in x.items()), start=ring.constant(to_fmpq(c))) for c, x in products)
        return sum(terms, ring.constant(0)) ** power

    def value(f: fmpq_mpoly) -> Value:
        bases, signs = [(Fraction(1), base) for base, _ in atoms], [1 if up else -1 for _, up in atoms]
        terms = ((c, graph.product(bases, [s * int(e) for s, e in zip(signs, x, strict=True)])) for x, c in f.terms())
        return graph.sum(graph.scaled(each, Fraction(int(c.p), int(c.q))) for c, each in terms)

    p, q = (prod((polynomial(*each) for each in side.items()), start=ring.constant(1)) for side in (above, below))
    common = p.gcd(q)
    if len(common) > 1:
        rest = _powered(graph, {b: e for b, e in powers.items() if b not in sums})
        cut = [b for b in _atoms(graph, sums) if b not in known]
        yield False, graph.product([value(p / common), value(q / common), rest], [1, -1, 1]), cut


def _rooted(powers: dict[int, Any], squares: dict[int, dict[int, Any]]) -> dict[int, Any]:
    """The powers with squares of roots in place of what is under these."""
    for root, inside in squares.items():
        for sign in (1, -1):
            while all(sign * powers.get(b, 0) * e >= e * e for b, e in inside.items()):
                powers = added(powers, {b: -sign * e for b, e in inside.items()} | {root: 2 * sign})
    return powers


def _cayley(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """N/D as (2/(1 + X) - 1)/k, X = (D - k N)/(D + k N), where one of these has fewer terms than N and D."""
    for (x, a), others, b in _quotients(graph, powers, sums):
        up, down = graph.terms(a, x), graph.terms(b)
        for k in () if others else sorted({down[m] / c for m, c in up.items() if m in down}, reverse=True):
            less, more = (added(down, {m: sign * k * c for m, c in up.items()}) for sign in (-1, 1))
            if less and more and min(len(less), len(more)) < len(up | down):
                less, more = (graph.sum((Fraction(c), m) for m, c in f.items()) for f in (less, more))
                one = graph.sum([UNIT, graph.product([less, more], [1, -1])])
                whole = graph.sum([graph.scaled(graph.inverse(one), 2), (Fraction(-1), 0)])
                yield False, graph.scaled(whole, 1 / k), _atoms(graph, [less[1], more[1]])


def _of_two(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """k (a b + A^2)/(a + b) as k A (2/(1 - X Y) - 1), X = 1 - 2/(1 + a/A), as coth of a sum is; k and A constant."""
    for (x, n), others, d in _quotients(graph, powers, sums):
        above = list(graph.terms(n, x).items())
        if others or len(above) != 2 or len(graph.terms(d)) != 2:
            continue
        a, b = graph.nodes[d][1]
        for (m, c), (m2, c2) in (above, above[::-1]):
            k = graph.product([(c, m), a, b], [1, -1, -1])
            square = graph.product([(c2, m2), k], [1, -1])
            if not graph.moves[k[1]] and not graph.moves[square[1]] and square[0] > 0:
                size = graph.function("sqrt", square)
                ones = (graph.sum([UNIT, graph.product([part, size], [1, -1])]) for part in (a, b))
                waves = [graph.sum([UNIT, graph.scaled(graph.inverse(one), -2)]) for one in ones]
                less = graph.sum([UNIT, graph.scaled(graph.product(waves), -1)])
                whole = graph.sum([graph.scaled(graph.inverse(less), 2), (Fraction(-1), 0)])
                yield False, graph.product([k, size, whole]), _atoms(graph, [a[1], b[1]])


def _quotients(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[tuple[Value, dict[int, int], int]]:
    """N, the other factors and D of a product N/D times others: N is a sum, or all but 1/D."""
    for b in (b for b in sums if powers[b] == -1):
        others = {m: e for m, e in powers.items() if m != b}
        for over in [*({a: 1} for a in sums if powers[a] == 1 and len(others) > 1), others]:
            yield _powered(graph, over), {m: e for m, e in others.items() if m not in over}, b


def _parallel(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """c N/D upside down, as k/c + (r/c)/N, where D = k N + r and r has fewer terms."""
    for n, others, b in _quotients(graph, powers, sums):
        up, down = graph.terms(n[1], n[0]), graph.terms(b)
        for k in sorted({c / up[m] for m, c in down.items() if m in up}, reverse=True):
            left = added(down, {m: -k * c for m, c in up.items()})
            if k > 0 and left and len(left) < len(down):
                c = _powered(graph, {m: -e for m, e in others.items()})
                r = graph.sum((Fraction(x), m) for m, x in left.items())
                over = graph.product([r, c, n], [1, 1, -1])
                yield True, graph.sum([graph.scaled(c, k), over]), _atoms(graph, [n[1], b])


def _powered(graph: Graph, powers: dict[int, int]) -> Value:
    """The product of some nodes to powers."""
    return graph.product(((Fraction(1), m) for m in powers), list(powers.values()))


def _spread(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """Distribute a product over the terms of a sum in the numerator, or its inverse over one in the denominator."""
    for b in sums:
        e = powers[b]
        if e not in (1, -1) or len(powers) == 1:
            continue
        rest = [((Fraction(1), m), e * k) for m, k in powers.items() if m != b]
        terms = [graph.product([term, *(v for v, _ in rest)], [1, *(k for _, k in rest)]) for term in graph.nodes[b][1]]
        yield e < 0, graph.sum(terms), _atoms(graph, [b, *(m for (_, m), _ in rest)], deeper=b)


def lines(graph: Graph, n: int) -> Iterator[Reading]:
    """Ways to read c (P + Q t)/(R + S t) as a line: t = tanh B, A = c Q/R, Z = c P/R; or t = exp(-2 B), A = c P/R."""
    powers = graph.powers(n)

    def without(*bases: int) -> Value:
        return _powered(graph, {b: e for b, e in powers.items() if b not in bases})

    for t, e in powers.items():
        if graph.nodes[t][0] == "tanh" and abs(e) == 1 and len(powers) > 1:  # the end is shorted, or open
            z0 = without(t) if e > 0 else graph.inverse(without(t))
            yield e < 0, 1, (z0, graph.nodes[t][1][0], ZERO), [t, *_factors(graph, z0[1])]
    above, below = ([b for b, e in powers.items() if e == sign and graph.nodes[b][0] == "sum"] for sign in (1, -1))
    for up in above:
        for down in below:
            for t in sorted(_waves(graph, up) & _waves(graph, down), reverse=True):
                (k, p, q), (m, r, s) = (_split(graph, b, t) for b in (up, down))
                for upside_down in (False, True) if k is not None and k == m else ():
                    c = without(up, down)
                    c, ends = (graph.inverse(c), (r, s, p, q)) if upside_down else (c, (p, q, r, s))
                    if found := _line(graph, t, c, *ends):
                        yield upside_down, *found
                        break


def _waves(graph: Graph, b: int) -> set[int]:
    """tanh and exp in the terms of a sum."""
    return {
        x for _, m in graph.nodes[b][1] for x, e in graph.powers(m).items()
        if e in (1, -1) and graph.nodes[x][0] in ("tanh", "exp")
    }  # fmt: skip


def _split(graph: Graph, b: int, t: int) -> tuple[int | None, Value, Value]:
    """Return k, P and Q of a sum t^k (P + Q t); k is None for any other sum."""
    found: dict[int, list[Value]] = {}
    for c, m in graph.nodes[b][1]:
        powers = graph.powers(m)
        k = powers.get(t, 0)
        x, rest = graph.product([(c, m), (Fraction(1), t)], [1, -k]) if k else (c, m)
        found.setdefault(k, []).append((x, rest))
    k = min(found)
    return (k if found.keys() <= {k, k + 1} else None), graph.sum(found[k]), graph.sum(found.get(k + 1, ()))


def _line(graph: Graph, t: int, c: Value, p: Value, q: Value, r: Value, s: Value) -> Any:
    """Write c (P + Q t)/(R + S t) or its negative as a line; None where constants degenerate, as with R = 0."""
    kind, ((x, through),) = graph.nodes[t]
    if kind == "exp" and x > 0:
        p, q, r, s = q, p, s, r
    if not r[0]:
        return None
    z0 = graph.product([c, q if kind == "tanh" else p, r], [1, 1, -1])
    if kind == "tanh":
        load = graph.product([c, p, r], [1, 1, -1])
    else:
        h, n = graph.product([s, r], [1, -1])
        powers = graph.powers(n)
        under = {b: -e for b, e in powers.items() if e < 0}
        for b in under if len(under) > 1 else ():  # the rest occurs in a sum below
            if powers[b] == -1 and _powered(graph, {m: e for m, e in powers.items() if m != b})[1] in graph.terms(b):
                under = {b: 1}
        below = _powered(graph, under)
        above = graph.product([(Fraction(1), n), below])
        less, more = graph.sum([below, graph.scaled(above, -h)]), graph.sum([below, graph.scaled(above, h)])
        if not more[0]:
            return None
        load = graph.product([z0, less, more], [1, 1, -1])
    if z0[0] == 0 or x == 0 or (kind == "tanh" and x < 0) or load == graph.scaled(z0, -1):
        return None
    sign = 1 if z0[0] > 0 else -1
    cut = _factors(graph, z0[1]) | _factors(graph, load[1]) | ({t} if kind == "tanh" else set())
    parts = graph.scaled(z0, sign), (x if kind == "tanh" else abs(x) / 2, through), graph.scaled(load, sign)
    return sign, parts, sorted(cut)


def merged(graph: Graph, line: Line, inner: Line, c: Fraction) -> Value | None:
    """A line before c times one of opposite z0, which is as one of negative length; None if that is not its z0."""
    (z0, through, _), (a, along, end) = line, inner
    if (-z0[0], z0[1]) != (c * a[0], a[1]):
        return None
    length, load = graph.sum([through, graph.scaled(along, -1)]), graph.scaled(end, c)
    if not length[0]:
        return load
    sign = Fraction(1 if (length[0] > 0) == (z0[0] > 0) else -1)
    return sign, graph.node("line", ((abs(z0[0]), z0[1]), (abs(length[0]), length[1]), graph.scaled(load, sign)))


def absorbing(graph: Graph, line: Line) -> Iterator[tuple[Value, list[int]]]:
    """A line as A (2/(1 - X) - 1), X = exp(-2 B) H, with H = (Z - A)/(Z + A) as 2/(1 + A/Z) - 1, or by Z/A."""
    z0, through, load = line
    wave, minus = graph.function("exp", graph.scaled(through, -2)), (Fraction(-1), 0)
    for above, below, sign in ((z0, load, 1), (load, z0, -1)) if load[0] else ():
        one = graph.sum([UNIT, graph.product([above, below], [1, -1])])
        h = graph.sum([graph.scaled(graph.inverse(one), 2 * sign), graph.scaled(minus, sign)])
        less = graph.sum([UNIT, graph.scaled(graph.product([wave, h]), -1)])
        whole = graph.sum([graph.scaled(graph.inverse(less), 2), minus])
        yield graph.product([z0, whole]), [z0[1], load[1]]


def _factors(graph: Graph, n: int) -> set[int]:
    """Sums and lines, not rational, that a value is a product of; if it is a sum itself, those in its terms."""
    bases = [x for m in graph.terms(n) for x in graph.powers(m)]
    return {b for b in bases if graph.nodes[b][0] in ("sum", "line") and b != n and not graph.is_rational[b]}


def _atoms(graph: Graph, nodes: list[int], deeper: int = -1) -> list[int]:
    """Sums within the factors of some nodes, where an equality need not look further."""
    found: set[int] = set()
    for n in nodes:
        for b in graph.powers(n):
            inner = graph.terms(b) if b in (deeper, n) and graph.nodes[b][0] == "sum" else {b: 1}
            found |= {x for m in inner for x in graph.powers(m) if graph.nodes[x][0] in ("sum", "line")}
    return sorted(found - {deeper})


def pieces_of(graph: Graph, powers: dict[int, int]) -> list[tuple[int, int]]:
    """Group powers: all constants, all rational ones, quotients of sums that differ in signs, and single powers."""
    left = dict(powers)
    found: list[tuple[int, int]] = []
    for chosen in (
        {b: e for b, e in left.items() if not graph.moves[b]},
        {b: e for b, e in left.items() if graph.moves[b] and graph.is_rational[b]},
    ):
        if chosen and len(chosen) < len(powers):
            found.append((_powered(graph, chosen)[1], 1))
            left = {b: e for b, e in left.items() if b not in chosen}
    sums = [b for b in left if graph.nodes[b][0] == "sum"]
    for a in sums:
        for b in sums:
            if left.get(a, 0) > 0 > left.get(b, 0) and len(left) + len(found) > 2 and _alike(graph, a, b):
                found.append((_powered(graph, {a: 1, b: -1})[1], 1))
                left[a], left[b] = left[a] - 1, left[b] + 1
    return found + [(b, e) for b, e in left.items() if e]


def _alike(graph: Graph, a: int, b: int) -> bool:
    """Whether two sums differ in the signs of their terms alone."""
    up, down = graph.terms(a), graph.terms(b)
    return up.keys() == down.keys() and all(abs(c) == abs(down[m]) for m, c in up.items())
