"""Exact verdicts: is an impedance positive real, is a reflection bounded real, of one port or of several?

Z = p/q is positive real if and only if Re p(jw) conj q(jw) >= 0 for all w and, after cancelling common factors, all
roots of p + q lie in Re s < 0. Poles and residues need no look of their own. H = p/q is bounded real if and only if
(1 + H)/(1 - H) = (q + p)/(q - p) is positive real, that is |q|^2 - |p|^2 >= 0 and all roots of q lie in Re s < 0.

Of several ports, Z is positive real if and only if Z + Z^H >= 0 on the imaginary axis, poles apart, and (Z + I)^-1 has
all its poles in Re s < 0: then S = I - 2 (Z + I)^-1 has them there, I - S^H S = 2 (Z + I)^-H (Z + Z^H) (Z + I)^-1 is
nonnegative on the axis, and S is bounded real by the maximum principle.

References
----------
M. Z. Q. Chen, M. C. Smith, "A note on tests for positive-real functions", IEEE Transactions on Automatic Control 54
(2009), 390-393.
B. D. O. Anderson, S. Vongpanitlerd, "Network Analysis and Synthesis", 1973, chapter 2.
"""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from flint import arb, fmpq, fmpq_mat, fmpz_poly

from passivity.budget import VERDICT, UndecidedError, bits_of, budget, spend
from passivity.errors import ExpressionError
from passivity.exact.storage import lossless_storage, negative_direction
from passivity.polynomial.roots import (
    candidates,
    power_of_two,
    reducing_cost,
    routh_column,
    scaled_value,
    square_roots,
    to_fmpq,
)
from passivity.polynomial.sign import allowance, coprime, find_sign, product
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix, inverted
from passivity.rational.polynomial_matrix import axis_sums
from passivity.rational.state_space import StateSpace, identity
from passivity.status import Kind, Status
from passivity.verdict import AxisSum, Certificate, Network, Parts, StorageCertificate, Verdict, Witness

if TYPE_CHECKING:
    from passivity.floats.modes import Modes

_FLOATS_FIRST = 12  # states from which floats are asked before the minors are
_STORAGE_MOST = 200  # states of impedances up to which it is: more take longer than some seconds
Test: TypeAlias = Callable[[Fraction, Fraction], Witness | None]  # a point as a witness, None if it is none
_ONE = fmpz_poly([1])
BROKEN = {Kind.PR: "Z + Z^H has a negative eigenvalue", Kind.BR: "S has a singular value above 1"}


def check_positive_real(z: Network | str) -> Verdict:
    """Is Z analytic with Z + Z^H >= 0 in the right half plane, that is, is a network with these impedances passive?

    Parameters
    ----------
    z : RationalFunction, str, RationalMatrix or StateSpace
        Impedances, admittances, or any hybrid of them whose port variables make power; of one port open and short
        circuit included. Taken exactly as given.

    Examples
    --------
    >>> of = RationalFunction.from_expression
    >>> check_positive_real(of("50 + 1n*s + 1/(1p*s)")).status
    <Status.PROVED: 'proved'>
    >>> verdict = check_positive_real(of("1/(s^2 + s + 1) - 1/100"))
    >>> verdict.status, verdict.witness.re > 0, verdict.witness.value.real < 0
    (<Status.REFUTED: 'refuted'>, True, True)
    >>> check_positive_real(RationalMatrix.from_rows([["s", "2*s"], ["2*s", "4*s"]])).lossless
    True
    >>> print(check_positive_real(RationalMatrix.from_rows([["1/s", "2/s"], ["2/s", "1/s"]])).why)
    Z has a pole on the axis that is not simple with a nonnegative Hermitian residue
    """
    return check(z, Kind.PR)


