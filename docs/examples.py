"""An example of each element and waveform for the scene reference, each read as part of a scene before it is shown."""

import shutil
import tempfile
import tomllib
from pathlib import Path

from tline.scene.file import scene_from

LINES = {
    "hydraulic": {"pipe": {"nodes": ["near", "far"], "z0": 1e7, "delay": 1}},
    "electrical": {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": 1}},
}
MEASURED = [Path(__file__).parents[1] / "scenes" / name for name in ("antenna.s1p", "filter.s2p", "memory.ibs")]
HYDRAULIC = {
    "Pipe": """\
[lines.pipe]
nodes = ["near", "far"]
length = "300 m"
diameter = "200 mm"
fluid = "water"
temperature = "12 degC"
wall = "steel"
wall_thickness = "6 mm"
""",
    "Site": """\
[nodes.near]
position = [120, 45.5]
""",
    "Reservoir": """\
[loads.tank]
at = "near"
kind = "reservoir"
pressure = "6 bar"
""",
    "Switch": """\
[loads.outlet]
at = "far"
kind = "valve"             # in an electrical scene "switch"
before = "90 bar/(m^3/s)"
after = inf                # shut
time = "0.2 s"
""",
    "Orifice": """\
[loads.outlet]
at = "far"
kind = "orifice"
kv = 120
opening = { shape = "ramp", from = 1, to = 0, at = "2 ns", duration = "5 ns" }
characteristic = [[0, 0], [0.5, 0.2], [1, 1]]
""",
    "CheckValve": """\
[loads.inlet]              # drains the node above 1 bar
at = "far"
kind = "check valve"
back_pressure = "1 bar"
kv = 60
""",
    "ReliefValve": """\
[loads.relief]
at = "far"
kind = "relief valve"
set_pressure = "12 bar"
band = "1 bar"
flow = "20 L/s"
pressure_drop = "13 bar"
""",
    "Leak": """\
[loads.burst]
at = "far"
kind = "leak"
flow = "2 L/s"
pressure = "5 bar"
opening = { shape = "step", to = 1, at = "1 ns" }
""",
    "Demand": """\
[loads.houses]
at = "far"
kind = "demand"
flow = "3 L/s"
required_pressure = "2 bar"
""",
    "AirVessel": """\
[loads.vessel]
at = "far"
kind = "air vessel"
gas_volume = "200 L"
gas_pressure = "5 bar"
""",
    "SurgeTank": """\
[loads.shaft]
at = "far"
kind = "surge tank"
tank_diameter = "3 m"
""",
    "Cavity": """\
[loads.summit]
at = "far"
kind = "cavity"
gas_volume = "1 mL"
""",
    "VapourCavity": """\
[loads.summit]
at = "far"
kind = "vapour cavity"
""",
    "AirValve": """\
[loads.summit]
at = "far"
kind = "air valve"
inlet_diameter = "100 mm"
outlet_diameter = "10 mm"
""",
    "OrificeLink": """\
[links.bend]               # a minor loss
nodes = ["near", "far"]
kind = "orifice"
loss_coefficient = 0.9
diameter = "20 cm"
""",
    "CheckValveLink": """\
[links.flap]
nodes = ["near", "far"]
kind = "check valve"
""",
    "RegulatingValve": """\
[links.reducer]            # a pressure reducing valve
nodes = ["near", "far"]
kind = "regulating valve"
keeps = "downstream"
set_pressure = "3 bar"
kv = 100
""",
    "ReliefValveLink": """\
[links.bypass]
nodes = ["near", "far"]
kind = "relief valve"
set_pressure = "3 bar"
band = "0.5 bar"
kv = 20
""",
    "Pump": """\
[links.pump]
nodes = ["near", "far"]
kind = "pump"
curve = [[0, "6 bar"], ["50 L/s", "5 bar"]]
trip = "2 ns"
inertia = "2 kg m^2"
rated_speed = "24 Hz"
check_valve = true
""",
    "Exponential": """\
[sources.pump]             # runs down
at = "near"
kind = "flow"
value = { shape = "exponential", from = "20 L/s", to = 0, at = "1 s", time_constant = "3 s" }
""",
    "PiecewiseLinear": """\
[sources.pump]
at = "near"
kind = "pressure"
value = { shape = "piecewise linear", points = [[0, "3 bar"], ["1 s", "5 bar"], ["4 s", "4 bar"]] }
""",
}
ELECTRICAL = {
    "Cable": """\
[lines.cable]
nodes = ["near", "far"]
z0 = "50 ohm"
velocity_factor = "66 %"
length = "10 m"

[lines.measured]           # or by a table of R(f) and L(f)
nodes = ["a", "b"]
length = "2 m"
capacitance = "100 pF/m"
tabulated = { file = "cable.csv", tolerance = "1 %" }
""",
    "Coupled": """\
[lines.traces]
nodes1 = ["near", "a"]
nodes2 = ["far", "b"]
length = "0.2 m"
inductance = [["310 nH/m", "60 nH/m"], ["60 nH/m", "310 nH/m"]]
capacitance = [["130 pF/m", "-13 pF/m"], ["-13 pF/m", "130 pF/m"]]

[lines.pair]               # or a symmetric pair by its modes
nodes1 = ["c", "d"]
nodes2 = ["e", "f"]
length = "0.2 m"
even = { z0 = "60 ohm", delay = "1.1 ns", resistance = "14 ohm/m" }
odd = { z0 = "40 ohm", delay = "0.9 ns", resistance = "10 ohm/m" }
""",
    "Source": """\
[sources.driver]
at = "near"
kind = "voltage"
value = "1 V"
resistance = "50 ohm"

[sources.offset]           # in series with what is behind the line
nodes = ["receiver", "far"]
kind = "voltage"
value = "0.2 V"

[loads.receiver]
at = "receiver"
kind = "resistor"
resistance = "50 ohm"
""",
    "NoFlow": """\
[loads.end]
at = "far"
kind = "open"              # in a hydraulic scene "closed"
""",
    "Short": """\
[loads.end]
at = "far"
kind = "short"
""",
    "Matched": """\
[loads.end]
at = "far"
kind = "matched"
""",
    "Resistor": """\
[loads.end]
at = "far"
kind = "resistor"
resistance = "75 ohm"
""",
    "Inductor": """\
[loads.bias]               # a choke that feeds direct current
at = "far"
kind = "inductor"
inductance = "10 uH"
""",
    "Capacitor": """\
[loads.receiver]
at = "far"
kind = "capacitor"
capacitance = "1.5 pF"
""",
    "Series": """\
[loads.end]
at = "far"
kind = "series"
resistance = "10 ohm"
inductance = "50 nH"
""",
    "Parallel": """\
[loads.receiver]
at = "far"
kind = "parallel"
resistance = "10 kohm"
capacitance = "4 pF"
""",
    "Impedance": """\
[loads.antenna]
at = "far"
kind = "impedance"
expression = "R + s*L + 1/(s*C)"
parameters = { R = "30 ohm", L = "20 nH", C = "5 pF" }
""",
    "Ibis": """\
[loads.memory]
at = "far"
kind = "ibis"
file = "memory.ibs"
pin = "A1"
corner = "min"
bits = "0110100"           # without bits it receives
bit = "1 ns"
""",
    "Touchstone": """\
[loads.antenna]
at = "far"
kind = "touchstone"
file = "antenna.s1p"
""",
    "Diode": """\
[loads.clamp]
at = "far"
kind = "diode"
saturation = "1e-14 A"
""",
    "Curve": """\
[loads.receiver]
at = "far"
kind = "table"
points = [["-1 V", "-20 mA"], [0, 0], ["3 V", "1 mA"], ["4 V", "30 mA"]]
""",
    "DiodeLink": """\
[links.clamp]
nodes = ["near", "far"]
kind = "diode"
saturation = "1e-14 A"
""",
    "CurveLink": """\
[links.coupler]
nodes = ["near", "far"]
kind = "table"
points = [[-1, "-1 mA"], [1, "1 mA"], [2, "20 mA"]]
""",
    "ResistorLink": """\
[links.series]             # between the line and a receiver of 1.5 pF
nodes = ["far", "receiver"]
kind = "resistor"
resistance = "33 ohm"

[loads.receiver]
at = "receiver"
kind = "capacitor"
capacitance = "1.5 pF"
""",
    "InductorLink": """\
[links.bond]
nodes = ["far", "die"]
kind = "inductor"
inductance = "0.8 nH"

[loads.die]
at = "die"
kind = "resistor"
resistance = "50 ohm"
""",
    "CapacitorLink": """\
[links.coupling]
nodes = ["far", "receiver"]
kind = "capacitor"
capacitance = "100 nF"

[loads.receiver]
at = "receiver"
kind = "resistor"
resistance = "50 ohm"
""",
    "SeriesLink": """\
[links.stub]               # passes what is near its resonance at 225 MHz
nodes = ["near", "far"]
kind = "series"
resistance = "1 ohm"
inductance = "50 nH"
capacitance = "10 pF"
""",
    "ParallelLink": """\
[links.trap]               # stops what is near its resonance at 225 MHz
nodes = ["far", "load"]
kind = "parallel"
inductance = "50 nH"
capacitance = "10 pF"

[loads.load]
at = "load"
kind = "resistor"
resistance = "50 ohm"
""",
    "ImpedanceLink": """\
[links.ferrite]            # an inductor beside the resistance of its core's losses
nodes = ["far", "load"]
kind = "impedance"
expression = "R0 + s*L*R/(R + s*L)"
parameters = { R0 = "0.1 ohm", R = "600 ohm", L = "1 uH" }

[loads.load]
at = "load"
kind = "resistor"
resistance = "50 ohm"
""",
    "SwitchLink": """\
[links.breaker]
nodes = ["far", "motor"]
kind = "switch"            # in a hydraulic scene "valve"
before = "1 mohm"
after = inf                # open
time = "10 ns"

[loads.motor]
at = "motor"
kind = "series"
resistance = "2 ohm"
inductance = "5 mH"
""",
    "Transformer": """\
[links.balun]              # from the line to a floating dipole
nodes = ["far", "reference", "arm1", "arm2"]
kind = "transformer"
ratio = 0.5                # raises the voltage to twice the line's

[loads.reference]
at = "reference"
kind = "short"

[links.dipole]
nodes = ["arm1", "arm2"]
kind = "resistor"
resistance = "200 ohm"

[loads.arm1]
at = "arm1"
kind = "resistor"
resistance = "1 kohm"

[loads.arm2]
at = "arm2"
kind = "resistor"
resistance = "1 kohm"
""",
    "Gyrator": """\
[links.gyrator]
nodes = ["near", "far"]
kind = "gyrator"
resistance = "50 ohm"
""",
    "ControlledSource": """\
[links.amplifier]          # from the end of the line to its beginning: a loop
nodes = ["far", "near"]
kind = "controlled source"
gain = -0.5
resistance = "50 ohm"
""",
    "CoupledInductors": """\
[links.windings]
nodes = ["near", "far"]
kind = "coupled inductors"
inductance = ["1 uH", "4 uH"]
coupling = 0.98
""",
    "Junction": """\
[links.circulator]         # what comes from far goes to near, and what comes from near into the load
nodes = ["near", "load", "far"]
kind = "junction"
z0 = "50 ohm"
scattering = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]

[loads.load]
at = "load"
kind = "resistor"
resistance = "50 ohm"
""",
    "MeasuredMultiport": """\
[links.filter]
nodes = ["near", "far"]
kind = "touchstone"
file = "filter.s2p"
nearest = true
""",
    "Probe": """\
[probes.end]
at = "far"

[probes.quarter]
line = "cable"
position = "25 %"
""",
    "Extent": """\
[measures.settled]
kind = "mean"
probe = "far"
start = "8 ns"
""",
    "Instant": """\
[measures.received]
kind = "crossing"
probe = "far"
level = "500 mV"
edge = "rise"
""",
    "Interval": """\
[measures.passage]
kind = "delay"
start = { probe = "near", level = "0.5 V", edge = "rise" }
stop = { probe = "far", level = "0.5 V", edge = "rise" }
""",
    "Value": """\
[measures.sampled]
kind = "value"
probe = "far"
at = "6 ns"
""",
    "Constant": """\
[sources.battery]
at = "near"
kind = "voltage"
value = { shape = "constant", level = "12 V" }  # or simply value = "12 V"
""",
    "Step": """\
[sources.driver]
at = "near"
kind = "voltage"
resistance = "50 ohm"
value = { shape = "step", to = "1 V", at = "2 ns" }
""",
    "Ramp": """\
[sources.driver]
at = "near"
kind = "voltage"
resistance = "50 ohm"
value = { shape = "ramp", from = "0.2 V", to = "3.3 V", at = "1 ns", duration = "0.5 ns" }
""",
    "Table": """\
[sources.measured]
at = "near"
kind = "current"
value = { shape = "table", file = "measured.csv" }
""",
    "Pulses": """\
[sources.clock]
at = "near"
kind = "voltage"
resistance = "50 ohm"
value = { shape = "pulses", high = "1 V", width = "4 ns", rise = "1 ns", fall = "1 ns", period = "10 ns" }
""",
    "Sine": """\
[sources.generator]
at = "near"
kind = "voltage"
resistance = "50 ohm"
value = { shape = "sine", amplitude = "1 V", frequency = "100 MHz" }
""",
    "DoubleExponential": """\
[sources.lightning]
at = "near"
kind = "current"
value = { shape = "double exponential", peak = "10 kA", rise = "0.4 us", decay = "68 us" }
""",
}


def example(model: str) -> str:
    """The example of a model, checked: read as part of a scene, without a mistake."""
    medium, text = ("hydraulic", HYDRAULIC[model]) if model in HYDRAULIC else ("electrical", ELECTRICAL[model])
    scene = {
        "medium": medium,
        "t_end": "20 ns",
        "lines": LINES[medium],
        "probes": {at: {"at": at} for at in ("near", "far")},
    }
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "measured.csv").write_text("0, 0\n1e-9, 1\n", encoding="utf-8")
        for file in MEASURED:
            shutil.copy(file, folder)
        Path(folder, "cable.csv").write_text("0, 0.1, 2.5e-7\n1e6, 0.1, 2.5e-7\n1e9, 0.1, 2.5e-7\n", encoding="utf-8")
        scene_from(scene | tomllib.loads(text), folder)
    return text
