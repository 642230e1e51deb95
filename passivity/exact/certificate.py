"""Repeats a proof from its certificate, by other means than the prover's.

The prover splits polynomials into even and odd parts, bisects and runs Routh's scheme. Here the even part comes from
p(s) q(-s), the cut points are taken from the certificate, and the roots are placed by a Schur-Richards reduction:

    f is Hurwitz  <=>  |c| < 1 and g is Hurwitz,   c = f(-a)/f(a),   g(s) = (f(s) - c f(-s))/(s + a),   any a > 0.

For on the axis |f(-s)| = |f(s)|, so if |c| < 1, f(s) - k c f(-s) has roots there for all k from 0 to 1 or for none, and
-a is a root at the end. If f is Hurwitz, |f(-a)| < |f(a)|.

The prover expands determinants as polynomials; here both sides are compared at more points than their degree allows
to agree by chance. The prover takes the characteristic polynomials of P; here squares are completed.
"""

from fractions import Fraction

from flint import arb, arb_poly, ctx, fmpq_poly, fmpz_mat, fmpz_poly

from passivity.budget import spend
from passivity.exact.storage import negative_direction
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import PolynomialMatrix, degree
from passivity.rational.state_space import StateSpace, dissipation, identity
from passivity.status import Kind
from passivity.verdict import Certificate, StorageCertificate

_MAX_BITS = 1_000_000
_MINUS = fmpz_poly([0, -1])


def verify(certificate: Certificate | StorageCertificate) -> bool:
    """Whether the facts in a certificate hold and make a proof."""
    if isinstance(certificate, StorageCertificate):
        return _stores(certificate)
    if isinstance(certificate.function, RationalFunction):
        return _of_one_port(certificate, certificate.function)
    network = certificate.function
    matrix = network.transfer if isinstance(network, StateSpace) else network
    return (
        (not isinstance(network, StateSpace) or _is_transfer(network, matrix))
        and _is_denominator(certificate, matrix)
        and is_hurwitz(certificate.closing)
        and len(certificate.sums) == matrix.size
        and all(is_nonnegative(2 * x.a, x.sign.factors, x.sign.breaks) for x in certificate.sums)
        and _has_these_sums(certificate, *matrix.fraction)
    )


def _of_one_port(certificate: Certificate, function: RationalFunction) -> bool:
    p, q, closing = function.p, function.q, certificate.closing
    whole = p + q if certificate.kind is Kind.PR else q
    if not closing or whole % closing or len(certificate.sums) != 1:
        return False
    common = whole // closing
    if not common or p % common or q % common:
        return False
    p, q = p // common, q // common
    if certificate.kind is Kind.BR:
        p, q = q + p, q - p
    even = (p * q(_MINUS) + p(_MINUS) * q).coeffs()[::2]  # twice Re p conj q, in powers of s^2 = -x
    allowed, sign = fmpz_poly([-c if k % 2 else c for k, c in enumerate(even)]), certificate.sums[0].sign
    return is_nonnegative(allowed, sign.factors, sign.breaks) and is_hurwitz(closing)


def _stores(certificate: StorageCertificate) -> bool:
    from passivity.floats.storage import as_scattering, is_positive, proves

    system, p = certificate.function, certificate.storage
    v, part = certificate.basis, certificate.reached
    if v is None or part is None:
        s = system if certificate.kind is Kind.BR else as_scattering(system)
        return s is not None and proves(s, p)
    return (
        system.a * v == v * part.a
        and system.b == v * part.b
        and system.c * v == part.c
        and system.d == part.d
        and p == p.transpose()
        and (is_positive(p) or negative_direction(p) is None)
        and negative_direction(-dissipation(certificate.kind, *part.matrices, p)) is None
    )


def _is_transfer(system: StateSpace, matrix: RationalMatrix) -> bool:
    """Whether the matrix is Z = D + C (sI - A)^-1 B.

    det(sI - A) (N - d Z) is a polynomial; where N - d Z falls off faster than s^-n, it falls off too, and so is zero.
    """
    (n, d), size, states = matrix.fraction, system.size, system.states
    series = [system.d, *system.markov(states + d.degree())]  # Z in powers of 1/s
    for i in range(size):
        for k in range(size):
            z = fmpq_poly([x[i, k] for x in reversed(series)])  # times a power of s
            rest = fmpq_poly(n[i][k]).left_shift(states + d.degree()) - z * d
            if rest.degree() >= d.degree():
                return False
    return True


def _is_denominator(certificate: Certificate, matrix: RationalMatrix) -> bool:
    """Whether c S, or c (Z + I)^-1, is a matrix of polynomials."""
    (n, d), c, x = matrix.fraction, certificate.closing, certificate.inverse
    if certificate.kind is Kind.BR:
        return all((entry * c) % d == 0 for row in n for entry in row)
    if x is None:
        return False
    unit = identity(matrix.size).numer_denom()[0]
    return all(
        (_at(n, t) + unit * d(t)) * _at(x, t) == unit * (c(t) * d(t)) for t in range(degree(n, d) + degree(x, c) + 1)
    )


def _has_these_sums(certificate: Certificate, n: PolynomialMatrix, d: fmpz_poly) -> bool:
    """Whether the sums of principal minors are the ones that were proved nonnegative: polynomials in s^2, at s = t."""
    m = len(n)
    unit = identity(m).numer_denom()[0]
    g = d * d(fmpz_poly([0, -1]))
    content = g.content()
    highest = max(m * degree(n, d), *(x.a.degree() + x.power * d.degree() for x in certificate.sums))
    for t in range(highest + 1):
        here, there = _at(n, t), _at(n, -t).transpose()
        form = here * d(-t) + there * d(t) if certificate.kind is Kind.PR else unit * g(t) - there * here
        expected = (-form).charpoly()
        for k, x in enumerate(certificate.sums, 1):
            if x.a(-t * t) * (g(t) // content) ** x.power != expected[m - k]:
                return False
    return True


def _at(a: PolynomialMatrix, t: int) -> fmpz_mat:
    return fmpz_mat([[x(t) for x in row] for row in a])


def is_nonnegative(a: fmpz_poly, factors: tuple, breaks: tuple[Fraction, ...]) -> bool:
    """Whether a is the product of the factors plus nonnegative coefficients, and the product is >= 0 for x >= 0."""
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