def check_bounded_real(h: Network | str) -> Verdict:
    """Is S analytic with S^H S <= I in the right half plane, that is, does a network never return more than came?

    Parameters
    ----------
    h : RationalFunction, str, RationalMatrix or StateSpace
        Reflection or scattering matrix, waves normalised so that |a|^2 - |b|^2 is the power. Taken exactly as given.

    Examples
    --------
    >>> check_bounded_real(RationalFunction.from_expression("(1 - s)/(1 + s)")).lossless
    True
    >>> check_bounded_real(RationalMatrix.from_rows([["0", "1/2"], ["1/2", "0"]])).status
    <Status.PROVED: 'proved'>
    """
    return check(h, Kind.BR)


def check(network: Network | str, kind: Kind) -> Verdict:
    """The verdict of one of the two functions above."""
    if isinstance(network, str):
        network = RationalFunction.from_expression(network)
    if isinstance(network, RationalFunction):
        with budget(VERDICT):
            return _of_one_port(network, kind)
    if not isinstance(network, Network):
        expected = "a RationalFunction or the text of one, a RationalMatrix or a StateSpace"
        expected += "; passivity.is_positive_real takes more"
        raise ExpressionError("function", "not a rational function or matrix", expected, type(network).__name__)
    return _of_multiport(network, kind)


