"""Compiled code of the package: it knows arrays and numbers and nothing else."""

from friction.kernel.automaton import automaton
from friction.kernel.diagram import (
    FRICTION,
    HELD,
    INPUT,
    NET,
    PRODUCT,
    STATE,
    SUM,
    SWITCH,
    Diagram,
    HybridRun,
    Inputs,
    N,
    Sampled,
    unsampled,
)
from friction.kernel.fixed import march, passed
from friction.kernel.law import (
    BLOWN_UP,
    BRISTLE,
    BUDGET,
    DONE,
    FA,
    FF,
    INACCURATE,
    MODE,
    SIGN,
    STALLED,
    TANH,
    ZONE,
    Drive,
    Law,
    Z,
    applied,
    friction,
    jacobian,
    mode_of,
    push_at,
    respond,
    steady,
)
from friction.kernel.prescribed import Course, deflect, prescribed_run
from friction.kernel.rodas import TERMS
from friction.kernel.roots import first_root
from friction.kernel.series import TERMS as TAYLOR_TERMS
from friction.kernel.structures import RUN, Bench, SmoothRun, compared, fixed_run
from friction.kernel.tolerance import solve
