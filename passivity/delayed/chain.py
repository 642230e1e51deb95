"""From the load of a lossless line to its input port, step by step: Z2, G2, H2, H1, G1.

u is the effort, y the flow, both counted from the input (end 1) to the load (end 2); Z2 = u2/y2, z0 > 0, T >= 0.

    G2 = Z2/z0,   H2 = (G2 - 1)/(G2 + 1),   H1 = exp(-2Ts) H2,   G1 = (1 - H1)/(1 + H1) = z0 y1/u1.

Because |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 and Re G1 = (1 - |H1|^2)/|1 + H1|^2, each is positive or bounded real if the one
before is. For a rational load the converse holds too: an active load makes an active port, whatever the delay.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, ctx

from passivity.ball import of_point
from passivity.budget import ASIDE, UndecidedError, budget, spend
from passivity.errors import ExpressionError, shown
from passivity.expression.number import digits, written
from passivity.one_port.positive_real import check_bounded_real, check_positive_real
from passivity.one_port.report import point
from passivity.one_port.verdict import Verdict, Witness
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction
from passivity.status import Decided, Status
from passivity.symbolic.delay import delayed_witness


@dataclass(frozen=True)
class Step(Decided):
    """One link of the chain: what is claimed, how that ended, and why.

    Attributes
    ----------
    claim : str
        What is claimed.
    status : Status
        How that ended.
    reason : str
        Why.
    """

    claim: str
    status: Status
    reason: str


@dataclass(frozen=True)
class Chain(Decided):
    """Whether the input port of a line with a load is passive.

    Parameters
    ----------
    load, reflection : Verdict
        Of Z2 as an impedance and of H2 as a reflection, each by its own exact test.
    z0, delay : Fraction
        Of the line.
    steps : tuple of Step
        The derivation.
    witness : Witness or None
        For an active port: s with Re s > 0, H2(s) exactly, and |exp(-2Ts) H2(s)| > 1 shown in ball arithmetic; None
        where a long delay leaves no such point in reach of reasonable numbers.
    input : acb or None
        G1 at the witness, a ball with negative real part.
    """

    load: Verdict
    reflection: Verdict
    z0: Fraction
    delay: Fraction
    steps: tuple[Step, ...]
    witness: Witness | None = None
    input: acb | None = None

    @property
    def status(self) -> Status:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How the last step ended."""
        return self.steps[-1].status

    def text_lines(self) -> list[str]:
        """The derivation in words."""
        lines = [f"through a line of z0 = {digits(self.z0)} and delay T = {digits(self.delay)}:"]
        for step in self.steps:
            lines += [f"  {step.claim}: {step.status.value}", f"    because {step.reason}"]
        return lines

    def to_dict(self) -> dict[str, Any]:
        """The derivation as JSON can hold it."""
        told: dict[str, Any] = {"z0": written(self.z0), "delay": written(self.delay), "status": self.status.value}
        told["steps"] = [{"claim": x.claim, "status": x.status.value, "reason": x.reason} for x in self.steps]
        return told | ({"witness": point(self.witness)} if self.witness else {})  # the value is that of H2


