"""What a verdict on all values of the parameters says."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import fmpz_mpoly

from passivity.calculus.expand import Pair
from passivity.calculus.proof import Proof
from passivity.errors import ExpressionError, shorten, shown
from passivity.exact.report import point
from passivity.exact.verdict import Verdict, Witness
from passivity.expression.number import complex_text, written
from passivity.rational.evaluate import Exact, exact
from passivity.status import Decided, Kind, Status, first_of
from passivity.symbolic.assumption import Range
from passivity.symbolic.domain import coefficients
from passivity.symbolic.formula import Formula, value
from tline.presentation import SCREEN


@dataclass(frozen=True)
class Counterexample:
    """Values of the parameters, and the refutation there.

    Parameters
    ----------
    values : dict of str to Fraction
        For all names in the expression.
    verdict : Verdict
        Of the function with these values; for Z or H with a delay, of the rational reflection H2 in
        H = exp(-delay s) H2, Z = (1 + H)/(1 - H).
    witness : Witness
        The point s and the value there of the function in `verdict`. With a delay |exp(-delay s) H2(s)| > 1, shown
        in ball arithmetic, and so Re Z(s) < 0.
    delay : Fraction
        0 without one.
    """

    values: dict[str, Fraction]
    verdict: Verdict
    witness: Witness
    delay: Fraction

    @property
    def why(self) -> str:
        """The reason in words."""
        if self.delay < 0:
            return "exp(-delay*s) with a negative delay grows without bound"
        return f"of the reflection H behind the delay, {self.verdict.why}" if self.delay else self.verdict.why


@dataclass(frozen=True)
class Condition:
    """What the parameters must satisfy, besides the assumptions: exactly then the property holds.

    Parameters
    ----------
    formula : Claim or Joined
        In the parameters, by their names.
    ranges : tuple of Range
        What is assumed.
    function : Pair
        Numerator and denominator as the expression gives them when multiplied out.
    """

    formula: Formula
    ranges: tuple[Range, ...]
    function: Pair

    def holds(self, values: Mapping[str, Exact]) -> bool:
        """Whether it is true of a value for each parameter, decided exactly.

        Raises
        ------
        ExpressionError
            If a parameter has no value, none that is a number, or one against the assumptions; and for 0/0.
        """
        numbers = {}
        for r in self.ranges:
            if r.name not in values:
                raise ExpressionError(f"parameter {r.name}", "no value", f"a number with {r}")
            numbers[r.name] = exact(values[r.name], f"parameter {r.name}")
            if numbers[r.name] not in r:
                raise ExpressionError(
                    f"parameter {r.name}", "against the assumption", str(r), shorten(shown(values[r.name]))
                )
        if all(_vanishes(f, numbers) for f in self.function):
            raise ExpressionError("parameters", "0/0 has no value", "a numerator or a denominator that is not zero")
        return self.formula.holds(numbers)

    def __str__(self) -> str:
        return str(self.formula)


@dataclass(frozen=True)
class SymbolicVerdict(Decided):
    """The answer for all values of the parameters.

    Parameters
    ----------
    kind : Kind
    ranges : tuple of Range
        What is assumed of each parameter.
    status : Status
        PROVED: the property holds for all values. REFUTED: for some it does not; see `counterexample`.
    why : str
        The reason, or what would settle it.
    proof : tuple of str
        The steps, if proved.
    condition : Condition or None
        For which values the property holds, where that is known and not all.
    counterexample : Counterexample or None
        If refuted.
    note : str
        Where the function is infinite, if that can be.
    certificate : dict or None
        What `passivity.verifier` checks, if the rules prove it.
    """

    kind: Kind
    ranges: tuple[Range, ...]
    status: Status
    why: str
    proof: tuple[str, ...] = ()
    condition: Condition | None = None
    counterexample: Counterexample | None = None
    note: str = ""
    certificate: Proof | None = None

    def text_lines(self) -> list[str]:
        """The answer, its reason, the condition, the counterexample, and the first steps of the proof."""
        told = [f"{self.kind.value}: {self.status.value}", f"  because {self.why}"]
        told += [f"  exactly if {self.condition}"] if self.condition else []
        if found := self.counterexample:
            told += [f"  {name} = {written(value)}" for name, value in found.values.items()]
            told.append(f"  witness s = {complex_text(found.witness.re, found.witness.im)}")
        note = [f"  note: {self.note}"] if self.note else []
        return told + first_of(self.proof, SCREEN - len(told) - len(note), "  ") + note

    def to_dict(self) -> dict[str, Any]:
        """All of it as JSON can hold it."""
        told: dict[str, Any] = {"kind": self.kind.value, "status": self.status.value, "why": self.why}
        told |= {"assumed": [str(r) for r in self.ranges], "proof": list(self.proof), "note": self.note}
        told |= {"condition": str(self.condition) if self.condition else None, "counterexample": None}
        if found := self.counterexample:
            at = {name: written(value) for name, value in found.values.items()}
            told["counterexample"] = {"values": at, "witness": point(found.witness), "delay": written(found.delay)}
        return told


def _vanishes(f: fmpz_mpoly, values: Mapping[str, Fraction]) -> bool:
    """Whether a polynomial is 0 for all s and delays."""
    return all(value(c, values) == 0 for part in coefficients(f) for c in coefficients(part, 1))
