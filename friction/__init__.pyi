from friction.fit import Fit as Fit
from friction.hunting import Swing as Swing, harmonic_damping as harmonic_damping, swings as swings
from friction.identification import Identification as Identification, identify as identify
from friction.methods import METHODS as METHODS, Method as Method
from friction.models import (
    MODELS as MODELS,
    Coulomb as Coulomb,
    Dahl as Dahl,
    ElastoPlastic as ElastoPlastic,
    Karnopp as Karnopp,
    LuGre as LuGre,
    Model as Model,
    Tanh as Tanh,
)
from friction.predict import (
    Chatter as Chatter,
    DeadZone as DeadZone,
    Limits as Limits,
    dead_zone as dead_zone,
    euler_chatter as euler_chatter,
    limits as limits,
    lugre_drift as lugre_drift,
    passive_damping as passive_damping,
    tanh_creep as tanh_creep,
)
from friction.prescribed import Prescribed as Prescribed, prescribe as prescribe
from friction.result import (
    Cycle as Cycle,
    Event as Event,
    Kind as Kind,
    Ledger as Ledger,
    Result as Result,
    Status as Status,
)
from friction.simulation import simulate as simulate
from friction.spring_contact import Armstrong as Armstrong, MaxwellSlip as MaxwellSlip
from friction.testbench import (
    PID as PID,
    Force as Force,
    Ramp as Ramp,
    Sine as Sine,
    Spring as Spring,
    Steps as Steps,
    Table as Table,
    Testbench as Testbench,
)
from tline.errors import InputError as InputError
