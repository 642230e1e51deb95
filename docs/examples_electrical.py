"""An example of each element of cables, and of each probe, measure and waveform, for the scene reference."""

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
    "ModulatedSine": """\
[sources.ringing]
at = "near"
kind = "current"
value = { shape = "modulated sine", amplitude = "10 A", frequency = "1 MHz", decay = "2 us" }
""",
    "DoubleExponential": """\
[sources.lightning]
at = "near"
kind = "current"
value = { shape = "double exponential", peak = "10 kA", rise = "0.4 us", decay = "68 us" }
""",
}
