"""What a verdict says, and the exact facts it rests on."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from flint import arb, fmpz_poly

from passivity.budget import ASIDE, if_affordable
from passivity.one_port.polynomial_sign import SignProof
from passivity.rational.function import RationalFunction
from passivity.status import Decided, Kind, Status

if TYPE_CHECKING:
    from passivity.one_port.margin import Margins


@dataclass(frozen=True)
class Certificate:
    """All that `passivity.one_port.certificate.verify` needs to repeat the proof.

    Parameters
    ----------
    kind : Kind
    function : RationalFunction
        As given.
    common : fmpz_poly
        What p and q had in common and was cancelled; 1 if nothing had to be.
    sign : SignProof
        Why A(w^2) = Re p(jw) conj q(jw), or |q(jw)|^2 - |p(jw)|^2 for `Kind.BR`, is nonnegative.
    column : tuple of arb
        Routh's column of p + q, or of q for `Kind.BR`, after cancelling: all balls above zero.
    """

    kind: Kind
    function: RationalFunction
    common: fmpz_poly
    sign: SignProof
    column: tuple[arb, ...]


@dataclass(frozen=True)
class Witness:
    """A point of the right half plane where the property fails.

    Parameters
    ----------
    re, im : Fraction
        The point s = re + j im, re > 0.
    value_re, value_im : Fraction or None
        Z(s) or H(s), exactly; None for H = 1/0.
    """

    re: Fraction
    im: Fraction
    value_re: Fraction | None
    value_im: Fraction | None


@dataclass(frozen=True)
class Verdict(Decided):
    """Answer to whether a function is positive real or bounded real.

    Parameters
    ----------
    kind : Kind
        The property asked for.
    function : RationalFunction
        As given.
    status : Status
        `PROVED` comes with a certificate, `REFUTED` with a witness, `UNDECIDED` with the budget that ran out.
    certificate : Certificate or None
    witness : Witness or None
    lossless : bool
        Re Z = 0, or |H| = 1, on the whole imaginary axis.
    hidden : fmpz_poly or None
        A factor common to numerator and denominator with roots in Re s >= 0: a mode that does not die out and that the
        terminals do not show. The verdict is about the function after cancelling it.
    budget : str
        What ran out, if undecided.
    """

    kind: Kind
    function: RationalFunction
    status: Status
    certificate: Certificate | None = None
    witness: Witness | None = None
    lossless: bool = False
    hidden: fmpz_poly | None = None
    budget: str = ""

    @cached_property
    def why(self) -> str:
        """The reason in plain words: band, pole, residue, degree."""
        from passivity.one_port.reason import reason

        short = "it fails at the witness" if self.witness else "the exact test holds"
        return if_affordable(ASIDE, reason, self) or f"{short}; the frequencies take too long to find"

    @cached_property
    def margins(self) -> "Margins":
        """How much room there is to the border, and at which frequency, z0 = 1 (see `passivity.one_port.margin`)."""
        from passivity.one_port.margin import margins

        return margins(self)

    def text_lines(self) -> list[str]:
        """The verdict, its reason, the witness, and the margins where they are affordable."""
        from passivity.one_port.report import in_lines

        return in_lines(self, self._margins)

    def to_dict(self) -> dict[str, Any]:
        """All of it, with the certificate."""
        from passivity.one_port.report import as_dict

        return as_dict(self, self._margins)

    def _figure(self) -> Any:
        """Impedance plane, Smith chart and reflection, z0 = 1."""
        from passivity.one_port.picture import draw_verdict

        return draw_verdict(self, self._margins)

    @property
    def _margins(self) -> "Margins":
        from passivity.one_port.margin import Margins

        return if_affordable(ASIDE, lambda: self.margins) or Margins(None, None, None)
