# type: ignore -- facts are plain tuples of two shapes, told apart by their first entry
"""Check a proof of passivity from its file: `python verifier.py proof.json`, with the standard library alone.

Nodes are functions of s: 1, s, a name, a sum of multiples, a product of powers, exp, log, sqrt, tanh, cosh, the input
impedance of a line. A fact holds in Re s > 0 for all values of the names: ("disc", low, high), a quadratic form in the
value w given by where its region crosses the real axis, a half-plane if an end is infinite, so that positive real is
(0, inf) and bounded real (-1, 1); ("real", low, high), a constant in s; ("arg", t), w > 0 for real s, no zeros and
poles, and |arg w| <= 90 t degrees, or w = 0 everywhere. Nothing is divided by 0 everywhere, as bounds show at one s > 0
for one choice of the names; others are limits of such. A step is a node, a fact, a rule, steps it rests on, data.
"""

import json
import re
import sys
from bisect import bisect_left
from contextlib import suppress
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from fractions import Fraction
from functools import partial, reduce
from itertools import pairwise, product, zip_longest
from math import inf, lcm, prod
from operator import add, mul, truediv
from random import Random

FUNCTIONS = "exp", "log", "sqrt", "tanh", "cosh"
FORMAT, LARGEST = "passivity proof 1", 4000  # terms of a polynomial, arguments of an exponential
DECIMAL = Context(prec=100, Emax=MAX_EMAX, Emin=MIN_EMIN)
POINTS = [(Fraction(2) ** k, digits) for k, digits in ((40, 28), (-1, 100), (-40, 100))]
ZERO, ONE, UNITY = Fraction(0), Fraction(1), {(): 1}
RIGHT, UNIT = ("disc", ZERO, inf), ("disc", -ONE, ONE)
STEPS, SINES = 64, [k * (3 * 64**2 - k * k) for k in range(65)]  # 2 64^3 times t (3 - t^2)/2 <= sin(90 t degrees)


def need(condition, what):
    """Raise ValueError unless a condition holds."""
    if not condition:
        raise ValueError(what)


def times(x, y):
    """Product of ends of intervals; 0 times an infinite limit is 0."""
    finite = not (x and y and (isinstance(x, float) or isinstance(y, float)))  # an infinity is one, a fraction none
    return (x * y if x and y else ZERO) if finite else inf if (x > 0) == (y > 0) else -inf


def inverted(low, high):
    """All 1/w for w in a disc, None if that has 0 inside."""
    ends = (1 / x if 0 < abs(x) < inf else ZERO if x else zero for x, zero in ((high, -inf), (low, inf)))
    return None if low < 0 < high or low == high == 0 else tuple(ends)


def scaled(fact, c):
    """Return the fact about c w that follows from one about w; None if none follows."""
    if not c:
        return ("real", ZERO, ZERO)
    if fact[0] == "arg":
        return fact if c > 0 else ("disc", -inf, ZERO) if fact[1] <= 1 else None
    return fact if c == 1 else (fact[0], *sorted(times(x, c) for x in fact[1:]))


def disc(fact):
    """Disc of a fact; None without one."""
    return fact[1:] if fact[0] != "arg" else RIGHT[1:] if fact[1] <= 1 else None


def turn(fact):
    """Bound of the argument from a fact; None without one; the function 0 has any."""
    if fact[0] != "disc" or fact[1] <= 0 or fact[2] == inf:
        return fact[1] if fact[0] == "arg" else None if fact[1] < 0 else Fraction(int(fact[0] == "disc"))
    return Fraction(bisect_left(SINES, 2 * STEPS**3 * (fact[2] - fact[1]) / (fact[2] + fact[1])), STEPS)


def implies(fact, goal):
    """Whether one fact about a function implies another."""
    if not fact or goal[0] == "arg":
        return bool(fact) and turn(fact) is not None and turn(fact) <= goal[1]
    known = disc(fact) if goal[0] in ("disc", fact[0]) else None
    return known is not None and goal[1] <= known[0] and known[1] <= goal[2]


