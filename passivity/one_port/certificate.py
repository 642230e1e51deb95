"""Repeats a proof from its certificate, by other means than the prover's.

The prover splits polynomials into even and odd parts, bisects and runs Routh's scheme. Here the even part comes from
p(s) q(-s), the cut points are taken from the certificate, and the roots are placed by a Schur-Richards reduction:

    f is Hurwitz  <=>  |c| < 1 and g is Hurwitz,   c = f(-a)/f(a),   g(s) = (f(s) - c f(-s))/(s + a),   any a > 0.

For on the axis |f(-s)| = |f(s)|, so if |c| < 1, f(s) - k c f(-s) has roots there for all k from 0 to 1 or for none, and
-a is a root at the end. If f is Hurwitz, |f(-a)| < |f(a)|.
"""

from fractions import Fraction

from flint import arb, arb_poly, ctx, fmpz_poly

from passivity.budget import spend
from passivity.one_port.verdict import Certificate
from passivity.status import Kind

_MAX_BITS = 1_000_000


def verify(certificate: Certificate) -> bool:
    """Whether the facts in a certificate hold and make a proof.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real
    >>> verify(check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")).certificate)
    True
    """
    common, (p, q) = certificate.common, (certificate.function.p, certificate.function.q)
    if not common or p % common or q % common:
        return False
    p, q = p // common, q // common
    if certificate.kind is Kind.BR:
        p, q = q + p, q - p
    if p + q == 0:
        return False
    minus = fmpz_poly([0, -1])
    even = (p * q(minus) + p(minus) * q).coeffs()[::2]  # twice Re p conj q, in powers of s^2 = -x
    allowed = fmpz_poly([-c if k % 2 else c for k, c in enumerate(even)])
    return is_nonnegative(allowed, certificate.sign.factors, certificate.sign.breaks) and is_hurwitz(p + q)


def is_nonnegative(a: fmpz_poly, factors: tuple, breaks: tuple[Fraction, ...]) -> bool:
    """Whether a is, up to what is nonnegative anyway, the product of the factors, and these are for x >= 0."""
    whole, odd = fmpz_poly([2]), fmpz_poly([1])
    for factor, power in factors:
        whole *= factor**power
        odd *= factor if power % 2 else 1
    ends = [Fraction(0), *breaks]
    if any(c < 0 for c in (a - whole).coeffs()) or sorted(set(ends)) != ends:
        return False
    pieces = [_on(odd, low, high) for low, high in zip(ends, breaks, strict=False)]
    return all(c >= 0 for piece in [*pieces, _shifted(odd, ends[-1])] for c in piece.coeffs())


def _shifted(f: fmpz_poly, low: Fraction) -> fmpz_poly:
    """f(low + t) in another unit of t, up to a positive factor."""
    n, d = f.degree(), low.denominator
    return fmpz_poly([c * d ** (n - k) for k, c in enumerate(f.coeffs())])(fmpz_poly([low.numerator, 1]))


def _on(f: fmpz_poly, low: Fraction, high: Fraction) -> fmpz_poly:
    """f at low + (high - low) t/(1 + t), in another unit of t: its coefficients have the signs of the true ones."""
    n, width = f.degree(), (high - low) * low.denominator
    g = _shifted(f, low).coeffs()
    g = [c * width.numerator**k * width.denominator ** (n - k) for k, c in enumerate(g)]
    return fmpz_poly(g[::-1])(fmpz_poly([1, 1]))


def is_hurwitz(f: fmpz_poly) -> bool:
    """Whether all roots lie in Re s < 0, by the reduction above in balls."""
    if f.leading_coefficient() < 0:
        f = -f
    if f[0] <= 0:
        return False
    n, bits = f.degree(), 64 + 8 * f.degree()
    a = arb(2) ** (round((f[0].bit_length() - f[n].bit_length()) / n) if n else 0)
    while bits < _MAX_BITS:
        spend(2 * len(f) ** 2 * (1000 + bits), f"the verification for degree {n}")
        with ctx.workprec(bits):
            answer = _reduces(arb_poly(f)(arb_poly([0, a])), n)  # roots of about modulus 1
        if answer is not None:
            return answer
        bits *= 2
    return False


def _reduces(f: arb_poly, degree: int) -> bool | None:
    """Whether the reduction with a = 1 runs to the end; None if the precision does not tell."""
    minus, divisor = arb_poly([0, -1]), arb_poly([1, 1])
    for _ in range(degree):
        mirrored = f(minus)
        c = f(-1) / f(1)
        if not (c < 1 and c > -1):
            return False if c >= 1 or c <= -1 else None
        f = (f - mirrored * c) // divisor
    return True
