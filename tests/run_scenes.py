"""Scenes that commands are tested with."""

VALVE = """
title = "Closing valve"
medium = "hydraulic"
t_end = "2 s"
start = "steady"
[lines.pipe]
nodes = ["tank", "valve"]
length = "300 m"
wave_speed = 1500
z0 = 4.7e7
[loads.tank]
at = "tank"
kind = "reservoir"
pressure = "6 bar"
[loads.valve]
at = "valve"
kind = "valve"
before = 6e7
after = inf
time = "0.1 s"
[probes.probe]
at = "valve"
[probes.middle]
line = "pipe"
position = "50 %"
"""


FORK = """
medium = "electrical"
t_end = "40 ns"
[lines.stem]
nodes = ["in", "fork"]
z0 = 50
delay = "4 ns"
[lines.left]
nodes = ["fork", "up"]
z0 = 50
delay = "2 ns"
[lines.right]
nodes = ["fork", "down"]
z0 = 50
delay = "6 ns"
[sources.in]
at = "in"
kind = "voltage"
resistance = 50
value = {shape = "step", to = "1 V", at = "1.03 ns"}
[probes.in]
at = "in"
"""


def driven_cable(load: str, t_end: str = "8 ns", z0: int = 50, source: str = "driver", resistance: int = 25) -> str:
    """A cable of 1 ns from a source of 1 V to what is told in TOML, with a probe there."""
    return f"""
medium = "electrical"
t_end = "{t_end}"
[lines.cable]
nodes = ["near", "far"]
z0 = {z0}
delay = "1 ns"
[sources.{source}]
at = "near"
kind = "voltage"
value = 1
resistance = {resistance}
{load}
[probes.far]
at = "far"
"""
