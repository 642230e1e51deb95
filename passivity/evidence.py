"""One way to verify every proof, whatever it is about."""

from typing import Any, TypeAlias

from passivity.calculus.proof import Proof, verify_proof
from passivity.calculus.witness import check_file
from passivity.delayed.boxes import FORMAT as FORMAT_OF_BALLS
from passivity.delayed.boxes import BallProof, from_file, holds
from passivity.exact.certificate import verify as verify_exact
from passivity.exact.verdict import Certificate, StorageCertificate
from passivity.verifier import FORMAT, check

Evidence: TypeAlias = Certificate | StorageCertificate | Proof | BallProof


def verify(evidence: Evidence) -> bool:
    """Whether the facts in a certificate or a proof hold and make a proof, checked by other means than the prover's.

    Parameters
    ----------
    evidence : Certificate, StorageCertificate, dict or BallProof
        ``certificate`` of a verdict on rational functions and matrices, ``proof`` or ``balls`` of one on expressions.

    Examples
    --------
    >>> from passivity import Kind, RationalFunction, check_expression, check_positive_real
    >>> verify(check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")).certificate)
    True
    >>> verify(check_expression("1 + exp(-s)", Kind.PR).proof)
    True
    """
    if isinstance(evidence, dict):
        return verify_proof(evidence)
    return holds(evidence) if isinstance(evidence, BallProof) else verify_exact(evidence)


def check_evidence(told: dict[str, Any]) -> str | None:
    """None if a proof or a witness, as its file is read, shows what it says; else what is wrong."""
    if told["format"] == FORMAT_OF_BALLS:
        try:
            return None if holds(from_file(told)) else "the balls do not make a proof"
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            return f"not a proof: {error}"
    return check(told) if told["format"] == FORMAT else check_file(told)
