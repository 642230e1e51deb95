"""An example of each element of pipes, for the scene reference."""

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
