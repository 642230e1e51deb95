import drives as drives
import friction as friction
import passivity as passivity
from tline.errors import (
    ActiveError as ActiveError,
    InputError as InputError,
    MissingExtraError as MissingExtraError,
    NoFlowError as NoFlowError,
    SceneError as SceneError,
)
from tline.exercises.answer import exercise as exercise
from tline.interchange.any_file import read as read
from tline.line import ElectricalLine as ElectricalLine, HydraulicLine as HydraulicLine
from tline.pictures.traces import plot as plot
from tline.scene.scene import Scene as Scene
from tline.shipped import examples as examples
from tline.solver.prepared import Prepared as Prepared, prepare as prepare
from tline.solver.result.result import Result as Result
from tline.solver.simulate import simulate as simulate
from tline.surge.operation import Operation as Operation, operate as operate
from tline.surge.study import SurgeStudy as SurgeStudy, surge_study as surge_study
from tline.sweeps import InterruptedWarning as InterruptedWarning, Sweep as Sweep, sweep as sweep

from . import (
    design as design,
    frequency as frequency,
    interchange as interchange,
    loss as loss,
    pictures as pictures,
    scene as scene,
    signal as signal,
    study as study,
)

__version__: str
