"""One way to verify every proof, whatever it is about."""

from typing import TypeAlias

from passivity.calculus.proof import Proof, verify_proof
from passivity.delayed.boxes import BallProof, holds
from passivity.multiport.certificate import verify as verify_matrix
from passivity.multiport.verdict import MinorCertificate, StorageCertificate, StrictCertificate
from passivity.one_port.certificate import verify as verify_one_port
from passivity.one_port.verdict import Certificate

Evidence: TypeAlias = Certificate | MinorCertificate | StorageCertificate | StrictCertificate | Proof | BallProof


def verify(evidence: Evidence) -> bool:
    """Whether the facts in a certificate or a proof hold and make a proof, checked by other means than the prover's.

    Parameters
    ----------
    evidence : Certificate, MinorCertificate, StorageCertificate, StrictCertificate, dict or BallProof
        ``certificate`` of a verdict on rational functions and matrices, ``proof`` or ``balls`` of one on expressions.

    Examples
    --------
    >>> from passivity import Kind, RationalFunction, check_expression, check_positive_real
    >>> verify(check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")).certificate)
    True
    >>> verify(check_expression("1 + exp(-s)", Kind.PR).proof)
    True
    """
    if isinstance(evidence, MinorCertificate | StorageCertificate | StrictCertificate):
        return verify_matrix(evidence)
    if isinstance(evidence, dict):
        return verify_proof(evidence)
    return holds(evidence) if isinstance(evidence, BallProof) else verify_one_port(evidence)
