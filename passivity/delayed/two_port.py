"""A lossless line seen from both ends: Z = z0 [[coth Ts, csch Ts], [csch Ts, coth Ts]], both flows counted into it.

The sum and the difference of the ports turn it, by a rotation M, into z0 coth(Ts/2) and z0 tanh(Ts/2): half the line,
with a short circuit or an open end. Z = M^T diag(...) M is positive real if and only if both are.
"""

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, ctx, fmpq

from passivity.calculus.derivation import Derivation
from passivity.delayed.chain import check_line
from passivity.rational.evaluate import Exact, positive
from passivity.rational.function import RationalFunction
from passivity.status import Decided, Status


@dataclass(frozen=True)
class LineVerdict(Decided):
    """Answer to whether the matrix of a line is positive real."""

    status: Status
    why: str
    modes: tuple[Derivation, ...] = ()  # the proof: half the line with its far end open, and with a short circuit
    re: Fraction | None = None  # where it is refuted, s = re + j im with re > 0
    im: Fraction | None = None
    vector: tuple[tuple[int, int], ...] | None = None  # v, real and imaginary parts
    value: arb | None = None  # v^H (Z + Z^H) v there, a ball below zero


def check_line_two_port(z0: Exact, delay: Exact, *, through: bool = False) -> LineVerdict:
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
    >>> check_line_two_port(1, 1, through=True).value < 0
    True
    """
    reference, travel = positive(z0, "z0"), positive(delay, "delay")
    if through:
        return _refuted(reference, travel)
    ends = (RationalFunction.constant(Fraction(0)), RationalFunction.constant(Fraction(0)).inverse())
    modes = tuple(check_line(end, reference, travel / 2) for end in ends)
    assert all(mode.status is Status.PROVED for mode in modes)
    why = "the even and the odd mode, z0 coth(Ts/2) and z0 tanh(Ts/2), are positive real"
    return LineVerdict(Status.PROVED, why, modes)


def _refuted(z0: Fraction, delay: Fraction) -> LineVerdict:
    """With v = (1, j), v^H (Z + Z^H) v = 4 z0 (Re coth Ts + Im csch Ts), below zero at Ts = 1/8 + j."""
    turn = acb(fmpq(1, 8), 1)
    with ctx.workprec(100):
        value = 4 * fmpq(z0.numerator, z0.denominator) * (turn.coth().real + turn.csch().imag)
    why = "with the flow at the second end counted out of the line, v^H (Z + Z^H) v is not the power that enters"
    return LineVerdict(
        Status.REFUTED, why, re=Fraction(1, 8) / delay, im=1 / delay, vector=((1, 0), (0, 1)), value=value
    )
