"""What is said of a function, and what anyone can check of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

from passivity.budget import ASIDE, if_affordable
from passivity.calculus.axis_value import AxisValue, axis_value
from passivity.calculus.graph import BOUNDED_REAL, POSITIVE_REAL, Graph
from passivity.calculus.proof import Proof, lines, prove
from passivity.calculus.read import read
from passivity.calculus.witness import Question, Witness
from passivity.delayed.boxes import BallProof
from passivity.delayed.poles import Pole
from passivity.one_port.verdict import Verdict
from passivity.status import Decided, Kind, Status

CLAIMS = {Kind.PR: POSITIVE_REAL, Kind.BR: BOUNDED_REAL}
_SHOWN = 40  # lines of a proof that are printed


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
    oracle : Verdict, MatrixVerdict, SymbolicVerdict, BallProof or None
        Of the exact test, of polynomials or of balls, where one of these decided.
    asked : tuple of (str, dict)
        The text, and the numbers for names in it, if the question was one.
    """

    kind: Kind
    statement: str
    status: Status
    why: str
    proof: Proof | None = None
    witness: Witness | None = None
    pole: Pole | None = None
    oracle: Any = None
    asked: tuple[str, Mapping[str, Fraction]] = field(default=("", {}), repr=False)

    @property
    def rational(self) -> Verdict | None:
        """The verdict of the exact test, if the function is rational with numbers alone."""
        return self.oracle if isinstance(self.oracle, Verdict) else None

    @property
    def balls(self) -> BallProof | None:
        """The proof in ball arithmetic, if it is one."""
        return self.oracle if isinstance(self.oracle, BallProof) else None

    @cached_property
    def margin(self) -> AxisValue | None:
        """Smallest Re Z(jω), or largest |H(jω)|; None where the axis has no values, or where `rational` has them."""
        text, numbers = self.asked
        graph = Graph()
        if self.rational is not None or not text:
            return None
        question = Question(graph, read(graph, text, numbers), CLAIMS[self.kind], text, numbers)
        return if_affordable(ASIDE, axis_value, question, self.proof)

    @cached_property
    def evidence(self) -> dict[str, Any] | None:
        """What a file can hold of a proof or a witness: for rational functions too, and for balls."""
        text, numbers = self.asked
        if self.balls:
            return self.balls.file
        graph = Graph()
        if self.rational is None or not text:
            return self.proof or (self.witness and self.witness.file)
        question = Question(graph, read(graph, text, numbers), CLAIMS[self.kind], text, numbers)
        if point := self.rational.witness:
            found = question.witness(point.re, point.im, {})
            return found and found.file
        return prove(question, self.statement) if self.proved else None

    def __str__(self) -> str:
        told = [f"{self.kind.value}: {self.status.value}", f"  because {self.why}"]
        if self.proof:
            steps = list(lines(self.proof))
            told += [f"    {line}" for line in steps[:_SHOWN]]
            told += [f"    … and {len(steps) - _SHOWN} more steps"] if len(steps) > _SHOWN else []
        return "\n".join(told)
