"""Two spools, a belt and a spring-loaded pulley: exact models, simulation and control; knows nothing of lines.

Names are imported when they are used: most programs need few of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

import tline.exact_numbers  # noqa: F401 (models hold them, and are sent to other processes)

if TYPE_CHECKING:
    from drives.animation import animate
    from drives.answers import exercise
    from drives.control import PI, Bandwidth, Design, Share, alike, decoupled, decoupler, design, relative_gain_array
    from drives.coupled import CoupledDrives
    from drives.derivation import PulleyCheck, check_pulley, wrong_sign
    from drives.energy import Energy
    from drives.linearise import Artefact, artefact, eigenvalues, forward_difference, literal_jacobian, zero_eigenvalues
    from drives.loop import closed_loop, simulate_control
    from drives.modes import HiddenMode, hidden_modes
    from drives.parts import Belt, Pulley, Spool
    from drives.picture import draw_bode, draw_closed_loop, draw_poles, draw_run
    from drives.resonance import Peak, effective_stiffness, largest_friction_with_peak, peak, undamped_frequency
    from drives.simulation import Run, simulate, steady_state
    from drives.slack import simulate_slack
    from drives.stability import Margins, margins
    from drives.state_space import StateSpace
    from drives.symbolic import INPUTS, OUTPUTS, UNITS, symbolic_transfer
    from drives.torque import Torque
    from drives.torque_limit import Reach, reach
    from drives.transfer import TransferFunction
    from tline.errors import InputError

_HOMES = {
    "animation": "animate",
    "loop": "closed_loop simulate_control",
    "control": "PI Bandwidth Design Share alike decoupled decoupler design relative_gain_array",
    "coupled": "CoupledDrives",
    "derivation": "PulleyCheck check_pulley wrong_sign",
    "energy": "Energy",
    "answers": "exercise",
    "linearise": "Artefact artefact eigenvalues forward_difference literal_jacobian zero_eigenvalues",
    "stability": "Margins margins",
    "modes": "HiddenMode hidden_modes",
    "parts": "Belt Pulley Spool",
    "torque_limit": "Reach reach",
    "resonance": "Peak effective_stiffness largest_friction_with_peak peak undamped_frequency",
    "picture": "draw_bode draw_closed_loop draw_poles draw_run",
    "simulation": "Run simulate steady_state",
    "slack": "simulate_slack",
    "state_space": "StateSpace",
    "symbolic": "INPUTS OUTPUTS UNITS symbolic_transfer",
    "torque": "Torque",
    "transfer": "TransferFunction",
}
_HOME = {name: f"drives.{home}" for home, names in _HOMES.items() for name in names.split()}
_HOME["InputError"] = "tline.errors"


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name not in _HOME:
        raise AttributeError(f"module 'drives' has no attribute '{name}'")
    return getattr(import_module(_HOME[name]), name)


__all__ = [
    "INPUTS",
    "OUTPUTS",
    "PI",
    "UNITS",
    "Artefact",
    "Bandwidth",
    "Belt",
    "CoupledDrives",
    "Design",
    "Energy",
    "HiddenMode",
    "InputError",
    "Margins",
    "Peak",
    "Pulley",
    "PulleyCheck",
    "Reach",
    "Run",
    "Share",
    "Spool",
    "StateSpace",
    "Torque",
    "TransferFunction",
    "alike",
    "animate",
    "artefact",
    "check_pulley",
    "closed_loop",
    "decoupled",
    "decoupler",
    "design",
    "draw_bode",
    "draw_closed_loop",
    "draw_poles",
    "draw_run",
    "effective_stiffness",
    "eigenvalues",
    "exercise",
    "forward_difference",
    "hidden_modes",
    "largest_friction_with_peak",
    "literal_jacobian",
    "margins",
    "peak",
    "reach",
    "relative_gain_array",
    "simulate",
    "simulate_control",
    "simulate_slack",
    "steady_state",
    "symbolic_transfer",
    "undamped_frequency",
    "wrong_sign",
    "zero_eigenvalues",
]
