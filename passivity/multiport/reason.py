"""The reason of a verdict on several ports in plain words."""

from flint import fmpz_poly

from passivity.multiport.axis_analysis import AxisAnalysis
from passivity.multiport.bands import bands, in_words
from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.polynomial_matrix import degree
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import MatrixVerdict, StorageCertificate, StrictCertificate
from passivity.one_port.axis import parts
from passivity.one_port.hurwitz import routh_column
from passivity.one_port.polynomial_sign import squarefree
from passivity.one_port.real_roots import positive_roots
from passivity.status import Kind, Status

_BOUNDED = {Kind.PR: "Z + Z^H >= 0", Kind.BR: "S^H S <= I"}
_EQUAL = {Kind.PR: "Z + Z^H = 0", Kind.BR: "S^H S = I"}
_BROKEN = {Kind.PR: "Z + Z^H has a negative eigenvalue", Kind.BR: "S has a singular value above 1"}
_EXTREME = {Kind.PR: "the smallest eigenvalue of (Z + Z^H)/2", Kind.BR: "the largest singular value of S"}
_CLOSING = {Kind.PR: "(Z + I)^-1", Kind.BR: "S"}


def reason(verdict: MatrixVerdict) -> str:
    """Why a verdict is what it is, frequencies ω in rad per unit of time.

    Examples
    --------
    >>> from passivity.multiport.positive_real import check_positive_real_matrix
    >>> reason(check_positive_real_matrix(RationalMatrix.from_rows([["1", "2/(s + 1)"], ["2/(s + 1)", "1"]])))
    'Z + Z^H has a negative eigenvalue for ω < 1'
    """
    kind, network = verdict.kind, verdict.network
    if verdict.status is Status.UNDECIDED:
        return "; ".join(filter(None, (verdict.budget, verdict.analysis and _seen(kind, verdict.analysis))))
    if isinstance(verdict.certificate, StorageCertificate):
        return "all energy that enters is stored: the stored energy is x^T P x/2 >= 0"
    if isinstance(verdict.certificate, StrictCertificate):
        return "the stored energy x^T P x grows by less than what enters, P > 0"
    if verdict.status is Status.PROVED:
        axis = (_EQUAL if verdict.lossless else _BOUNDED)[kind]
        return f"{axis} for all ω, and all poles of {_CLOSING[kind]} lie in Re s < 0"
    if verdict.negative:
        return f"{_BROKEN[kind]} {bands(verdict.negative)}"
    if verdict.analysis:
        where = in_words(verdict.analysis.bands) if verdict.analysis.bands else "near a pole"
        return f"{_BROKEN[kind]} {where} (floating point), exactly so at the witness"
    if kind is Kind.BR:
        return "S has a pole in Re s > 0"
    return _fault(network.transfer if isinstance(network, StateSpace) else network)


def _seen(kind: Kind, analysis: AxisAnalysis) -> str:
    """What floating point sees."""
    value = f"{_EXTREME[kind]} is {analysis.value:.6g} ± {analysis.value_error:.1g} at ω = {analysis.frequency:.6g}"
    bands = f", {_BROKEN[kind]} {in_words(analysis.bands)}" if analysis.bands else ""
    methods = "two methods that agree" if analysis.agree else "two methods that disagree"
    return (
        f"in floating point, by {methods}, {value}{bands}; all eigenvalues of A have Re s <= {analysis.rightmost:.3g}"
    )


def _fault(z: RationalMatrix) -> str:
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
