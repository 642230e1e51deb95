"""Verdicts in words and as plain data; exact numbers are texts, polynomials lists, highest power first."""

import math
from fractions import Fraction
from typing import Any

from passivity.budget import VERDICT, if_affordable
from passivity.expression.number import complex_text, digits, written
from passivity.one_port.certificate import verify
from passivity.one_port.margin import Margin, Margins
from passivity.one_port.robustness import Robustness
from passivity.one_port.verdict import Verdict, Witness

_ROWS = (("input", "smallest Re Z(jω)"), ("output", "smallest Re 1/Z(jω)"), ("reflection", "largest |H(jω)|"))


def as_dict(verdict: Verdict, margins: Margins, robust: Robustness | None = None) -> dict[str, Any]:
    """What JSON can hold of a verdict and of what else was asked."""
    told: dict[str, Any] = {
        "kind": verdict.kind.value,
        "status": verdict.status.value,
        "why": verdict.why,
        "lossless": verdict.lossless,
        "hidden_factor": coefficients(verdict.hidden) if verdict.hidden else None,
        "numerator": coefficients(verdict.function.p),
        "denominator": coefficients(verdict.function.q),
        "margins": {name: _margin(margin) for name, margin in margins._asdict().items()},
    }
    if verdict.witness:
        told["witness"] = point(verdict.witness)
    if verdict.certificate:
        c = verdict.certificate
        told["certificate"] = {
            "cancelled": coefficients(c.common),
            "sign_factors": [{"factor": coefficients(f), "power": power} for f, power in c.sign.factors],
            "sign_breaks": [written(x) for x in c.sign.breaks],
            "routh_column": [pivot.str(12) for pivot in c.column],
            "verified": if_affordable(VERDICT, verify, c),
        }
    if robust:
        exception = robust.exception
        told["robustness"] = {
            "tolerance": written(robust.tolerance),
            "same": robust.same,
            "exception": exception
            and {"numerator": coefficients(exception.p), "denominator": coefficients(exception.q)},
        }
    return told


def point(witness: Witness) -> dict[str, str | None]:
    """A witness as texts."""
    return {key: None if part is None else written(part) for key, part in vars(witness).items()}


def coefficients(polynomial: Any) -> list[str]:
    """Of a polynomial, highest power first, as texts."""
    return [str(c) for c in reversed(polynomial.coeffs())] or ["0"]


def _margin(margin: Margin | None) -> dict[str, Any] | None:
    if margin is None:
        return None
    value, frequency = (x if math.isfinite(x) else str(x) for x in (margin.value, margin.frequency))
    return {"value": value, "low": written(margin.low), "high": written(margin.high), "frequency": frequency}


def in_lines(verdict: Verdict, margins: Margins, robust: Robustness | None = None, z0: str = "1") -> list[str]:
    """A verdict in words, line by line."""
    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    if verdict.witness:
        w = verdict.witness
        letter = "Z" if verdict.kind == "positive real" else "H"
        value = "infinite" if w.value_re is None else complex_text(w.value_re, w.value_im or Fraction(0))
        lines += [f"  witness s = {complex_text(w.re, w.im)}", f"    {letter}(s) = {value}"]
    if robust:
        words = {True: "the same", False: "not the same for all", None: "not shown to be the same"}[robust.same]
        lines.append(f"  within {digits(robust.tolerance, 3)} of each coefficient: {words}")
        if robust.exception is not None:
            lines.append(f"    such as {_short(str(robust.exception))}")
    rows = [(name, getattr(margins, key)) for key, name in _ROWS]
    against = f"   H = (Z - z0)/(Z + z0), z0 = {z0}" if verdict.kind == "positive real" else ""
    for name, margin in rows:
        if margin is not None:
            sign = "=" if margin.low == margin.high else "≈"
            tail = against if name.startswith("largest") else ""
            lines.append(f"  {name:<20} {sign} {_number(margin):<12} {_place(verdict, margin)}{tail}")
    return lines


def _place(verdict: Verdict, margin: Margin) -> str:
    if verdict.lossless:
        return "for all ω"
    if math.isinf(margin.frequency):
        return "for ω to infinity"
    return f"at ω = {margin.frequency:.6g} rad/s"


def _number(margin: Margin) -> str:
    """Six digits, and more where they would hide on which side of 1 a number lies."""
    text = digits(margin.middle)
    if text == "1" and margin.low != 1:
        return f"1 {'-' if margin.low < 1 else '+'} {digits(abs(Fraction(margin.low) - 1), 3)}"
    return text


def _short(text: str) -> str:
    return text if len(text) <= 100 else text[:97] + "..."
