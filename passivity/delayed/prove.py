"""Proofs by composition: from discs that hold the values of the parts to discs that hold those of the whole."""

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import reduce
from operator import add

from flint import acb, arb, ctx

from passivity.ball import Real, ends, of_fraction
from passivity.budget import spend
from passivity.delayed.disc import RIGHT, UNIT, Disc, power_of_bound
from passivity.delayed.field import TooLargeError
from passivity.delayed.form import ONE, Form, Function, Product, constant, depends_on_s, multiply, of_rational
from passivity.delayed.leaf import leaves
from passivity.delayed.proof import ProofStep
from passivity.delayed.rewrite import line, means, rewritings
from passivity.delayed.value import value

MAX_REWRITINGS = 40
DEPTHS = (1, 2, 4, 6)  # of rewritings within rewritings, tried in turn
_INF = math.inf
_BITS = 128


def prove(form: Form, goal: Disc, depths: tuple[int, ...] = DEPTHS) -> ProofStep | None:
    """A proof that the values for Re s > 0 lie in a disc, if the rules find one; the sharpest of those found together.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> print(prove(of_text("1/(1 + exp(-2*s)) - 1/2"), RIGHT))
    -1/2 + 1/(1 + exp(-2*s)): Re >= 0
    """
    return next(filter(None, (_Prover(depth).reach(form, goal) for depth in depths)), None)


class _Prover:
    """What is known about each form so far."""

    def __init__(self, most: int):
        self.known: dict[Form, list[ProofStep]] = {}
        self.most, self.depth, self.rewritten = most, 0, 0

    def reach(self, form: Form, goal: Disc) -> ProofStep | None:
        found = [step for step in self.facts(form) if step.within(goal)]
        if found:
            return min(found, key=lambda step: (step.disc.radius, -step.disc.low))
        return next((s for s in self.rewrite(form) if s.within(goal)), None)

    def facts(self, form: Form) -> list[ProofStep]:
        if form not in self.known:
            spend(100_000, "a proof by composition")
            self.known[form] = []
            found = list(self.direct(form))
            if not any(isinstance(step.claim, Disc) for step in found):
                found += next(([step] for step in self.rewrite(form)), [])
            self.known[form] = found + _conversions(form, found)
        return self.known[form]

    def direct(self, form: Form) -> Iterator[ProofStep]:
        if not depends_on_s(form):
            return _constant(form)
        if (r := form.rational) is not None:
            return leaves(r)
        return self.sum(form) if len(form.terms) > 1 else self.product(form, *form.terms)

    def rewrite(self, form: Form) -> Iterator[ProofStep]:
        """Facts about the same function written differently, and about lines."""
        if self.depth >= self.most or form.rational is not None:
            return
        self.depth += 1
        try:
            for other in rewritings(form):
                self.rewritten += 1
                if self.rewritten > MAX_REWRITINGS:
                    return
                yield from (ProofStep("equal", form, step.claim, (step,)) for step in self.facts(other))
            for constants, parts in line(form):
                steps = [self.right(part) for part in parts]
                if all(steps):
                    yield ProofStep("line", form, RIGHT, tuple(filter(None, steps)), line=constants)
        except TooLargeError:
            return
        finally:
            self.depth -= 1

    def right(self, form: Form) -> ProofStep | None:
        return next((s for s in self.facts(form) if s.within(RIGHT)), None)

    def discs(self, form: Form) -> list[ProofStep]:
        return [step for step in self.facts(form) if isinstance(step.claim, Disc)]

    def turn(self, form: Form) -> ProofStep | None:
        found = [step for step in self.facts(form) if isinstance(step.claim, Fraction)]
        return min(found, key=lambda step: step.turn, default=None)

    def sum(self, form: Form) -> Iterator[ProofStep]:
        parts = [Form((term,)) for term in form.terms]
        known = [self.discs(part) for part in parts]
        for key in (_low, _high, _width):
            chosen = [min(steps, key=key, default=None) for steps in known]
            if all(step and key(step) < _INF for step in chosen):
                steps = tuple(filter(None, chosen))
                yield ProofStep("sum", form, reduce(add, (step.disc for step in steps)), steps)
        turns = [self.turn(part) for part in parts]
        if all(step and step.turn <= 1 for step in turns):
            steps = tuple(filter(None, turns))
            yield ProofStep("sum", form, max(step.turn for step in steps), steps)

    def product(self, form: Form, term: Product) -> Iterator[ProofStep]:
        r, factors = term.rational, term.factors
        if r.degree > 0 and r.p.leading_coefficient() < 0:
            for step in self.discs(form * constant(-1)):
                yield ProofStep("multiple", form, step.disc.scaled(Fraction(-1)), (step,))
            return
        if r.degree == 0 and len(factors) == 1 and factors[0][1] in (1, -1):
            ((base, e),) = factors
            c = r.numerator[0] / r.denominator[0]
            if c == 1 and e == 1:
                yield from self.function(base) if isinstance(base, Function) else ()
                return
            inner = multiply([(base, 1)])
            for step in self.discs(inner):
                disc = step.disc if e == 1 else step.disc.inverse()
                if disc:
                    yield ProofStep("multiple" if e == 1 else "inverse", form, disc.scaled(c), (step,))
        for c, argument, disc in means(form):
            if step := self.right(argument):
                yield ProofStep("mean", form, disc.scaled(c), (step,))
        pieces = [*([(of_rational(r), 1)] if r != ONE else []), *((multiply([(b, 1)]), e) for b, e in factors)]
        yield from self.moduli(form, pieces)
        turns = [self.turn(piece) for piece, _ in pieces]
        if all(turns):
            total = sum(abs(e) * step.turn for (_, e), step in zip(pieces, turns, strict=True) if step)
            yield ProofStep("product", form, Fraction(total), tuple(filter(None, turns)))
            squared = multiply([(form, 2)])
            if any(b.name == "sqrt" for b, _ in factors if isinstance(b, Function)) and total <= 4:
                square = self.turn(squared) if squared.rational is not None else None
                if square and square.turn <= 2 and square.turn / 2 < total and value(form, acb(1)).real > 0:
                    yield ProofStep("square", form, square.turn / 2, (square, *filter(None, turns)))

    def moduli(self, form: Form, pieces: list[tuple[Form, int]]) -> Iterator[ProofStep]:
        chosen, bound = [], Fraction(1)
        for piece, e in pieces:
            best = min(self.discs(piece), key=lambda step: _size(step, e), default=None)
            if best is None or _size(best, e) == _INF:
                return
            chosen.append(best)
            bound *= power_of_bound(_size(best, e), abs(e))
            if bound == _INF:
                return
        yield ProofStep("moduli", form, Disc(-bound, bound), tuple(chosen))

    def function(self, function: Function) -> Iterator[ProofStep]:
        form, argument = multiply([(function, 1)]), function.argument
        match function.name:
            case "exp":
                yield from self.exponential(form, argument)
            case "sqrt":
                turn = self.turn(argument)
                if turn and turn.turn <= 2:
                    yield ProofStep("root", form, turn.turn / 2, (turn,))
                    for step in self.discs(argument):
                        if step.disc.low > 0:
                            low = _enclosed(of_fraction(step.disc.low).sqrt()).low
                            yield ProofStep("root", form, Disc(low, _INF), (turn, step))
                        if step.disc.radius < _INF:
                            high = _enclosed(of_fraction(step.disc.radius).sqrt()).high
                            yield ProofStep("root", form, Disc(-high, high), (turn, step))
            case "log":
                for step in self.discs(argument):
                    if step.disc.low > 0:
                        low = Fraction(0) if step.disc.low == 1 else _enclosed(of_fraction(step.disc.low).log()).low
                        yield ProofStep("logarithm", form, Disc(low, _INF), (step,))
            case "tanh" | "coth":
                if step := self.right(argument):
                    yield ProofStep("hyperbolic", form, RIGHT, (step,))
            case "sech":
                if (turn := self.turn(argument)) and 2 * turn.turn <= 1:
                    yield ProofStep("diffusion", form, UNIT, (turn,))

    def exponential(self, form: Form, argument: Form) -> Iterator[ProofStep]:
        best = min(self.discs(argument), key=_high, default=None)
        if best and _high(best) < _INF:
            bound = Fraction(1) if _high(best) == 0 else _enclosed(of_fraction(_high(best)).exp()).high
            yield ProofStep("exponential", form, Disc(-bound, bound), (best,))
        if (power := of_power(argument)) and (turn := self.turn(power[1])) and turn.turn <= 2:
            yield ProofStep("power", form, abs(power[0]) * turn.turn, (turn,))