def image(name, x):
    """Bounds of exp, sqrt (x >= 0) or log (x > 0) at a number or its limit, by decimals that are rounded correctly."""
    if x in (inf, -inf) or (x == 0 and name == "log"):
        return (ZERO if (name, x) == ("exp", -inf) else inf if x == inf else -inf,) * 2
    if name == "exp" and abs(x) > LARGEST:
        return (ZERO, Fraction(1, 2**5000)) if x < 0 else (Fraction(2**5000), inf)
    y = DECIMAL.divide(x.numerator, x.denominator)
    y = Fraction({"exp": DECIMAL.exp, "sqrt": DECIMAL.sqrt, "log": DECIMAL.ln}[name](y))
    if (name == "sqrt" and y * y == x) or x == (name == "log"):
        return y, y
    need(name != "log" or abs(y) > Fraction(1, 10**30), "a logarithm too near to 0")
    return y - abs(y) / 10**60, y + abs(y) / 10**60


def within(f, *ends):
    """Bounds of a function, monotone in each decimal and rounded once, from bounds of its arguments."""
    found = [f(*x) for x in product(*ends)]
    return min(found).next_minus(), max(found).next_plus()


class Graph:
    """Nodes (kind, parts), read as quotients of polynomials, and the rules: facts about a node from those of others."""

    def __init__(self, names):
        self.nodes, self.names, self.roots, self.zero = [("one", ())], names, {}, set()  # roots met: their squares

    def enter(self, kind, parts):
        """Append a node from its file after a look at its parts."""
        need(kind in ("s", "name", "sum", "mul", "line", *FUNCTIONS), f"unknown node {kind}")
        if kind in ("s", "name"):
            need(len(parts) == (kind == "name"), f"wrong parts in {kind}")
        else:
            parts = [tuple(x) if kind == "mul" else (Fraction(x[0]), *x[1:]) for x in parts]
            small = [n for n, e in parts if type(e) is int and abs(e) <= LARGEST]
            ids = small if kind == "mul" else [n for _, n in parts]
            right = len(ids) == len(parts) == {"sum": len(set(ids)), "mul": len(set(ids)), "line": 3}.get(kind, 1)
            need(right and all(type(n) is int and 0 <= n < len(self.nodes) for n in ids), f"wrong parts in {kind}")
        self.nodes.append((kind, tuple(parts)))

    def look(self):
        """Find a point where bounds show that nothing is divided by 0; remember the nodes that may be 0 there."""
        for s, digits in POINTS:
            with localcontext(DECIMAL, prec=digits), suppress(ArithmeticError, TypeError, ValueError):
                values = []
                for kind, parts in self.nodes:
                    values.append(self.value(kind, parts, values, s))
                self.zero = {n for n, (low, high) in enumerate(values) if low <= 0 <= high}
                return
        raise ValueError("a division by 0")

    def value(self, kind, parts, values, s):
        """Bounds of a node at a point s > 0 and for one choice of the names, from those of the nodes before it."""
        plus, by, one = partial(within, add), partial(within, mul), (Decimal(1),) * 2

        def over(x):
            need(not x[0] <= 0 <= x[1], "a division by 0")
            return within(truediv, one, x)

        def times(c, x):
            return by(within(truediv, [Decimal(c.numerator)], [Decimal(c.denominator)]), x)

        if kind in ("s", "name"):
            low, high = (s, s) if kind == "s" else disc(self.names[parts[0]])
            low = max(low, min(high, 1) - 1)
            return times(low + (min(high, low + 1) - low) * Fraction(Random("".join(parts)).random()), one)
        if kind in ("one", "mul"):
            return reduce(by, (values[n] if e > 0 else over(values[n]) for n, e in parts for _ in range(abs(e))), one)
        x, *more = [times(c, values[n]) for c, n in parts]
        if kind in ("sum", "log", "sqrt"):
            return reduce(plus, more, x) if kind == "sum" else within(Decimal.ln if kind == "log" else Decimal.sqrt, x)
        e = within(Decimal.exp, times(1 if kind in ("exp", "cosh") else -2, (more or [x])[0]))
        if kind in ("exp", "cosh"):
            return e if kind == "exp" else times(Fraction(1, 2), plus(e, over(e)))
        if kind == "line":  # z0 (1 + r e)/(1 - r e), r = (Z - z0)/(Z + z0)
            e = by(e, by(plus(x, times(-1, more[1])), over(plus(x, more[1]))))
        found = by(plus(one, times(-1, e)), over(plus(one, e)))
        return by(x, found) if kind == "line" else found

    def powers(self, n):
        """A node as a product: base to exponent."""
        kind, parts = self.nodes[n]
        return dict(parts) if kind == "mul" else {n: 1} if n else {}

    def powers_of(self, known, exponents):
        """A product of powers of nodes, as one; none that is 0 is divided by."""
        pairs = [(m, e) for (m, _), e in zip(known, exponents, strict=True)]
        need(all(type(e) is int and (e > 0 or m not in self.zero) for m, e in pairs), "no such powers")
        return reduce(added, ({b: e * k for b, k in self.powers(m).items()} for m, e in pairs), {})

    def terms(self, n, c=ONE):
        """c times a node as a sum: node to coefficient."""
        kind, parts = self.nodes[n]
        return {m: c * x if c != 1 else x for x, m in parts} if kind == "sum" else {n: c}

    def fraction(self, c, n, cut=()):
        """c times a node as a quotient of polynomials in atoms: nodes but sums and products, and those in `cut`."""
        (kind, parts), (top, bottom) = self.nodes[n], (UNITY, UNITY)
        if n in cut or kind in ("name", "s", "log"):
            top = {((n, 1),): 1}
            self.roots.pop(n, None)  # of which no square is known here, whatever an equality before knew
        elif kind == "sum":
            top = {}
            for x, m in parts:
                p, q = self.fraction(x, m, cut)
                if q != bottom:
                    top, p, bottom = (self.multiplied(*pair) for pair in ((top, q), (p, bottom), (bottom, q)))
                top = added(top, p)
        elif kind == "mul":
            top, bottom = self.powered((self.fraction(ONE, m, cut), e) for m, e in parts)
        elif kind == "sqrt":
            p, bottom = self.fraction(*parts[0], cut)  # the root of p/q is that of p q, over q
            top, self.roots[n] = {((n, 1),): 1}, self.multiplied(p, bottom)
        elif kind == "line":  # A (Z + A t)/(A + Z t), t = tanh B an atom if it is cut
            (a, x), (z, y) = self.fraction(*parts[0], cut), self.fraction(*parts[2], cut)
            t = next(({((m, 1),): 1} for m in cut if m > 0 and self.nodes[m] == ("tanh", parts[1:2])), None)
            over, under = (UNITY, t) if t else self.exponentials(*parts[1])[1:]
            ax, az = self.multiplied(a, y), self.multiplied(z, x)  # over the common denominator of A and Z
            top = self.multiplied(a, added(self.multiplied(az, over), self.multiplied(ax, under)))
            bottom = self.multiplied(x, added(self.multiplied(ax, over), self.multiplied(az, under)))
        elif n:
            once, plus, minus = self.exponentials(*parts[0])
            pair = {"exp": (once, UNITY), "tanh": (minus, plus)}.get(kind)
            top, bottom = pair or (self.multiplied(once, plus), {(): 2})
        return top if c == 1 else {key: x * c for key, x in top.items() if x * c}, bottom

    def powered(self, factors):
        """Product of powers of quotients, with common factors cancelled."""
        top, bottom = UNITY, UNITY
        for p, q in (pair[:: 1 if e > 0 else -1] for pair, e in factors for _ in range(abs(e))):
            p, bottom = (UNITY, UNITY) if p == bottom else (p, bottom)
            top, q = (UNITY, UNITY) if q == top else (top, q)
            top, bottom = self.multiplied(top, p), self.multiplied(bottom, q)
        return top, bottom

    def exponentials(self, c, n):
        """e^w, 1 + e^-2w and 1 - e^-2w of a multiple; exp of each term is an atom, numbered from -1 downwards."""
        once, back = (tuple(sorted((~m, k * x) for m, x in self.terms(n, c).items())) for k in (1, -2))
        return {once: 1}, {(): 1, back: 1}, {(): 1, back: -1}

    def multiplied(self, f, g):
        """A product of polynomials, squares of roots replaced."""
        if UNITY in (f, g):
            return g if f == UNITY else f
        need(len(f) * len(g) <= 100 * LARGEST, "an equality is too large to check")
        found = {}
        for a, x in f.items():
            for b, y in g.items():
                key = added(dict(a), dict(b)) if a and b else dict(a or b)
                square = self.roots and next((m for m, e in key.items() if e >= 2 and m in self.roots), None)
                if square:
                    rest = {tuple(sorted(added(key, {square: -2}).items())): x * y}
                    found = added(found, self.multiplied(rest, self.roots[square]))
                else:
                    name = tuple(sorted(key.items()))
                    found[name] = found.get(name, 0) + x * y
        return found if all(found.values()) else {key: x for key, x in found.items() if x}

    def is_equal(self, left, right):
        """Whether two quotients of polynomials are one."""
        return left == right or self.multiplied(left[0], right[1]) == self.multiplied(right[0], left[1])

    def rule_leaf(self, n, known, data):
        """Facts of 1, s and names, as assumed."""
        kind, parts = self.nodes[n]
        need(not known, "a leaf has no premises")
        return [self.names[parts[0]]] if kind == "name" else {"one": [("real", ONE, ONE)], "s": [RIGHT]}.get(kind, [])

    def rule_combination(self, n, known, data):
        """w = sum of c w_k: discs add up, and so do constants; arguments of up to 90 degrees are a convex cone."""
        pairs = zip(map(Fraction, data), known, strict=True)
        parts, terms = zip(*((scaled(fact, c), self.terms(m, c)) for c, (m, fact) in pairs), strict=True)
        need(reduce(added, terms) == self.terms(n) and None not in parts, "not this sum")
        turns, discs = [turn(f) for f in parts], [disc(f) for f in parts]
        found = [("arg", max(turns))] if None not in turns and max(turns) <= 1 else []
        if None not in discs:
            low, high = (max(x, key=abs) if inf in map(abs, x) else sum(x) for x in zip(*discs, strict=True))
            found.append(("real" if all(f[0] == "real" for f in parts) else "disc", low, high))
        return found

    def rule_product(self, n, known, data):
        """w = product of w_k^e: arguments add, moduli multiply; constants multiply as intervals, and scale one disc."""
        facts = [fact for _, fact in known]
        need(self.powers_of(known, data) == self.powers(n), "not this product")
        signs = [1 if turn(f) is not None else -1 for f in facts]
        turns = [turn(scaled(f, sign)) for f, sign in zip(facts, signs, strict=True)]
        total = None not in turns and ("arg", sum(abs(e) * t for e, t in zip(data, turns, strict=True)))
        found = list(filter(None, [total and scaled(total, prod(map(pow, signs, map(abs, data))))]))
        discs = [disc(f) if e > 0 else disc(f) and inverted(*disc(f)) for e, f in zip(data, facts, strict=True)]
        if None in discs:
            return found
        moving, low, high, bound = [e for e, f in zip(data, facts, strict=True) if f[0] != "real"], ONE, ONE, ONE
        for e, (a, b) in zip(map(abs, data), discs, strict=True):
            bound = bound * max(-a, b) ** e if max(-a, b, bound) < inf else inf
            a, b = (ZERO, max(-a, b) ** e) if e % 2 == 0 and a < 0 else (a**e, b**e)
            ends = [times(x, y) for x in (low, high) for y in (a, b)]
            low, high = min(ends), max(ends)
        scaling = [("disc" if moving else "real", low, high)] if moving in ([], [1], [-1]) else []
        return [*found, *scaling, ("disc", -bound, bound)]

    def rule_equal(self, n, known, data):
        """w = c w_1, expanded as polynomials in the given atoms and in nodes other than sums and products."""
        ((m, fact),), (c, cut) = known, data
        left, right = self.fraction(ONE, n, cut), self.fraction(Fraction(c), m, cut)
        need(left[1] and right[1] and self.is_equal(left, right), "not equal")
        return [scaled(fact, Fraction(c))] if scaled(fact, Fraction(c)) else []

    def rule_function(self, n, known, data):
        """exp, log, sqrt, tanh, 1/cosh, exp(c log w_1) in a region; Re sqrt(c w_1 w_2) >= sqrt(c Re w_1 Re w_2)."""
        ((base, e),), ((m, fact), *others) = self.powers(n).items(), known
        name, parts = self.nodes[base]
        if others:  # for half the sum of two angles has at least the geometric mean of their cosines
            (c, x), low, least = parts[0], *((disc(f) or (-inf,))[0] for _, f in known)
            same = self.powers(x) == added(*(self.powers(m) for m, _ in known))
            need((name, e) == ("sqrt", 1) and same and c > 0 and min(low, least) >= 0, "not such a root")
            return [("disc", image(name, c * low * least)[0], inf)]
        if (name, e) == ("exp", 1) and self.nodes[parts[0][1]] == ("log", ((ONE, m),)):  # a power turns as much
            return [("arg", abs(parts[0][0]) * turn(fact))] if turn(fact) is not None and turn(fact) <= 2 else []
        need(name in FUNCTIONS and parts[0][1] == m and e == (-1 if name == "cosh" else 1), "not at this argument")
        fact = scaled(fact, parts[0][0])
        (low, high), angle = (disc(fact) or (-inf, inf)) if fact else (-inf, inf), fact and turn(fact)
        if name in ("tanh", "cosh"):  # |cosh(x + jy)|^2 = sinh^2 x + cos^2 y >= 1 where |y| <= x
            if name == "cosh":
                return [UNIT] if angle is not None and angle <= Fraction(1, 2) else []
            return [RIGHT] if low >= 0 else [("disc", -inf, ZERO)] if high <= 0 else []
        found = [("arg", angle / 2)] if name == "sqrt" and angle is not None and angle <= 2 else []
        need(found or name != "sqrt", "not sqrt of a function off the negative axis")
        low = max(low, ZERO) if found else low
        if (name != "exp" and fact[0] == "arg") or (name == "log" and low <= 0):
            return found
        floor, roof = image(name, low)[0], image(name, high if name != "sqrt" else max(-disc(fact)[0], high))[1]
        ends = [("disc", floor, inf)] * (name != "exp") + [("disc", -roof, roof)] * (name != "log")
        return [*found, *([("real", floor, roof)] if fact and fact[0] == "real" else ends)]

    def rule_square(self, n, known, data):
        """w^2 = c w_1, c > 0, where w > 0 for real s, without zeros and poles, so that w is the root of c w_1."""
        ((m, fact), *parts), (c, exponents) = known, data
        whole = None not in [turn(f) for _, f in parts] and self.powers_of(parts, exponents)
        twice = self.powered([(self.fraction(ONE, n), 2)])
        same = twice[0] and self.is_equal(twice, self.fraction(Fraction(c), m))
        need(Fraction(c) > 0 and same and whole == self.powers(n), "not its root")
        return [("arg", turn(fact) / 2)] if turn(fact) is not None and turn(fact) <= 2 else []

    def rule_mean(self, n, known, data):
        """log(1 + X)/X and (1 - exp(-X))/X, means over t from 0 to 1 of 1/(1 + tX) and of exp(-tX), for X = c w_1."""
        ((m, fact),), c = known, Fraction(data)
        ((base, e),) = added(self.powers(n), self.powers(m)).items()
        of_log = self.nodes[base][0] == "log"
        inner = base if of_log else max(self.terms(base))
        kind, ((x, argument),) = self.nodes[inner]
        right = of_log or (kind == "exp" and self.terms(base) == {0: ONE, inner: -ONE})
        same = self.terms(argument, x) == added({0: ONE} if of_log else {}, self.terms(m, c if of_log else -c))
        need(right and same and e == 1 and c > 0 and disc(fact) and disc(fact)[0] >= 0, "not a mean")
        return [("disc", ZERO if of_log else -c, c)]

    def rule_line(self, n, known, data):
        """Re W >= 0 stays along dW/dx = A B - (B/A) W^2; if A is constant, so does a disc that w -> A^2/w maps."""
        (kind, parts), (ids, facts) = self.nodes[n], zip(*known, strict=True)
        (a, x), (b, y), (c, z) = parts if kind == "line" else [(ZERO, 0)] * 3
        need(a > 0 and b > 0 and ids[0] == (z if c else 0), "not this line")
        constant = ids[1:] == (x, y) and facts[1][0] == "real"  # A B and B/A go as B
        for e, m in () if constant else zip((1, -1), ids[1:], strict=True):
            both = self.powered(((self.fraction(ONE, y), 1), (self.fraction(ONE, x), e)))
            need(self.is_equal(both, self.fraction(ONE, m)), "not its series impedance or shunt admittance")
        (low, high), (least, most), (along, _) = (disc(f) or (-inf, 0) for f in map(scaled, facts, (c, a, b)))
        need(min(low, least, along) >= 0, "not passive")
        (under, over), ends = inverted(low, high) or (inf, inf), (least, most) if constant else (ZERO, inf)
        least, most = (times(x, x) for x in ends)
        return [("disc", min(low, times(least, under)), max(high, times(most, over)))]

    def rule_rational(self, n, known, data):
        """Chen and Smith: u/v is positive real if Re u conj v >= 0 for all jw, and u + v has its roots in Re s < 0."""
        fact, pair = read_fact(data["fact"]), self.fraction(ONE, n)
        atoms, unit = {m for f in pair for key in f for m, _ in key}, Fraction(data.get("unit", -1))
        delayed = [~m for m, f in known if implies(f, RIGHT) and unit > 0]  # exp(-c w_1), read as (1 - t)/(1 + t)
        fits = delayed == [*atoms] if known else unit == -1 and all(m >= 0 and self.nodes[m][0] == "s" for m in atoms)
        powers = [{-key[0][1] / unit if key else ZERO: Fraction(x) for key, x in f.items()} for f in pair]
        least, most = (end(0, *powers[0], *powers[1]) for end in (min, max))
        whole, steps = lcm(*(x.denominator for f in powers for x in f.values())), range(int(most - least) + 1)
        fits = fits and len(known) == len(delayed) and len(atoms) < 2 and len(steps) <= LARGEST
        need(fits and all(k - least in steps for f in powers for k in f), "not rational in s")
        lists = [[int(whole * f.get(least + k, 0)) for k in steps] for f in powers]
        p, q = (composed(f, [1, -1], [1, 1]) if known else combined(f, [], 0) for f in lists)
        choices = [(p, q)] if fact == ("arg", 1) else [(p, [ZERO, *q]), ([ZERO, *p], q)] if fact == ("arg", 2) else []
        if fact[0] == "disc" and fact[1] < fact[2]:  # w - low, high - w, or their quotient
            up = combined(p, q, -fact[1]) if fact[1] > -inf else q
            down = combined(q, p, -1, fact[2]) if fact[2] < inf else q
            choices = [(up, down) if fact[1] > -inf else (down, q)]
        u, v = ([Fraction(x) for x in data[key]] for key in "pq")
        need(any(u and v and convolved(u, y) == convolved(x, v) for x, y in choices), "another function")
        axis = [x * (-1) ** k for k, x in enumerate(convolved(u, [y * (-1) ** k for k, y in enumerate(v)])[::2])]
        right = is_nonnegative(axis, data["factors"], data["breaks"]) and is_hurwitz(combined(u, v, 1))
        need(right, "negative on the axis, or roots in Re s >= 0")
        return [fact]


