"""Verdicts in words, with their reasons, and as plain data: numbers as texts, polynomials from the highest power."""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import acb, fmpz_poly

from passivity import discrete
from passivity.budget import VERDICT, if_affordable
from passivity.errors import shorten
from passivity.exact.positive_real import BROKEN
from passivity.exact.robustness import Robustness
from passivity.expression.number import beside_one, complex_text, digits, written
from passivity.polynomial.roots import positive_roots, roots_on_axis, routh_column, violations
from passivity.polynomial.sign import allowance, product, squarefree
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import degree
from passivity.rational.state_space import StateSpace
from passivity.status import Kind, Status
from passivity.verdict import Margin, Margins, StorageCertificate, Verdict, Witness
from tline.presentation import SCREEN

_MARGINS = {"input": "smallest Re Z(jω)", "output": "smallest Re 1/Z(jω)", "reflection": "largest |H(jω)|"}
_OF_SEVERAL = {"input": "smallest eigenvalue of (Z + Zᴴ)/2", "reflection": "largest singular value of S"}
# of one port and of several: the property on the axis, with equality, its contrary, and what has its poles in Re s < 0
_ONE = {
    Kind.PR: ("Re Z(jω) >= 0", "Re Z(jω) = 0", "Re Z(jω) < 0", "roots of p + q"),
    Kind.BR: ("|H(jω)| <= 1", "|H(jω)| = 1", "|H(jω)| > 1", "roots of the denominator"),
}
_SEVERAL = {
    Kind.PR: ("Z + Z^H >= 0", "Z + Z^H = 0", BROKEN[Kind.PR], "poles of (Z + I)^-1"),
    Kind.BR: ("S^H S <= I", "S^H S = I", BROKEN[Kind.BR], "poles of S"),
}
EXTREME = {Kind.PR: "the smallest eigenvalue of (Z + Z^H)/2", Kind.BR: "the largest singular value of S"}
MOST_NAMED = 4  # bands or frequencies in one sentence


def as_dict(verdict: Verdict, margins: Margins, robust: Robustness | None = None) -> dict[str, Any]:
    """Verdict, margins and robustness as a dictionary for JSON."""
    from passivity.calculus.proof import verify

    function, witness, found = verdict.function, verdict.witness, verdict.certificate
    told: dict[str, Any] = {"kind": verdict.kind.value, "status": verdict.status.value, "why": verdict.why}
    told |= {"statement": verdict.statement} if verdict.statement else {}
    told |= {"ports": verdict.ports, "lossless": verdict.lossless}
    told["hidden_factor"] = coefficients(verdict.hidden) if verdict.hidden else None
    if isinstance(function, RationalFunction):
        told |= _fraction(function)
    told["margins"] = {name: _margin(margin) for name, margin in margins._asdict().items()}
    if witness:
        told["witness"] = witness.in_texts() | ((verdict.evidence or {}) if function is None else {})
    if verdict.status is Status.UNDECIDED and (seen := verdict.analysis):
        bands = [[_number(x) for x in band] for band in seen.bands]
        told["analysis"] = {name: _number(x) for name, x in vars(seen).items() if name != "bands"} | {"bands": bands}
    if found:
        verified = if_affordable(VERDICT, verify, found)
        proof = {"proof": found, "verified": verified}
        told |= proof if verdict.proof else {"certificate": _certificate(found) | {"verified": verified}}
    told |= {"note": verdict.note} if verdict.note or function is None else {}
    if function is None:
        condition = str(verdict.condition) if verdict.condition else None
        told |= {"assumed": [str(r) for r in verdict.ranges], "condition": condition, "steps": list(verdict.steps)}
    if robust:
        told["robustness"] = {"tolerance": written(robust.tolerance), "same": robust.same}
        told["robustness"]["exception"] = robust.exception and _fraction(robust.exception)
    return told


def coefficients(polynomial: Any) -> list[str]:
    """Coefficients of a polynomial as texts, highest power first."""
    return [str(c) for c in reversed(polynomial.coeffs())] or ["0"]


def _fraction(function: RationalFunction) -> dict[str, list[str]]:
    return {"numerator": coefficients(function.p), "denominator": coefficients(function.q)}


