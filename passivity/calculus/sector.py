"""Values in a disc or a half-plane: sectors, indices and quadratic forms, as the two properties of a linear map."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import fmpq

from passivity.budget import granted
from passivity.calculus.ask import ask
from passivity.calculus.given import given
from passivity.calculus.question import statements
from passivity.discrete import Discrete
from passivity.errors import ExpressionError, shown
from passivity.expression.number import square_root, written
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.state_space import StateSpace, identity
from passivity.status import Kind
from passivity.verdict import Verdict


def is_in_sector(
    what: Any,
    low: Exact,
    high: Exact,
    assume: Iterable[str] = (),
    values: Mapping[str, Exact] | None = None,
    *,
    budget: float = 1,
) -> Verdict:
    """Is a function W analytic in Re s > 0 with values there in the disc on [low, high], or in a half-plane?

    The disc has the two ends on its edge and its centre on the real axis. ``(nu, inf)``, Re W >= nu, is the input
    feedforward index, ``(0, 1/rho)``, Re 1/W >= rho, the output feedback index (`get_input_ff_index` and
    `get_output_fb_index` of python-control). Of several ports W - low I, or (2 W - (low + high) I)/(high - low).

    Parameters
    ----------
    what : text, numbers or system
        As of `is_positive_real`, but for samples, lines and scenes; of discrete time for abs z > 1.
    low, high : int, float, Fraction, Decimal or str
        low < high; one of them may be infinite, as a float or as text: ``"inf"``, ``"-inf"``.
    assume, values, budget
        As of `is_positive_real`.

    Raises
    ------
    ExpressionError
        For other ends, and where `is_positive_real` raises it.

    References
    ----------
    G. Zames, "On the input-output stability of time-varying nonlinear feedback systems", part I, IEEE Transactions on
    Automatic Control 11 (1966), 228-238, DOI 10.1109/TAC.1966.1098316.

    Examples
    --------
    >>> is_in_sector("(s + 2)/(s + 1)", 1, 2).status, is_in_sector("1/(s + 1)", "1/9", "inf").status
    (<Status.PROVED: 'proved'>, <Status.REFUTED: 'refuted'>)
    """
    below, above = _end(low), _end(high)
    if not below < above or (math.isinf(below) and math.isinf(above)):
        expected = "two numbers in rising order, one of them infinite at most"
        raise ExpressionError("sector", "not an interval", expected, f"{shown(low)}, {shown(high)}")
    if math.isinf(below) or math.isinf(above):
        factor, offset = (1, -Fraction(below)) if math.isinf(above) else (-1, Fraction(above))
        kind, region = Kind.PR, f"Re W >= {written(below)}" if factor > 0 else f"Re W <= {written(above)}"
    else:
        kind, factor = Kind.BR, 2 / (above - below)
        offset, region = -(above + below) / (above - below), f"W is in the disc on [{written(below)}, {written(above)}]"
    with granted(budget):
        verdict = ask(_moved(what, kind, Fraction(factor), Fraction(offset)), kind, assume, values)
    scale = f"{written(Fraction(factor))}*W".removeprefix("1*").replace("-1*W", "-W")
    moved = f"{scale} + {written(Fraction(offset))}".removesuffix(" + 0").replace("+ -", "- ")
    note = f"{kind.letter} = {moved} of the given W, {kind} if and only if {region}"
    return replace(verdict, note="; ".join(filter(None, (note, verdict.note))))


def is_dissipative(
    what: Any,
    q: Exact,
    s: Exact,
    r: Exact,
    assume: Iterable[str] = (),
    values: Mapping[str, Exact] | None = None,
    *,
    budget: float = 1,
) -> Verdict:
    """Is a function W analytic in Re s > 0 with Q |W|^2 + 2 S Re W + R >= 0 there, dissipative for that supply?

    Parameters
    ----------
    what : text, numbers or system
        As of `is_in_sector`; of several ports with the forms Q I, S I and R I.
    q, s, r : int, float, Fraction, Decimal or str
        Q <= 0; the form is zero at numbers, that is S^2 - Q R is the square of a fraction.
    assume, values, budget
        As of `is_positive_real`.

    Raises
    ------
    ExpressionError
        For another form, and where `is_in_sector` raises it.

    References
    ----------
    D. J. Hill, P. J. Moylan, "The stability of nonlinear dissipative systems", IEEE Transactions on Automatic Control
    21 (1976), 708-711, DOI 10.1109/TAC.1976.1101352.

    Examples
    --------
    >>> is_dissipative("1/(s + 1)", -1, 0, 1).status, is_dissipative("1/(s + 1)", -1, "1/2", 0).status
    (<Status.PROVED: 'proved'>, <Status.PROVED: 'proved'>)
    """
    Q, S, R = (exact(x, "supply") for x in (q, s, r))
    told = f"{written(Q)}, {written(S)}, {written(R)}"
    if Q == 0 and S:
        ends = (-R / (2 * S), math.inf) if S > 0 else (-math.inf, -R / (2 * S))
        return is_in_sector(what, *ends, assume, values, budget=budget)
    root = square_root(S * S - Q * R)
    if Q >= 0 or not root:
        expected = "Q <= 0, and S^2 - Q R the square of a fraction above 0; for Q > 0 > R ask about 1/W with R, S, Q"
        raise ExpressionError("supply", "no disc or half-plane between fractions", expected, told)
    middle, radius = S / -Q, root / -Q
    return is_in_sector(what, middle - radius, middle + radius, assume, values, budget=budget)


def _end(x: Exact) -> Fraction | float:
    """A number, or an infinity."""
    text = x.strip().lstrip("+") if isinstance(x, str) else x
    return float(text) if text in ("inf", "-inf", math.inf, -math.inf) else exact(x, "sector")


def _moved(what: Any, kind: Kind, c: Fraction, d: Fraction) -> Any:
    """c W + d of a question."""
    if isinstance(what, str):
        *lets, (_, last) = statements(what)
        known = "".join(f"let {name} = {text}; " for name, text in lets)
        return f"{known}{written(c)}*({last}) + {written(d)}".replace("+ -", "- ")
    what = given(what, kind)
    match what:
        case RationalFunction():
            return what * c + d
        case Discrete(network):
            return Discrete(_moved(network, kind, c, d))
        case RationalMatrix(rows):
            return RationalMatrix(
                tuple(tuple(x * c + d * (i == k) for k, x in enumerate(row)) for i, row in enumerate(rows))
            )
        case StateSpace():
            by, more = (fmpq(x.numerator, x.denominator) for x in (c, d))
            return StateSpace(what.a, what.b, what.c * by, what.d * by + identity(what.size) * more)
    expected = "an expression, a rational function, a matrix of such, or a state space"
    raise ExpressionError("what", "has no sector", expected, type(what).__name__)
