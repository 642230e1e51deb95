from tline.scene.air_valve import AirValve as AirValve
from tline.scene.cable_loss import CableTable as CableTable, LossTangent as LossTangent, Skin as Skin, Wire as Wire
from tline.scene.cavities import Cavities as Cavities
from tline.scene.characteristic import Curve as Curve, Diode as Diode
from tline.scene.coupled import Coupled as Coupled, OneMode as OneMode, SkinMatrix as SkinMatrix
from tline.scene.elements import *  # noqa: F403
from tline.scene.file import schema as schema
from tline.scene.friction import (
    Darcy as Darcy,
    Laminar as Laminar,
    Linear as Linear,
    QuasiSteady as QuasiSteady,
    VardyBrown as VardyBrown,
    Zielke as Zielke,
)
from tline.scene.heights import Site as Site
from tline.scene.line import Cable as Cable, Creep as Creep, Pipe as Pipe
from tline.scene.load import (
    Matched as Matched,
    NoFlow as NoFlow,
    Reservoir as Reservoir,
    Short as Short,
    Switch as Switch,
)
from tline.scene.measure import Probe as Probe
from tline.scene.multiport import (
    ControlledSource as ControlledSource,
    CoupledInductors as CoupledInductors,
    Gyrator as Gyrator,
    Junction as Junction,
    Transformer as Transformer,
)
from tline.scene.outflow import Demand as Demand, Leak as Leak
from tline.scene.pump import Pump as Pump
from tline.scene.rational import (
    Capacitor as Capacitor,
    Impedance as Impedance,
    Inductor as Inductor,
    Parallel as Parallel,
    Resistor as Resistor,
    Series as Series,
)
from tline.scene.scene import Scene as Scene, Solver as Solver
from tline.scene.shape import Constant as Constant, Step as Step
from tline.scene.source import Source as Source
from tline.scene.touchstone import MeasuredMultiport as MeasuredMultiport, Touchstone as Touchstone
from tline.scene.user_defined import UserLink as UserLink, UserLoad as UserLoad
from tline.scene.valve import CheckValve as CheckValve, Orifice as Orifice, ReliefValve as ReliefValve
from tline.scene.vessel import (
    AirVessel as AirVessel,
    Cavity as Cavity,
    SurgeTank as SurgeTank,
    VapourCavity as VapourCavity,
)
from tline.scene.waveform import (
    DoubleExponential as DoubleExponential,
    Exponential as Exponential,
    PiecewiseLinear as PiecewiseLinear,
    Pulses as Pulses,
    Ramp as Ramp,
    Sine as Sine,
    Table as Table,
)