def check_line(load: RationalFunction, z0: Exact, delay: Exact) -> Chain:
    """Is the input port of a lossless line passive, with this load at its other end?

    Parameters
    ----------
    load : RationalFunction
        Z2, the impedance of the load; open and short circuit included.
    z0 : int, float, Fraction, Decimal or str
        Characteristic impedance of the line, above zero.
    delay : int, float, Fraction, Decimal or str
        Time T from end to end, at least zero.

    Raises
    ------
    ExpressionError
        For another z0 or delay.

    Examples
    --------
    >>> load = RationalFunction.from_expression("25 + s/1000000000")
    >>> chain = check_line(load, "50 ohm", "3 ns")
    >>> [step.status.value for step in chain.steps]
    ['proved', 'proved', 'proved', 'proved']
    """
    reference, travel = exact(z0, "z0"), exact(delay, "delay")
    if reference <= 0:
        raise ExpressionError("z0", "not positive", "more than 0", shown(z0))
    if travel < 0:
        raise ExpressionError("delay", "negative", "at least 0", shown(delay))
    one, unit = load.p * reference.denominator, load.q * reference.numerator
    h2 = RationalFunction(one - unit, one + unit)
    verdict, reflection = check_positive_real(load), check_bounded_real(h2)
    steps = (
        Step("G2 = Z2/z0 is positive real", verdict.status, verdict.why),
        Step("H2 = (G2 - 1)/(G2 + 1) is bounded real", reflection.status, reflection.why),
    )
    if reflection.status is not Status.REFUTED:
        steps += tuple(_onwards(h2, reflection, travel))
        return Chain(verdict, reflection, reference, travel, steps)
    try:
        with budget(ASIDE):
            witness = delayed_witness(reflection, 2 * travel)
            there = witness and _input(witness, travel)
        assert witness is not None
        assert there is not None
        reason = f"|H1(s)| > 1 at s = {digits(witness.re)} + {digits(witness.im)}j"
        value = f"Re G1(s) = {there.real.str(6, radius=False)} there"
    except UndecidedError:  # the point would have too many digits
        witness, there = None, None
        reason = "exp(-2Ts) takes away no pole of H2 in Re s > 0, and has the modulus 1 on the axis"
        value = "Re G1 < 0 where |H1| > 1"
    steps += (
        Step("H1 = exp(-2Ts) H2 is bounded real", Status.REFUTED, reason),
        Step("G1 = (1 - H1)/(1 + H1) is positive real", Status.REFUTED, value),
    )
    return Chain(verdict, reflection, reference, travel, steps, witness, there)


def _onwards(h2: RationalFunction, reflection: Verdict, delay: Fraction) -> list[Step]:
    """The last two steps where H2 is not refuted: they hold for every delay, and add only what it looks like."""
    if h2 == RationalFunction.constant(Fraction(-1)) and not delay:
        port = "1 + H1 = 0: G1 is infinite, a short circuit, and 1/G1 = 0 is positive real"
    else:
        port = "Re G1 = (1 - |H1|^2)/|1 + H1|^2 >= 0" + _shape(h2, reflection, delay)
    delayed = "|exp(-2Ts)| <= 1 for Re s > 0 and T >= 0, and a product of bounded real functions is one"
    return [
        Step("H1 = exp(-2Ts) H2 is bounded real", reflection.status, delayed),
        Step("G1 = (1 - H1)/(1 + H1) is positive real", reflection.status, port),
    ]


def _shape(h2: RationalFunction, reflection: Verdict, delay: Fraction) -> str:
    if not delay:
        return "; without delay G1 = 1/G2"
    if h2.is_zero:
        return "; the end is matched and G1 = 1"
    if h2 == RationalFunction.constant(Fraction(1)):
        return "; the end is open and G1 = tanh(Ts), with poles at ω = (k + 1/2) pi/T of residue 1/T"
    if h2 == RationalFunction.constant(Fraction(-1)):
        return "; the end is short-circuited and G1 = coth(Ts), with poles at ω = k pi/T of residue 1/T"
    return "; nothing is lost, so all poles of G1 are simple and on the axis" if reflection.lossless else ""


def _input(witness: Witness, delay: Fraction) -> acb:
    """G1 at the witness, with twelve certain digits of its real part."""
    if witness.value_re is None or witness.value_im is None:
        return acb(-1)
    bits = 64
    while True:
        spend(20 * bits + 10_000, "the value at the input port")
        with ctx.workprec(bits):
            turn = of_point(-2 * delay * witness.re, -2 * delay * witness.im)
            h1 = turn.exp() * of_point(witness.value_re, witness.value_im)
            there = (1 - h1) / (1 + h1)
        if there.real < 0 and there.real.rel_accuracy_bits() > 40:
            return there
        bits *= 2
