"""One way to verify every proof, whatever it is about."""

from typing import Any, TypeAlias

from passivity.calculus.proof import Proof, verify_proof
from passivity.calculus.witness import check_file
from passivity.delayed.boxes import ALL_RULES
from passivity.exact.certificate import verify as verify_exact
from passivity.exact.verdict import Certificate, StorageCertificate
from passivity.verifier import FORMAT, check

Evidence: TypeAlias = Certificate | StorageCertificate | Proof


def verify(evidence: Evidence) -> bool:
    """Whether the facts in a certificate or a proof hold and make a proof, checked by other means than the prover's.

    Parameters
    ----------
    evidence : Certificate, StorageCertificate or dict
        ``certificate`` of a verdict on rational functions and matrices, ``proof`` of one on expressions.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real, is_positive_real
    >>> verify(check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")).certificate)
    True
    >>> verify(is_positive_real("1 + exp(-s)").proof)
    True
    """
    return verify_proof(evidence) if isinstance(evidence, dict) else verify_exact(evidence)


def check_evidence(told: dict[str, Any]) -> str | None:
    """None if a proof or a witness, as its file is read, shows what it says; else what is wrong."""
    return check(told, ALL_RULES) if told["format"] == FORMAT else check_file(told)
