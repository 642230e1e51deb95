# type: ignore -- facts are plain tuples of two shapes, told apart by their first entry
"""Check a proof of passivity from its file: `python verifier.py proof.json`, with the standard library alone.

A proof is a list of nodes, each an operation on earlier ones, and of steps: node, fact, rule, steps it rests on, data.
Nodes are functions of s: 1, s, a name, a sum of multiples, a product of powers, exp, log, sqrt, tanh, cosh, the input
impedance of a line, a ratio of polynomials, a state space. A fact holds in Re s > 0, for all values of the names that
are assumed. It is a quadratic form in the value w, Q |w|^2 + 2 S Re w + R >= 0, told by where its region crosses the
real axis: ("disc", low, high), a half-plane if an end is infinite; positive real is (0, inf), bounded real (-1, 1).
("real", low, high) is a constant in s. ("arg", t), two half-planes turned: w > 0 for real s, no zeros and poles, and
|arg w| <= 90 t degrees. An infinite constant is the limit of an unbounded region, an open circuit; a function that is
0 or infinite everywhere satisfies any bound of the argument; what is 0/0 everywhere has no value.
"""

import json
import sys
from fractions import Fraction
from itertools import pairwise, zip_longest
from math import gcd, inf, isqrt, lcm, log

FORMAT = "passivity proof 1"
FUNCTIONS = "exp", "log", "sqrt", "tanh", "cosh"
BITS, LARGEST = 160, 4000  # of an exponential; terms of a polynomial
ZERO, ONE = Fraction(0), Fraction(1)
RIGHT, UNIT = ("disc", ZERO, inf), ("disc", -ONE, ONE)


def need(condition, what):
    """Refuse what is not a proof."""
    if not condition:
        raise ValueError(what)


def times(x, y):
    """A product of ends of intervals; 0 times an infinite limit is 0."""
    if inf in (abs(x), abs(y)) and x and y:  # long fractions are no floats
        return inf if (x > 0) == (y > 0) else -inf
    return x * y if x and y else ZERO


def total(ends):
    """The sum of lower, or of upper ends."""
    return next((x for x in ends if x in (inf, -inf)), None) or sum(ends)


def inverted(low, high):
    """All 1/w for w in a disc, None if that has 0 inside."""
    if low < 0 < high or low == high == 0:
        return None
    if low < 0:
        return tuple(-x for x in reversed(inverted(-high, -low)))
    return (1 / high if high < inf else ZERO), (1 / low if low else inf)


def scaled(fact, c):
    """The fact about c w that follows, None if there is none."""
    if not c:
        return ("real", ZERO, ZERO)
    if fact[0] == "arg":
        return fact if c > 0 else ("disc", -inf, ZERO) if fact[1] <= 1 else None
    return (fact[0], *sorted(times(x, c) for x in fact[1:]))


def disc(fact):
    """The disc that a fact tells of, None if there is none."""
    return fact[1:] if fact[0] != "arg" else RIGHT[1:] if fact[1] <= 1 else None


def turn(fact):
    """The bound of the argument that a fact tells of, None if there is none; 0 everywhere has any."""
    return fact[1] if fact[0] == "arg" else None if fact[1] < 0 else Fraction(int(fact[0] == "disc"))


def implies(fact, goal):
    """Whether one fact about a function implies another."""
    if goal[0] == "arg":
        return turn(fact) is not None and turn(fact) <= goal[1]
    known = disc(fact) if goal[0] in ("disc", fact[0]) else None
    return known is not None and goal[1] <= known[0] and known[1] <= goal[2]


def exponential(x):
    """Bounds of e^x for a rational x."""
    if abs(x) > 4096:
        return (ZERO, Fraction(1, 2**5000)) if x < 0 else (Fraction(2**5000), inf)
    halvings = 2 * abs(int(x)).bit_length() + 8
    bits = BITS + halvings + 2 * abs(int(x))
    y = (x.numerator << bits) // (x.denominator << halvings)
    term, total, k = 1 << bits, 1 << bits, 0
    while term not in (0, -1):
        k += 1
        term = (term * y >> bits) // k
        total += term
    low, high = total - 4 * k, total + 4 * k  # each term is off by less than four units
    for _ in range(halvings):
        low, high = low * low >> bits, (high * high >> bits) + 1
    return Fraction(low, 1 << bits), Fraction(high, 1 << bits)


