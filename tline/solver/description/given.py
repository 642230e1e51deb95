"""Types of the scene that go on through the solver as they are."""

from tline.scene.coupled import End
from tline.scene.element import Between, Measured
from tline.scene.heights import NO_HEIGHT, Height
from tline.scene.law import AIR_VOLUME, GAS_VOLUME, OPENING, Bend, ElementLaw, Governor, LawKind, Volume, kinds_numbered
from tline.scene.line import SceneLine
from tline.scene.load import Matched, Reservoir, Short, Switch
from tline.scene.measure import Extent, Interval, LevelCrossing, Measure, Probe, Signal
from tline.scene.medium import Medium, readable
from tline.scene.pipe_table import PipeTable
from tline.scene.plausible import plausibility_notes
from tline.scene.polyline import Tabled
from tline.scene.ports import Multiport, Ports
from tline.scene.rational import Ratio, RationalImpedance, Resistor
from tline.scene.scene import Scene
from tline.scene.shape import Constant, Shape, Straight
from tline.scene.source import Source
from tline.scene.stretches import Stretches, stretches_of