def _of_one_port(function: RationalFunction, kind: Kind) -> Verdict:
    p, q = function.p, function.q
    closing = p + q if kind is Kind.PR else q
    try:
        allowed = allowance(kind, p, q)
        sign = find_sign(allowed)
        if isinstance(sign, Fraction):
            witness, hidden = from_axis(of_one_port(kind, p, q), allowed, sign), _hidden(_common(p, q))
            return Verdict(kind, function, Status.REFUTED, witness=witness, hidden=hidden, negative=(allowed,))
        lossless, common = not allowed, _ONE
        column = routh_column(closing)
        if column is None and (common := _common(p, q)).degree() > 0:
            allowed, closing = allowance(kind, p // common, q // common), closing // common
            sign = find_sign(allowed)
            assert not isinstance(sign, Fraction)
            column = routh_column(closing)
        hidden = _hidden(common)
        if column is None:
            witness = from_root(of_one_port(kind, p, q), closing)
            return Verdict(kind, function, Status.REFUTED, witness=witness, lossless=lossless, hidden=hidden)
    except UndecidedError as error:
        return Verdict(kind, function, Status.UNDECIDED, reason=str(error))
    certificate = Certificate(kind, function, (AxisSum(allowed, 0, sign),), closing, column)
    return Verdict(kind, function, Status.PROVED, certificate, lossless=lossless, hidden=hidden)


def _of_multiport(network: RationalMatrix | StateSpace, kind: Kind) -> Verdict:
    if isinstance(network, StateSpace):
        if found := lossless_storage(kind, network):
            certificate = StorageCertificate(kind, network, *found)
            return Verdict(kind, network, Status.PROVED, certificate, lossless=True, hidden=hidden_modes(network))
        if network.states >= _FLOATS_FIRST and (verdict := by_floats(kind, network)) is not None:
            return verdict
    try:
        return replace(_by_minors(kind, network), hidden=hidden_modes(network))
    except UndecidedError as error:
        if isinstance(network, StateSpace) and network.states:
            return refuted_or_undecided(kind, network, str(error))
        return Verdict(kind, network, Status.UNDECIDED, reason=str(error))


def _by_minors(kind: Kind, network: RationalMatrix | StateSpace) -> Verdict:
    matrix = network.transfer if isinstance(network, StateSpace) else network
    n, d = matrix.fraction
    totals, sums = list(axis_sums(kind, n, d)), []
    for a, power in totals:
        sign = find_sign(a)
        if isinstance(sign, Fraction):
            away = a * product(d, d)  # from poles on the axis
            x0 = find_sign(away)
            assert isinstance(x0, Fraction)
            witness = from_axis(of_multiport(kind, matrix), away, x0)
            return Verdict(kind, network, Status.REFUTED, witness=witness, negative=tuple(a for a, _ in totals))
        sums.append(AxisSum(a, power, sign))
    closing, inverse = inverted(n, d) if kind is Kind.PR else (d, None)  # where Z v = -v for all s, a sum is negative
    column = routh_column(closing)
    if column is None:
        witness = from_root(of_multiport(kind, matrix), closing)
        return Verdict(kind, network, Status.REFUTED, witness=witness)
    certificate = Certificate(kind, network, tuple(sums), closing, column, inverse)
    return Verdict(kind, network, Status.PROVED, certificate, lossless=not any(a for a, _ in totals))


def by_floats(kind: Kind, system: StateSpace) -> Verdict | None:
    """Refute at a point, or prove by a storage function, found in floats and checked exactly; None if neither works."""
    from passivity.floats.modes import Modes
    from passivity.floats.storage import as_scattering, strict_storage
    from passivity.floats.system import FloatSystem

    try:
        look = Modes(FloatSystem.of(kind, system))
        if (found := _refuted(look, system, look.lowest[1])) is not None:
            return found
        if kind is Kind.BR:
            storage = strict_storage(system, look)
        else:
            s = as_scattering(system) if system.states <= _STORAGE_MOST else None
            storage = s and strict_storage(s)
    except (OverflowError, UndecidedError, ValueError):  # beyond the doubles, or eigenvalues do not converge
        return None
    proof = None if storage is None else StorageCertificate(kind, system, storage)
    return proof and Verdict(kind, system, Status.PROVED, proof)


def _refuted(look: "Modes", system: StateSpace, frequency: float) -> Verdict | None:
    """Refuted at one of the points that floats suggest, the first of them over the axis at a frequency."""
    from passivity.floats.modes import is_negative

    kind = look.system.kind
    for re, im, vector in look.suspects(frequency):
        system.check_value()
        if is_negative(kind, system, re, im, vector):
            exact = tuple((Fraction(x.real), Fraction(x.imag)) for x in vector)
            near = "near a pole" if look.has_pole_near(complex(re, im)) else f"near ω = {float(im):.6g}"
            why = f"{BROKEN[kind]} {near} (floating point), exactly so at the witness"
            witness = Witness(kind, re, im, system, exact)
            return Verdict(kind, system, Status.REFUTED, witness=witness, floats=look.system, reason=why)
    return None


def refuted_or_undecided(kind: Kind, system: StateSpace, reason: str) -> Verdict:
    """Verdict on a state space that is not proved: points where the property fails in floats are tried exactly.

    Modes hidden at the ports are not searched.
    """
    from passivity.floats.modes import Modes
    from passivity.floats.system import FloatSystem

    verdict = Verdict(kind, system, Status.UNDECIDED, reason=reason)
    try:
        floats = FloatSystem.of(kind, system)
        look, verdict = Modes(floats), replace(verdict, floats=floats)
        found = _refuted(look, system, look.lowest[1])
        if found is None and verdict.analysis and verdict.analysis.bands:  # narrower ones than the look has seen
            found = _refuted(look, system, verdict.analysis.frequency / floats.unit)
        return verdict if found is None else found
    except (OverflowError, ValueError):  # beyond the range of doubles, or the eigenvalues do not converge
        return verdict
    except UndecidedError as error:
        return replace(verdict, reason=f"{reason}; {error}")


def hidden_modes(network: RationalMatrix | StateSpace) -> fmpz_poly | None:
    """Polynomial of modes with Re s >= 0 that are hidden at the ports; None without such modes.

    For a state space: the uncontrollable or unobservable modes; for a matrix: the factors common
    to numerator and denominator of an entry.
    """
    if isinstance(network, StateSpace):
        if all(len(each.independent_columns()) == network.states for each in (network, network.dual())):
            return None
        return _hidden(network.modes // network.reached()[1].dual().reached()[1].modes)
    found = _ONE
    for entry in (entry for row in network.rows for entry in row):
        if factor := _hidden(_common(entry.p, entry.q)):
            found *= factor // found.gcd(factor)
    return found if found.degree() > 0 else None


def _common(p: fmpz_poly, q: fmpz_poly) -> fmpz_poly:
    return _ONE if coprime(p, q) else p.gcd(q)


def _hidden(common: fmpz_poly) -> fmpz_poly | None:
    """A factor, if it has roots in Re s >= 0."""
    return common if common.degree() > 0 and routh_column(common) is None else None


def from_axis(test: Test, a: fmpz_poly, x0: Fraction) -> Witness:
    """Witness s = sigma + jw above a point of the axis with a(x0) < 0: w rational near sqrt(x0), sigma small enough."""
    w = next(w for w in square_roots(x0) if a(to_fmpq(w * w)) < 0)
    sigma, witness, step = power_of_two(w) if w else Fraction(1), None, 1
    while (witness := test(sigma, w)) is None:
        sigma, step = sigma / 2**step, 2 * step
    while (step := step // 2) > 1:  # back to the largest that will do: fewer digits
        larger = test(sigma * 2 ** (step // 2), w)
        sigma, witness = (larger.re, larger) if larger else (sigma, witness)
    return witness


def from_root(test: Test, f: fmpz_poly) -> Witness:
    """Witness near a root of f in the right half plane: of f = p + q, where Z = -1, or of f = q, where H has a pole."""
    for re, im in candidates(f):
        if re > 0 and (witness := test(re, im)):
            return witness
    raise AssertionError("a polynomial that is not Hurwitz has a root in the right half plane")


def of_one_port(kind: Kind, p: fmpz_poly, q: fmpz_poly, delay: Fraction = Fraction(0)) -> Test:
    """Test whether a point is a witness against p/q; with a delay T, of a reflection against exp(-2Ts) p/q."""

    def test(re: Fraction, im: Fraction) -> Witness | None:
        degree, size = max(p.degree(), q.degree()), max(bits_of(re), bits_of(im))
        spend(10_000 + 5 * (degree + 1) * ((degree + 1) * size + p.height_bits() + q.height_bits()), "a witness")
        (a, b), (c, d) = scaled_value(p, re, im, degree), scaled_value(q, re, im, degree)
        real, size = a * c + b * d, c * c + d * d
        wrong = real < 0 if kind is Kind.PR else a * a + b * b > size
        if not wrong or (not size and q):  # a pole of H by chance: its neighbours have values
            return None
        if size and delay and not arb(fmpq(a * a + b * b - size, size)) > arb(to_fmpq(4 * delay * re)).expm1():
            return None
        if not size:
            return Witness(kind, re, im, None)
        spend(reducing_cost(size.bit_length()), "a witness")
        value = Fraction(int(real), int(size)), Fraction(int(b * c - a * d), int(size))
        return Witness(kind, re, im, (value,))

    return test


def of_multiport(kind: Kind, network: RationalMatrix) -> Test:
    """Test whether a point is a witness, with a vector of few digits."""

    def test(re: Fraction, im: Fraction) -> Witness | None:
        value = network.at(re, im) if re > 0 else None
        if value is None or not (x := negative_direction(form := hermitian_form(kind, value))):
            return None
        vector = _short(form, x) if network.size > 1 else fmpq_mat(2, 1, [1, 0])
        return Witness(kind, re, im, _parts(value * vector), _parts(vector))

    return test


def hermitian_form(kind: Kind, value: fmpq_mat) -> fmpq_mat:
    """Z + Z^H, or I - S^H S, from a value [[U, -V], [V, U]], in the same way of writing."""
    if kind is Kind.PR:
        return value + value.transpose()
    return identity(value.nrows()) - value.transpose() * value


def _short(form: fmpq_mat, x: list[fmpq]) -> fmpq_mat:
    """The vector on the coarsest grid on which the form still is negative."""
    n, largest, bits = len(x), max(map(abs, x)), 1
    while True:
        y = fmpq_mat(n, 1, [fmpq((c * 2**bits / largest + fmpq(1, 2)).floor(), 2**bits) for c in x])
        if (y.transpose() * form * y)[0, 0] < 0:
            return y
        bits *= 2


def _parts(column: fmpq_mat) -> tuple[Parts, ...]:
    parts = [Fraction(int(c.p), int(c.q)) for c in column.entries()]
    return tuple(zip(parts[: len(parts) // 2], parts[len(parts) // 2 :], strict=True))
