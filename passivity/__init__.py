"""Proofs that impedances are positive real and reflections bounded real; knows nothing of lines.

Names are imported when they are used: most programs need few of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

import tline.exact_numbers  # noqa: F401 (verdicts hold them, and are sent to other processes)

if TYPE_CHECKING:
    from passivity.delayed.chain import Chain, Step, check_line
    from passivity.delayed.decide import ExpressionVerdict, check_expression
    from passivity.delayed.roots import roots_right
    from passivity.errors import ExpressionError
    from passivity.evidence import verify
    from passivity.multiport.cayley import impedances, scattering
    from passivity.multiport.ideal import (
        circulator_scattering,
        gyrator_impedances,
        gyrator_scattering,
        transformer_scattering,
    )
    from passivity.multiport.line_two_port import check_line_two_port
    from passivity.multiport.matrix import RationalMatrix
    from passivity.multiport.measured import MeasuredNetwork, fit_scattering
    from passivity.multiport.positive_real import check_bounded_real_matrix, check_positive_real_matrix
    from passivity.multiport.state_space import StateSpace
    from passivity.one_port.margin import Margin, Margins, margins
    from passivity.one_port.positive_real import check_bounded_real, check_positive_real
    from passivity.one_port.robustness import Robustness, robustness
    from passivity.one_port.verdict import Certificate, Verdict, Witness
    from passivity.rational.function import RationalFunction
    from passivity.sampled.behind_delay import DelayedModel, fit_behind_delay
    from passivity.sampled.check import SampleVerdict, check_samples
    from passivity.sampled.enforce import Enforced, enforce
    from passivity.sampled.fit import fit
    from passivity.sampled.matrix_model import MatrixModel, fit_matrix
    from passivity.sampled.model import PoleResidueModel
    from passivity.sampled.read import read_csv, read_touchstone
    from passivity.sampled.response import SampledResponse
    from passivity.status import Kind, Status
    from passivity.symbolic.assumption import Range, parse_assumption
    from passivity.symbolic.check import check_symbolic
    from passivity.symbolic.counterexample import Counterexample
    from passivity.symbolic.identities import admittance_identity, reflection_identity
    from passivity.symbolic.verdict import Condition, SymbolicVerdict

_HOMES = {
    "delayed.chain": "Chain Step check_line",
    "delayed.decide": "ExpressionVerdict check_expression",
    "delayed.roots": "roots_right",
    "errors": "ExpressionError",
    "evidence": "verify",
    "multiport.cayley": "impedances scattering",
    "multiport.ideal": "circulator_scattering gyrator_impedances gyrator_scattering transformer_scattering",
    "multiport.line_two_port": "check_line_two_port",
    "multiport.matrix": "RationalMatrix",
    "multiport.measured": "MeasuredNetwork fit_scattering",
    "multiport.positive_real": "check_bounded_real_matrix check_positive_real_matrix",
    "multiport.state_space": "StateSpace",
    "one_port.margin": "Margin Margins margins",
    "one_port.positive_real": "check_bounded_real check_positive_real",
    "one_port.robustness": "Robustness robustness",
    "one_port.verdict": "Certificate Verdict Witness",
    "rational.function": "RationalFunction",
    "sampled.behind_delay": "DelayedModel fit_behind_delay",
    "sampled.check": "SampleVerdict check_samples",
    "sampled.enforce": "Enforced enforce",
    "sampled.fit": "fit",
    "sampled.matrix_model": "MatrixModel fit_matrix",
    "sampled.model": "PoleResidueModel",
    "sampled.read": "read_csv read_touchstone",
    "sampled.response": "SampledResponse",
    "status": "Kind Status",
    "symbolic.assumption": "Range parse_assumption",
    "symbolic.check": "check_symbolic",
    "symbolic.counterexample": "Counterexample",
    "symbolic.identities": "admittance_identity reflection_identity",
    "symbolic.verdict": "Condition SymbolicVerdict",
}
_HOME = {name: home for home, names in _HOMES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name not in _HOME:
        raise AttributeError(f"module 'passivity' has no attribute '{name}'")
    return getattr(import_module(f"passivity.{_HOME[name]}"), name)


__all__ = [
    "Certificate",
    "Chain",
    "Condition",
    "Counterexample",
    "DelayedModel",
    "Enforced",
    "ExpressionError",
    "ExpressionVerdict",
    "Kind",
    "Margin",
    "Margins",
    "MatrixModel",
    "MeasuredNetwork",
    "PoleResidueModel",
    "Range",
    "RationalFunction",
    "RationalMatrix",
    "Robustness",
    "SampleVerdict",
    "SampledResponse",
    "StateSpace",
    "Status",
    "Step",
    "SymbolicVerdict",
    "Verdict",
    "Witness",
    "admittance_identity",
    "check_bounded_real",
    "check_bounded_real_matrix",
    "check_expression",
    "check_line",
    "check_line_two_port",
    "check_positive_real",
    "check_positive_real_matrix",
    "check_samples",
    "check_symbolic",
    "circulator_scattering",
    "enforce",
    "fit",
    "fit_behind_delay",
    "fit_matrix",
    "fit_scattering",
    "gyrator_impedances",
    "gyrator_scattering",
    "impedances",
    "margins",
    "parse_assumption",
    "read_csv",
    "read_touchstone",
    "reflection_identity",
    "robustness",
    "roots_right",
    "scattering",
    "transformer_scattering",
    "verify",
]
