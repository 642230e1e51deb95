"""Coefficients of the systems of scipy.signal and python-control."""

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly

from passivity.errors import ExpressionError
from passivity.rational.evaluate import exact


def coefficients(system: Any) -> tuple[Iterable[Any], Iterable[Any]]:
    """Numerator and denominator, highest power first; see `RationalFunction.from_system`."""
    kind = type(system).__name__
    if getattr(system, "dt", None) not in (None, 0):
        got = f"{kind} with dt={system.dt}"
        raise ExpressionError("system", "discrete in time", "a continuous system", got)
    table = hasattr(system, "ninputs")  # python-control: coefficients in a table of outputs by inputs
    names = ("ninputs", "noutputs") if table else ("inputs", "outputs")
    if (ports := tuple(getattr(system, name, 1) for name in names)) != (1, 1):
        got = f"{ports} of {kind}"
        raise ExpressionError("system", "too many ports", "one input and one output", got)
    if hasattr(system, "A"):
        return _of_state_space(system.A, system.B, system.C, system.D)
    if hasattr(system, "gain"):
        system = system.to_tf()
    if hasattr(system, "num"):
        return (system.num[0][0], system.den[0][0]) if table else (system.num, system.den)
    expected = "a scipy.signal.lti or python-control system"
    raise ExpressionError("system", "no coefficients", expected, kind)


def _of_state_space(a: Any, b: Any, c: Any, d: Any) -> tuple[list[Fraction], list[Fraction]]:
    """D + C (sI - A)^-1 B, exactly: det(sI - A + BC) = det(sI - A) (1 + C (sI - A)^-1 B)."""
    n = len(a)
    a, b, c, d = (
        fmpq_mat(*shape, [_fmpq(value) for row in rows for value in row])
        for rows, shape in ((a, (n, n)), (b, (n, 1)), (c, (1, n)), (d, (1, 1)))
    )
    q = a.charpoly()
    return _descending((a - b * c).charpoly() + q * (d[0, 0] - 1)), _descending(q)


def _fmpq(value: Any) -> fmpq:
    number = exact(value, "state space")
    return fmpq(number.numerator, number.denominator)


def _descending(polynomial: fmpq_poly) -> list[Fraction]:
    return [Fraction(int(c.p), int(c.q)) for c in reversed(polynomial.coeffs())] or [Fraction(0)]
