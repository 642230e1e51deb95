"""Verdicts for all values of parameters as plain data; exact numbers are texts."""

from typing import Any

from passivity.expression.number import written
from passivity.symbolic.verdict import SymbolicVerdict


def symbolic_as_dict(verdict: SymbolicVerdict) -> dict[str, Any]:
    """What JSON can hold of such a verdict.

    Examples
    --------
    >>> from passivity.status import Kind
    >>> from passivity.symbolic.check import check_symbolic
    >>> symbolic_as_dict(check_symbolic("k", Kind.PR, ["k real"]))["condition"]
    'k >= 0'
    """
    found = verdict.counterexample
    return {
        "kind": verdict.kind.value,
        "status": verdict.status.value,
        "why": verdict.why,
        "assumed": [str(r) for r in verdict.ranges],
        "condition": str(verdict.condition) if verdict.condition else None,
        "proof": list(verdict.proof),
        "counterexample": found
        and {
            "values": {name: written(value) for name, value in found.values.items()},
            "witness": {key: None if part is None else written(part) for key, part in vars(found.witness).items()},
            "delay": written(found.delay),
        },
        "note": verdict.note,
    }