def _certificate(found: Any) -> dict[str, Any]:
    if isinstance(found, tuple):
        return {"modes": [mode.to_dict() for mode in found]}
    if isinstance(found, StorageCertificate):
        matrices = {"basis": found.basis, "storage": found.storage}
        return {key: [[str(x) for x in row] for row in m.tolist()] for key, m in matrices.items() if m is not None}
    return {
        "sums": [
            {
                "sum": coefficients(x.a),
                "power": x.power,
                "sign_factors": [{"factor": coefficients(f), "power": power} for f, power in x.sign.factors],
                "sign_breaks": [written(b) for b in x.sign.breaks],
            }
            for x in found.sums
        ],
        "closing": coefficients(found.closing),
        "routh_column": [pivot.str(12) for pivot in found.column],
    }


def _margin(margin: Margin | None) -> dict[str, Any] | None:
    if margin is None:
        return None
    ends = {"low": margin.low, "high": margin.high}
    told = {"value": _number(margin.value)} | {name: None if x is None else written(x) for name, x in ends.items()}
    return told | {"frequency": _number(margin.frequency)}


def _number(x: float) -> float | str:
    return x if math.isfinite(x) else str(x)


def in_lines(verdict: Verdict, margins: Margins, robust: Robustness | None = None, z0: str = "1") -> list[str]:
    """A verdict in words, line by line, with as many steps of its proof as a screen has room for."""
    several = f", {verdict.ports} ports" if verdict.ports > 1 or _is_matrix(verdict) else ""
    lines = [f"{verdict.kind.value}{verdict.region}{several}: {verdict.status.value}", f"  because {verdict.why}"]
    lines += ["  with z = (1 + s)/(1 - s)"] if verdict.is_discrete and (verdict.proof or verdict.steps) else []
    lines += [f"  exactly if {verdict.condition}"] if verdict.condition else []
    if verdict.witness:
        lines += _witness(verdict.witness)
    if robust:
        words = {True: "the same", False: "not the same for all", None: "not shown to be the same"}[robust.same]
        lines.append(f"  within {digits(robust.tolerance, 3)} of each coefficient: {words}")
        if robust.exception is not None:
            lines.append(f"    such as {shorten(str(robust.exception), 100)}")
    lines += [_margin_line(verdict, key, margin, z0) for key, margin in margins._asdict().items() if margin]
    note = [f"  note: {verdict.note}"] if verdict.note else []
    return lines + _first_steps(verdict, SCREEN - len(lines) - len(note)) + note


def _is_matrix(verdict: Verdict) -> bool:
    return verdict.function is not None and not isinstance(verdict.function, RationalFunction)


def _first_steps(verdict: Verdict, room: int) -> list[str]:
    """Steps of a proof, as many as there is room for lines; the last line says how many more there are."""
    from passivity.calculus.proof import lines

    steps = list(lines(verdict.proof)) if verdict.proof else verdict.steps
    shown = len(steps) if len(steps) <= room else room - 1
    told = [f"    {line}" for line in steps[:shown]]
    return told + ([f"    … and {len(steps) - shown} more steps"] if len(steps) > shown else [])


def _witness(found: Witness) -> list[str]:
    lines = [f"  {name} = {written(x)}" for name, x in found.names.items()]
    place = f"within {digits(found.spot.radius, 3)} of " if found.spot else ""
    name = found.variable
    lines.append(f"  witness {place}{name} = {complex_text(found.re, found.im)}")
    if isinstance(found.found, acb):
        return [*lines, f"    {found.kind.letter}({name}) = {found.found.str(12)}"]
    if len(found.vector) == 1 and not isinstance(found.found, StateSpace):
        value = "infinite" if found.image is None else complex_text(*found.image[0])
        return [*lines, f"    {found.kind.letter}({name}) = {value}"]
    form = "vᴴ(Z + Zᴴ)v" if found.kind is Kind.PR else "|v|² − |Sv|²"
    negative: Any = isinstance(found.found, StateSpace) or found.form  # of a state space the value takes long
    v = ", ".join(complex_text(*map(Fraction, x)) for x in found.vector)
    return [
        *lines,
        f"    v = ({v})",
        f"    {form} {f'= {digits(negative)}' if isinstance(negative, Fraction) else '< 0'}",
    ]