def image(name, x):
    """Bounds of exp, sqrt (x >= 0) or log (x > 0) at a number or its limit."""
    if x in (inf, -inf) or (x == 0 and name == "log"):
        end = ZERO if (name, x) == ("exp", -inf) else inf if x == inf else -inf
        return end, end
    if name == "exp":
        return exponential(x) if x else (ONE, ONE)
    if name == "sqrt":
        root = isqrt((x.numerator << 2 * BITS) // x.denominator)
        return Fraction(root, 1 << BITS), Fraction(
            root + (root * root * x.denominator != x.numerator << 2 * BITS), 1 << BITS
        )
    near = Fraction(log(x.numerator) - log(x.denominator)) if x != 1 else ZERO
    low, high = (near - abs(near) / 2**30, near + abs(near) / 2**30)
    need(not near or (exponential(low)[1] <= x <= exponential(high)[0]), "a logarithm too near to 0")
    return low, high


class Graph:
    """Nodes (kind, parts): read as sums, as products, and as quotients of polynomials."""

    def __init__(self, names):
        self.nodes, self.names, self.roots = [("one", ())], names, {}  # roots that were met: their arguments

    def enter(self, kind, parts):
        """Append a node after a look at its parts."""
        if kind == "sum":
            ids = [n for c, n in parts if isinstance(c, Fraction)]
        elif kind == "mul":
            ids = [n for n, e in parts if isinstance(e, int)]
        else:
            need(kind in ("s", "name", "ratio", "system", "line", *FUNCTIONS), f"unknown node {kind}")
            ids = [n for _, n in parts] if kind in ("line", *FUNCTIONS) else []
            need(len(ids) == (3 * (kind == "line") + (kind in FUNCTIONS)), f"wrong number of parts in {kind}")
        need(all(isinstance(n, int) and 0 <= n < len(self.nodes) for n in ids), "a node refers to a later one")
        need(kind not in ("sum", "mul") or len(ids) == len(set(ids)) == len(parts), f"wrong parts in {kind}")
        self.nodes.append((kind, parts))

    def powers(self, n):
        """A node as a product: base to exponent."""
        kind, parts = self.nodes[n]
        return dict(parts) if kind == "mul" else {n: 1} if n else {}

    def terms(self, n, c=ONE):
        """c times a node as a sum: node to coefficient."""
        kind, parts = self.nodes[n]
        return {m: c * x for x, m in parts} if kind == "sum" else {n: c}

    def fraction(self, c, n, cut):
        """c times a node as a quotient of polynomials in atoms: what is no sum or product, and the nodes in `cut`."""
        (kind, parts), one = self.nodes[n], {(): ONE}
        top, bottom = one, one
        if n in cut or kind in ("name", "s", "log", "ratio", "system"):
            top = {((n, ONE),): ONE}
        elif kind == "sum":
            top = {}
            for x, m in parts:
                p, q = self.fraction(x, m, cut)
                if q == one:
                    q, p = bottom, self.multiplied(p, bottom)
                else:
                    top, p, q = self.multiplied(top, q), self.multiplied(p, bottom), self.multiplied(bottom, q)
                top, bottom = added(top, p), q
        elif kind == "mul":
            for m, e in parts:
                p, q = self.fraction(ONE, m, cut)[:: 1 if e > 0 else -1]
                for _ in range(abs(e)):
                    top, bottom = self.multiplied(top, p), self.multiplied(bottom, q)
        elif kind == "sqrt":
            top, (p, q) = {((n, ONE),): ONE}, self.fraction(*parts[0], cut)
            self.roots |= {n: p} if q == one else {}
        elif kind == "line":  # A (Z + A tanh B)/(A + Z tanh B), tanh B = (e - 1/e)/(e + 1/e)
            (a, x), (z, y) = self.fraction(*parts[0], cut), self.fraction(*parts[2], cut)
            plus, minus = self.hyperbolic(*parts[1])
            ax, az = self.multiplied(a, y), self.multiplied(z, x)  # over the common denominator of A and Z
            top = self.multiplied(a, added(self.multiplied(az, plus), self.multiplied(ax, minus)))
            bottom = self.multiplied(x, added(self.multiplied(ax, plus), self.multiplied(az, minus)))
        elif n:
            plus, minus = self.hyperbolic(*parts[0])
            if kind == "exp":
                top = {self.exponent(*parts[0], 1): ONE}
            else:
                top, bottom = (plus, {(): Fraction(2)}) if kind == "cosh" else (minus, plus)
        need(len(top) + len(bottom) <= LARGEST, "an equality is too large to check")
        return {key: x * c for key, x in top.items() if x * c}, bottom

    def exponent(self, c, n, sign):
        """exp(c w) as a monomial: exp of each term of w is an atom."""
        return tuple(sorted(((("exp", m), sign * x) for m, x in self.terms(n, c).items()), key=str))

    def hyperbolic(self, c, n):
        """e^x + e^-x and e^x - e^-x."""
        up, down = self.exponent(c, n, 1), self.exponent(c, n, -1)
        return added({up: ONE}, {down: ONE}), added({up: ONE}, {down: -ONE})

    def multiplied(self, f, g):
        """A product of polynomials, squares of roots replaced."""
        need(len(f) * len(g) <= 100 * LARGEST, "an equality is too large to check")
        found, more = {}, []
        for a, x in f.items():
            for b, y in g.items():
                key = added(dict(a), dict(b))
                square = next((m for m, e in key.items() if e >= 2 and m in self.roots), None)
                if square is not None:
                    key[square] -= 2
                    rest = {tuple(sorted(((m, e) for m, e in key.items() if e), key=str)): x * y}
                    more.append(self.multiplied(rest, self.roots[square]))
                else:
                    name = tuple(sorted(key.items(), key=str))
                    found[name] = found.get(name, 0) + x * y
        for other in more:
            found = added(found, other)
        return {key: x for key, x in found.items() if x}

    def rational(self, n):
        """A node that is rational in s as a quotient of polynomials, lowest power first."""
        kind, parts = self.nodes[n]
        if kind == "ratio":
            return [Fraction(x) for x in parts[0]], [Fraction(x) for x in parts[1]]
        found = []
        for f in self.fraction(ONE, n, ()):
            powers = {}
            for key, x in f.items():
                need(not key or (len(key) == 1 and self.nodes[key[0][0]][0] == "s"), "not rational in s")
                powers[int(key[0][1]) if key else 0] = x
            found.append([powers.get(k, ZERO) for k in range(max(powers, default=-1) + 1)])
        return found


def added(f, g):
    """The sum of two polynomials, of two lists of terms, or of two lists of exponents."""
    found = dict(f)
    for key, x in g.items():
        found[key] = found.get(key, 0) + x
    return {key: x for key, x in found.items() if x}


RULES = {}  # each gives the facts about a node that follow from what is known of others, and from data


def rule(follows):
    """Enter a rule into the table."""
    RULES[follows.__name__] = follows
    return follows


@rule
def leaf(graph, n, known, data):
    """1, s, and what is assumed of a name."""
    kind, parts = graph.nodes[n]
    return [graph.names[parts[0]]] if kind == "name" else {"one": [("real", ONE, ONE)], "s": [RIGHT]}.get(kind, [])


@rule
def combination(graph, n, known, data):
    """w = sum of c w_k: discs add up, and so do constants; arguments of up to 90 degrees are a convex cone."""
    terms, parts = {}, []
    for c, (m, fact) in zip(map(Fraction, data), known, strict=True):
        terms = added(terms, graph.terms(m, c))
        parts.append(scaled(fact, c))
    need(terms == graph.terms(n) and None not in parts, "not this sum")
    turns, discs = [turn(f) for f in parts], [disc(f) for f in parts]
    found = [("arg", max(turns))] if None not in turns and max(turns) <= 1 else []
    if None not in discs:
        kind = "real" if all(f[0] == "real" for f in parts) else "disc"
        found.append((kind, total([low for low, _ in discs]), total([high for _, high in discs])))
    return found


@rule
def product(graph, n, known, data):
    """w = product of w_k^e: arguments add, moduli multiply; constants multiply as intervals, and scale one disc."""
    total = {}
    for e, (m, _) in zip(data, known, strict=True):
        need(isinstance(e, int) and e, "not an exponent")
        total = added(total, {b: e * k for b, k in graph.powers(m).items()})
    need(total == graph.powers(n), "not this product")
    turns, discs = [turn(f) for _, f in known], [disc(f) for _, f in known]
    found = [("arg", sum(abs(e) * t for e, t in zip(data, turns, strict=True)))] if None not in turns else []
    discs = [d if e > 0 else d and inverted(*d) for e, d in zip(data, discs, strict=True)]
    if None in discs:
        return found
    moving = [e for e, (_, f) in zip(data, known, strict=True) if f[0] != "real"]
    if moving in ([], [1], [-1]):
        low, high = ONE, ONE
        for e, (a, b) in zip(data, discs, strict=True):
            for _ in range(abs(e) if e % 2 or a >= 0 else 0):
                ends = [times(x, y) for x in (low, high) for y in (a, b)]
                low, high = min(ends), max(ends)
            if e % 2 == 0 and a < 0:  # an even power of a constant
                ends = [times(x, y) for x in (low, high) for y in (ZERO, max(-a, b) ** abs(e))]
                low, high = min(ends), max(ends)
        found.append(("disc" if moving else "real", low, high))
    bound = ONE
    for e, (a, b) in zip(data, discs, strict=True):
        bound = bound * max(-a, b) ** abs(e) if max(-a, b, bound) < inf else inf
    return [*found, ("disc", -bound, bound)]


@rule
def inverse(graph, n, known, data):
    """w = 1/w_1: Re 1/w = Re w/|w|^2, a disc goes over into a disc, and the argument changes its sign."""
    ((m, fact),) = known
    need(graph.powers(n) == {b: -e for b, e in graph.powers(m).items()}, "not its inverse")
    ends = disc(fact) and inverted(*disc(fact))
    arg = [("arg", turn(fact))] if turn(fact) is not None else []
    return [*arg, ("disc" if fact[0] == "arg" else fact[0], *ends)] if ends else arg


@rule
def equal(graph, n, known, data):
    """w = c w_1, multiplied out as polynomials in the atoms that are given, and in what is no sum or product."""
    ((m, fact),), (c, cut) = known, data
    (p, q), (u, v) = graph.fraction(ONE, n, cut), graph.fraction(Fraction(c), m, cut)
    need(q and v and graph.multiplied(p, v) == graph.multiplied(u, q), "not equal")
    return [scaled(fact, Fraction(c))] if scaled(fact, Fraction(c)) else []


@rule
def function(graph, n, known, data):
    """exp, log, sqrt, tanh and 1/cosh where the argument keeps to a region."""
    ((base, e),), (m, fact) = graph.powers(n).items(), known[0]
    name, parts = graph.nodes[base]
    need(name in FUNCTIONS and parts[0][1] == m and e == (-1 if name == "cosh" else 1), "not at this argument")
    fact = scaled(fact, parts[0][0])
    (low, high), angle = (disc(fact) or (-inf, inf)) if fact else (-inf, inf), fact and turn(fact)
    if name == "cosh":  # |cosh(x + jy)|^2 = sinh^2 x + cos^2 y >= 1 where |y| <= x
        return [UNIT] if angle is not None and angle <= Fraction(1, 2) else []
    if name == "tanh":
        return [RIGHT] if low >= 0 else []
    constant, found = fact and fact[0] == "real", []
    if name == "sqrt":
        need(angle is not None and angle <= 2, "not sqrt of a function off the negative axis")
        found = [("arg", angle / 2)]
        low = max(low, ZERO)
    if (name != "exp" and fact[0] == "arg") or (name == "log" and low <= 0):
        return found
    floor, roof = image(name, low)[0], image(name, high if name != "sqrt" else max(-disc(fact)[0], high))[1]
    if constant:
        return [*found, ("real", floor, roof)]
    return [
        *found,
        *([("disc", floor, inf)] if name != "exp" else []),
        *([("disc", -roof, roof)] if name != "log" else []),
    ]


@rule
def power(graph, n, known, data):
    """exp(c log w_1), a power of w_1, turns c times as much."""
    (name, parts), (m, fact) = graph.nodes[n], known[0]
    need(name == "exp" and graph.nodes[parts[0][1]] == ("log", ((ONE, m),)), "not a power")
    return [("arg", abs(parts[0][0]) * turn(fact))] if turn(fact) is not None and turn(fact) <= 2 else []


@rule
def square(graph, n, known, data):
    """w^2 = c w_1, c > 0, where w > 0 for real s, without zeros and poles, so that w is the root of c w_1."""
    ((m, fact), *parts), (c, exponents), total = known, data, {}
    for e, (b, f) in zip(exponents, parts, strict=True):
        total = added(total, {x: e * k for x, k in graph.powers(b).items()}) if turn(f) is not None else {}
    (u, v), p, q = graph.fraction(Fraction(c), m, ()), {(): ONE}, {(): ONE}
    for b, e in graph.powers(n).items():  # w^2, roots being squared
        kind, inner = graph.nodes[b]
        f, g = graph.fraction(*(inner[0] if kind == "sqrt" else (ONE, b)), ())[:: 1 if e > 0 else -1]
        for _ in range(abs(e) * (2 - (kind == "sqrt"))):
            p, q = graph.multiplied(p, f), graph.multiplied(q, g)
    twice = graph.multiplied(p, v) == graph.multiplied(q, u)
    need(
        Fraction(c) > 0
        and p
        and u
        and twice
        and total == graph.powers(n)
        and turn(fact) is not None
        and turn(fact) <= 2,
        "not its root",
    )
    return [("arg", turn(fact) / 2)]


@rule
def mean(graph, n, known, data):
    """log(1 + X)/X and (1 - exp(-X))/X, means over t from 0 to 1 of 1/(1 + tX) and of exp(-tX), for X = c w_1."""
    ((m, fact),), c = known, Fraction(data)
    ((base, e),), x = added(graph.powers(n), graph.powers(m)).items(), graph.terms(m, c)
    kind, parts = graph.nodes[base]
    need(e == 1 and c > 0 and disc(fact) and disc(fact)[0] >= 0, "not a mean")
    if kind == "log":
        need(graph.terms(parts[0][1], parts[0][0]) == added({0: ONE}, x), "not the mean of 1/(1 + tX)")
        return [("disc", ZERO, c)]
    ((inner, factor),) = added(graph.terms(base), {0: -ONE}).items()
    (name, parts) = graph.nodes[inner]
    need(factor == -1 and name == "exp" and graph.terms(parts[0][1], -parts[0][0]) == x, "not the mean of exp(-tX)")
    return [("disc", -c, c)]


@rule
def line(graph, n, known, data):
    """A line: dW/dx = A B - (B/A) W^2 from the load on; where Re W = 0, Re dW/dx = Re A B + |W|^2 Re B/A >= 0."""
    (kind, parts), (load, series, shunt) = graph.nodes[n], known
    (a, x), (b, y), (c, z) = parts if kind == "line" else [(ZERO, 0)] * 3
    need(a > 0 and b > 0 and c >= 0 and load[0] == (z if c else 0), "not this line")
    for e, (m, _) in ((1, series), (-1, shunt)):  # B A and B/A
        (p, q), (u, v), (f, g) = (graph.fraction(ONE, k, ()) for k in (x, y, m))
        p, q = (p, q) if e > 0 else (q, p)
        same = graph.multiplied(graph.multiplied(p, u), g) == graph.multiplied(graph.multiplied(q, v), f)
        need(same, "not its series impedance or shunt admittance")
    return [RIGHT] if all(disc(f) and disc(f)[0] >= 0 for _, f in known) else []


@rule
def rational(graph, n, known, data):
    """Chen and Smith: u/v is positive real if Re u conj v >= 0 on the axis and u + v has its roots in Re s < 0."""
    (p, q), fact = graph.rational(n), read_fact(data["fact"])
    if fact[0] == "arg":
        need(fact[1] in (1, 2), "not a bound of this rule")
        choices = [(p, q)] if fact[1] == 1 else [(p, [ZERO, *q]), ([ZERO, *p], q)]
    else:  # w - low, high - w, or their quotient
        need(fact[0] == "disc" and fact[1] < fact[2], "not a disc")
        up = combined(p, q, -fact[1]) if fact[1] > -inf else q
        down = combined(q, p, -1, fact[2]) if fact[2] < inf else q
        choices = [(up, down) if fact[1] > -inf else (down, q)]
    u, v = ([Fraction(x) for x in data[key]] for key in "pq")
    need(any(u and v and convolved(u, y) == convolved(x, v) for x, y in choices), "another function")
    need(is_nonnegative(on_axis(u, v), data["factors"], data["breaks"]), "negative on the axis")
    need(is_hurwitz(combined(u, v, 1)), "roots in Re s >= 0")
    return [fact]


@rule
def storage(graph, n, known, data):
    """A storage function x^T P x: T P T^T and T K(P) T^T have dominant diagonals, and so P > 0 and K(P) > 0."""
    kind, parts = graph.nodes[n]
    need(kind == "system", "not a state space")
    (a, b, c, d, p), found = [[list(map(Fraction, x)) for x in m] for m in (*parts, data["P"])], read_fact(data["fact"])
    need(p == transposed(p) and found in (RIGHT, UNIT) and len(p) == len(a), "not a symmetric matrix for this")
    bounded, states, ports = found == UNIT, range(len(a)), range(len(d))
    pa, pb, ct, dt = matrix(p, a), matrix(p, b), transposed(c), transposed(d)
    cc, cd, dd = matrix(ct, c), matrix(ct, d), matrix(dt, d)
    k = [[-pa[i][j] - pa[j][i] - bounded * cc[i][j] for j in states] for i in states]
    side = [[-pb[i][m] + (-cd[i][m] if bounded else ct[i][m]) for m in ports] for i in states]
    end = [[(i == m) - dd[i][m] if bounded else d[i][m] + d[m][i] for m in ports] for i in ports]
    k = [x + y for x, y in zip(k, side, strict=True)] + [
        x + y for x, y in zip(transposed(side) or [[]], end, strict=True)
    ]
    need(is_dominated(p, data["T"][0]) and is_dominated(k, data["T"][1]), "not positive definite")
    return [found]


def transposed(x):
    """The transpose of a matrix."""
    return [list(column) for column in zip(*x, strict=True)]


def matrix(x, y):
    """The product of two matrices."""
    return [[sum((r * c for r, c in zip(row, column, strict=True)), ZERO) for column in transposed(y)] for row in x]


def is_dominated(x, t):
    """Whether the diagonal of T X T^T exceeds the sum of the moduli beside it, in each row: then X > 0."""
    unit = lcm(*(entry.denominator for row in x for entry in row))
    whole = [[int(entry * unit) for entry in row] for row in x]
    first = [[sum(r * c for r, c in zip(row, column, strict=True)) for column in whole] for row in t]  # X is symmetric
    rows = [[sum(r * c for r, c in zip(row, other, strict=True)) for other in t] for row in first]
    return len(t) == len(x) and all(2 * row[i] > sum(map(abs, row)) for i, row in enumerate(rows))


def combined(f, g, c, a=1):
    """a f + c g, lowest power first."""
    total = [a * x + c * y for x, y in zip_longest(f, g, fillvalue=ZERO)]
    while total and not total[-1]:
        total.pop()
    return total


def convolved(f, g):
    """The product of two polynomials."""
    found = [ZERO] * (len(f) + len(g) - 1 if f and g else 0)
    for k, x in enumerate(f):
        for m, y in enumerate(g):
            found[k + m] += x * y
    return combined(found, [], 0)


def on_axis(u, v):
    """Re u(jw) conj v(jw), in powers of x = w^2."""
    even = convolved(u, [y * (-1) ** k for k, y in enumerate(v)])[::2]
    return combined([y * (-1) ** k for k, y in enumerate(even)], [], 0)


def shifted(f, low):
    """f(low + t)."""
    f = list(f)
    for k in range(len(f) - 1):
        for m in range(len(f) - 2, k - 1, -1):
            f[m] += low * f[m + 1]
    return f


def is_nonnegative(a, factors, breaks):
    """Whether a(x) is at least a product of powers, and that >= 0 for x >= 0 by signs of coefficients on pieces."""
    whole, odd = [ONE], [ONE]
    for f, e in factors:
        f = [Fraction(x) for x in f]
        for k in range(e):
            whole, odd = convolved(whole, f), convolved(odd, f) if e % 2 and not k else odd
    ends = [ZERO, *map(Fraction, breaks)]
    pieces = [shifted(odd, ends[-1]), combined(a, whole, -1)]
    for low, high in pairwise(ends):  # x = low + (high - low) t/(1 + t)
        g = [x * (high - low) ** k for k, x in enumerate(shifted(odd, low))]
        pieces.append(shifted(g[::-1], ONE))
    return ends == sorted(set(ends)) and all(x >= 0 for piece in pieces for x in piece)


def is_hurwitz(f):
    """Whether all roots lie in Re s < 0, by Routh's scheme in whole numbers."""
    unit = lcm(*(x.denominator for x in f)) * (-1 if f and f[-1] < 0 else 1)
    f = [int(x * unit) for x in reversed(f)]
    first, second = f[::2], f[1::2]
    while second:
        if first[0] <= 0 or second[0] <= 0:
            return False
        rest = [second[0] * x - first[0] * y for x, y in zip_longest(first[1:], second[1:], fillvalue=0)]
        common = gcd(*rest) or 1
        first, second = second, [x // common for x in rest][: len(first) - 1]
    return bool(f) and first[0] > 0


def read_fact(fact):
    """A fact from its texts."""
    kind, *ends = fact
    need((kind, len(ends)) in (("real", 2), ("disc", 2), ("arg", 1)), "not a fact")
    return (kind, *(float(x) if x in ("inf", "-inf") else Fraction(x) for x in ends))


def read_node(kind, parts):
    """A node from its texts."""
    pairs = kind in ("sum", "line", *FUNCTIONS)
    return kind, tuple((Fraction(x), n) for x, n in parts) if pairs else tuple(
        tuple(x) if kind == "mul" else x for x in parts
    )


def check(proof):
    """None if a proof, as its file is read, proves its claim; else what is wrong."""
    step = "the head"
    try:
        need(proof["format"] == FORMAT, f"not of the format {FORMAT}")
        graph, known = Graph({name: read_fact(fact) for name, fact in proof["names"].items()}), []
        for kind, *parts in proof["nodes"][1:]:
            graph.enter(*read_node(kind, parts))
        for k, (n, fact, name, premises, data) in enumerate(proof["steps"]):
            step, goal = f"step {k}, rule '{name}'", read_fact(fact)
            need(n >= 0 and all(0 <= m < k for m in premises), "a step refers to a later one")
            need(
                any(implies(f, goal) for f in RULES[name](graph, n, [known[m] for m in premises], data)),
                "does not follow",
            )
            known.append((n, goal))
        step, (c, n), (m, fact) = "the end", proof["root"], known[-1]
        final = scaled(fact, Fraction(c))
        need(m == n and final and implies(final, read_fact(proof["claim"])), "the steps do not lead to the claim")
    except (ArithmeticError, AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        return f"{step}: {error}"
    return None


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        given = json.load(file)
    wrong = check(given)
    sys.stdout.write((wrong or f"holds: {given['statement']}, in {len(given['steps'])} steps") + "\n")
    sys.exit(int(bool(wrong)))
