from drives.control import (
    PI as PI,
    Bandwidth as Bandwidth,
    Design as Design,
    Margins as Margins,
    design as design,
    margins as margins,
)
from drives.coupled import CoupledDrives as CoupledDrives
from drives.decoupling import (
    Share as Share,
    alike as alike,
    decoupled as decoupled,
    decoupler as decoupler,
    relative_gain_array as relative_gain_array,
)
from drives.derivation import PulleyCheck as PulleyCheck, check_pulley as check_pulley, wrong_sign as wrong_sign
from drives.energy import Energy as Energy
from drives.feedback import (
    Sensitivities as Sensitivities,
    closed_loop as closed_loop,
    sampled_poles as sampled_poles,
    sensitivities as sensitivities,
)
from drives.linearise import (
    Artefact as Artefact,
    artefact as artefact,
    forward_difference as forward_difference,
    literal_jacobian as literal_jacobian,
    zero_eigenvalues as zero_eigenvalues,
)
from drives.loop import simulate_control as simulate_control
from drives.parts import Belt as Belt, Pulley as Pulley, Spool as Spool, Winding as Winding
from drives.picture import draw_bode as draw_bode, draw_poles as draw_poles, draw_run as draw_run
from drives.resonance import (
    HiddenMode as HiddenMode,
    Peak as Peak,
    effective_stiffness as effective_stiffness,
    hidden_modes as hidden_modes,
    largest_friction_with_peak as largest_friction_with_peak,
    peak as peak,
    undamped_frequency as undamped_frequency,
)
from drives.simulation import Run as Run, simulate as simulate, steady_state as steady_state
from drives.state_space import StateSpace as StateSpace
from drives.symbolic import INPUTS as INPUTS, OUTPUTS as OUTPUTS, UNITS as UNITS, symbolic_transfer as symbolic_transfer
from drives.torque import Torque as Torque
from drives.torque_limit import Reach as Reach, reach as reach
from drives.transfer import TransferFunction as TransferFunction
from tline.errors import InputError as InputError
