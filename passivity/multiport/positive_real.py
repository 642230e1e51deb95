"""Exact verdicts for networks with several ports: is Z positive real, is S bounded real?

Z is positive real if and only if Z + Z^H >= 0 on the imaginary axis, poles apart, and (Z + I)^-1 has all its poles in
Re s < 0: then S = I - 2 (Z + I)^-1 has them there, I - S^H S = 2 (Z + I)^-H (Z + Z^H) (Z + I)^-1 is nonnegative on
the axis, and S is bounded real by the maximum principle. For one port this is the test of Chen and Smith.

References
----------
B. D. O. Anderson, S. Vongpanitlerd, "Network Analysis and Synthesis", 1973, chapter 2.
M. Z. Q. Chen, M. C. Smith, "A note on tests for positive-real functions", IEEE Transactions on Automatic Control 54
(2009), 390-393.
"""

from dataclasses import replace
from fractions import Fraction

from passivity.errors import ExpressionError
from passivity.multiport.axis_form import axis_sums
from passivity.multiport.cayley import inverted
from passivity.multiport.hidden import hidden_modes
from passivity.multiport.refutation import refuted_or_undecided
from passivity.multiport.state_space import StateSpace
from passivity.multiport.storage import lossless_storage
from passivity.multiport.verdict import MatrixVerdict, MinorCertificate, MinorSum, Network, StrictCertificate
from passivity.multiport.witness import beside_axis, first_witness, near_root
from passivity.one_port.axis import product
from passivity.one_port.hurwitz import routh_column
from passivity.one_port.polynomial_sign import UndecidedError, find_sign
from passivity.status import Kind, Status

_STORAGE_FIRST = 12  # states from which a storage function is looked for before the minors are


def check_positive_real_matrix(z: Network) -> MatrixVerdict:
    """Is Z analytic with Z + Z^H >= 0 in the right half plane, that is, is a network with these impedances passive?

    Parameters
    ----------
    z : RationalMatrix or StateSpace
        Impedances, admittances, or any hybrid of them whose port variables make power. Taken exactly as given.

    Examples
    --------
    >>> from passivity.multiport.matrix import RationalMatrix
    >>> check_positive_real_matrix(RationalMatrix.from_rows([["s", "2*s"], ["2*s", "4*s"]])).lossless
    True
    >>> verdict = check_positive_real_matrix(RationalMatrix.from_rows([["1/s", "2/s"], ["2/s", "1/s"]]))
    >>> print(verdict.why)
    Z has a pole on the axis that is not simple with a nonnegative Hermitian residue
    """
    return check(z, Kind.PR)


def check_bounded_real_matrix(s: Network) -> MatrixVerdict:
    """Is S analytic with S^H S <= I in the right half plane, that is, does a network never return more than came?

    Parameters
    ----------
    s : RationalMatrix or StateSpace
        Scattering matrix, waves normalised so that |a|^2 - |b|^2 is the power. Taken exactly as given.

    Examples
    --------
    >>> from passivity.multiport.matrix import RationalMatrix
    >>> check_bounded_real_matrix(RationalMatrix.from_rows([["0", "1/2"], ["1/2", "0"]])).status
    <Status.PROVED: 'proved'>
    """
    return check(s, Kind.BR)


def check(network: Network, kind: Kind) -> MatrixVerdict:
    """The verdict of one of the two functions above."""
    if not isinstance(network, Network):
        expected = "a RationalMatrix or a StateSpace"
        raise ExpressionError("network", "not a network with several ports", expected, type(network).__name__)
    if kind is Kind.BR and isinstance(network, StateSpace) and network.states >= _STORAGE_FIRST:
        from passivity.multiport.strict_storage import strict_storage

        try:
            storage = strict_storage(network)
        except (OverflowError, ValueError):  # beyond the range of doubles, or eigenvalues do not converge
            storage = None
        if storage is not None:
            return MatrixVerdict(kind, network, Status.PROVED, StrictCertificate(network, storage))
    try:
        answer = _decided(kind, network)
    except UndecidedError as error:
        if isinstance(network, StateSpace) and network.states:
            return refuted_or_undecided(kind, network, str(error))
        return MatrixVerdict(kind, network, Status.UNDECIDED, budget=str(error))
    return replace(answer, hidden=hidden_modes(network))


def _decided(kind: Kind, network: Network) -> MatrixVerdict:
    matrix = network.transfer if isinstance(network, StateSpace) else network
    n, d = matrix.fraction
    if kind is Kind.PR and isinstance(network, StateSpace) and (energy := lossless_storage(network)):
        return MatrixVerdict(kind, network, Status.PROVED, energy, lossless=True)
    totals, sums = list(axis_sums(kind, n, d)), []
    for a, power in totals:
        sign = find_sign(a)
        if isinstance(sign, Fraction):
            witness = first_witness(kind, matrix, beside_axis(a * product(d, d)))  # away from poles on the axis
            negative = tuple(a for a, _ in totals)
            return MatrixVerdict(kind, network, Status.REFUTED, witness=witness, negative=negative)
        sums.append(MinorSum(a, power, sign))
    closing, inverse = inverted(n, d) if kind is Kind.PR else (d, None)  # where Z v = -v for all s, a sum is negative
    column = routh_column(closing)
    if column is None:
        witness = first_witness(kind, matrix, near_root(closing))
        return MatrixVerdict(kind, network, Status.REFUTED, witness=witness)
    certificate = MinorCertificate(kind, network, tuple(sums), closing, inverse, column)
    return MatrixVerdict(kind, network, Status.PROVED, certificate, lossless=not any(a for a, _ in totals))
