"""Proofs that impedances are positive real and reflections bounded real; knows nothing of lines."""

from passivity.delayed.chain import Chain, Step, check_line
from passivity.errors import ExpressionError
from passivity.one_port.certificate import verify
from passivity.one_port.margin import Margin, Margins, margins
from passivity.one_port.positive_real import check_bounded_real, check_positive_real
from passivity.one_port.robustness import Robustness, robustness
from passivity.one_port.verdict import Certificate, Verdict, Witness
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status

__all__ = [
    "Certificate",
    "Chain",
    "ExpressionError",
    "Kind",
    "Margin",
    "Margins",
    "RationalFunction",
    "Robustness",
    "Status",
    "Step",
    "Verdict",
    "Witness",
    "check_bounded_real",
    "check_line",
    "check_positive_real",
    "margins",
    "robustness",
    "verify",
]
