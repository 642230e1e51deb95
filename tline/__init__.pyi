import drives as drives
import friction as friction
import passivity as passivity
from tline.errors import ActiveError as ActiveError
from tline.errors import InputError as InputError
from tline.errors import MissingExtraError as MissingExtraError
from tline.errors import NoFlowError as NoFlowError
from tline.errors import SceneError as SceneError
from tline.exercises.answer import exercise as exercise
from tline.interchange.any_file import read as read
from tline.line import ElectricalLine as ElectricalLine
from tline.line import HydraulicLine as HydraulicLine
from tline.pictures.traces import plot as plot
from tline.scene.scene import Scene as Scene
from tline.shipped import examples as examples
from tline.solver.prepared import Prepared as Prepared
from tline.solver.prepared import prepare as prepare
from tline.solver.result.result import Result as Result
from tline.solver.simulate import simulate as simulate
from tline.surge.operation import Operation as Operation
from tline.surge.operation import operate as operate
from tline.surge.study import SurgeStudy as SurgeStudy
from tline.surge.study import surge_study as surge_study
from tline.sweeps import InterruptedWarning as InterruptedWarning
from tline.sweeps import Sweep as Sweep
from tline.sweeps import sweep as sweep

from . import design as design
from . import frequency as frequency
from . import interchange as interchange
from . import loss as loss
from . import pictures as pictures
from . import scene as scene
from . import signal as signal
from . import study as study

__version__: str
