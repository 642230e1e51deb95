"""Proofs as trees of steps, each a rule and what it was applied to."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from passivity.delayed.disc import Disc
from passivity.delayed.form import Form
from passivity.one_port.verdict import Certificate

# For Re s > 0: the values lie in a disc; or there is no zero or pole, the function is positive on the real axis, and
# |arg|, from there on, is at most so many quarter turns
Claim: TypeAlias = Disc | Fraction


@dataclass(frozen=True)
class ProofStep:
    """One conclusion about a function in Re s > 0.

    Parameters
    ----------
    rule : str
        A name in `passivity.delayed.verify.RULES`.
    form : Form
        The function.
    claim : Disc or Fraction
        The disc that holds its values; or a bound of |arg|, in quarter turns, of a function without zeros and poles.
    premises : tuple of ProofStep
    certificate : Certificate or None
        Of the rational leaves.
    line : tuple of two Form or None
        Characteristic impedance A and propagation B, for the rule of lines.
    """

    rule: str
    form: Form
    claim: Claim
    premises: "tuple[ProofStep, ...]" = ()
    certificate: Certificate | None = None
    line: tuple[Form, Form] | None = None

    @property
    def disc(self) -> Disc:
        """The claim, where it is a disc."""
        assert isinstance(self.claim, Disc)
        return self.claim

    @property
    def turn(self) -> Fraction:
        """The claim, where it is a bound of |arg|."""
        assert isinstance(self.claim, Fraction)
        return self.claim

    def within(self, goal: Disc) -> bool:
        """Whether the claim says that the values lie in a disc."""
        return isinstance(self.claim, Disc) and self.claim <= goal

    def lines(self, depth: int = 0) -> Iterator[str]:
        """The tree of the proof, line by line, premises indented."""
        yield f"{'  ' * depth}{self}   [{self.rule}]"
        for premise in self.premises:
            yield from premise.lines(depth + 1)

    def __str__(self) -> str:
        claim = f"|arg| <= {90 * self.claim}°" if isinstance(self.claim, Fraction) else str(self.claim)
        return f"{self.form}: {claim}"
