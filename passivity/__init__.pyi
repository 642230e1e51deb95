from passivity.calculus.ask import is_bounded_real as is_bounded_real, is_positive_real as is_positive_real
from passivity.calculus.derivation import (
    Derivation as Derivation,
    admittance_identity as admittance_identity,
    derive as derive,
    reflection_identity as reflection_identity,
)
from passivity.calculus.proof import verify as verify
from passivity.calculus.sector import is_dissipative as is_dissipative, is_in_sector as is_in_sector
from passivity.delayed.line import check_line as check_line, check_line_two_port as check_line_two_port
from passivity.delayed.roots import roots_right as roots_right
from passivity.errors import ExpressionError as ExpressionError
from passivity.exact.margin import margins as margins
from passivity.exact.positive_real import (
    check_bounded_real as check_bounded_real,
    check_positive_real as check_positive_real,
)
from passivity.exact.robustness import Robustness as Robustness, robustness as robustness
from passivity.rational.function import RationalFunction as RationalFunction
from passivity.rational.matrix import (
    RationalMatrix as RationalMatrix,
    impedances as impedances,
    scattering as scattering,
)
from passivity.rational.state_space import StateSpace as StateSpace
from passivity.sampled.check import SampleVerdict as SampleVerdict, check_samples as check_samples
from passivity.sampled.enforce import Enforced as Enforced, enforce as enforce, nearest as nearest
from passivity.sampled.fit import fit as fit
from passivity.sampled.measured import DelayedModel as DelayedModel, fit_scattering as fit_scattering
from passivity.sampled.model import PoleResidueModel as PoleResidueModel
from passivity.sampled.read import read_csv as read_csv, read_touchstone as read_touchstone
from passivity.sampled.response import SampledResponse as SampledResponse
from passivity.status import Kind as Kind, Status as Status
from passivity.symbolic.assumption import Range as Range, parse_assumption as parse_assumption
from passivity.symbolic.formula import Condition as Condition
from passivity.verdict import (
    Certificate as Certificate,
    Margin as Margin,
    Margins as Margins,
    Verdict as Verdict,
    Witness as Witness,
)
