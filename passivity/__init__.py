"""Proofs that impedances are positive real and reflections bounded real; knows nothing of lines."""

from passivity.certificate import verify
from passivity.chain import Chain, Step, check_line
from passivity.errors import ExpressionError
from passivity.margin import Margin, Margins, margins
from passivity.positive_real import check_bounded_real, check_positive_real
from passivity.rational import RationalFunction
from passivity.robustness import Robustness, robustness
from passivity.verdict import Certificate, Kind, Status, Verdict, Witness

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
