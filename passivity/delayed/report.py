"""Verdicts on functions with delays and roots of s as plain data: numbers are texts, balls with their radius."""

from typing import Any

from passivity.budget import VERDICT, if_affordable
from passivity.delayed.boxes import holds
from passivity.delayed.decide import ExpressionVerdict
from passivity.delayed.verify import verify_proof
from passivity.expression.number import written


def expression_as_dict(verdict: ExpressionVerdict) -> dict[str, Any]:
    """What JSON can hold of such a verdict, if it is not rational; its proof is verified anew.

    Examples
    --------
    >>> from passivity.delayed.decide import check_expression
    >>> from passivity.status import Kind
    >>> told = expression_as_dict(check_expression("1 + exp(-s)", Kind.PR))
    >>> told["status"], told["proof"]["verified"]
    ('proved', True)
    """
    told: dict[str, Any] = {
        "kind": verdict.kind.value,
        "status": verdict.status.value,
        "why": verdict.why,
        "function": str(verdict.form),
    }
    if verdict.pole:
        told[verdict.pole.word] = verdict.pole.place.str(20)
    if verdict.proof:
        verified = if_affordable(VERDICT, verify_proof, verdict.proof)
        told["proof"] = {"steps": list(verdict.proof.lines()), "verified": verified}
    if verdict.balls:
        told["balls"] = {
            "radius": written(verdict.balls.radius),
            "cuts": [written(cut) for cut in verdict.balls.cuts],
            "verified": if_affordable(VERDICT, holds, verdict.balls),
        }
    if found := verdict.witness:
        told["witness"] = {"re": written(found.re), "im": written(found.im), "value": found.value.str(20)}
    if margin := verdict.margin:
        told["margin"] = {
            "attained": margin.attained.str(20),
            "bound": None if margin.bound is None else written(margin.bound),
            "frequency": margin.frequency,
        }
    return told
