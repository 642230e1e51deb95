"""Verdicts with their proofs and witnesses; one port is the 1 by 1 case."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from flint import acb, arb, fmpq_mat, fmpz_poly

from passivity.ball import of_point
from passivity.budget import ASIDE, VERDICT, if_affordable
from passivity.expression.number import digits, double, written
from passivity.polynomial.sign import SignProof
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import PolynomialMatrix
from passivity.rational.state_space import StateSpace
from passivity.status import Decided, Kind, Status

if TYPE_CHECKING:
    from passivity.calculus.question import Question
    from passivity.calculus.values import Spot
    from passivity.floats.axis import AxisAnalysis
    from passivity.floats.system import FloatSystem
    from passivity.symbolic.assumption import Range
    from passivity.symbolic.formula import Condition

Network: TypeAlias = RationalFunction | RationalMatrix | StateSpace
Parts: TypeAlias = tuple[Fraction, Fraction]  # real and imaginary part

_ONE = ((Fraction(1), Fraction(0)),)


class AxisSum(NamedTuple):
    """Sum of all principal minors of one order of the form that must not be negative on the axis, times |d|^2.

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
    """A point of the right half plane, and of several ports a direction, where the property fails.

    Parameters
    ----------
    kind : Kind
    re, im : Fraction
        The point s = re + j im, re > 0.
    found : tuple of (Fraction, Fraction), StateSpace, acb or None
        The image; the state space that has it, which takes longer; a ball around the value; None where it is infinite.
    vector : tuple of (Fraction, Fraction)
        v; 1 of one port.
    names : mapping of str to Fraction
        Values of names in the function.
    spot : Spot or None
        Of a point nearer to a zero of a part than digits tell: the disc around s that holds it, and that part's value.
    variable : str
        "s"; "z" of a function of discrete time, whose point re + j im then lies outside the unit disc.
    """

    kind: Kind
    re: Fraction
    im: Fraction
    found: Any
    vector: tuple[Parts, ...] = _ONE
    names: Mapping[str, Fraction] = field(default_factory=dict)
    spot: "Spot | None" = None
    variable: str = "s"

    @cached_property
    def image(self) -> tuple[Parts, ...] | None:
        """Z v or S v there, real and imaginary part of each component; None where it is infinite, or in a ball."""
        if isinstance(self.found, StateSpace):
            return self.found.image(self.re, self.im, self.vector)
        return None if isinstance(self.found, acb) else self.found

    @property
    def value(self) -> acb | None:
        """Z(s) or H(s) of one port, in a ball; None where it is infinite."""
        return of_point(*self.image[0]) if self.image else self.found

    @property
    def form(self) -> Any:
        """v^H (Z + Z^H) v, or |v|^2 - |S v|^2: negative; in a ball if the value is known so."""
        if isinstance(self.found, acb):
            return 2 * self.found.real if self.kind is Kind.PR else 1 - abs(self.found) ** 2
        if self.image is None:
            return None
        if self.kind is Kind.PR:
            return 2 * sum(a * c + b * d for (a, b), (c, d) in zip(self.vector, self.image, strict=True))
        return sum(a * a + b * b for a, b in self.vector) - sum(a * a + b * b for a, b in self.image)

    def in_texts(self) -> dict[str, Any]:
        """As texts: of one port with Z or H there, of several with v and the form that is negative."""
        told: dict[str, Any] = {"re": written(self.re), "im": written(self.im)}
        told |= {"variable": self.variable} if self.variable != "s" else {}
        told |= {"values": {name: written(x) for name, x in self.names.items()}} if self.names else {}
        if isinstance(self.found, acb):
            return told | {"value": self.found.str(20, radius=False)}
        if len(self.vector) == 1:
            parts = map(written, self.image[0]) if self.image else (None, None)
            return told | dict(zip(("value_re", "value_im"), parts, strict=True))
        form = self.form.str(20) if isinstance(self.form, arb) else written(self.form)
        return told | {"vector": [[written(Fraction(x)) for x in pair] for pair in self.vector], "value": form}

    @property
    def why(self) -> str:
        """Sentence on the value of the function there, known in a ball."""
        name, value = self.variable, self.found
        s = f"{name} = {digits(self.re)} + {digits(self.im)}j"
        s += "".join(f", {name} = {digits(x)}" for name, x in self.names.items())
        if not self.im and not self.spot and value.imag != 0:
            return f"the value at {s} is not real, as if a branch cut ran there"
        if self.spot:
            sort = f"|H({name})| > 1" if self.kind is Kind.BR else f"Re Z({name}) < 0"
            place = f"a point within {digits(self.spot.radius, 3)} of {s}"
            small = f"{('', 'j ', '-', '-j ')[self.spot.turn % 4]}2^-{digits(Fraction(self.spot.exponent))}"
            return f"{sort} at {place}, where a part of the function is {small}"
        if self.kind is Kind.BR:
            return f"|H({name})| = {abs(value).str(15, radius=False)} at {s}"
        return f"Re Z({name}) = {value.real.str(6, radius=False)} at {s}"


