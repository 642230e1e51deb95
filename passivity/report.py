"""Verdicts as plain data, with all their evidence; exact numbers are texts, polynomials lists, highest power first."""

import math
from typing import Any

from passivity.budget import VERDICT, if_affordable
from passivity.delayed.chain import Chain
from passivity.expression.number import written
from passivity.one_port.certificate import verify
from passivity.one_port.margin import Margin, Margins
from passivity.one_port.robustness import Robustness
from passivity.one_port.verdict import Verdict, Witness


def as_dict(verdict: Verdict, margins: Margins, robust: Robustness | None, chain: Chain | None) -> dict[str, Any]:
    """What JSON can hold of a verdict and of what else was asked."""
    told: dict[str, Any] = {
        "kind": verdict.kind.value,
        "status": verdict.status.value,
        "why": verdict.why,
        "lossless": verdict.lossless,
        "hidden_factor": _list(verdict.hidden) if verdict.hidden else None,
        "numerator": _list(verdict.function.p),
        "denominator": _list(verdict.function.q),
        "margins": {name: _margin(margin) for name, margin in margins._asdict().items()},
    }
    if verdict.witness:
        told["witness"] = _witness(verdict.witness)
    if verdict.certificate:
        c = verdict.certificate
        told["certificate"] = {
            "cancelled": _list(c.common),
            "sign_factors": [{"factor": _list(f), "power": power} for f, power in c.sign.factors],
            "sign_breaks": [written(x) for x in c.sign.breaks],
            "routh_column": [pivot.str(12) for pivot in c.column],
            "verified": if_affordable(VERDICT, verify, c),
        }
    if robust:
        exception = robust.exception
        told["robustness"] = {
            "tolerance": written(robust.tolerance),
            "same": robust.same,
            "exception": exception and {"numerator": _list(exception.p), "denominator": _list(exception.q)},
        }
    if chain is not None:
        told["line"] = {
            "z0": written(chain.z0),
            "delay": written(chain.delay),
            "status": chain.status.value,
            "steps": [{"claim": x.claim, "status": x.status.value, "reason": x.reason} for x in chain.steps],
        }
        if chain.witness:  # the value is that of H2
            told["line"]["witness"] = _witness(chain.witness)
    return told


def _witness(witness: Witness) -> dict[str, str | None]:
    return {key: None if part is None else written(part) for key, part in vars(witness).items()}


def _list(polynomial: Any) -> list[str]:
    return [str(c) for c in reversed(polynomial.coeffs())] or ["0"]


def _margin(margin: Margin | None) -> dict[str, Any] | None:
    if margin is None:
        return None
    value, frequency = (x if math.isfinite(x) else str(x) for x in (margin.value, margin.frequency))
    return {"value": value, "low": written(margin.low), "high": written(margin.high), "frequency": frequency}
