"""The expanded function whose parameters are to be judged, its exact condition, and its verdict at given values.

A delay may precede a rational reflection, H1 = exp(-tau s) H2, also in the impedance or admittance
(1 + H1)/(1 - H1), which is positive real if and only if H1 is bounded real. For tau >= 0 that is so exactly if H2 is:
|H1| <= |H2| in Re s > 0, on the axis |H1| = |H2|, and they have the same poles. For tau < 0 H1 grows without bound
unless H2 = 0.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import islice
from math import inf
from typing import Any

from passivity.budget import VERDICT, UndecidedError, budget
from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.calculus.fact import CLAIMS, Fact
from passivity.calculus.graph import Graph, Value
from passivity.calculus.question import Question as Asked
from passivity.calculus.search import Search
from passivity.calculus.values import needed
from passivity.errors import ExpressionError, shorten
from passivity.exact.positive_real import check
from passivity.expression.number import written
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.symbolic.assumption import Range, trials
from passivity.symbolic.conditions import allowance, as_impedance, low_degree_condition, positivity_condition
from passivity.symbolic.domain import coefficients
from passivity.symbolic.formula import Condition, Formula, claim, join, polynomial_text, quotient_text, value
from passivity.verdict import Verdict, Witness
from passivity.verifier import Graph as Nodes, scaled

MAX_TRIALS = 600
MAX_WORK = 400_000  # of all trials together: characters read and squares of degrees
_LINE, _SHOWN = 400, 200  # characters of a step, and of all values in a reason
_E = 1  # the generator exp(-tau s)


@dataclass(frozen=True)
class Question:
    """Is p/q, behind a delay if any, positive real or bounded real?"""

    kind: Kind  # BR where there is a delay: p/q is then the reflection H2 behind it
    whole: Pair  # the function with its delay
    function: Pair  # p/q
    delay: Pair  # tau of exp(-tau s), 0 without one
    expansion: Expansion

    @classmethod
    def of(cls, kind: Kind, graph: Graph, value: Value, ranges: Iterable[Range] = ()) -> "Question":
        """The question whether a value has a property; ExpansionError if it cannot be expanded."""
        expansion = Expansion(graph, value[1], ranges)
        for n in expansion.atoms:
            raise ExpansionError(f"{graph.nodes[n][0]}(...) is not rational, nor a delay")
        found = [expansion.delay(k) for k in range(len(expansion.units))]
        delays = [one for one in found if one is not None]
        if len(delays) < len(found):
            raise ExpansionError("one exp(...) is no delay exp(-T*s) with T free of s")
        if len(delays) > 1:
            raise ExpansionError("the delays are not whole multiples of one")
        whole = expansion.of(value).reduced()
        if not delays:
            return cls(kind, whole, whole, Pair(0 * expansion.one, expansion.one), expansion)
        tau = expansion.of(delays[0]).reduced()
        return cls(Kind.BR, whole, *_as_reflection(kind, whole, tau, expansion), expansion)

    def formula(self) -> Formula | bool | None:
        """When the property holds: for all parameters of the domain (True), for those of a formula, or not known."""
        domain, z = self.expansion.domain, as_impedance(self.kind, self.function)
        found = positivity_condition(z, domain, self.expansion)
        if found is None and self.degree <= 2:
            found = low_degree_condition(z, domain)
        forward = claim(self.expansion.times(*self.delay), ">=", domain)
        if found is None or forward is True:
            return found
        nothing = join("and", [claim(c, "=", domain) for c in coefficients(self.function.p)])
        return join("or", [join("and", [forward, found]), nothing])

    @property
    def degree(self) -> int:
        """Larger degree of p and q in s."""
        return max(int(f.degrees()[0]) for f in self.function)

    @property
    def work(self) -> int:
        """Work of a trial with values for the parameters."""
        return sum(map(len, self.function)) + self.degree**2

    def refutation(self, values: Mapping[str, Fraction], asked: Asked) -> tuple[Witness, str] | None:
        """The refutation for values of the free parameters, and the reason; None too where it is 0/0."""
        over, under = (value(f, values) for f in self.delay)
        sides = [[value(c, values) for c in reversed(coefficients(f))] for f in self.function]
        try:
            verdict = check(RationalFunction.from_coefficients(*sides), self.kind)
        except ExpressionError:
            return None
        delay, witness = over / under if under else Fraction(0), verdict.witness
        if delay and (verdict.refuted or delay < 0):
            search = Search(asked, values)
            witness = search.glance() or search.hunt()
        if witness is None or not under:
            return None
        why = f"of the reflection H behind the delay, {verdict.why}" if delay else verdict.why
        why = "exp(-delay*s) with a negative delay grows without bound" if delay < 0 else why
        return replace(witness, names={**asked.numbers, **values}), why

    def note(self) -> str:
        """Where an impedance is infinite for all s, if that can be."""
        q = self.function.q
        if self.kind is Kind.BR or q.degrees()[0] > 0 or 0 not in self.expansion.domain.signs(q):
            return ""
        return f"where {polynomial_text(q)} = 0 it is infinite: an open circuit, which counts as positive real"

    def lines(self) -> list[str]:
        """The steps of the proof that the property holds for all parameters."""
        z = as_impedance(self.kind, self.function)
        (p, q), told = map(polynomial_text, z), []
        if self.delay.p:
            tau = quotient_text(*self.delay)
            told.append(f"H1 = exp(-({tau})*s) H2 with {tau} >= 0 is bounded real if and only if H2 is")
        h = "H2" if self.delay.p else "H"
        told.append(f"{'Z' if self.kind is Kind.PR else f'(1 + {h})/(1 - {h})'} = p/q with p = {p}, q = {q}")
        a = polynomial_text(allowance(z, self.expansion), "x")
        told.append(f"Re p(jw) conj q(jw) = {a} >= 0, x = w^2")
        told.append(f"p + q = {polynomial_text(z.p + z.q)} has no root in Re s > 0 that p and q do not have in common")
        return [shorten(line, _LINE) for line in told]


def decide(asked: Asked, made: partial) -> Verdict:
    """The verdict by polynomials in the parameters, with a search for values that refute."""
    free = made.keywords["ranges"]
    question, formula, limit = None, None, "neither a proof nor a counterexample was found"
    try:
        with budget(VERDICT // 3):
            question = Question.of(asked.kind, asked.graph, asked.value, free)
            formula = question.formula()
    except UndecidedError as error:
        limit = str(error)
    if question is None:
        return made(Status.UNDECIDED, reason=f"{limit}; to settle it: values for the parameters")
    if formula is True:
        why = "the exact test holds, whatever the parameters are"
        return made(Status.PROVED, reason=why, steps=tuple(question.lines()), note=question.note())
    condition, note = Condition(formula, free, question.whole) if formula else None, question.note()
    work = 0  # done in the trials
    for values in islice(trials(free), MAX_TRIALS):
        holds = condition is not None and condition.formula.holds(values)
        work += len(asked.text) if holds else question.work
        try:
            found = None if holds else question.refutation(values, asked)
        except UndecidedError:
            break
        if found:
            witness, why = found
            at = shorten(", ".join(f"{name} = {written(x)}" for name, x in witness.names.items()), _SHOWN)
            return made(Status.REFUTED, reason=f"not for {at}: {why}", condition=condition, witness=witness, note=note)
        if work > MAX_WORK:
            break
    help_ = f"whether the assumptions imply {condition}" if condition else "values for the parameters"
    return made(Status.UNDECIDED, reason=f"{limit}; to settle it: {help_}", condition=condition, note=note)


def rule_parameters(nodes: Nodes, n: int, known: list[Any], data: list[str]) -> list[Fact]:
    """c times a node of s and parameters is positive or bounded real for all of these, by signs of polynomials."""
    graph, kind, c, ranges = Graph.of(nodes), Kind[data[0]], Fraction(data[1]), []
    for name in {graph.nodes[m][1][0] for m in needed(graph, n) if graph.nodes[m][0] == "name"}:
        _, low, high = graph.names[name]
        ranges.append(Range(name, None if low == -inf else low, None if high == inf else high))
    if known or any(r.is_point or graph.names[r.name][0] != "real" for r in ranges):
        raise ValueError("not of parameters alone")
    fact = scaled(CLAIMS[kind], 1 / c) if Question.of(kind, graph, (c, n), ranges).formula() is True else None
    return [fact] if fact else []


def _as_reflection(kind: Kind, function: Pair, tau: Pair, expansion: Expansion) -> tuple[Pair, Pair]:
    """H2 and its delay of a function H1, or Z, of s and exp(-tau s) that has this form; else ExpansionError."""
    p, q = function
    h = Pair(p, q) if kind is Kind.BR else Pair(p - q, p + q).reduced()
    (over, m), (under, n) = (_single_power(f) for f in h)
    return Pair(over, under), expansion.product(tau, Pair((m - n) * expansion.one, expansion.one)).reduced()


def _single_power(f) -> tuple:
    """g and k with f = g e^k, g free of e."""
    parts = [(g, k) for k, g in enumerate(coefficients(f, _E)) if g]
    if len(parts) > 1:
        raise ExpansionError("it is not exp(-T*s) times a rational reflection, nor the impedance of one")
    return parts[0] if parts else (f, 0)
