"""Types of the scene that go on through the solver as they are."""

from tline.scene.air_valve import AIR_VOLUME, AirValve
from tline.scene.coupled import End
from tline.scene.element import Between
from tline.scene.heights import NO_HEIGHT, Height
from tline.scene.law import OPENING, Bend, ElementLaw, Governor, LawKind, Volume, kinds_numbered
from tline.scene.line import SceneLine
from tline.scene.load import Matched, Reservoir, Resistor, Short, Switch
from tline.scene.measure import Extent, Interval, LevelCrossing, Measure, Probe, Signal
from tline.scene.medium import Medium, readable
from tline.scene.multiport import Multiport, Ports
from tline.scene.pipe_table import PipeTable
from tline.scene.plausible import plausibility_notes
from tline.scene.rational import Ratio, RationalImpedance
from tline.scene.scene import Scene
from tline.scene.shape import Constant, Shape
from tline.scene.source import Source
from tline.scene.stretches import Stretches, stretches_of
from tline.scene.touchstone import Touchstone
from tline.scene.vessel import GAS_VOLUME, AirVessel
