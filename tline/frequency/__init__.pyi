from tline.frequency.delay_system import DelaySystem as DelaySystem
from tline.frequency.oscillations import Resonance as Resonance, resonances as resonances
from tline.frequency.ports import (
    ScatteringParameters as ScatteringParameters,
    impedance as impedance,
    scattering_parameters as scattering_parameters,
)
from tline.frequency.response import ProbeResponse as ProbeResponse, Response as Response, respond as respond
from tline.solver.description.passive import taken_power as taken_power