RULES = {name[5:]: follows for name, follows in vars(Graph).items() if name.startswith("rule_")}


def added(f, g):
    """The sum of two polynomials, of two lists of terms, or of two lists of exponents."""
    found = dict(f)
    for key, x in g.items():
        found[key] = found[key] + x if key in found else x
    return found if all(found.values()) else {key: x for key, x in found.items() if x}


def combined(f, g, c, a=1):
    """a f + c g, lowest power first."""
    total = [a * x + c * y for x, y in zip_longest(f, g, fillvalue=0)]
    while total and not total[-1]:
        total.pop()
    return total


def convolved(f, g):
    """The product of two polynomials."""
    return [sum(x) for x in zip_longest(*([0] * k + [x * y for y in g] for k, x in enumerate(f)), fillvalue=0)]


def composed(f, top, bottom):
    """f(top/bottom) without its denominator."""
    found, power = [], [1]
    for x in reversed(f):
        found, power = combined(convolved(top, found), power, x), convolved(bottom, power)  # the short one first
    return found


def is_nonnegative(a, factors, breaks):
    """Whether a(x) is at least a product of powers, and that >= 0 for x >= 0 by signs of coefficients on pieces."""
    factors = [([Fraction(x) for x in f], min(e, LARGEST)) for f, e in factors]
    whole = reduce(convolved, (f for f, e in factors for _ in range(e)), [ONE])
    odd = reduce(convolved, (f for f, e in factors if e > 0 and e % 2), [ONE])
    ends = [ZERO, *map(Fraction, breaks)]
    pieces = [composed(odd, [low, high], [ONE, ONE]) for low, high in pairwise(ends)]  # x = (low + high t)/(1 + t)
    pieces += [composed(odd, [ends[-1], ONE], [ONE]), combined(a, whole, -1)]
    return ends == sorted(set(ends)) and all(x >= 0 for piece in pieces for x in piece)


