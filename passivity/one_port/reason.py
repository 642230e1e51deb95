"""The reason of a verdict in plain words: which band, pole, residue or degree decides."""

import math
from itertools import pairwise

from flint import fmpz_poly

from passivity.one_port.axis import allowance, parts, product
from passivity.one_port.polynomial_sign import squarefree
from passivity.one_port.real_roots import positive_roots
from passivity.one_port.verdict import Verdict
from passivity.status import Kind, Status

MOST_NAMED = 4  # bands or frequencies in one sentence
_BOUNDED = {Kind.PR: "Re Z(jω) >= 0", Kind.BR: "|H(jω)| <= 1"}
_BROKEN = {Kind.PR: "Re Z(jω) < 0", Kind.BR: "|H(jω)| > 1"}
_EQUAL = {Kind.PR: "Re Z(jω) = 0", Kind.BR: "|H(jω)| = 1"}
_CLOSING = {Kind.PR: "p + q", Kind.BR: "the denominator"}


def reason(verdict: Verdict) -> str:
    """Why a verdict is what it is, frequencies ω in rad per unit of time.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real
    >>> check_positive_real(RationalFunction.from_expression("(s + 2)/(s^2 + s + 1)")).why
    'Re Z(jω) < 0 for ω > 1.41421'
    >>> check_positive_real(RationalFunction.from_expression("1 - s")).why
    'Z has a pole at infinity with negative residue'
    """
    kind = verdict.kind
    if verdict.status is Status.UNDECIDED:
        return verdict.budget
    if verdict.status is Status.PROVED:
        text = f"{_axis(verdict)}, and all roots of {_CLOSING[kind]} lie in Re s < 0"
        return text + _hidden(verdict)
    bands = _bands(allowance(kind, verdict.function.p, verdict.function.q))
    if bands:
        return f"{_BROKEN[kind]} {bands}" + _hidden(verdict)
    reduced = verdict.function.reduced()
    fault = _fault(reduced.p, reduced.q) if kind is Kind.PR else "H has a pole in Re s > 0"
    return fault + _hidden(verdict)


def _hidden(verdict: Verdict) -> str:
    if verdict.hidden is None:
        return ""
    factor = str(verdict.hidden).replace("x", "s").replace("(-", "-").replace("+ -", "- ").replace(")", "")
    return f"; the common factor {factor} is a hidden mode that does not die out"


def _axis(verdict: Verdict) -> str:
    kind = verdict.kind
    if verdict.lossless:
        return f"{_EQUAL[kind]} for all ω (lossless)"
    p, q = verdict.function.p, verdict.function.q
    a = allowance(kind, p, q)
    a //= a.gcd(product(q, q))  # at a pole Re Z is not zero, though A is
    even = [f for f, power in squarefree(a) if power % 2 == 0 and f[0]]
    touched = [0.0] * (not a[0]) + sorted(root.frequency for f in even for root in positive_roots(f))
    at = f" (equal at ω = {_list([f'{w:.6g}' for w in touched])})" if touched else ""
    return f"{_BOUNDED[kind]} for all ω{at}"


def _bands(a: fmpz_poly) -> str:
    """Where a polynomial in w^2 is negative; empty if nowhere."""
    if not a:
        return ""
    changes = [root for f, power in squarefree(a) if power % 2 and f[0] for root in positive_roots(f)]
    ends = [0.0, *sorted(root.frequency for root in changes), math.inf]
    negative = a.leading_coefficient() < 0
    bands = [pair for k, pair in enumerate(reversed(list(pairwise(ends)))) if (k % 2 == 1) != negative]
    return _list([_band(*pair) for pair in reversed(bands)])


def _band(low: float, high: float) -> str:
    if low == 0:
        return "for all ω" if high == math.inf else f"for ω < {high:.6g}"
    if high == math.inf:
        return f"for ω > {low:.6g}"
    if f"{low:.6g}" == f"{high:.6g}":
        return f"in a narrow band at ω = {low:.12g}"
    return f"for {low:.6g} < ω < {high:.6g}"


def _list(items: list[str]) -> str:
    more = len(items) - MOST_NAMED
    return ", ".join(items[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _fault(p: fmpz_poly, q: fmpz_poly) -> str:
    """Which pole of p/q is wrong, if Re p conj q >= 0 on the axis; p and q coprime."""
    excess = p.degree() - q.degree()
    if excess > 1:
        return f"Z grows like s^{excess}: the degree of the numerator exceeds that of the denominator by more than one"
    if excess == 1 and p.leading_coefficient() * q.leading_coefficient() < 0:
        return "Z has a pole at infinity with negative residue"
    order = next(k for k, c in enumerate(q.coeffs()) if c)
    if order > 1:
        return f"Z has a pole of order {order} at s = 0"
    if order and p[0] * q[1] < 0:
        return "Z has a pole at s = 0 with negative residue"
    u, v = parts(q.right_shift(order))
    for factor, power in squarefree(u.gcd(v)):  # of the poles whose mirror images are poles
        for root in positive_roots(factor) if factor.degree() > 0 else []:
            place = f"on the axis at ω = {root.frequency:.6g}"
            if power > 1:
                return f"Z has a pole of order {power} {place}"
            if root.sign_of(product(p, q.derivative())) < 0:
                return f"Z has a pole {place} with negative residue"
    return "Z has a pole in Re s > 0"