def _margin_line(verdict: Verdict, key: str, margin: Margin, z0: str) -> str:
    where = f"at θ = {margin.frequency:.6g} rad" if verdict.is_discrete else f"at ω = {margin.frequency:.6g} rad/s"
    name = _MARGINS[key].replace("jω", "e^jθ") if verdict.is_discrete else _MARGINS[key]
    if _is_matrix(verdict):
        return f"  {_OF_SEVERAL[key]} ≈ {margin.value:.6g} {where}, proved not beyond {margin.bound:.6g}"
    if verdict.function is None:
        bound = margin.high if margin.largest else margin.low
        known = ", sampled" if bound is None else f", proved not to pass {digits(bound)}"
        value = f"{margin.value:.6g}"
        return f"  {name:<20} {'about' if bound is None else '≈'} {value:<12} {where}{known}"
    value = beside_one(margin.low if margin.largest else margin.high)
    sign = "=" if margin.low == margin.high else "≈"
    against = f"   H = (Z - z0)/(Z + z0), z0 = {z0}" if verdict.kind is Kind.PR and key == "reflection" else ""
    if verdict.lossless:
        where = f"for all {'θ' if verdict.is_discrete else 'ω'}"
    elif math.isinf(margin.frequency):
        where = "for ω to infinity"
    return f"  {name:<20} {sign} {value:<12} {where}{against}"


def reason(verdict: Verdict) -> str:
    """Reason of a verdict, with frequencies ω in rad per unit of time."""
    if verdict.in_s is not None:
        return _outside(verdict, verdict.in_s)
    kind, network = verdict.kind, verdict.function
    bounded, equal, broken, closing = (_ONE if isinstance(network, RationalFunction) else _SEVERAL)[kind]
    if verdict.status is Status.UNDECIDED:
        return "; ".join(filter(None, (verdict.reason, verdict.analysis and _seen(verdict))))
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
    if kind is Kind.BR:
        return f"{'H' if verdict.ports == 1 else 'S'} has a pole in Re s > 0{_hidden(verdict)}"
    if isinstance(network, RationalFunction):
        return _fault(network.reduced()) + _hidden(verdict)
    return _fault_of_matrix(network.transfer if isinstance(network, StateSpace) else network)


def _outside(verdict: Verdict, inner: Verdict) -> str:
    """The reason of a verdict on a function of z, from that on the function of s."""
    if found := verdict.witness:
        if isinstance(found.found, acb) and inner.witness and inner.reason == inner.witness.why:
            return found.why
        if isinstance(found.found, StateSpace):
            near = f"near θ = {abs(math.atan2(found.im, found.re)):.6g}"
            return f"{BROKEN[verdict.kind]} {near} (floating point), exactly so at the witness"
    return discrete.in_words(replace(inner, hidden=None).why) + _hidden(verdict)


def _hidden(verdict: Verdict) -> str:
    if verdict.hidden is None or not isinstance(verdict.function, RationalFunction):
        return ""
    factor = (
        str(verdict.hidden)
        .replace("x", "z" if verdict.is_discrete else "s")
        .replace("(-", "-")
        .replace("+ -", "- ")
        .replace(")", "")
    )
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
    """Analysis of several ports in floating point, as a sentence."""
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
    for root, power in roots_on_axis(q.right_shift(order)):
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
    rest = f.right_shift(next(k for k, c in enumerate(f.coeffs()) if c))
    return 2 * sum(power for _, power in roots_on_axis(rest)) == rest.degree()


def in_words(intervals: Sequence[tuple[float, float]]) -> str:
    """Intervals of w, the first MOST_NAMED of them."""
    return listed([_band(low, high) for low, high in intervals])


def listed(items: Sequence[str]) -> str:
    """The first MOST_NAMED of some items, and how many more there are."""
    more = len(items) - MOST_NAMED
    return ", ".join(items[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _band(low: float, high: float) -> str:
    if f"{low:.6g}" == f"{high:.6g}":
        return f"in a narrow band at ω = {low:.12g}"
    if low == 0:
        return "for all ω" if high == math.inf else f"for ω < {high:.6g}"
    return f"for ω > {low:.6g}" if high == math.inf else f"for {low:.6g} < ω < {high:.6g}"