class Margin(NamedTuple):
    """An extreme value on the imaginary axis: Re Z or |H|, an eigenvalue of (Z + Z^H)/2 or a singular value of S.

    Parameters
    ----------
    low, high : Fraction, float or None
        The value lies between them; equal where it is known exactly, infinite where it is. Of several ports one end is
        proved, the other computed in floats; if it is not rational one is sampled, the other proved or None.
    frequency : float
        Angular frequency where it is attained, rad/s; ``math.inf`` for the limit.
    largest : bool
        A largest value; else a smallest.
    """

    low: Any
    high: Any
    frequency: float
    largest: bool = False

    @property
    def value(self) -> float:
        """Attained end of the enclosure: the number to print."""
        return double(self.low if self.largest else self.high)

    @property
    def bound(self) -> float:
        """Proved end of the enclosure, which is never passed."""
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
    """Answer to whether a function or a matrix is positive real or bounded real, with checkable evidence.

    Parameters
    ----------
    kind : Kind
        The property asked for.
    function : RationalFunction, RationalMatrix, StateSpace or None
        As given, where the exact test answers; None of an expression that is not rational, or has names.
    status : Status
        `PROVED` comes with a proof, `REFUTED` with a witness, `UNDECIDED` with the open question in `reason`.
    certificate : Certificate, StorageCertificate, dict, tuple of Derivation or None
        The proof: exact facts; steps that `passivity.verifier` checks; or the proofs of two halves of a line.
    witness : Witness or None
    lossless : bool
        Re Z = 0 or |H| = 1, Z + Z^H = 0 or S^H S = I, on the whole imaginary axis.
    hidden : fmpz_poly or None
        A factor with roots in Re s >= 0 that does not show at the ports: common to numerator and denominator, or modes
        of a state space. The verdict is about the function without it.
    negative : tuple of fmpz_poly
        Polynomials in x = w^2 that must not be negative on the axis, if one is somewhere (see `AxisSum`).
    reason : str
        Reason, where the function does not show it; the unresolved part, if undecided.
    floats : FloatSystem or None
        The state space in floating point, if it was looked at so; then hidden modes are not looked for.
    statement : str
        The claim, with the assumptions.
    asked : tuple of (str, dict, dict)
        The text, the numbers for names in it, and the assumptions on others, if the question was a text.
    ranges : tuple of Range
        Assumptions on parameters, where the answer is for all their values.
    condition : Condition or None
        For which of them the property holds, where that is known and not all.
    steps : tuple of str
        A proof by polynomials in them.
    note : str
        Where the function is infinite, if that can be.
    in_s : Verdict or None
        Of a function of discrete time, asked about for |z| > 1: the verdict on that of s, z = (1 + s)/(1 - s), to which
        the certificate belongs. Frequencies are angles θ of z = exp(jθ) then.
    """

    kind: Kind
    function: Any
    status: Status
    certificate: Any = None
    witness: Witness | None = None
    lossless: bool = False
    hidden: fmpz_poly | None = None
    negative: tuple[fmpz_poly, ...] = ()
    reason: str = ""
    floats: "FloatSystem | None" = None
    statement: str = ""
    asked: tuple[str, Mapping[str, Fraction], Mapping[str, Any]] = field(default=("", {}, {}), repr=False)
    ranges: "tuple[Range, ...]" = ()
    condition: "Condition | None" = None
    steps: tuple[str, ...] = ()
    note: str = ""
    in_s: "Verdict | None" = None

    @cached_property
    def analysis(self) -> "AxisAnalysis | None":
        """Analysis on the axis in floating point; None if the eigenvalues do not converge."""
        try:
            return self.floats and self.floats.analysis
        except ValueError:  # numpy's LinAlgError
            return None

    @property
    def is_discrete(self) -> bool:
        """Whether the function is one of z, asked about for |z| > 1."""
        return self.in_s is not None

    @property
    def region(self) -> str:
        """Words behind what was asked: where it has to hold, if that is not Re s > 0."""
        return " for |z| > 1" if self.is_discrete else ""

    @property
    def ports(self) -> int:
        """Number of ports."""
        if self.function is None:
            modes = self.certificate if isinstance(self.certificate, tuple) else self.witness and self.witness.vector
            return len(modes or _ONE)
        return 1 if isinstance(self.function, RationalFunction) else self.function.size

    @cached_property
    def why(self) -> str:
        """The reason in plain words: band, pole, residue, degree."""
        known = self.function is None or (self.reason and self.status is not Status.UNDECIDED)
        if known and self.in_s is None:
            return self.reason
        from passivity.report import reason

        short = "it fails at the witness" if self.witness else "the exact test holds"
        return if_affordable(ASIDE, reason, self) or f"{short}; the frequencies take too long to find"

    @cached_property
    def margins(self) -> Margins:
        """Margins to the boundary of the property, and their frequencies, z0 = 1 (see `passivity.exact.margin`)."""
        if self.function is None and self.in_s is None:
            from passivity.calculus.proof import margins_of

            return margins_of(self) if self.asked[0] else Margins()
        from passivity.exact.margin import margins

        return margins(self)

    @property
    def proof(self) -> dict[str, Any] | None:
        """The proof along the expression."""
        return self.certificate if isinstance(self.certificate, dict) else None

    @property
    def question(self) -> "Question":
        """The text that was asked about, as a graph."""
        from passivity.calculus.question import Question

        return Question.of(self.kind, *self.asked)

    @cached_property
    def evidence(self) -> dict[str, Any] | None:
        """Proof or witness as the content of a file, for rational functions too."""
        from passivity.calculus.proof import prove
        from passivity.calculus.prove import Prover

        if self.in_s is not None:
            return self.in_s.evidence
        open_circuit = isinstance(self.function, RationalFunction) and self.function.is_infinite  # 1/0 is no node
        if self.proof or open_circuit or not self.asked[0]:
            return self.proof
        if point := self.witness:
            return self.question.file(point)
        question = self.question
        prover = Prover(question.graph)
        if self.steps:
            if_affordable(VERDICT, prover.for_all, self.kind, question.value)
        return prove(question, self.statement, prover) if self.proved else None

    def text_lines(self) -> list[str]:
        """The verdict, its reason, the witness, the margins where they are affordable, and the steps of the proof."""
        from passivity.report import in_lines

        return in_lines(self, self._margins)

    def to_dict(self) -> dict[str, Any]:
        """Verdict as values for JSON, with the proof, and whether it was verified."""
        from passivity.report import as_dict

        return as_dict(self, self._margins)

    def plot(self, ax: Any = None) -> Any:
        """Impedance plane, Smith chart and reflection, z0 = 1, with the value at the witness; on `ax` the Smith chart.

        Of several ports, or a state space: all singular values of S, or eigenvalues of (Z + Z^H)/2, over frequency.
        """
        if self.function is not None and not isinstance(self.function, RationalFunction):
            from passivity.exact.picture import draw_worst

            return draw_worst(self, ax)
        if self.function is None and (not self.asked[0] or self.question.graph.names):
            return super().plot(ax)
        from passivity.exact.picture import draw_verdict

        return draw_verdict(self, self._margins, ax=ax)

    @property
    def _margins(self) -> Margins:
        return if_affordable(ASIDE, lambda: self.margins) or Margins()
