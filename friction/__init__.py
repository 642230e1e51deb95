"""Friction models on a testbench, exact where they can be, and predictions of where methods fail."""

from friction.armstrong import Armstrong
from friction.fit import Fit
from friction.hunting import Swing, harmonic_damping, swings
from friction.identify import Identification, identify
from friction.maxwell import MaxwellSlip
from friction.methods import METHODS, Method
from friction.models import MODELS, Coulomb, Dahl, ElastoPlastic, Karnopp, LuGre, Model, Tanh
from friction.predict import (
    Chatter,
    DeadZone,
    Limits,
    dead_zone,
    euler_chatter,
    limits,
    lugre_drift,
    passive_damping,
    tanh_creep,
)
from friction.prescribe import Prescribed, prescribe
from friction.result import Cycle, Event, Kind, Ledger, Result, Status
from friction.simulate import simulate
from friction.testbench import PID, Force, Ramp, Sine, Spring, Steps, Table, Testbench
from tline.errors import InputError

__all__ = [
    "METHODS",
    "MODELS",
    "PID",
    "Armstrong",
    "Chatter",
    "Coulomb",
    "Cycle",
    "Dahl",
    "DeadZone",
    "ElastoPlastic",
    "Event",
    "Fit",
    "Force",
    "Identification",
    "InputError",
    "Karnopp",
    "Kind",
    "Ledger",
    "Limits",
    "LuGre",
    "MaxwellSlip",
    "Method",
    "Model",
    "Prescribed",
    "Ramp",
    "Result",
    "Sine",
    "Spring",
    "Status",
    "Steps",
    "Swing",
    "Table",
    "Tanh",
    "Testbench",
    "dead_zone",
    "euler_chatter",
    "harmonic_damping",
    "identify",
    "limits",
    "lugre_drift",
    "passive_damping",
    "prescribe",
    "simulate",
    "swings",
    "tanh_creep",
]
