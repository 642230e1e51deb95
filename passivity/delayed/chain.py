"""From the load of a lossless line to its input port, step by step: Z2, G2, H2, H1, G1.

u is the effort, y the flow, both counted from the input (end 1) to the load (end 2); Z2 = u2/y2, z0 > 0, T >= 0.

    G2 = Z2/z0,   H2 = (G2 - 1)/(G2 + 1),   H1 = exp(-2Ts) H2,   G1 = (1 - H1)/(1 + H1) = z0 y1/u1.

Because |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 and Re G1 = (1 - |H1|^2)/|1 + H1|^2, each is positive or bounded real if the one
before is. For a rational load the converse holds too: an active load makes an active port, whatever the delay.
"""

from fractions import Fraction

from flint import acb, ctx

from passivity.ball import of_point
from passivity.budget import ASIDE, UndecidedError, budget, spend
from passivity.calculus.conclusion import Conclusion
from passivity.calculus.derivation import Derivation
from passivity.errors import ExpressionError, shown
from passivity.exact.positive_real import check_bounded_real, check_positive_real
from passivity.exact.verdict import Verdict, Witness
from passivity.expression.number import digits
from passivity.rational.evaluate import Exact, exact, positive
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.symbolic.question import delayed_witness


def check_line(load: RationalFunction | str, z0: Exact, delay: Exact) -> Derivation:
    """Is the input port of a lossless line passive, with this load at its other end?

    Parameters
    ----------
    load : RationalFunction or str
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
    >>> chain = check_line("25 + s/1000000000", "50 ohm", "3 ns")
    >>> [step.status.value for _, step in chain.statements]
    ['proved', 'proved', 'proved', 'proved']
    """
    load = RationalFunction.from_expression(load) if isinstance(load, str) else load
    reference, travel = positive(z0, "z0"), exact(delay, "delay")
    if travel < 0:
        raise ExpressionError("delay", "negative", "at least 0", shown(delay))
    one, unit = load.p * reference.denominator, load.q * reference.numerator
    h2 = RationalFunction(one - unit, one + unit)
    verdict, reflection = check_positive_real(load), check_bounded_real(h2)

    def chain(h1: str, g1: str, witness: Witness | None = None, there: acb | None = None) -> Derivation:
        last = reflection.status
        told = (
            ("load", Conclusion(Kind.PR, f"G2 = Z2/z0 is {Kind.PR}", verdict.status, verdict.why, oracle=verdict)),
            ("a", Conclusion(Kind.BR, f"H2 = (G2 - 1)/(G2 + 1) is {Kind.BR}", last, reflection.why, oracle=reflection)),
            ("b", Conclusion(Kind.BR, f"H1 = exp(-2Ts) H2 is {Kind.BR}", last, h1)),
            ("c", Conclusion(Kind.PR, f"G1 = (1 - H1)/(1 + H1) is {Kind.PR}", last, g1)),
        )
        return Derivation(told, reference, travel, witness, there)

    if reflection.status is not Status.REFUTED:
        delayed = "|exp(-2Ts)| <= 1 for Re s > 0 and T >= 0, and a product of bounded real functions is one"
        return chain(delayed, _port(h2, reflection, travel))
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
    return chain(reason, value, witness=witness, there=there)


def _port(h2: RationalFunction, reflection: Verdict, delay: Fraction) -> str:
    """Why G1 is positive real if H2 is not refuted, and what it looks like."""
    known = {0: "the end is matched and G1 = 1"} | {
        sign: f"the end is {end} and G1 = {name}(Ts), with poles at ω = {poles} pi/T of residue 1/T"
        for sign, end, name, poles in ((1, "open", "tanh", "(k + 1/2)"), (-1, "short-circuited", "coth", "k"))
    }
    special = next((text for c, text in known.items() if h2 == RationalFunction.constant(Fraction(c))), "")
    if not delay:
        if special and h2 == RationalFunction.constant(Fraction(-1)):
            return "1 + H1 = 0: G1 is infinite, a short circuit, and 1/G1 = 0 is positive real"
        special = "without delay G1 = 1/G2"
    elif not special and reflection.lossless:
        special = "nothing is lost, so all poles of G1 are simple and on the axis"
    return "Re G1 = (1 - |H1|^2)/|1 + H1|^2 >= 0" + (f"; {special}" if special else "")


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
