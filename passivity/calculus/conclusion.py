"""What is said of a function, and what anyone can check of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from flint import arb

from passivity.budget import ASIDE, VERDICT, if_affordable
from passivity.calculus.fact import CLAIMS, Fact
from passivity.calculus.graph import Graph
from passivity.calculus.proof import Proof, lines, prove, sharpest, verify_proof
from passivity.calculus.read import read
from passivity.calculus.search import Search
from passivity.calculus.values import at_point
from passivity.calculus.witness import Question, Witness
from passivity.delayed.poles import Pole
from passivity.exact.verdict import Verdict
from passivity.expression.number import complex_text, digits, written
from passivity.status import Decided, Kind, Status, first_of
from tline.presentation import SCREEN


class AxisValue(NamedTuple):
    """The smallest Re Z(jw), or the largest |H(jw)|, between a value that is attained and one that is not passed."""

    attained: arb  # at `frequency`, which was found by sampling; a ball
    bound: Fraction | None  # proved for all of Re s > 0; None if nothing is, and then `attained` is a sampled value
    frequency: float  # rad/s


@dataclass(frozen=True)
class Conclusion(Decided):
    """Whether a function has a property, with what anyone can check.

    Parameters
    ----------
    kind : Kind
    statement : str
        What was asked, with the assumptions.
    status : Status
    why : str
        The reason in one sentence, or what was not resolved.
    proof : dict or None
        What `passivity.verifier` checks, if the rules prove it; `passivity.calculus.proof.save` writes it.
    witness : Witness or None
        Values of the names, and a point s where the property fails.
    pole : Pole or None
        Where the function is unbounded or, an impedance, zero in Re s > 0; then there may be no witness in reach.
    oracle : Verdict, SymbolicVerdict or None
        Of the exact test or of polynomials, where one of these decided.
    asked : tuple of (str, dict, dict)
        The text, the numbers for names in it, and what was assumed of others, if the question was one.
    """

    kind: Kind
    statement: str
    status: Status
    why: str
    proof: Proof | None = None
    witness: Witness | None = None
    pole: Pole | None = None
    oracle: Any = None
    asked: tuple[str, Mapping[str, Fraction], Mapping[str, Fact]] = field(default=("", {}, {}), repr=False)

    @property
    def rational(self) -> Verdict | None:
        """The verdict of the exact test, if the function is rational with numbers alone."""
        return self.oracle if isinstance(self.oracle, Verdict) else None

    @cached_property
    def margin(self) -> AxisValue | None:
        """Smallest Re Z(jω), or largest |H(jω)|; None where the axis has no values, or where `rational` has them."""
        return if_affordable(ASIDE, self._on_axis) if self.rational is None and self.asked[0] else None

    def _on_axis(self) -> AxisValue | None:
        question = self._question
        frequency = Search(question, {}).lowest()
        there = (
            None if frequency is None else at_point(question.graph, question.value, Fraction(0), Fraction(frequency))
        )
        if frequency is None or there is None or not there.is_finite():
            return None
        bound = sharpest(self.proof) if self.proof else None
        return AxisValue(abs(there) if question.bounded else there.real, bound, frequency)

    @property
    def _question(self) -> Question:
        text, numbers, names = self.asked
        graph = Graph(dict(names))
        return Question(graph, read(graph, text, numbers), CLAIMS[self.kind], text, numbers)

    @cached_property
    def evidence(self) -> dict[str, Any] | None:
        """What a file can hold of a proof or a witness: for rational functions too."""
        if self.rational is None or not self.asked[0]:
            return self.proof or (self.witness and self.witness.file)
        question = self._question
        if point := self.rational.witness:
            found = question.witness(point.re, point.im, {})
            return found and found.file
        return prove(question, self.statement) if self.proved else None

    @property
    def certificate(self) -> Any:
        """What proves it, whatever it is: a proof by the rules, or that of the oracle."""
        return self.proof or getattr(self.oracle, "certificate", None)

    def text_lines(self) -> list[str]:
        """The answer, its reason, the witness, the margin, and the steps of the proof as far as a screen shows them."""
        if self.oracle is not None:
            return self.oracle.text_lines()
        told, letter = [f"{self.kind.value}: {self.status.value}", f"  because {self.why}"], self.kind.letter
        if found := self.witness:
            told += [f"  {name} = {written(x)}" for name, x in found.values.items()]
            told += [f"  witness s = {complex_text(found.re, found.im)}", f"    {letter}(s) = {found.value.str(12)}"]
        if margin := self.margin:
            name = "smallest Re Z(jω)" if letter == "Z" else "largest |H(jω)|"
            sign = "about" if margin.bound is None else "≈"
            bound = ", sampled" if margin.bound is None else f", proved not to pass {digits(margin.bound)}"
            value = f"{float(margin.attained):.6g}"
            told.append(f"  {name:<20} {sign} {value:<12} at ω = {margin.frequency:.6g} rad/s{bound}")
        return told + first_of(list(lines(self.proof)) if self.proof else [], SCREEN - len(told), "    ")

    def to_dict(self) -> dict[str, Any]:
        """All of it as JSON can hold it, with the proof, and whether it was verified."""
        if self.oracle is not None:
            return {"statement": self.statement, **self.oracle.to_dict()}
        told: dict[str, Any] = {"kind": self.kind.value, "statement": self.statement, "status": self.status.value}
        told |= {"why": self.why, "proof": self.proof, "witness": self.witness and self.witness.file}
        if self.pole:
            told[self.pole.word] = self.pole.place.str(20)
        if self.proof:
            told["verified"] = if_affordable(VERDICT, verify_proof, self.proof)
        if margin := self.margin:
            bound = None if margin.bound is None else written(margin.bound)
            told["margin"] = {"attained": margin.attained.str(20), "bound": bound, "frequency": margin.frequency}
        return told

    def plot(self, ax: Any = None) -> Any:
        """The picture of the verdict of a rational function, or of samples, on `ax` or in a new figure."""
        return super().plot(ax) if self.oracle is None else self.oracle.plot(ax)
