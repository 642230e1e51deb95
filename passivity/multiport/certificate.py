"""Repeats a proof from its certificate, by other means than the prover's.

The prover expands determinants as polynomials; here both sides are compared at more points than their degree allows
to agree by chance. The prover takes the characteristic polynomials of P; here squares are completed.
"""

from flint import fmpq_poly, fmpz_mat, fmpz_poly

from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.polynomial_matrix import PolynomialMatrix, degree
from passivity.multiport.quadratic_form import negative_direction
from passivity.multiport.state_space import StateSpace
from passivity.multiport.storage import kyp
from passivity.multiport.strict_storage import proves
from passivity.multiport.verdict import Certificate, MinorCertificate, StorageCertificate, StrictCertificate
from passivity.one_port.certificate import is_hurwitz, is_nonnegative
from passivity.status import Kind


def verify(certificate: Certificate) -> bool:
    """Whether the facts in a certificate hold and make a proof.

    Examples
    --------
    >>> from passivity.multiport.positive_real import check_positive_real_matrix
    >>> z = RationalMatrix.from_rows([["s + 1", "s"], ["s", "s + 1/s"]])
    >>> verify(check_positive_real_matrix(z).certificate)
    True
    """
    if isinstance(certificate, StorageCertificate):
        return _stores(certificate)
    if isinstance(certificate, StrictCertificate):
        return proves(certificate.system, certificate.storage)
    network = certificate.network
    if isinstance(network, StateSpace):
        matrix = network.transfer
        if not _is_transfer(network, matrix):
            return False
    else:
        matrix = network
    n, d = matrix.fraction
    return (
        _is_denominator(certificate, matrix)
        and is_hurwitz(certificate.closing)
        and len(certificate.sums) == matrix.size
        and all(is_nonnegative(2 * x.a, x.sign.factors, x.sign.breaks) for x in certificate.sums)
        and _has_these_sums(certificate, n, d)
    )


def _stores(certificate: StorageCertificate) -> bool:
    system, v, part, p = certificate.system, certificate.basis, certificate.reached, certificate.storage
    return (
        system.a * v == v * part.a
        and system.b == v * part.b
        and system.c * v == part.c
        and system.d == part.d
        and p == p.transpose()
        and negative_direction(p) is None
        and negative_direction(-kyp(part, p)) is None
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


def _is_denominator(certificate: MinorCertificate, matrix: RationalMatrix) -> bool:
    """Whether c S, or c (Z + I)^-1, is a matrix of polynomials."""
    (n, d), c, x = matrix.fraction, certificate.closing, certificate.inverse
    if certificate.kind is Kind.BR:
        return all((entry * c) % d == 0 for row in n for entry in row)
    if x is None:
        return False
    unit = fmpz_mat(matrix.size, matrix.size, [int(i == k) for i in range(matrix.size) for k in range(matrix.size)])
    return all(
        (_at(n, t) + unit * d(t)) * _at(x, t) == unit * (c(t) * d(t)) for t in range(degree(n, d) + degree(x, c) + 1)
    )


def _has_these_sums(certificate: MinorCertificate, n: PolynomialMatrix, d: fmpz_poly) -> bool:
    """Whether the sums of principal minors are the ones that were proved nonnegative: polynomials in s^2, at s = t."""
    m = len(n)
    unit = fmpz_mat(m, m, [int(i == k) for i in range(m) for k in range(m)])
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
