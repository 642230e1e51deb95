"""The reason of a verdict in plain words: which band, pole, residue or degree decides."""

from flint import fmpz_poly

from passivity.exact.verdict import StorageCertificate, Verdict
from passivity.polynomial.bands import in_words, listed, violations
from passivity.polynomial.hurwitz import routh_column
from passivity.polynomial.roots import positive_roots
from passivity.polynomial.sign import allowance, parts, product, squarefree
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import degree
from passivity.rational.state_space import StateSpace
from passivity.status import Kind, Status

# of one port and of several: the property on the axis, with equality, its contrary, and what has its poles in Re s < 0
_ONE = {
    Kind.PR: ("Re Z(jω) >= 0", "Re Z(jω) = 0", "Re Z(jω) < 0", "roots of p + q"),
    Kind.BR: ("|H(jω)| <= 1", "|H(jω)| = 1", "|H(jω)| > 1", "roots of the denominator"),
}
_SEVERAL = {
    Kind.PR: ("Z + Z^H >= 0", "Z + Z^H = 0", "Z + Z^H has a negative eigenvalue", "poles of (Z + I)^-1"),
    Kind.BR: ("S^H S <= I", "S^H S = I", "S has a singular value above 1", "poles of S"),
}
EXTREME = {Kind.PR: "the smallest eigenvalue of (Z + Z^H)/2", Kind.BR: "the largest singular value of S"}


def reason(verdict: Verdict) -> str:
    """Why a verdict is what it is, frequencies ω in rad per unit of time."""
    kind, network = verdict.kind, verdict.function
    bounded, equal, broken, closing = (_ONE if isinstance(network, RationalFunction) else _SEVERAL)[kind]
    if verdict.status is Status.UNDECIDED:
        return "; ".join(filter(None, (verdict.budget, verdict.analysis and _seen(verdict))))
    if isinstance(verdict.certificate, StorageCertificate):
        if verdict.lossless:
            return "all energy that enters is stored: the stored energy is x^T P x/2 >= 0"
        return "the stored energy x^T P x grows by less than what enters, P > 0"
    if verdict.status is Status.PROVED:
        axis = f"{equal} for all ω" if verdict.lossless else f"{bounded} for all ω"
        if isinstance(network, RationalFunction):
            axis += " (lossless)" if verdict.lossless else _touched(network, kind)
        return f"{axis}, and all {closing} lie in Re s < 0{_hidden(verdict)}"
    if verdict.negative:
        return f"{broken} {in_words(violations(verdict.negative))}{_hidden(verdict)}"
    if verdict.place:
        return f"{broken} {verdict.place} (floating point), exactly so at the witness"
    if kind is Kind.BR:
        return f"{'H' if verdict.ports == 1 else 'S'} has a pole in Re s > 0{_hidden(verdict)}"
    if isinstance(network, RationalFunction):
        return _fault(network.reduced()) + _hidden(verdict)
    return _fault_of_matrix(network.transfer if isinstance(network, StateSpace) else network)


def _hidden(verdict: Verdict) -> str:
    if verdict.hidden is None or not isinstance(verdict.function, RationalFunction):
        return ""
    factor = str(verdict.hidden).replace("x", "s").replace("(-", "-").replace("+ -", "- ").replace(")", "")
    return f"; the common factor {factor} is a hidden mode that does not die out"


def _touched(function: RationalFunction, kind: Kind) -> str:
    """At which frequencies there is equality."""
    p, q = function.p, function.q
    a = allowance(kind, p, q)
    a //= a.gcd(product(q, q))  # at a pole Re Z is not zero, though A is
    even = [f for f, power in squarefree(a) if power % 2 == 0 and f[0]]
    touched = [0.0] * (not a[0]) + sorted(root.frequency for f in even for root in positive_roots(f))
    return f" (equal at ω = {listed([f'{w:.6g}' for w in touched])})" if touched else ""


def _seen(verdict: Verdict) -> str:
    """What floating point sees of several ports."""
    kind, found = verdict.kind, verdict.analysis
    assert found
    value = f"{EXTREME[kind]} is {found.value:.6g} ± {found.value_error:.1g} at ω = {found.frequency:.6g}"
    bands = f", {_SEVERAL[kind][2]} {in_words(found.bands)}" if found.bands else ""
    methods = "two methods that agree" if found.agree else "two methods that disagree"
    return f"in floating point, by {methods}, {value}{bands}; all eigenvalues of A have Re s <= {found.rightmost:.3g}"


def _fault(z: RationalFunction) -> str:
    """Which pole of p/q is wrong, if Re p conj q >= 0 on the axis; p and q coprime."""
    p, q = z.p, z.q
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


def _fault_of_matrix(z: RationalMatrix) -> str:
    """Which pole of Z is wrong, where Z + Z^H >= 0 on the axis and yet Z is not positive real."""
    n, d = z.fraction
    mirrored = d.gcd(d(fmpz_poly([0, -1])))
    if routh_column(d // mirrored) is None or not _on_axis(mirrored):
        return "Z has a pole in Re s > 0"
    places = ["on the axis"] * (mirrored.degree() > 0) + ["at infinity"] * (degree(n, d) > d.degree())
    return f"Z has a pole {' or '.join(places)} that is not simple with a nonnegative Hermitian residue"


def _on_axis(f: fmpz_poly) -> bool:
    """Whether all roots of a polynomial, which come with their mirror images, lie on the imaginary axis."""
    rest = parts(f.right_shift(next(k for k, c in enumerate(f.coeffs()) if c)))[0]
    found = [(g, power) for g, power in squarefree(rest) if g.degree() > 0]
    return sum(power * len(positive_roots(g)) for g, power in found) == rest.degree()
