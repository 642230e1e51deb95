"""What a verdict on several ports says, and the exact facts it rests on."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

from flint import arb, fmpq_mat, fmpz_poly

from passivity.budget import ASIDE, if_affordable
from passivity.multiport.axis_analysis import AxisAnalysis
from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.polynomial_matrix import PolynomialMatrix
from passivity.multiport.state_space import StateSpace
from passivity.one_port.polynomial_sign import SignProof
from passivity.status import Decided, Kind, Status

Network: TypeAlias = RationalMatrix | StateSpace


class MinorSum(NamedTuple):
    """The sum of all principal minors of one order of |d|^2 (Z + Z^H), or of |d|^2 (I - S^H S), on the axis.

    Parameters
    ----------
    a : fmpz_poly
        The sum in x = w^2 is a g^power, where g is |d|^2 with coprime coefficients.
    power : int
    sign : SignProof
        Why a is nonnegative.
    """

    a: fmpz_poly
    power: int
    sign: SignProof


@dataclass(frozen=True)
class MinorCertificate:
    """Proof by the signs of the sums of principal minors.

    Parameters
    ----------
    kind : Kind
    network : RationalMatrix or StateSpace
        As given; its transfer matrix is N/d with d the common denominator.
    sums : tuple of MinorSum
        Of order 1, 2, ..., m.
    closing : fmpz_poly
        Denominator c of (Z + I)^-1, or of S.
    inverse : list of list of fmpz_poly or None
        X with (N + d I) X = c d I; None for `Kind.BR`.
    column : tuple of arb
        Routh's column of c: all balls above zero.
    """

    kind: Kind
    network: Network
    sums: tuple[MinorSum, ...]
    closing: fmpz_poly
    inverse: PolynomialMatrix | None
    column: tuple[arb, ...]


@dataclass(frozen=True)
class StorageCertificate:
    """Proof by a storage function x^T P x.

    Parameters
    ----------
    system : StateSpace
        As given; of impedances.
    basis : fmpq_mat
        Columns that span the states which the inputs reach: A V = V A1, B = V B1, C1 = C V.
    reached : StateSpace
        (A1, B1, C1, D).
    storage : fmpq_mat
        P >= 0 with [[A1^T P + P A1, P B1 - C1^T], [B1^T P - C1, -D - D^T]] <= 0.
    """

    system: StateSpace
    basis: fmpq_mat
    reached: StateSpace
    storage: fmpq_mat


@dataclass(frozen=True)
class StrictCertificate:
    """Proof by a storage function x^T P x that S is bounded real with something to spare.

    Parameters
    ----------
    system : StateSpace
        (A, B, C, D) of S.
    storage : fmpq_mat
        P > 0 with [[A^T P + P A + C^T C, P B + C^T D], [B^T P + D^T C, D^T D - I]] < 0.
    """

    system: StateSpace
    storage: fmpq_mat


Certificate: TypeAlias = MinorCertificate | StorageCertificate | StrictCertificate


@dataclass(frozen=True)
class MatrixWitness:
    """A point of the right half plane and a vector for which the property fails.

    Parameters
    ----------
    re, im : Fraction
        The point s = re + j im, re > 0.
    vector : tuple of (Fraction, Fraction)
        Real and imaginary part of each component of v.
    value : Fraction
        v^H (Z + Z^H) v, or |v|^2 - |S v|^2, at s: negative.
    """

    re: Fraction
    im: Fraction
    vector: tuple[tuple[Fraction, Fraction], ...]
    value: Fraction


@dataclass(frozen=True)
class MatrixVerdict(Decided):
    """Answer to whether a matrix is positive real or bounded real.

    Parameters
    ----------
    kind : Kind
        The property asked for.
    network : RationalMatrix or StateSpace
        As given.
    status : Status
        `PROVED` comes with a certificate, `REFUTED` with a witness, `UNDECIDED` with the budget that ran out.
    lossless : bool
        Z + Z^H = 0, or S^H S = I, on the whole imaginary axis.
    hidden : fmpz_poly or None
        A factor with roots in Re s >= 0 that does not show at the ports: common to numerator and denominator of an
        entry, or modes of a state space. The verdict is about the functions without it.
    negative : tuple of fmpz_poly
        The sums of principal minors in x = w^2, if one of them is negative somewhere.
    budget : str
        What ran out, if undecided.
    analysis : AxisAnalysis or None
        What floating point sees of a state space too large for the exact test, whose hidden modes are not looked for.
    """

    kind: Kind
    network: Network
    status: Status
    certificate: Certificate | None = None
    witness: MatrixWitness | None = None
    lossless: bool = False
    hidden: fmpz_poly | None = None
    negative: tuple[fmpz_poly, ...] = ()
    budget: str = ""
    analysis: AxisAnalysis | None = None

    @cached_property
    def why(self) -> str:
        """The reason in plain words: band, pole, residue."""
        from passivity.multiport.reason import reason

        return reason(self)

    def text_lines(self) -> list[str]:
        """The verdict, its reason, the witness, and the margin where it is affordable."""
        from passivity.multiport.report import in_lines

        return in_lines(self, self._margin)

    def to_dict(self) -> dict[str, Any]:
        """All of it, with the certificate."""
        from passivity.multiport.report import as_dict

        return as_dict(self, self._margin)

    @property
    def _margin(self) -> Any:
        from passivity.multiport.margin import margin

        return if_affordable(ASIDE, margin, self.network, self.kind)
