"""What a verdict on a one-port or a multiport says, and the exact facts it rests on; one port is the 1 by 1 case."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from flint import arb, fmpq_mat, fmpz_poly

from passivity.budget import ASIDE, if_affordable
from passivity.expression.number import double
from passivity.polynomial.sign import SignProof
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import PolynomialMatrix
from passivity.rational.state_space import StateSpace
from passivity.status import Decided, Kind, Status

if TYPE_CHECKING:
    from passivity.floats.axis import AxisAnalysis
    from passivity.floats.system import FloatSystem

Network: TypeAlias = RationalFunction | RationalMatrix | StateSpace
Parts: TypeAlias = tuple[Fraction, Fraction]  # real and imaginary part

_ONE = ((Fraction(1), Fraction(0)),)


class AxisSum(NamedTuple):
    """The sum of all principal minors of one order of what must not be negative on the axis, |d|^2 times.

    In x = w^2 it is a g^power, where g is |d|^2 with coprime coefficients. Of one port it is Re p(jw) conj q(jw), or
    |q(jw)|^2 - |p(jw)|^2, after cancelling.
    """

    a: fmpz_poly
    power: int
    sign: SignProof  # why a is nonnegative


@dataclass(frozen=True)
class Certificate:
    """Proof by signs on the axis and the place of poles: all that `passivity.verify` needs to repeat it.

    Parameters
    ----------
    kind : Kind
    function : RationalFunction, RationalMatrix or StateSpace
        As given; a matrix is N/d with d the common denominator.
    sums : tuple of AxisSum
        Of principal minors of order 1, 2, ..., m.
    closing : fmpz_poly
        Denominator c of 1/(Z + 1), (Z + I)^-1 or of S.
    column : tuple of arb
        Routh's column of c: all balls above zero.
    inverse : list of list of fmpz_poly or None
        X with (N + d I) X = c d I, for impedances of several ports.
    """

    kind: Kind
    function: Network
    sums: tuple[AxisSum, ...]
    closing: fmpz_poly
    column: tuple[arb, ...]
    inverse: PolynomialMatrix | None = None


@dataclass(frozen=True)
class StorageCertificate:
    """Proof by a storage function x^T P x.

    With a basis V of a lossless system: L(P) <= 0 of the reached part, P >= 0 (`passivity.exact.storage`). Else
    M(P) < 0, P > 0 (`passivity.floats.storage`) of S, or of the scattering matrix that impedances have.
    """

    kind: Kind
    function: StateSpace  # as given
    storage: fmpq_mat  # P
    basis: fmpq_mat | None = None  # V, of the states that the inputs reach: A V = V A1, B = V B1, C1 = C V
    reached: StateSpace | None = None  # (A1, B1, C1, D)


@dataclass(frozen=True)
class Witness:
    """A point of the right half plane and a direction in which the property fails, in exact numbers.

    Parameters
    ----------
    kind : Kind
    re, im : Fraction
        The point s = re + j im, re > 0.
    found : tuple of (Fraction, Fraction), StateSpace or None
        The image; or the state space that has it, which may take seconds to be found.
    vector : tuple of (Fraction, Fraction)
        v; 1 of one port.
    """

    kind: Kind
    re: Fraction
    im: Fraction
    found: tuple[Parts, ...] | StateSpace | None
    vector: tuple[Parts, ...] = _ONE

    @cached_property
    def image(self) -> tuple[Parts, ...] | None:
        """Z v or S v there, real and imaginary part of each component; None where it is infinite."""
        return self.found.image(self.re, self.im, self.vector) if isinstance(self.found, StateSpace) else self.found

    @property
    def value(self) -> Fraction | None:
        """v^H (Z + Z^H) v, or |v|^2 - |S v|^2: negative."""
        if self.image is None:
            return None
        if self.kind is Kind.PR:
            return 2 * sum((a * c + b * d for (a, b), (c, d) in zip(self.vector, self.image, strict=True)), Fraction(0))
        return sum((a * a + b * b for a, b in self.vector), Fraction(0)) - sum(a * a + b * b for a, b in self.image)

    @property
    def value_re(self) -> Fraction | None:
        """Real part of Z(s) or H(s) of one port; of several, of the first component of the image."""
        return self.image[0][0] if self.image else None

    @property
    def value_im(self) -> Fraction | None:
        """The same for the imaginary part."""
        return self.image[0][1] if self.image else None


class Margin(NamedTuple):
    """An extreme value on the imaginary axis: Re Z or |H|, an eigenvalue of (Z + Z^H)/2 or a singular value of S.

    Parameters
    ----------
    low, high : Fraction or float
        The value lies between them; equal where it is known exactly, infinite where it is. Of several ports one end is
        proved, the other computed in floats.
    frequency : float
        Angular frequency where it is attained, rad/s; ``math.inf`` for the limit.
    largest : bool
        A largest value; else a smallest.
    """

    low: Fraction | float
    high: Fraction | float
    frequency: float
    largest: bool = False

    @property
    def value(self) -> float:
        """The end that is attained: the number to print."""
        return double(self.low if self.largest else self.high)

    @property
    def bound(self) -> float:
        """The end that is proved not to be passed."""
        return double(self.high if self.largest else self.low)


class Margins(NamedTuple):
    """The margins of a function; None where the question makes no sense, or there is no bound for several ports.

    Parameters
    ----------
    input : Margin or None
        Smallest Re Z(jw), or eigenvalue: a resistance that may be taken away in series; negative: that must be added.
    output : Margin or None
        Smallest Re 1/Z(jw): the same for a conductance in parallel.
    reflection : Margin or None
        Largest |H(jw)|, where H = (Z - z0)/(Z + z0), or the given reflection itself; or largest singular value of S.
    """

    input: Margin | None = None
    output: Margin | None = None
    reflection: Margin | None = None


@dataclass(frozen=True)
class Verdict(Decided):
    """Answer to whether a function or a matrix is positive real or bounded real.

    Parameters
    ----------
    kind : Kind
        The property asked for.
    function : RationalFunction, RationalMatrix or StateSpace
        As given.
    status : Status
        `PROVED` comes with a certificate, `REFUTED` with a witness, `UNDECIDED` with the budget that ran out.
    certificate : Certificate, StorageCertificate or None
    witness : Witness or None
    lossless : bool
        Re Z = 0 or |H| = 1, Z + Z^H = 0 or S^H S = I, on the whole imaginary axis.
    hidden : fmpz_poly or None
        A factor with roots in Re s >= 0 that does not show at the ports: common to numerator and denominator, or modes
        of a state space. The verdict is about the function without it.
    negative : tuple of fmpz_poly
        What must not be negative on the axis, in x = w^2, if it is somewhere (see `AxisSum`).
    budget : str
        What ran out, if undecided.
    floats : FloatSystem or None
        The state space in floating point, if it was looked at so; then hidden modes are not looked for.
    place : str
        Where floating point sees a violation that was then proved.
    """

    kind: Kind
    function: Any
    status: Status
    certificate: Certificate | StorageCertificate | None = None
    witness: Witness | None = None
    lossless: bool = False
    hidden: fmpz_poly | None = None
    negative: tuple[fmpz_poly, ...] = ()
    budget: str = ""
    floats: "FloatSystem | None" = None
    place: str = ""

    @cached_property
    def analysis(self) -> "AxisAnalysis | None":
        """What floating point sees on the axis; None if the eigenvalues do not converge."""
        try:
            return self.floats and self.floats.analysis
        except ValueError:  # numpy's LinAlgError
            return None

    @property
    def ports(self) -> int:
        """Number of ports."""
        return 1 if isinstance(self.function, RationalFunction) else self.function.size

    @cached_property
    def why(self) -> str:
        """The reason in plain words: band, pole, residue, degree."""
        from passivity.exact.report import reason

        short = "it fails at the witness" if self.witness else "the exact test holds"
        return if_affordable(ASIDE, reason, self) or f"{short}; the frequencies take too long to find"

    @cached_property
    def margins(self) -> Margins:
        """How much room there is to the border, and at which frequency, z0 = 1 (see `passivity.exact.margin`)."""
        from passivity.exact.margin import margins

        return margins(self)

    def text_lines(self) -> list[str]:
        """The verdict, its reason, the witness, and the margins where they are affordable."""
        from passivity.exact.report import in_lines

        return in_lines(self, self._margins)

    def to_dict(self) -> dict[str, Any]:
        """All of it, with the certificate."""
        from passivity.exact.report import as_dict

        return as_dict(self, self._margins)

    def plot(self, ax: Any = None) -> Any:
        """Impedance plane, Smith chart and reflection, z0 = 1; of one port. On `ax` the Smith chart alone."""
        if not isinstance(self.function, RationalFunction):
            return super().plot(ax)
        from passivity.exact.picture import draw_verdict

        return draw_verdict(self, self._margins, ax=ax)

    @property
    def _margins(self) -> Margins:
        return if_affordable(ASIDE, lambda: self.margins) or Margins()