def of_power(argument: Form) -> tuple[Fraction, Form] | None:
    """The exponent and the base, if exp(argument) is a power: exp(c log f)."""
    if len(argument.terms) == 1 and argument.terms[0].rational.degree == 0 and len(argument.terms[0].factors) == 1:
        (term,) = argument.terms
        ((base, e),) = term.factors
        if isinstance(base, Function) and base.name == "log" and e == 1:
            return term.rational.numerator[0] / term.rational.denominator[0], base.argument
    return None


def _constant(form: Form) -> Iterator[ProofStep]:
    if (r := form.rational) is not None:
        claim = Disc(x := r.numerator[0] / r.denominator[0], x)
    else:
        with ctx.workprec(_BITS):
            ball = value(form, acb(1))
        if not (ball.is_finite() and ball.imag == 0):
            return
        claim = _enclosed(ball.real)
    yield ProofStep("constant", form, claim)
    if claim.low > 0:
        yield ProofStep("constant", form, Fraction(0))


def _conversions(form: Form, found: list[ProofStep]) -> list[ProofStep]:
    """A half-plane as a bound of the argument, and the reverse."""
    turns = [s for s in found if isinstance(s.claim, Fraction) and s.claim <= 1]
    halves = [s for s in found if s.within(RIGHT)]
    if turns and not halves:
        return [ProofStep("half-plane", form, RIGHT, (turns[0],))]
    if halves and not turns and _is_not_zero(form):
        return [ProofStep("half-plane", form, Fraction(1), (halves[0],))]
    return []


def _is_not_zero(form: Form) -> bool:
    return bool(value(form, acb(arb(37) / 29, arb(17) / 23)) != 0)


def _enclosed(ball: arb) -> Disc:
    return Disc(*ends(ball))


def _low(step: ProofStep) -> Real:
    return -step.disc.low


def _high(step: ProofStep) -> Real:
    return step.disc.high


def _width(step: ProofStep) -> Real:
    return step.disc.width


def _size(step: ProofStep, e: int) -> Real:
    disc = step.disc if e > 0 else step.disc.inverse()
    return disc.radius if disc else _INF
