"""Whether a value of a graph has a property, as it was asked; points where it fails, shown in balls, kept in files."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self

from passivity.calculus.fact import BOUNDED_REAL, CLAIMS, Fact, in_texts
from passivity.calculus.graph import Graph, Value
from passivity.calculus.read import read
from passivity.calculus.values import Spot, at_point, value_at
from passivity.expression.number import written
from passivity.status import Kind
from passivity.verdict import Witness
from passivity.verifier import read_fact

FORMAT = "passivity witness 1"


@dataclass(frozen=True)
class Question:
    """Whether a value has a property, as it was asked."""

    graph: Graph
    value: Value
    claim: Fact  # the property
    text: str  # from which the value was read
    numbers: Mapping[str, Fraction]  # of names in the text that the graph does not have

    @classmethod
    def of(cls, kind: Kind, text: str, numbers: Mapping[str, Fraction], names: Mapping[str, Fact]) -> Self:
        """Make the question about a text, with values of some names and assumptions on the others."""
        graph = Graph(dict(names))
        return cls(graph, read(graph, text, numbers), CLAIMS[kind], text, numbers)

    @property
    def kind(self) -> Kind:
        """Which property."""
        return Kind.BR if self.claim == BOUNDED_REAL else Kind.PR

    def fails(
        self, re: Fraction, im: Fraction, values: Mapping[str, Fraction], spot: Spot | None = None
    ) -> Witness | None:
        """The point, or that of a disc around it, as a witness, if balls show that the property fails there."""
        if re <= 0:
            return None
        if spot:
            found = value_at(self.graph, self.value, re, im, spot, values)
        else:
            found = at_point(self.graph, self.value, re, im, values)
        wrong = found.real < 0 if self.kind is Kind.PR else abs(found) > 1
        unreal = not im and not spot and (found.imag > 0 or found.imag < 0)
        shown = found.is_finite() and (wrong or unreal)
        return Witness(self.kind, re, im, found, names=dict(values), spot=spot) if shown else None

    def file(self, witness: Witness) -> dict[str, Any] | None:
        """Return the contents of a file for `check_file`, if balls show that a point is a witness."""
        found = self.fails(witness.re, witness.im, witness.names, witness.spot)
        return found and {
            "format": FORMAT,
            "text": self.text,
            "claim": in_texts(self.claim),
            "names": {name: in_texts(fact) for name, fact in self.graph.names.items()},
            "numbers": {name: written(x) for name, x in self.numbers.items()},
            "values": {name: written(x) for name, x in witness.names.items() if name in self.graph.names},
            "s": [written(witness.re), written(witness.im)],
            "value": found.found.str(20, radius=False),
            "spot": found.spot and [written(found.spot.radius), *found.spot[1:]],
        }


def check_file(witness: dict[str, Any]) -> str | None:
    """Return None if a witness, as read from its file, shows that its text lacks the property; else the fault found."""
    try:
        need = witness["format"] == FORMAT and witness["claim"] in map(in_texts, CLAIMS.values())
        names: dict[str, Fact] = {name: read_fact(fact) for name, fact in witness["names"].items()}
        numbers = {name: Fraction(x) for name, x in witness["numbers"].items()}
        kind = Kind.BR if read_fact(witness["claim"]) == BOUNDED_REAL else Kind.PR
        question = Question.of(kind, witness["text"], numbers, names)
        values = {name: Fraction(x) for name, x in witness["values"].items()}
        (re, im), told = map(Fraction, witness["s"]), witness.get("spot")
        spot = told and Spot(Fraction(told[0]), *map(int, told[1:]))
        allowed = all(_allows(names[name], x) for name, x in values.items())
        shown = need and allowed and question.fails(re, im, values, spot) is not None
        return None if shown else "balls do not show that the claim fails there"
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        return f"not a witness: {error}"


def _allows(fact: Fact, x: Fraction) -> bool:
    """Return whether a constant satisfies the assumption on a parameter or a function."""
    kind, low, high = fact
    return low <= x <= high and (kind in ("real", "disc"))
