"""Facts about the nodes of a graph, by the rules of `passivity.verifier`: the prover only chooses which to apply."""

import math
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import Any, TypeAlias

from passivity.budget import VERDICT, UndecidedError, budget, spend
from passivity.calculus.fact import (
    POSITIVE_REAL,
    Fact,
    angle_of,
    high_of,
    inverse_of,
    is_useful,
    low_of,
    shortened,
    size_of,
    tilt_of,
    width_of,
)
from passivity.calculus.graph import ZERO, Graph, Value
from passivity.calculus.leaf import rational_facts, wave_facts
from passivity.calculus.rewrite import Line, absorbing, lines, merged, pieces_of, rewritings
from passivity.calculus.values import needed
from passivity.delayed.boxes import prove_in_balls, rule_balls
from passivity.errors import ExpressionError
from passivity.expression.number import written
from passivity.status import Kind
from passivity.symbolic.question import rule_parameters
from passivity.verifier import RULES, disc, implies, scaled, turn

# of rewritings within rewritings, tried in turn; at first rational parts are not looked at closely
DEPTHS = (0, 2, 4, 6)
MAX_REWRITINGS = 120  # of what one mark needs
_COST = 60_000
_EQUALITY = VERDICT // 10
_SMALL = 150  # nodes of a graph in which equalities are also multiplied out in full

ALL_RULES = RULES | {"balls": rule_balls, "parameters": rule_parameters}  # those that the verifier does not know, too
Step = tuple[int, Fact, str, list[int], Any]  # node, fact, rule, the steps it rests on, data
Task: TypeAlias = Iterator[int]  # asks for facts about nodes, which are there when it goes on


