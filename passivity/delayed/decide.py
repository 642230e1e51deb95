"""Is an expression in s, with delays and roots of s, positive or bounded real? Proved, refuted or undecided."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from flint import acb

from passivity.ball import near
from passivity.budget import ASIDE, VERDICT, UndecidedError, budget, if_affordable
from passivity.delayed.boxes import BallProof, UnresolvedError, prove_in_balls
from passivity.delayed.disc import RIGHT, UNIT
from passivity.delayed.field import TooLargeError
from passivity.delayed.form import Form, of_rational
from passivity.delayed.margin import AxisValue, axis_value
from passivity.delayed.poles import Pole, find_pole
from passivity.delayed.proof import ProofStep
from passivity.delayed.prove import DEPTHS, prove
from passivity.delayed.search import Point, beside, find_witness
from passivity.delayed.translate import Translation
from passivity.delayed.value import value
from passivity.delayed.verify import verify_proof
from passivity.errors import ExpressionError
from passivity.expression.number import digits
from passivity.one_port import positive_real
from passivity.one_port.verdict import Verdict
from passivity.rational.evaluate import Exact, is_rational, of_tree, with_values
from passivity.rational.function import RationalFunction
from passivity.status import Decided, Kind, Status

_EACH = VERDICT // 2
_PLACES = (acb(37, 29), acb(5, 3) / 7, acb(1, 70) / 13)


@dataclass(frozen=True)
class ExpressionVerdict(Decided):
    """Answer to whether an expression is positive real or bounded real.

    Parameters
    ----------
    kind : Kind
        The property asked for.
    form : Form
        The expression, its rational parts brought together.
    status : Status
        `PROVED` comes with one of `rational`, `proof` and `balls`; `REFUTED` with `rational`, `witness` or `pole`;
        `UNDECIDED` with `unresolved`.
    rational : Verdict or None
        Of the exact test, if the expression is rational.
    proof : ProofStep or None
        A proof by composition; its `lines()` are to be printed, `passivity.delayed.verify.verify_proof` repeats it.
    balls : BallProof or None
        A proof in ball arithmetic, which `passivity.delayed.boxes.holds` repeats.
    witness : Point or None
        s with rational parts, Re s > 0, and the ball that holds the value there.
    pole : Pole or None
        Where the function is unbounded or, an impedance, zero in Re s > 0; then there may be no other witness.
    unresolved : str
        What was not resolved, if undecided.
    """

    kind: Kind
    form: Form
    status: Status
    rational: Verdict | None = None
    proof: ProofStep | None = None
    balls: BallProof | None = None
    witness: Point | None = None
    pole: Pole | None = None
    unresolved: str = ""

    @property
    def why(self) -> str:
        """The reason in one sentence."""
        if self.rational is not None:
            return self.rational.why
        if self.proof:
            return f"composed of parts that are proved: {self.proof}"
        if self.balls:
            return f"strictly so in {len(self.balls.cuts) - 1} balls on the axis up to ω = {digits(self.balls.radius)}"
        if self.pole:
            letter = "Z" if self.kind is Kind.PR else "H"
            return f"{letter} has a {self.pole.word} at s = {_place(self.pole.place)}"
        if self.witness is None:
            return self.unresolved
        s = f"s = {digits(self.witness.re)} + {digits(self.witness.im)}j"
        if not self.witness.im and self.witness.value.imag != 0:
            return f"the value at {s} is not real, as if a branch cut ran there"
        if self.kind is Kind.PR:
            return f"Re Z(s) = {self.witness.value.real.str(6, radius=False)} at {s}"
        return f"|H(s)| = {abs(self.witness.value).str(15, radius=False)} at {s}"

    @cached_property
    def margin(self) -> AxisValue | None:
        """Smallest Re Z(jω), or largest |H(jω)|; None where the axis has no values, or where `rational` has them."""
        return None if self.rational is not None else if_affordable(ASIDE, axis_value, self.kind, self.form, self.proof)


def check_expression(text: str, kind: Kind, parameters: Mapping[str, Exact] | None = None) -> ExpressionVerdict:
    """Is an expression analytic in Re s > 0 with Re Z >= 0 there, or |H| <= 1?

    First rules on the expression itself, which turn facts about the parts into facts about the whole; then a search for
    a point where the property fails, shown in balls; then balls on the axis, if all is rational in s and delays.
    Functions are principal branches. A function that is not real for real s > 0 has neither property.

    Parameters
    ----------
    text : str
        What `passivity.expression.parse.parse` reads.
    kind : Kind
        The property.
    parameters : mapping of str to number or text, optional
        A value for every name in the expression but ``s``, and for no other.

    Raises
    ------
    ExpressionError
        What `parse` refuses; a missing or unused parameter; a division by zero; what is too large.

    References
    ----------
    O. Brune, "Synthesis of a finite two-terminal network whose driving-point impedance is a prescribed function of
    frequency", J. Math. Phys. 10 (1931), 191-236: sums, inverses and compositions of positive real functions.

    Examples
    --------
    >>> verdict = check_expression("sqrt((R + s*L)/(s*C))*tanh(sqrt((R + s*L)*s*C))", Kind.PR, {"R": 1, "L": 2, "C": 3})
    >>> verdict.status, verdict.proof.rule
    (<Status.PROVED: 'proved'>, 'line')
    >>> verdict = check_expression("exp(2*s)/2", Kind.BR)
    >>> verdict.status, abs(verdict.witness.value) > 1
    (<Status.REFUTED: 'refuted'>, True)
    """
    tree, values = with_values(text, parameters or {})
    if is_rational(tree):
        pair = of_tree(tree, values)
        return _exact(kind, RationalFunction(pair.p, pair.q))
    form = Translation(values).whole(tree)
    if (r := form.rational) is not None:
        return _exact(kind, r)
    if not any(value(form, s).is_finite() for s in _PLACES):
        raise ExpressionError(
            "", "no value in reach", "an expression that is neither 1/0 nor beyond all numbers everywhere"
        )
    return _decided(kind, form)


def _place(s: acb) -> str:
    return f"{digits(near(s.real))} + {digits(near(s.imag))}j"


def _exact(kind: Kind, r: RationalFunction) -> ExpressionVerdict:
    verdict = positive_real.check(r, kind)
    return ExpressionVerdict(kind, of_rational(r), verdict.status, rational=verdict, unresolved=verdict.budget)


def _decided(kind: Kind, form: Form) -> ExpressionVerdict:
    """The first of the ways that leads to an answer; each has its own budget."""
    missing = []
    for way in (_composed, _by_a_pole, _searched, _in_balls, _composed_deeply):
        try:
            with budget(_EACH):
                found = way(kind, form)
        except UndecidedError as error:
            found, _ = None, missing.append(str(error))
        if found is not None:
            return found
    unresolved = f"no rule applies, no counterexample was found, and balls do not settle it: {'; '.join(missing)}"
    return ExpressionVerdict(kind, form, Status.UNDECIDED, unresolved=unresolved)


def _composed(kind: Kind, form: Form, depths: tuple[int, ...] = DEPTHS[:2]) -> ExpressionVerdict | None:
    proof = prove(form, RIGHT if kind is Kind.PR else UNIT, depths)
    return ExpressionVerdict(kind, form, Status.PROVED, proof=proof) if proof and verify_proof(proof) else None


def _composed_deeply(kind: Kind, form: Form) -> ExpressionVerdict | None:
    return _composed(kind, form, DEPTHS[2:])


def _by_a_pole(kind: Kind, form: Form) -> ExpressionVerdict | None:
    try:
        pole = find_pole(kind, form)
    except TooLargeError:
        return None
    return ExpressionVerdict(kind, form, Status.REFUTED, witness=pole.witness, pole=pole) if pole else None


def _searched(kind: Kind, form: Form) -> ExpressionVerdict | None:
    witness = find_witness(kind, form)
    return ExpressionVerdict(kind, form, Status.REFUTED, witness=witness) if witness else None


def _in_balls(kind: Kind, form: Form) -> ExpressionVerdict | None:
    try:
        return ExpressionVerdict(kind, form, Status.PROVED, balls=prove_in_balls(kind, form))
    except UnresolvedError as error:
        if error.frequency is not None and (witness := beside(kind, form, error.frequency)):
            return ExpressionVerdict(kind, form, Status.REFUTED, witness=witness)
        raise
