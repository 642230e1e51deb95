"""Lossless line with its load, step by step Z2, G2, H2, H1, G1, and as a two-port.

u is the effort, y the flow, both counted from the input (end 1) to the load (end 2); Z2 = u2/y2, z0 > 0, T >= 0.

    G2 = Z2/z0,   H2 = (G2 - 1)/(G2 + 1),   H1 = exp(-2Ts) H2,   G1 = (1 - H1)/(1 + H1) = z0 y1/u1.

Because |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 and Re G1 = (1 - |H1|^2)/|1 + H1|^2, each is positive or bounded real if the one
before is. For a rational load the converse holds too: an active load makes an active port, for any delay.

From both ends, with both flows counted into it, Z = z0 [[coth Ts, csch Ts], [csch Ts, coth Ts]]. The sum and the
difference of the ports turn it, by a rotation M, into z0 coth(Ts/2) and z0 tanh(Ts/2): half the line, with a short
circuit or an open end. Z = M^T diag(...) M is positive real if and only if both are.
"""

from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import acb, ctx

from passivity.ball import of_fraction, of_point
from passivity.budget import ASIDE, UndecidedError, budget, spend
from passivity.calculus.derivation import Derivation
from passivity.errors import ExpressionError, shown
from passivity.exact.positive_real import check_bounded_real, check_positive_real, from_axis, from_root, of_one_port
from passivity.expression.number import digits
from passivity.polynomial.sign import allowance, find_sign
from passivity.rational.evaluate import Exact, exact, positive
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.verdict import Verdict, Witness


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
            ("load", replace(verdict, statement=f"G2 = Z2/z0 is {Kind.PR}")),
            ("a", replace(reflection, statement=f"H2 = (G2 - 1)/(G2 + 1) is {Kind.BR}")),
            ("b", Verdict(Kind.BR, None, last, statement=f"H1 = exp(-2Ts) H2 is {Kind.BR}", reason=h1)),
            ("c", Verdict(Kind.PR, None, last, statement=f"G1 = (1 - H1)/(1 + H1) is {Kind.PR}", reason=g1)),
        )
        return Derivation(told, reference, travel, witness, there)

    if reflection.status is not Status.REFUTED:
        delayed = "|exp(-2Ts)| <= 1 for Re s > 0 and T >= 0, and a product of bounded real functions is one"
        return chain(delayed, _port(h2, reflection, travel))
    try:
        with budget(ASIDE):
            witness = _behind(reflection, travel)
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
    """Sentence on why G1 is positive real if H2 is not refuted, with its special form."""
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


def _behind(reflection: Verdict, delay: Fraction) -> Witness | None:
    """s with |H1(s)| > 1, shown in ball arithmetic, for a verdict that refutes H2."""
    h2 = reflection.function
    if not delay:
        return reflection.witness
    test, allowed = of_one_port(Kind.BR, h2.p, h2.q, delay), allowance(Kind.BR, h2.p, h2.q)
    sign = find_sign(allowed)
    return from_axis(test, allowed, sign) if isinstance(sign, Fraction) else from_root(test, h2.reduced().q)


def _input(witness: Witness, delay: Fraction) -> acb:
    """G1 at the witness, with twelve certain digits of its real part."""
    if witness.image is None:
        return acb(-1)
    bits = 64
    while True:
        spend(20 * bits + 10_000, "the value at the input port")
        with ctx.workprec(bits):
            turn = of_point(-2 * delay * witness.re, -2 * delay * witness.im)
            h1 = turn.exp() * of_point(*witness.image[0])
            there = (1 - h1) / (1 + h1)
        if there.real < 0 and there.real.rel_accuracy_bits() > 40:
            return there
        bits *= 2


def check_line_two_port(z0: Exact, delay: Exact, *, through: bool = False) -> Verdict:
    """Is the impedance matrix of a lossless line positive real?

    Parameters
    ----------
    z0, delay : int, float, Fraction, Decimal or str
        Characteristic impedance and time from end to end, both above zero: without delay there are no impedances.
    through : bool
        Count the flow at the second end out of the line. Then Z = z0 [[coth, -csch], [csch, coth]] does not speak of
        power, u1 y1 - u2 y2 does, and it is not positive real though the line is passive.

    Raises
    ------
    ExpressionError
        For another z0 or delay.

    Examples
    --------
    >>> check_line_two_port("50 ohm", "3 ns").status
    <Status.PROVED: 'proved'>
    >>> check_line_two_port(1, 1, through=True).witness.form < 0
    True
    """
    reference, travel = positive(z0, "z0"), positive(delay, "delay")
    if through:  # with v = (1, j), v^H (Z + Z^H) v = 4 z0 (Re coth Ts + Im csch Ts), below zero at Ts = 1/8 + j
        s = of_point(Fraction(1, 8), Fraction(1))
        with ctx.workprec(100):
            z0_coth, z0_csch = (x * of_fraction(reference) for x in (s.coth(), s.csch()))
        first, second = z0_coth - z0_csch * acb(0, 1), z0_csch + z0_coth * acb(0, 1)
        image: Any = tuple((x.real, x.imag) for x in (first, second))
        v: Any = (1, 0), (0, 1)
        why = "with the flow at the second end counted out of the line, v^H (Z + Z^H) v is not the power that enters"
        witness = Witness(Kind.PR, Fraction(1, 8) / travel, 1 / travel, image, v)
        return Verdict(Kind.PR, None, Status.REFUTED, witness=witness, reason=why)
    ends = (RationalFunction.constant(Fraction(0)), RationalFunction.constant(Fraction(0)).inverse())
    modes = tuple(check_line(end, reference, travel / 2) for end in ends)
    assert all(mode.status is Status.PROVED for mode in modes)
    why = "the even and the odd mode, z0 coth(Ts/2) and z0 tanh(Ts/2), are positive real"
    return Verdict(Kind.PR, None, Status.PROVED, modes, reason=why)
