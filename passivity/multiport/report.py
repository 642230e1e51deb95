"""Verdicts on several ports in words and as plain data; exact numbers are texts, polynomials highest power first."""

import math
from typing import Any

from passivity.budget import VERDICT, if_affordable
from passivity.expression.number import complex_text, digits, written
from passivity.multiport.certificate import verify
from passivity.multiport.margin import MatrixMargin
from passivity.multiport.verdict import Certificate, MatrixVerdict, StorageCertificate, StrictCertificate
from passivity.one_port.report import coefficients
from passivity.status import Kind


def as_dict(verdict: MatrixVerdict, margin: MatrixMargin | None) -> dict[str, Any]:
    """What JSON can hold of a verdict, its margin and its evidence.

    Examples
    --------
    >>> from passivity.multiport.ideal import gyrator_impedances
    >>> from passivity.multiport.positive_real import check_positive_real_matrix
    >>> as_dict(check_positive_real_matrix(gyrator_impedances(5)), None)["certificate"]["verified"]
    True
    """
    told: dict[str, Any] = {
        "kind": verdict.kind.value,
        "ports": verdict.network.size,
        "status": verdict.status.value,
        "why": verdict.why,
        "lossless": verdict.lossless,
        "hidden_factor": coefficients(verdict.hidden) if verdict.hidden else None,
        "margin": margin and {name: _number(x) for name, x in margin._asdict().items()},
    }
    if witness := verdict.witness:
        told["witness"] = {
            "re": written(witness.re),
            "im": written(witness.im),
            "vector": [[written(x) for x in pair] for pair in witness.vector],
            "value": written(witness.value),
        }
    if verdict.analysis:
        bands = [[_number(x) for x in band] for band in verdict.analysis.bands]
        told["analysis"] = {name: _number(x) for name, x in vars(verdict.analysis).items() if name != "bands"}
        told["analysis"] |= {"bands": bands}
    if verdict.certificate:
        told["certificate"] = _certificate(verdict.certificate) | {
            "verified": if_affordable(VERDICT, verify, verdict.certificate)
        }
    return told


def _certificate(certificate: Certificate) -> dict[str, Any]:
    if isinstance(certificate, StorageCertificate):
        return {
            "basis": [[str(x) for x in row] for row in certificate.basis.tolist()],
            "storage": [[str(x) for x in row] for row in certificate.storage.tolist()],
        }
    if isinstance(certificate, StrictCertificate):
        return {"storage": [[str(x) for x in row] for row in certificate.storage.tolist()]}
    return {
        "minor_sums": [
            {
                "sum": coefficients(x.a),
                "power": x.power,
                "sign_factors": [{"factor": coefficients(f), "power": power} for f, power in x.sign.factors],
                "sign_breaks": [written(b) for b in x.sign.breaks],
            }
            for x in certificate.sums
        ],
        "closing": coefficients(certificate.closing),
        "routh_column": [pivot.str(12) for pivot in certificate.column],
    }


def _number(x: float) -> float | str:
    return x if math.isfinite(x) else str(x)


def in_lines(verdict: MatrixVerdict, margin: MatrixMargin | None) -> list[str]:
    """A verdict in words, line by line."""
    lines = [f"{verdict.kind.value}, {verdict.network.size} ports: {verdict.status.value}", f"  because {verdict.why}"]
    if w := verdict.witness:
        vector = ", ".join(complex_text(re, im) for re, im in w.vector)
        form = "vᴴ(Z + Zᴴ)v" if verdict.kind is Kind.PR else "|v|² − |Sv|²"
        lines += [
            f"  witness s = {complex_text(w.re, w.im)}",
            f"    v = ({vector})",
            f"    {form} = {digits(w.value)}",
        ]
    if margin:
        name = "smallest eigenvalue of (Z + Zᴴ)/2" if verdict.kind is Kind.PR else "largest singular value of S"
        proved = f"proved not beyond {margin.bound:.6g}"
        lines.append(f"  {name} ≈ {margin.value:.6g} at ω = {margin.frequency:.6g} rad/s, {proved}")
    return lines
