"""The expanded function whose parameters are to be judged, its exact condition, and its verdict at given values."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.calculus.graph import Graph, Value
from passivity.errors import ExpressionError
from passivity.exact.positive_real import check
from passivity.exact.verdict import Verdict
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.symbolic import write
from passivity.symbolic.assumption import Range
from passivity.symbolic.counterexample import Counterexample
from passivity.symbolic.delay import as_reflection, delayed_witness
from passivity.symbolic.domain import coefficients
from passivity.symbolic.formula import Formula, claim, join, value
from passivity.symbolic.low_degree import low_degree_condition
from passivity.symbolic.positivity import allowance, as_impedance, positivity_condition

_SHOWN = 400  # characters of a line


@dataclass(frozen=True)
class Question:
    """Is p/q, behind a delay if any, positive real or bounded real?

    Parameters
    ----------
    kind : Kind
        BR where there is a delay: p/q is then the reflection H2 behind it.
    whole, function, delay : Pair
        The function with its delay; p/q; and tau of exp(-tau s), 0 without one.
    expansion : Expansion
        Where they come from.
    """

    kind: Kind
    whole: Pair
    function: Pair
    delay: Pair
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
        return cls(Kind.BR, whole, *as_reflection(kind, whole, tau, expansion), expansion)

    def formula(self) -> Formula | bool | None:
        """When the property holds: for all parameters of the domain (True), for those of a formula, or not known."""
        domain, z = self.expansion.domain, as_impedance(self.kind, self.function)
        found = self._with_numbers() if not domain.ranges else positivity_condition(z, domain, self.expansion)
        if found is None and self.degree <= 2:
            found = low_degree_condition(z, domain)
        forward = claim(self.expansion.times(*self.delay), ">=", domain)
        if found is None or forward is True:
            return found
        nothing = join("and", [claim(c, "=", domain) for c in coefficients(self.function.p)])
        return join("or", [join("and", [forward, found]), nothing])

    @property
    def degree(self) -> int:
        """Of p or q in s."""
        return max(int(f.degrees()[0]) for f in self.function)

    @property
    def work(self) -> int:
        """Of a trial with values for the parameters."""
        return sum(map(len, self.function)) + self.degree**2

    def verdict(self, values: Mapping[str, Fraction]) -> Verdict:
        """The verdict on p/q without a delay, for values of the free parameters."""
        sides = [[value(c, values) for c in reversed(coefficients(f))] for f in self.function]
        return check(RationalFunction.from_coefficients(*sides), self.kind)

    def refutation(self, values: Mapping[str, Fraction], numbers: Mapping[str, Fraction]) -> Counterexample | None:
        """The refutation for values of the free parameters, beside the numbers of others; None too where it is 0/0."""
        over, under = (value(f, values) for f in self.delay)
        try:
            verdict = self.verdict(values)
        except ExpressionError:
            return None
        delay = over / under if under else Fraction(0)
        witness = delayed_witness(verdict, delay) if under else None
        return Counterexample({**numbers, **values}, verdict, witness, delay) if witness else None

    def _with_numbers(self) -> bool | None:
        status = self.verdict({}).status
        return None if status is Status.UNDECIDED else status is Status.PROVED

    def note(self) -> str:
        """Where an impedance is infinite for all s, if that can be."""
        q = self.function.q
        if self.kind is Kind.BR or q.degrees()[0] > 0 or 0 not in self.expansion.domain.signs(q):
            return ""
        return f"where {write.polynomial(q)} = 0 it is infinite: an open circuit, which counts as positive real"

    def lines(self) -> list[str]:
        """The steps of the proof that the property holds for all parameters."""
        z = as_impedance(self.kind, self.function)
        (p, q), told = map(write.polynomial, z), []
        if self.delay.p:
            tau = write.quotient(*self.delay)
            told.append(f"H1 = exp(-({tau})*s) H2 with {tau} >= 0 is bounded real if and only if H2 is")
        h = "H2" if self.delay.p else "H"
        told.append(f"{'Z' if self.kind is Kind.PR else f'(1 + {h})/(1 - {h})'} = p/q with p = {p}, q = {q}")
        if self.expansion.domain.ranges:
            a = write.polynomial(allowance(z, self.expansion), "x")
            told.append(f"Re p(jw) conj q(jw) = {a} >= 0, x = w^2")
        told.append(f"p + q = {write.polynomial(z.p + z.q)} has no root in Re s > 0 that p and q do not have in common")
        return [write.cut(line, _SHOWN) for line in told]
