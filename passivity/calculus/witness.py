"""A point where a graph fails to be positive or bounded real, shown in balls and kept in a file."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb

from passivity.calculus.fact import BOUNDED_REAL, Fact
from passivity.calculus.graph import Graph, Value
from passivity.calculus.read import read
from passivity.calculus.values import at_point
from passivity.expression.number import digits, written
from passivity.verifier import read_fact

FORMAT = "passivity witness 1"


@dataclass(frozen=True)
class Witness:
    """A point of the right half plane where a property fails; as a tuple (re, im, value), by names as its file.

    Parameters
    ----------
    re, im : Fraction
        The point s = re + j im, re > 0.
    value : acb
        A ball that holds the value there.
    values : mapping of str to Fraction
        For the names in the function.
    file : dict
        What `check_file` reads.
    """

    re: Fraction
    im: Fraction
    value: acb
    values: Mapping[str, Fraction]
    file: dict[str, Any]

    def __getitem__(self, key: Any) -> Any:
        return self.file[key] if isinstance(key, str) else (self.re, self.im, self.value)[key]

    @property
    def why(self) -> str:
        """What is wrong there, in words."""
        s = f"s = {digits(self.re)} + {digits(self.im)}j"
        s += "".join(f", {name} = {digits(x)}" for name, x in self.values.items())
        bounded = self.file["claim"] == [str(x) for x in BOUNDED_REAL]
        if not self.im and self.value.imag != 0:
            return f"the value at {s} is not real, as if a branch cut ran there"
        if bounded:
            return f"|H(s)| = {abs(self.value).str(15, radius=False)} at {s}"
        return f"Re Z(s) = {self.value.real.str(6, radius=False)} at {s}"


@dataclass(frozen=True)
class Question:
    """Whether a value has a property, as it was asked.

    Parameters
    ----------
    graph : Graph
    value : tuple of (Fraction, int)
    claim : tuple
        The property as a fact.
    text : str
        From which the value was read.
    numbers : mapping of str to Fraction
        Values of names in the text that the graph does not have.
    """

    graph: Graph
    value: Value
    claim: Fact
    text: str
    numbers: Mapping[str, Fraction]

    @property
    def bounded(self) -> bool:
        """Whether the property is that of a reflection."""
        return self.claim == BOUNDED_REAL

    def fails(self, re: Fraction, im: Fraction, values: Mapping[str, Fraction]) -> acb | None:
        """The value at a point, if balls show that the property fails there."""
        if re <= 0:
            return None
        found = at_point(self.graph, self.value, re, im, values)
        wrong = abs(found) > 1 if self.bounded else found.real < 0
        unreal = not im and (found.imag > 0 or found.imag < 0)
        return found if found.is_finite() and (wrong or unreal) else None

    def witness(self, re: Fraction, im: Fraction, values: Mapping[str, Fraction]) -> Witness | None:
        """The point as a witness, if it is one."""
        found = self.fails(re, im, values)
        if found is None:
            return None
        file = {
            "format": FORMAT,
            "text": self.text,
            "claim": [str(x) for x in self.claim],
            "names": {name: [fact[0], *map(written, fact[1:])] for name, fact in self.graph.names.items()},
            "numbers": {name: written(x) for name, x in self.numbers.items()},
            "values": {name: written(x) for name, x in values.items()},
            "s": [written(re), written(im)],
            "value": found.str(20, radius=False),
        }
        return Witness(re, im, found, dict(values), file)


def check_file(witness: dict[str, Any]) -> str | None:
    """None if a witness, as its file is read, shows that its text lacks the property; else what is wrong."""
    try:
        need = witness["format"] == FORMAT and witness["claim"] in (["disc", "0", "inf"], ["disc", "-1", "1"])
        names: dict[str, Fact] = {name: read_fact(fact) for name, fact in witness["names"].items()}
        graph, numbers = Graph(names), {name: Fraction(x) for name, x in witness["numbers"].items()}
        value = read(graph, witness["text"], numbers)
        question = Question(graph, value, read_fact(witness["claim"]), witness["text"], numbers)
        values = {name: Fraction(x) for name, x in witness["values"].items()}
        re, im = witness["s"]
        allowed = all(_allows(names[name], x) for name, x in values.items())
        shown = need and allowed and question.fails(Fraction(re), Fraction(im), values) is not None
        return None if shown else "balls do not show that the claim fails there"
    except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError) as error:
        return f"not a witness: {error}"


def _allows(fact: Fact, x: Fraction) -> bool:
    """Whether a constant has what is assumed of a parameter or a function."""
    kind, low, high = fact
    return low <= x <= high and (kind in ("real", "disc"))
