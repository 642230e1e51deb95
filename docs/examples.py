"""An example of each element and waveform for the scene reference, each read as part of a scene before it is shown."""

import tempfile
import tomllib
from pathlib import Path

from tline.scene.file import scene_from

LINES = {
    "hydraulic": {"pipe": {"nodes": ["near", "far"], "z0": 1e7, "delay": 1}},
    "electrical": {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": 1}},
}
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
even = { z0 = "60 ohm", delay = "1.1 ns" }
odd = { z0 = "40 ohm", delay = "0.9 ns" }
""",
    "Source": """\
[sources.driver]
at = "near"
kind = "voltage"
value = "1 V"
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
    "Probe": """\
[probes.end]
at = "far"

[probes.quarter]
line = "cable"
position = "25 %"
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
    scene = {"medium": medium, "t_end": "20 ns", "lines": LINES[medium], "probes": {"far": {"at": "far"}}}
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "measured.csv").write_text("0, 0\n1e-9, 1\n", encoding="utf-8")
        scene_from(scene | tomllib.loads(text), folder)
    return text