class Prover:
    """Facts proved so far about each node."""

    def __init__(self, graph: Graph):
        self.graph, self.steps = graph, []
        self.known: dict[int, list[int]] = {}
        self.seen: set[int] = set()  # nodes visited
        self.lines: dict[int, tuple[int, Line, list[int]]] = {}  # nodes that are 1 or -1 times a line, with its cut
        self.most, self.depth, self.rewritten = DEPTHS[0], 0, 0
        self.products: dict[int, list[int]] = {}  # those with a base in them
        for m, (kind, parts) in enumerate(graph.nodes):
            for b, _ in parts if kind == "mul" and len(parts) > 1 else ():
                self.products.setdefault(b, []).append(m)

    def reach(self, value: Value, goal: Fact, depths: tuple[int, ...] = DEPTHS) -> int | None:
        """The step that proves a fact about a value, the sharpest of those found; None if the rules lead to none."""
        for most in depths:
            self.most, self.depth = most, 0
            self.rewritten = 0
            self._run(iter([value[1]]))
            if (found := self._implying(value, goal)) is not None:
                return found
            if most and self._waves(value[1]) and (found := self._implying(value, goal)) is not None:
                return found
            self.rewritten, found = 0, []
            self._run(self._rewrite(value[1], lambda k: self._best(value, goal, [k]) is not None, found))
            if found:
                return found[0]
            keep = self._is_passive if most else lambda k: self.steps[k][2] == "line"
            self.seen = {n for n in self.seen if any(map(keep, self.known[n]))}
            self.known = {n: steps for n, steps in self.known.items() if most or n in self.seen}
        return None

    def strictly(self, kind: Kind, value: Value) -> bool:
        """Whether balls prove a value without names strictly positive or bounded real."""
        return bool(self.follow(value[1], "balls", [], prove_in_balls(kind, self.graph, value)))

    def for_all(self, kind: Kind, value: Value) -> bool:
        """Whether polynomials prove a value of s and parameters positive or bounded real for all of these."""
        return bool(self.follow(value[1], "parameters", [], [kind.name, written(value[0])]))

    def _run(self, task: Task) -> None:
        """Work through a task and those that it waits for, however deep, without recursion."""
        stack = [task]
        while stack:
            n = next(stack[-1], None)
            if n is None:
                stack.pop()
            elif n not in self.seen:
                spend(_COST, "a proof by composition")
                self.seen.add(n)
                self.known.setdefault(n, [])
                stack.append(self._facts(n))

    def _waves(self, n: int) -> list[int]:
        """Facts about a node that commensurate delays make rational in one exponential."""
        self._run(iter([self.graph.s[1]]))
        found = []
        for fact, data in wave_facts(self.graph, n):
            premises = self.known[self.graph.s[1]]
            found += self.follow(n, "rational", premises, {"fact": [fact[0], *map(written, fact[1:])], **data})
        return found

    def _implying(self, value: Value, goal: Fact) -> int | None:
        return self._best(value, goal, self.known.get(value[1], ()))

    def _best(self, value: Value, goal: Fact, steps: Iterable[int]) -> int | None:
        """The sharpest of some steps that imply a fact."""
        moved = ((scaled(self.steps[k][1], value[0]), k) for k in steps)
        implying = [(size_of(fact), low_of(fact), k) for fact, k in moved if fact and implies(fact, goal)]
        return min(implying)[-1] if implying else None

    def _facts(self, n: int) -> Task:
        """Steps about a node, those that others imply left out."""
        yield from self._direct(n)
        if not any(disc(self.steps[k][1]) for k in self.known[n]):
            yield from self._rewrite(n, lambda _: True, [])
        elif self.most and self.graph.nodes[n][0] == "mul" and not self._is_passive(*self.known[n]):
            yield from self._rewrite(n, self._is_passive, [])

    def _is_passive(self, *steps: int) -> bool:
        """Whether one of some steps says that something or its negative is positive real, or bounded real."""
        return any(tilt_of(self.steps[k][1]) <= 1 or size_of(self.steps[k][1]) <= 1 for k in steps)

    def follow(self, n: int, rule: str, premises: list[int], data: Any = None) -> list[int]:
        """Apply a rule, keep its new facts, and return their steps."""
        try:
            found = ALL_RULES[rule](self.graph, n, [self.steps[k][:2] for k in premises], data)
        except (ValueError, TypeError, ZeroDivisionError, RecursionError):
            return []
        fresh = []
        for fact in found:
            fact = shortened(fact)
            if is_useful(fact) and not any(implies(self.steps[k][1], fact) for k in self.known.setdefault(n, [])):
                self.known[n] = [k for k in self.known[n] if not implies(fact, self.steps[k][1])]
                self.steps.append((n, fact, rule, premises, data))
                self.known[n].append(len(self.steps) - 1)
                fresh.append(len(self.steps) - 1)
        return fresh

    def _direct(self, n: int) -> Task:
        """Facts by the operation of a node itself."""
        graph, (kind, parts) = self.graph, self.graph.nodes[n]
        if kind in ("one", "s", "name"):
            self.follow(n, "leaf", [])
        elif graph.moves[n] and graph.is_rational[n] and graph.powers(n) not in ({graph.s[1]: 1}, {graph.s[1]: -1}):
            yield from self._rational(n, kind)
        elif kind == "sum":
            yield from self._sum(n)
        elif kind == "mul":
            found = False
            for upside_down, sign, parts, cut in lines(graph, n) if graph.moves[n] else ():
                found, line = True, graph.node("line", parts)
                target = graph.inverse((Fraction(1), n))[1] if upside_down else n
                self.lines.setdefault(target, (sign, parts, [m for m in cut if graph.nodes[m][0] != "tanh"]))
                yield line
                for k in list(self.known[line]):
                    self._equal(target, k, str(sign), cut)
                for k in list(self.known.get(target, ())) if upside_down else ():
                    self.follow(n, "product", [k], [-1])
                if self.known[n]:
                    return
            if self.most or not found:
                yield from self._product(n)
        elif kind == "line":
            self.lines[n] = 1, parts, [parts[2][1]] if parts[2][1] else []
            yield from self._line(n, *parts)
        elif kind in ("exp", "log", "sqrt", "tanh", "cosh"):
            yield parts[0][1]
            for k in list(self.known[parts[0][1]]):
                self.follow(n, "function", [k])
            factors = graph.powers(parts[0][1])
            if kind == "sqrt" and list(factors.values()) == [1, 1]:
                yield from factors
                both = [k for m in factors if (k := self.right(m)) is not None]
                if len(both) == len(factors):
                    self.follow(n, "function", both)
            name, inner = graph.nodes[parts[0][1]]
            if kind == "exp" and name == "log":
                yield inner[0][1]
                for k in list(self.known[inner[0][1]]):
                    self.follow(n, "function", [k])

    def _rational(self, n: int, kind: str) -> Task:
        """Try the parts of a node, then the exact test; on a closer look the exact test with the sharpest discs."""
        if not self.most:
            yield from self._sum(n) if kind == "sum" else self._product(n)
            if self.right(n) is not None:
                return
        for fact, data in rational_facts(self.graph, n, bool(self.most)):
            self.follow(n, "rational", [], {"fact": [fact[0], *map(written, fact[1:])], **data})
        if self.most and kind == "mul" and not any(turn(self.steps[k][1]) is not None for k in self.known[n]):
            yield from self._product(n)

    def _line(self, n: int, z0: Value, through: Value, load: Value) -> Task:
        """A line, from its load and a constant z0, or from its load, series impedance and shunt admittance."""
        along = [z0[1], through[1]]
        if self.graph.moves[z0[1]]:
            plain = [(Fraction(1), through[1]), (Fraction(1), z0[1])]
            along = [self.graph.product(plain, [1, e])[1] for e in (1, -1)]
        end = load[1] if load[0] else 0
        yield end
        sign, inner, cut = self.lines.get(end, (0, (ZERO, ZERO, ZERO), []))
        if sign and (one := merged(self.graph, (z0, through, load), inner, sign * load[0])):
            yield one[1]
            for k in list(self.known[one[1]]):
                self._equal(n, k, written(one[0]), cut)
        if self.most and self._implying(load, POSITIVE_REAL) is None:
            self._waves(end)
        known = [(scaled(self.steps[k][1], load[0]), k) for k in self.known[end]]
        best = [min(((key(fact), k) for fact, k in known if fact), default=(math.inf, 0)) for key in (low_of, high_of)]
        if best[0][0] > 0:
            if self.most:
                yield from self._absorbed(n, (z0, through, load))
            return
        yield from along
        others = [k for m in along if (k := self.right(m)) is not None]
        for k in {k for x, k in best if x < math.inf} if len(others) == 2 else ():  # the sharpest about the load
            self.follow(n, "line", [k, *others])

    def active(self) -> list[tuple[int, int, Line]]:
        """Nodes that are 1 or -1 times a line whose load was not found to be passive, deepest first.

        Not those, if there are others, whose load is the negative of a passive one: that is a line of z0 < 0.
        """
        about: dict[int, list[int]] = {}
        for k, (n, *_) in enumerate(self.steps):
            about.setdefault(n, []).append(k)
        lines = [(n, sign, line) for n, (sign, line, _) in self.lines.items()]

        def passive(line: Line, sign: int) -> bool:
            c, m = line[2]
            return self._best((sign * c, m), POSITIVE_REAL, about.get(m, ())) is not None

        active = sorted((x for x in lines if not passive(x[2], 1)), key=lambda each: each[0])
        return [x for x in active if not passive(x[2], -1)] or active

    def right(self, n: int) -> int | None:
        """Return the step with the sharpest bound among those that prove Re w >= 0."""
        found = [(low_of(self.steps[k][1]), k) for k in self.known[n] if implies(self.steps[k][1], POSITIVE_REAL)]
        return min(found)[1] if found else None

    def _absorbed(self, n: int, line: Line) -> Task:
        """A line that loses more than its load gives."""
        along = line[1]
        yield along[1]
        if not any(low_of(self.steps[k][1]) < 0 < along[0] for k in self.known[along[1]]):
            return
        for (c, m), cut in absorbing(self.graph, line):
            yield m
            for k in list(self.known[m]):
                self._equal(n, k, written(c), cut)
            if self.known[n]:
                return

    def _sum(self, n: int) -> Task:
        """Prove facts about a sum from the sharpest facts about its terms, the rational terms taken together."""
        graph, terms = self.graph, self.graph.nodes[n][1]
        simple = [(c, m) for c, m in terms if graph.is_rational[m]]
        if 1 < len(simple) < len(terms):
            c, together = graph.sum(simple)
            terms = [(c, together), *((c, m) for c, m in terms if not graph.is_rational[m])]
        yield from (m for _, m in terms)
        known = [[(scaled(self.steps[k][1], c), k) for k in self.known[m]] for c, m in terms]
        data = [written(c) for c, _ in terms]
        for key in (low_of, high_of, width_of, angle_of):
            best = [min(((key(f), k) for f, k in facts if f), default=(math.inf, 0)) for facts in known]
            if all(x < math.inf for x, _ in best) and (key is not angle_of or all(x <= 1 for x, _ in best)):
                self.follow(n, "combination", [k for _, k in best], data)
            if not self.most and self.right(n) is not None:
                return

    def _product(self, n: int) -> Task:
        """Prove facts about a product from its inverse or its factors; factors that belong together are kept so."""
        graph, powers = self.graph, self.graph.powers(n)
        if len(powers) == 1:
            ((b, e),) = powers.items()
            if e == -1:
                yield b
            if graph.nodes[b][0] == "cosh" and e == -1:
                yield graph.nodes[b][1][0][1]
                for k in list(self.known[graph.nodes[b][1][0][1]]):
                    self.follow(n, "function", [k])
        if len(powers) > 1 and any(e == -1 and graph.nodes[b][0] == "log" for b, e in powers.items()):
            yield graph.inverse((Fraction(1), n))[1]  # which may be a mean
        for k in list(self.known.get(graph.opposite(n) or 0, ())):
            self.follow(n, "product", [k], [-1])
        yield from self._means(n, powers)
        pieces = pieces_of(graph, powers)
        if len(pieces) > 1 or pieces[0][1] not in (1, -1):
            yield from self._multiplied(n, pieces)
            yield from self._roots(n, pieces)
        if self.most and not self._is_passive(*self.known[n]) and (units := self._units(n, powers)):
            yield from self._multiplied(n, units)

    def _units(self, n: int, powers: dict[int, int]) -> list[tuple[int, int]]:
        """Split powers into products present from the beginning and the rest; empty without such products."""
        left, found = dict(powers), []
        for m in sorted({m for b in powers for m in self.products.get(b, ())}, reverse=True):
            inner = self.graph.powers(m)
            if m != n and len(inner) < len(left) and inner.items() <= left.items():
                found.append((m, 1))
                left = {b: e for b, e in left.items() if b not in inner}
        return [*found, *left.items()] if found else []

    def _multiplied(self, n: int, pieces: list[tuple[int, int]]) -> Task:
        """A product, from the sharpest facts about the nodes whose powers it is made of."""
        graph = self.graph
        exponents = [e for _, e in pieces]
        yield from (m for m, _ in pieces)
        known = [[(self.steps[k][1], k) for k in self.known[m]] for m, _ in pieces]
        sharpest = [low_of, size_of] if any(not graph.moves[m] for m, _ in pieces) else [size_of]
        for up in [*sharpest, tilt_of]:
            best = []
            for (_, e), facts in zip(pieces, known, strict=True):
                usable = [(up(f) if e > 0 or up is tilt_of else up(inverse_of(f)), k) for f, k in facts]
                best.append(min(usable, default=(math.inf, 0)))
            if all(x < math.inf for x, _ in best):
                self.follow(n, "product", [k for _, k in best], exponents)
            if not self.most and self.right(n) is not None:
                return

    def _roots(self, n: int, pieces: list[tuple[int, int]]) -> Task:
        """A product of roots, from its square."""
        graph = self.graph
        if not any(graph.nodes[m][0] == "sqrt" for m, _ in pieces):
            return
        angles = [
            min(((angle_of(self.steps[k][1]), k) for k in self.known[m]), default=(math.inf, 0)) for m, _ in pieces
        ]
        if all(x < math.inf for x, _ in angles):
            c, squared = graph.product([(Fraction(1), n)], [2])
            if c > 0 and squared != n and not any(graph.nodes[m][0] == "sqrt" for m in needed(graph, squared)):
                yield squared
                for k in list(self.known[squared]):
                    self.follow(n, "square", [k, *(x for _, x in angles)], [written(c), [e for _, e in pieces]])

    def _means(self, n: int, powers: dict[int, int]) -> Task:
        """log(1 + X)/X and (1 - exp(-X))/X."""
        graph = self.graph
        for b, e in powers.items():
            if e != 1 or graph.nodes[b][0] not in ("log", "sum"):
                continue
            if graph.nodes[b][0] == "log":
                c, x = graph.sum([graph.nodes[b][1][0], (Fraction(-1), 0)])
            else:
                c, x = graph.sum([(Fraction(1), b), (Fraction(-1), 0)])
                if c != -1 or graph.nodes[x][0] != "exp":
                    continue
                c, x = graph.scaled(graph.nodes[x][1][0], -1)
            if {k: -v for k, v in graph.powers(x).items()} == {k: v for k, v in powers.items() if k != b}:
                yield x
                for k in [k for k in self.known[x] if disc(self.steps[k][1])]:
                    self.follow(n, "mean", [k], written(c))

    def _equal(self, n: int, k: int, c: str, cut: list[int]) -> list[int]:
        """Carry a fact over to a multiple, nodes in `cut` not expanded; if that fails and is cheap, all expanded."""
        try:
            with budget(_EQUALITY):
                found = self.follow(n, "equal", [k], [c, cut])
                return found or (
                    self.follow(n, "equal", [k], [c, []]) if cut and len(self.graph.nodes) < _SMALL else []
                )
        except UndecidedError:
            return []

    def _rewrite(self, n: int, enough: Callable[[int], bool], found: list[int]) -> Task:
        """Facts about the same function, or its inverse, written differently, until one is enough."""
        if self.depth >= self.most or self.graph.is_rational[n]:
            return
        self.depth += 1
        try:
            for upside_down, (c, m), cut in rewritings(self.graph, n):
                self.rewritten += 1
                if self.rewritten > MAX_REWRITINGS:
                    return
                target = self.graph.inverse((Fraction(1), n))[1] if upside_down else n
                yield m
                for k in list(self.known[m]):
                    for other in self._equal(target, k, written(c), cut):
                        fresh = [other] if target == n else self.follow(n, "product", [other], [-1])
                        if any(map(enough, fresh)):
                            found += filter(enough, fresh)
                            return
        except ExpressionError:  # a division by zero on the way
            return
        finally:
            self.depth -= 1