def is_hurwitz(f):
    """Whether all roots lie in Re s < 0, by Routh's scheme in whole numbers: rows over a pivot before, exactly."""
    unit, over, pivot = lcm(*(x.denominator for x in f)) * (-1 if f and f[-1] < 0 else 1), 1, 1
    first, second = ([int(x * unit) for x in f[::-1][k::2]] for k in (0, 1))
    while second and min(first[0], second[0]) > 0:
        rest = [(second[0] * x - first[0] * y) // over for x, y in zip_longest(first[1:], second[1:], fillvalue=0)]
        first, second, over, pivot = second, rest[: len(first) - 1], pivot, second[0]
    return bool(first and not second) and first[0] > 0


def read_fact(fact):
    """A fact from its texts."""
    need((fact[0], len(fact)) in (("real", 3), ("disc", 3), ("arg", 2)), "not a fact")
    return (fact[0], *(float(x) if x in ("inf", "-inf") else Fraction(x) for x in fact[1:]))


def check(proof, rules=RULES):
    """Return None if a proof, as read from its file, proves its claim; else the mistake."""
    step = "the head"
    try:
        need(proof["format"] == FORMAT, f"not of the format {FORMAT}")
        need(not re.search(r'"[-+.\d/_ ]+e[-+\d_ ]*"', json.dumps(proof), re.IGNORECASE), "a number with an exponent")
        graph, known, unused = Graph({name: read_fact(fact) for name, fact in proof["names"].items()}), [], set()
        for kind, *parts in proof["nodes"][1:]:
            graph.enter(kind, parts)
        graph.look()
        for k, (n, fact, name, premises, data) in enumerate(proof["steps"]):
            step, goal = f"step {k}, rule '{name}'", read_fact(fact)
            need(n >= 0 and all(0 <= m < k for m in premises), "a step refers to a later one")
            found, unused = rules[name](graph, n, [known[m] for m in premises], data), {*unused, k} - {*premises}
            need(any(implies(f, goal) for f in found), "does not follow")
            known.append((n, goal))
        step, (c, n), (m, fact) = "the end", proof["root"], known[-1]
        need(m == n and implies(scaled(fact, Fraction(c)), read_fact(proof["claim"])), "no step leads to the claim")
        need(unused == {k}, "a step on which nothing rests")
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        return f"{step}: {error}"


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.exit(check(json.load(file)))  # None is success
