"""Verdicts in words and as plain data; exact numbers are texts, polynomials lists, highest power first."""

import math
from fractions import Fraction
from typing import Any

from passivity.budget import VERDICT, if_affordable
from passivity.errors import shorten
from passivity.exact.certificate import verify
from passivity.exact.robustness import Robustness
from passivity.exact.verdict import Certificate, Margin, Margins, StorageCertificate, Verdict, Witness
from passivity.expression.number import complex_text, digits, written
from passivity.rational.function import RationalFunction
from passivity.rational.state_space import StateSpace
from passivity.status import Kind, Status

_ONE = {"input": "smallest Re Z(jω)", "output": "smallest Re 1/Z(jω)", "reflection": "largest |H(jω)|"}
_SEVERAL = {"input": "smallest eigenvalue of (Z + Zᴴ)/2", "reflection": "largest singular value of S"}


def as_dict(verdict: Verdict, margins: Margins, robust: Robustness | None = None) -> dict[str, Any]:
    """What JSON can hold of a verdict and of what else was asked."""
    function = verdict.function
    told: dict[str, Any] = {"kind": verdict.kind.value, "status": verdict.status.value, "why": verdict.why}
    told |= {"ports": verdict.ports, "lossless": verdict.lossless}
    told["hidden_factor"] = coefficients(verdict.hidden) if verdict.hidden else None
    if isinstance(function, RationalFunction):
        told |= _fraction(function)
    told["margins"] = {name: _margin(margin) for name, margin in margins._asdict().items()}
    if verdict.witness:
        told["witness"] = point(verdict.witness)
    if verdict.status is Status.UNDECIDED and (found := verdict.analysis):
        bands = [[_number(x) for x in band] for band in found.bands]
        told["analysis"] = {name: _number(x) for name, x in vars(found).items() if name != "bands"} | {"bands": bands}
    if verdict.certificate:
        verified = if_affordable(VERDICT, verify, verdict.certificate)
        told["certificate"] = _certificate(verdict.certificate) | {"verified": verified}
    if robust:
        told["robustness"] = {"tolerance": written(robust.tolerance), "same": robust.same}
        told["robustness"]["exception"] = robust.exception and _fraction(robust.exception)
    return told


def point(witness: Witness) -> dict[str, Any]:
    """A witness as texts: of one port with Z or H there, of several with v and the form that is negative."""
    told: dict[str, Any] = {"re": written(witness.re), "im": written(witness.im)}
    if len(witness.vector) == 1:
        value = {"value_re": witness.value_re, "value_im": witness.value_im}
        return told | {name: None if x is None else written(x) for name, x in value.items()}
    assert witness.value is not None
    return told | {"vector": [[written(x) for x in pair] for pair in witness.vector], "value": written(witness.value)}


def coefficients(polynomial: Any) -> list[str]:
    """Of a polynomial, highest power first, as texts."""
    return [str(c) for c in reversed(polynomial.coeffs())] or ["0"]


def _fraction(function: RationalFunction) -> dict[str, list[str]]:
    return {"numerator": coefficients(function.p), "denominator": coefficients(function.q)}


def _certificate(found: Certificate | StorageCertificate) -> dict[str, Any]:
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
    told = {"value": _number(margin.value), "low": written(margin.low), "high": written(margin.high)}
    return told | {"frequency": _number(margin.frequency)}


def _number(x: float) -> float | str:
    return x if math.isfinite(x) else str(x)


def in_lines(verdict: Verdict, margins: Margins, robust: Robustness | None = None, z0: str = "1") -> list[str]:
    """A verdict in words, line by line."""
    several = f", {verdict.ports} ports" if not isinstance(verdict.function, RationalFunction) else ""
    lines = [f"{verdict.kind.value}{several}: {verdict.status.value}", f"  because {verdict.why}"]
    if verdict.witness:
        lines += _witness(verdict.witness)
    if robust:
        words = {True: "the same", False: "not the same for all", None: "not shown to be the same"}[robust.same]
        lines.append(f"  within {digits(robust.tolerance, 3)} of each coefficient: {words}")
        if robust.exception is not None:
            lines.append(f"    such as {shorten(str(robust.exception), 100)}")
    against = f"   H = (Z - z0)/(Z + z0), z0 = {z0}" if verdict.kind is Kind.PR else ""
    for key, margin in margins._asdict().items():
        if margin and several:
            proved = f"proved not beyond {margin.bound:.6g}"
            lines.append(f"  {_SEVERAL[key]} ≈ {margin.value:.6g} at ω = {margin.frequency:.6g} rad/s, {proved}")
        elif margin:
            value = beside_one(margin.low if margin.largest else margin.high)
            sign, tail = "=" if margin.low == margin.high else "≈", against if key == "reflection" else ""
            lines.append(f"  {_ONE[key]:<20} {sign} {value:<12} {_place(verdict, margin)}{tail}")
    return lines


def _witness(found: Witness) -> list[str]:
    lines = [f"  witness s = {complex_text(found.re, found.im)}"]
    if len(found.vector) == 1 and not isinstance(found.found, StateSpace):
        value = "infinite" if found.image is None else complex_text(*found.image[0])
        return [*lines, f"    {found.kind.letter}(s) = {value}"]
    form = "vᴴ(Z + Zᴴ)v" if found.kind is Kind.PR else "|v|² − |Sv|²"
    value = "< 0" if isinstance(found.found, StateSpace) else f"= {digits(found.value or 0)}"  # the first takes long
    return [
        *lines,
        f"    v = ({', '.join(complex_text(*x) for x in found.vector)})",
        f"    {form} {value}",
    ]


def _place(verdict: Verdict, margin: Margin) -> str:
    if verdict.lossless:
        return "for all ω"
    if math.isinf(margin.frequency):
        return "for ω to infinity"
    return f"at ω = {margin.frequency:.6g} rad/s"


def beside_one(x: Fraction | float) -> str:
    """Six digits, and more where they would hide on which side of 1 a number lies."""
    text = digits(x)
    return f"1 {'-' if x < 1 else '+'} {digits(abs(Fraction(x) - 1), 3)}" if text == "1" and x != 1 else text
