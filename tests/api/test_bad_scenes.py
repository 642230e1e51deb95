"""Bad input gets one clear sentence a mistake that names the element: never a traceback, never a silent pass."""

import re
import time
from pathlib import Path

import pytest

from tline.errors import InputError, SceneError
from tline.scene.file import read_scene
from tline.scene.line import Cable, Pipe
from tline.scene.load import Matched, NoFlow, Reservoir, Resistor, Short, Switch
from tline.scene.mistakes import MOST
from tline.scene.probe import Probe
from tline.scene.pulses import Pulses
from tline.scene.rational_load import Impedance, Parallel, Series
from tline.scene.scene import Scene, Solver
from tline.scene.shape import Step
from tline.scene.source import Source
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe

CABLE = """
medium = "electrical"
t_end = "40 ns"
[lines.cable]
nodes = ["near", "far"]
z0 = "50 ohm"
delay = "5 ns"
[sources.gen]
at = "near"
kind = "voltage"
value = "1 V"
resistance = "50 ohm"
[loads.end]
at = "far"
kind = "resistor"
resistance = "75 ohm"
[probes.seen]
at = "far"
"""
PIPE = """
medium = "hydraulic"
t_end = "2 s"
[lines.pipe]
nodes = ["tank", "valve"]
radius = "10 cm"
density = 998
wave_speed = "1200 m/s"
length = "300 m"
[sources.pump]
at = "tank"
kind = "pressure"
value = "5 bar"
resistance = "1 bar/(m^3/s)"
[loads.outlet]
at = "valve"
kind = "resistor"
resistance = 1e8
[probes.seen]
at = "valve"
"""

# Tables of mistakes: a change, and after each => how a sentence begins, with … for what does not matter. A change is
# `old -> new`, `^ text` at the top, `+ text` at the end, `ideal + text` where the source has no resistance; | is a new
# line.
SCENE = r"""
medium = "electrical" ->  => medium: is missing
"electrical" -> "electrik" => medium: unknown, expected 'hydraulic' or 'electrical', got 'electrik'
"electrical" -> ["electrical"] => medium: unknown, expected 'hydraulic' or 'electrical', got ['electrical']
"electrical" -> {a = 1} => medium: unknown, expected 'hydraulic' or 'electrical', got {'a': 1}
t_end = "40 ns" ->  => t_end: is missing
"40 ns" -> 0 => t_end: duration out of range, expected more than 0, got 0
"40 ns" -> "-1 s" => t_end: duration out of range, expected more than 0, got '-1 s'
"40 ns" -> nan => t_end: not a finite number, expected a time such as '1 s', got nan
"40 ns" -> "40 m" => t_end: this unit measures something else, expected a time such as '1 s', got '40 m'
"40 ns" -> 2020-02-02 => t_end: not a number, expected a time such as '1 s', got datetime.date(2020, 2, 2)
"40 ns" -> 1e30
  => t_end: slabs of 5e-09 s make a run of 2e+38 slabs, expected at most 1e+09; no slab is longer than the delay of
"40 ns" -> 1e-30 => t_end: the run ends within the first slab, expected at least a slab of
^ start = "stedy" => start: unknown, expected 'rest' or 'steady', got 'stedy'
^ title = 5 => title: not a text, expected text in quotes, got 5
^ tend = 1 => tend: unknown key, expected 't_end'
^ self = 1 | xyz = 1 => self: unknown key => xyz: unknown key, expected one of 'title', 'medium'
[loads.end] -> [load.end] => load: unknown key, expected 'loads'
[probes.seen] | at = "far" ->  => probes: is missing
[probes.seen] | at = "far" -> [probes] => probes: nothing would be recorded, expected at least one table [probes.NAME]
[probes.seen] | at = "far" -> [[probes]] => probes: not a table, expected keys with values, got [{}]
[probes.seen] -> [probes] | other = "far" | [probes.seen]
  => probes.other: not a table, expected keys with values, got 'far'
[loads.end] -> [loads] | other = true | [loads.end] => loads.other: not a table, expected keys with values, got True
[loads.end] -> [[loads]] => loads: not a table, expected keys with values, got [{
^ solver = "fast" => solver: not a table, expected keys with values, got 'fast'
+ [solver] | order = 0 => solver.order: not a whole number in range, expected one from 1 to 16
+ [solver] | order = 17 => solver.order: not a whole number in range, expected one from 1 to 16
+ [solver] | order = 2.5 => solver.order: not a whole number in range, expected one from 1 to 16
+ [solver] | order = -1 => solver.order: not a whole number in range, expected one from 1 to 16
+ [solver] | order = nan => solver.order: not a whole number in range, expected one from 1 to 16
+ [solver] | order = true => solver.order: not a whole number in range, expected one from 1 to 16, got True
+ [solver] | slab = "6 ns"
  => solver.slab: longer than the shortest delay, expected at most that of lines.cable, 5e-09 s, got 6e-09 s
+ [solver] | slab = 0 => solver.slab: duration out of range, expected more than 0, got 0
+ [solver] | slab = "-1 ns" => solver.slab: duration out of range, expected more than 0, got '-1 ns'
+ [solver] | slab = 1e-30 => solver.slab: slabs of 1e-30 s put 5e+22 samples on the lines at once
+ [solver] | orde = 3 => solver.orde: unknown key, expected 'order'
at = "near" -> at = "neer" => sources.gen.at: no line ends at this node, expected 'near', got 'neer'
"voltage" -> "voltge" => sources.gen.kind: unknown, expected 'pressure', 'flow', 'voltage' or 'current', got 'voltge'
"voltage" -> "pressure"
  => sources.gen.kind: not a word of electrical scenes, expected 'voltage' or 'current', got 'pressure'
value = "1 V" ->  => sources.gen.value: is missing
"voltage" -> "current"
  => sources.gen.value: this unit measures something else, expected a current such as '1 A', got '1 V'
value = "1 V" -> value = 1 | resistence = 1 => sources.gen.resistence: unknown key, expected 'resistance'
"voltage" | value = "1 V" | resistance = "50 ohm" -> "current" | value = 1 | resistance = 0
  => sources.gen.resistance: beside the current it takes all of it, expected none for an ideal source, got 0
at = "far" | kind -> at = "fare" | kind => loads.end.at: no line ends at this node, expected 'far', got 'fare'
ideal + [sources.other] | at = "near" | kind = "voltage" | value = 2
  => sources.other: node 'near' is already held by sources.gen, expected one ideal effort or short at a node
ideal + [loads.s] | at = "near" | kind = "short"
  => loads.s: node 'near' is already held by sources.gen, expected one ideal effort or short at a node
ideal + [loads.s] | at = "near" | kind = "resistor" | resistance = 0
  => loads.s: node 'near' is already held by sources.gen, expected one ideal effort or short at a node
ideal + [loads.s] | at = "near" | kind = "impedance" | expression = "0*s"
  => loads.s: node 'near' is already held by sources.gen, expected one ideal effort or short at a node
ideal + [loads.c] | at = "near" | kind = "parallel" | capacitance = 1e-12
  => loads.c: its impedance vanishes at high frequency: a jump of sources.gen drives an infinite flow, expected a
ideal + [loads.c] | at = "near" | kind = "impedance" | expression = "1/s"
  => loads.c: its impedance vanishes at high frequency: a jump of sources.gen drives an infinite flow, expected a
ideal + [loads.s] | at = "near" | kind = "switch" | before = inf | after = 0 | time = 1
  => loads.s: shorts node 'near', which sources.gen holds, expected a resistance above zero
"""
LINE = r"""
nodes = ["near", "far"] ->  => lines.cable.nodes: is missing
nodes = ["near", "far"] -> nodes = [] => lines.cable.nodes: not two nodes, expected two names such as ["a", "b"], got []
nodes = ["near", "far"] -> nodes = ["far"]
  => lines.cable.nodes: not two nodes, expected two names such as ["a", "b"], got ['far']
nodes = ["near", "far"] -> nodes = ["near", "mid", "far"]
  => lines.cable.nodes: not two nodes, expected two names such as ["a", "b"], got ['near', 'mid', 'far']
nodes = ["near", "far"] -> nodes = "far"
  => lines.cable.nodes: not two nodes, expected two names such as ["a", "b"], got 'far'
nodes = ["near", "far"] -> nodes = {a = 1}
  => lines.cable.nodes: not two nodes, expected two names such as ["a", "b"], got {'a': 1}
nodes = ["near", "far"] -> nodes = [1, true] => lines.cable.nodes[0]: not a text => lines.cable.nodes[1]: not a text
nodes = ["near", "far"] -> nodes = ["", "far"] => lines.cable.nodes[0]: not a name, expected letters, digits
delay = "5 ns" ->  => lines.cable: wave_speed or delay cannot be found, add
delay = "5 ns" -> delay = 0 => lines.cable.delay: delay out of range, expected more than 0, got 0
delay = "5 ns" -> delay = "-5 ns" => lines.cable.delay: delay out of range, expected more than 0, got '-5 ns'
delay = "5 ns" -> delay = nan => lines.cable.delay: not a finite number, expected a time such as '1 s', got nan
delay = "5 ns" -> delay = "inf" => lines.cable.delay: not a finite number, expected a time such as '1 s', got 'inf'
delay = "5 ns" -> delay = 1e-310 => lines.cable.delay: delay out of range, expected at least 1e-100
delay = "5 ns" -> delay = 1e200 => lines.cable.delay: delay out of range, expected at most 1e+100
delay = "5 ns" -> delay = true => lines.cable.delay: not a number, expected a time such as '1 s', got True
delay = "5 ns" -> delay = [1] => lines.cable.delay: not a number, expected a time such as '1 s', got [1]
delay = "5 ns" -> delay = 2020-02-02
  => lines.cable.delay: not a number, expected a time such as '1 s', got datetime.date(2020, 2, 2)
delay = "5 ns" -> delay = "5 m"
  => lines.cable.delay: this unit measures something else, expected a time such as '1 s', got '5 m'
delay = "5 ns" -> delay = "5 nz" => lines.cable.delay: unknown unit 'nz', expected
z0 = "50 ohm" | delay = "5 ns" -> z0 = "5 V" | delay = "3 V"
  => lines.cable.z0: this unit => lines.cable.delay: this unit
z0 = "50 ohm" -> Z0 = 50 => lines.cable.Z0: unknown key, expected 'z0'
z0 = "50 ohm" -> z0 = 50 | radius = 1 => lines.cable.radius: unknown key, expected one of 'nodes', 'vertices'
[lines.cable] -> [lines] | other = 5 | [lines.cable] => lines.other: not a table, expected keys with values, got 5
"""
HYDRAULIC = r"""
"5 bar" -> "5 V" => sources.pump.value: this unit measures something else, expected a pressure such as '1 Pa'
"pressure" -> "flow" => sources.pump.value: this unit measures something else, expected a volume flow such as '1 m^3/s'
1e8 -> "3 bar"
  => loads.outlet.resistance: this unit measures something else, expected a hydraulic impedance such as '1 Pa s/m^3',
1e8 -> "3 ohm" => loads.outlet.resistance: this unit measures something else
"pressure" -> "voltage"
  => sources.pump.kind: not a word of hydraulic scenes, expected 'pressure' or 'flow', got 'voltage'
"resistor" | resistance = 1e8 -> "switch" | before = 1 | after = 1 | time = 1
  => loads.outlet.kind: not a word of hydraulic scenes, expected 'valve', got 'switch'
"resistor" | resistance = 1e8 -> "open"
  => loads.outlet.kind: not a word of hydraulic scenes, expected 'closed', got 'open'
"300 m" -> "300 s" => lines.pipe.length: this unit measures something else, expected a length such as '1 m', got '300 s'
density = 998 -> fluid = "watr" => lines.pipe.fluid: unknown fluid, expected 'water'
density = 998 -> density = 998 | z0 = 5 => lines.pipe: radius, wave_speed, density and z0 clash
density = 998 -> permittivity = 2 => lines.pipe.permittivity: unknown key, expected
"""
# of sources.gen.value
VALUE = r"""
true => : not a number, expected a voltage such as '1 V', got True
[1] => : not a number, expected a voltage such as '1 V', got [1]
"1 bar" => : this unit measures something else, expected a voltage such as '1 V', got '1 bar'
"nan V" => : not a finite number, expected a voltage such as '1 V', got 'nan V'
1e200 => : level out of range, expected at most 1e+100, got 1e+200
{level = 1} => .shape: is missing
{shape = "stp"} => .shape: unknown, expected 'step', got 'stp'
{shape = 5} => .shape: unknown, expected one of 'constant', 'step', 'ramp', 'piecewise linear'
{shape = ["step"]} => .shape: unknown, expected 'step', got ['step']
{shape = "step"} => .to: is missing
{shape = "step", to = 1, frm = 0} => .frm: unknown key, expected 'from'
{shape = "exponential", to = 1, timeconstant = 1} => .timeconstant: unknown key, expected 'time_constant'
{shape = "step", from = "1 A", to = "1 s", at = "1 V"} => .from: this unit => .to: this unit
  => .at: this unit measures something else, expected a time such as '1 s', got '1 V'
{shape = "constant", level = "1 A"}
  => .level: this unit measures something else, expected a voltage such as '1 V', got '1 A'
{shape = "step", to = 1, at = inf} => .at: not a finite number, expected a time such as '1 s', got inf
{shape = "ramp", to = 1, duration = 0} => .duration: duration out of range, expected more than 0, got 0
{shape = "pulses", high = 1, width = 1, rise = 1, period = 1.5}
  => .period: shorter than the pulse, expected at least 2 s, got 1.5 s
{shape = "pulses", high = 1, width = 0} => .width: duration out of range, expected more than 0
{shape = "pulses", high = 1, width = 1, rise = -1, fall = "1 V"} => .rise: duration out of range, expected at least 0
  => .fall: this unit
{shape = "pulses", high = 1, width = 1e-9, period = 2e-9, count = 0}
  => .count: not a whole number in range, expected one of at least 1, got 0
{shape = "pulses", high = 1, width = 1e-9, period = 2e-9, count = 2.5} => .count: not a whole number in range
{shape = "pulses", high = 1, width = 1e-9, period = 2e-9, count = true} => .count: not a whole number in range
{shape = "pulses", high = 1, width = 1, count = 3}
  => .count: pulses are counted only where they repeat, expected a period
{shape = "pulses", high = 1, width = 1e-21, period = 4e-20, count = 1_000_000_000_000}
  => .period: too many pulses before the end, expected at most 1,000,000, got 1e+12
{shape = "piecewise linear"} => .points: is missing
{shape = "piecewise linear", points = [[0, 1]]} => .points: too few, expected at least 2, got 1
{shape = "piecewise linear", points = [[0, 1], [2, 1], [1, 1]]}
  => .points: point 3 lies before the one in front of it, expected times in order, got 1 s
{shape = "piecewise linear", points = [[0, 1], [0, 2], [0, 3]]}
  => .points: point 3 is the third at one time, expected at most two, for a jump, got 0 s
{shape = "piecewise linear", points = [[0, 1], [1, 2, 3]]}
  => .points[1]: not a point, expected a pair [time, level], got [1, 2, 3]
{shape = "piecewise linear", points = [0, 1]} => .points[0]: not a point => .points[1]: not a point
{shape = "piecewise linear", points = [["0 V", 1], [1, "2 A"]]} => .points[0][0]: this unit => .points[1][1]: this unit
{shape = "piecewise linear", points = "x"} => .points: not a list, got 'x'
{shape = "sine", amplitude = 1, frequency = 0} => .frequency: frequency out of range, expected more than 0, got 0
{shape = "sine", amplitude = 1, frequency = 1e9, at = 2, until = 1}
  => .until: not after the begin, expected more than 2 s, got 1 s
{shape = "sine", amplitude = 1, frequency = "1 s", phase = "1 V"} => .frequency: this unit => .phase: this unit
{shape = "exponential", to = 1, time_constant = -1} => .time_constant: duration out of range
{shape = "double exponential", peak = 1, rise = 2, decay = 2}
  => .rise: must be the shorter time, expected less than 2 s, got 2 s
{shape = "table", file = "none.csv"} => .file: '…none.csv' cannot be read, got No such file
{shape = "table", file = "."} => .file: '…cannot be read, got Is a directory
{shape = "table", file = "a\u0000b"} => .file: '…cannot be read, got …embedded null
{shape = "table", file = 5} => .file: not a text, expected text in quotes, got 5
"""
# of the load at the far end; ~ stands for kind = "impedance"
LOAD = r"""
kind = "resistor" => .resistance: is missing
kind = "resistr" | resistance = 1 => .kind: unknown, expected 'resistor', got 'resistr'
resistance = 1 => .kind: is missing
kind = 5 => .kind: unknown, expected one of 'closed', 'open', 'short', 'reservoir', 'matched'
kind = ["open"] => .kind: unknown, expected 'open', got ['open']
kind = "closed" => .kind: not a word of electrical scenes, expected 'open', got 'closed'
kind = "valve" | before = 1 | after = 2 | time = 0
  => .kind: not a word of electrical scenes, expected 'switch', got 'valve'
kind = "reservoir" | pressure = "5 bar"
  => .kind: not a word of electrical scenes, expected a voltage source, or 'short', got 'reservoir'
kind = "resistor" | resistence = 1 => .resistence: unknown key, expected 'resistance'
kind = "resistor" | resistance = 1 | parameters = {} => .parameters: unknown key, expected one of 'at', 'kind'
kind = "resistor" | resistance = nan => .resistance: not a finite number, expected a resistance such as '1 ohm', got nan
kind = "resistor" | resistance = -1 => .resistance: resistance out of range, expected at least 0, or kind = 'impedance'
kind = "resistor" | resistance = 5e-324 => .resistance: resistance out of range, expected at least 1e-100
kind = "resistor" | resistance = "1e400 ohm" => .resistance: resistance out of range, expected at most 1e+100
kind = "resistor" | resistance = {} => .resistance: not a number, expected a resistance such as '1 ohm', got {}
kind = "resistor" | resistance = "3 bar"
  => .resistance: this unit measures something else, expected a resistance such as '1 ohm', got '3 bar'
kind = "switch" => .before: is missing => .after: is missing => .time: is missing
kind = "switch" | before = -1 | after = nan | time = "1 V" => .before: resistance out => .after: not a finite
  => .time: this unit
kind = "parallel" => : no element given, expected at least one of resistance, inductance and capacitance
kind = "series" | inductance = "1 F" | capacitance = 0 => .inductance: this unit
  => .capacitance: capacitance out of range, expected more than 0
kind = "impedance" => : its Z(s) is not given once, expected either expression, or numerator and denominator, got none
~ numerator = [1] => : its Z(s) is not given once…got numerator
~ numerator = [1] | denominator = [1] | expression = "s"
  => : its Z(s) is not given once…got expression, numerator, denominator
~ numerator = [1] | denominator = [1] | parameters = {R = 1}
  => .parameters: they belong to an expression, not to coefficients
~ numerator = [] | denominator = [1] => .numerator: no coefficients, expected at least one number
~ numerator = [0] | denominator = [0] => : 0/0 has no value
~ numerator = [1, "x"] | denominator = [true]
  => .denominator[0]: not a number, expected a number or text such as '10 nH', got True
~ numerator = [1, "x"] | denominator = [1] => .numerator[1]: not a number, expected…got 'x'
~ numerator = [1, nan] | denominator = [1] => .numerator[1]: not a number, expected…got nan
~ numerator = 1 | denominator = [1] => .numerator: not a list, got 1
~ numerator = [-50, 1] | denominator = [1, 1]
  => : its impedance tends to minus the line's 50 at high frequency: no wave is defined
~ expression = "" => .expression: column 1: the expression ends too early
~ expression = "__import__('os').system('x')" => .expression: column 12: this character has no meaning here
~ expression = "eval(s)" => .expression: column 1: unknown function
~ expression = "s^1000000000"
  => .expression: column 2: this power is not known, expected a whole number from -200 to 200
~ expression = "((s^200)^200)^200" => .expression: the degree in s is too high
~ expression = "(s + 1)^100" => : its degree in s is too high, expected at most 20, got 100
~ expression = "1e1000000000" => .expression: column 1: the decimal exponent is out of range, expected at most e400
~ expression = "1e400" => : its resistance at low or high frequency is out of range, expected 1e-100 to 1e+100
~ expression = "1e-400" => : its resistance at low or high frequency is out of range, expected 1e-100 to 1e+100
~ expression = "exp(-s)" => .expression: exp(...) is not rational in s, expected only + - * / and whole powers
~ expression = "0/0" => .expression: 0/0 has no value
~ expression = "-50" => : cancels the conductance of the lines at node 'far': no wave is defined
~ expression = "R + s*L" | parameters = {R = 1} => .parameters.L: no value, expected one for each of L, R, got R
~ expression = "R" | parameters = {R = 1, Q = 1} => .parameters.Q: not in the expression, expected values for R
~ expression = "R" | parameters = {R = nan} => .parameters.R: not a finite number
~ expression = "R" | parameters = {R = true} => .parameters.R: not a number
~ expression = "R" | parameters = {R = "3 ohms"} => .parameters.R: unknown unit 'ohms'
~ expression = "R" | parameters = 5 => .parameters: not a table, expected keys with values, got 5
~ expression = "short" | parameters = {short = nan} => .parameters.short: not a finite number
"""
# of the probe
PROBE = r"""
 => : its place is not given once, expected either at, or line with position
line = "cable" => : its place is not given once, expected either at, or line with position
at = "far" | position = "5 %" => : its place is not given once, expected either at, or line with position
position = 1 => .line: is missing
at = "fra" => .at: no line ends at this node, expected 'far', got 'fra'
at = "xyz" => .at: no line ends at this node, expected one of 'far', 'near', got 'xyz'
at = 5 => .at: not a text, expected text in quotes, got 5
at = "" => .at: not a name
at = "far" | line = "cabel" => .line: no such line, expected 'cable', got 'cabel'
line = "cabel" | position = "25 %" => .line: no such line, expected 'cable', got 'cabel'
line = "cable" | position = "120 %" => .position: not on the line, expected 0 to 100 %, got '120 %'
line = "cable" | position = "-5 %" => .position: position out of range, expected at least 0, got '-5 %'
line = "cable" | position = -1 => .position: position out of range, expected at least 0, got -1
line = "cable" | position = "1 s"
  => .position: this unit measures something else, expected a length such as '1 m', got '1 s'
line = "cable" | position = "2 m"
  => .position: the line's length is not known, expected a share such as '25 %', got '2 m'
line = "cable" | position = "nan" => .position: not a finite number
line = "cable" | position = true => .position: not a number
at = "far" | posn = 1 => .posn: unknown key, expected 'position'
"""
END = 'kind = "resistor"\nresistance = "75 ohm"'


def changed(scene: str, change: str) -> str:
    if change.startswith("^ "):
        return change[2:] + "\n" + scene
    if change.startswith(("+ ", "ideal + ")):
        scene = scene.replace('resistance = "50 ohm"\n', "") if change.startswith("ideal") else scene
        return scene + change.partition("+ ")[2]
    old, _, new = change.partition("->")
    assert old.strip() in scene
    return scene.replace(old.strip(), new.strip())


def cases(scene: str, table: str, change: str = "{}", element: str = "") -> list[tuple[str, list[str]]]:
    """Scenes and beginnings of sentences."""
    found = []
    for line in table.strip("\n").replace("\n  =>", " =>").splitlines():
        new, *begins = re.split(" ?=> ?", line)
        text = changed(scene, change.replace("{}", new).replace(" | ", "\n").replace("~", 'kind = "impedance"\n'))
        found.append((text, [element + begin for begin in begins]))
    return found


CASES = [
    *cases(CABLE, SCENE),
    *cases(CABLE, LINE),
    *cases(PIPE, HYDRAULIC),
    *cases(CABLE, VALUE, '"1 V" -> {}', "sources.gen.value"),
    *cases(CABLE, LOAD, f"{END} -> {{}}", "loads.end"),
    *cases(CABLE, PROBE, '[probes.seen]\nat = "far" -> [probes.seen]\n{}', "probes.seen"),
]


def mistakes_of(text: str | bytes, folder: Path) -> list[str]:
    """One sentence a mistake, from reading and assembling the scene."""
    file = folder / "scene.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        assemble(describe(read_scene(file)), set())
    found = caught.value.mistakes if isinstance(caught.value, SceneError) else [caught.value]
    return [str(mistake) for mistake in found]


def agree(sentences: list[str], begins: list[str]) -> None:
    """Each sentence begins as it should, is one line, and not long."""
    assert len(sentences) == len(begins), sentences
    for sentence, begin in zip(sentences, begins, strict=True):
        assert re.match(".*".join(map(re.escape, begin.split("…"))), sentence), sentence
        assert "\n" not in sentence
        assert len(sentence) < 400


@pytest.mark.parametrize(("text", "begins"), CASES, ids=[f"{begins[0]:.60}" for _, begins in CASES])
def test_one_sentence_a_mistake(text, begins, tmp_path):
    agree(mistakes_of(text, tmp_path), begins)


def test_sound_scenes_pass(tmp_path):
    for text in (CABLE, PIPE):
        (tmp_path / "scene.toml").write_text("\ufeff" + text, encoding="utf-8")  # some editors begin so
        assemble(describe(read_scene(tmp_path / "scene.toml")), set())


# what would be long in the tables
BY_HAND = [
    ('"5 ns"', f'"{"9" * 300}"', "lines.cable.delay: a text of 300 characters is no quantity"),
    ('"40 ns"', "0x" + "f" * 5000, "t_end: not a finite number"),
    ("[loads", f"[solver]\norder = 0x{'f' * 5000}\n[loads", "solver.order: not a whole number in range"),
    (END, f'kind = "impedance"\nexpression = "{"(" * 1000}"', "loads.end.expression: column 102: nested too deeply"),
    (END, f'kind = "impedance"\nexpression = "{"s" * 10**5}"', "loads.end.expression: the expression is too long"),
    (END, f'kind = "impedance"\nnumerator = [{"1," * 5001}]\ndenominator = [1]', "loads.end: its degree in s is too"),
    ("[loads.end]", '[loads."a.b c"]', 'loads."a.b c".resistance: this unit'),
    ("[loads.end]", '[loads."κλειστό"]', "loads.κλειστό.resistance: this unit"),
    ("[loads.end]", "[loads.switch]", "loads.switch.resistance: this unit"),
    ("[lines.cable]", '[lines."a\\nb"]', 'lines."a\\nb": not a name, expected letters, digits'),
    ("[lines.cable]", '[lines.""]', 'lines."": not a name, expected letters, digits and other visible characters'),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "begin"), BY_HAND, ids=[case[2][:40] for case in BY_HAND])
def test_long_texts_and_strange_names(old, new, begin, tmp_path):
    text = CABLE.replace(old, new)
    agree(mistakes_of(text.replace("75 ohm", "75 bar") if "this unit" in begin else text, tmp_path), [begin])


JUNCTION = '[lines.other]\nnodes = ["far", "x"]\nz0 = 1\ndelay = 5\n'


def test_junctions(tmp_path):
    begins = [
        "loads.end: node 'far' is a junction, and only the end of one line can be matched, expected a resistor, got 2",
    ]
    agree(mistakes_of(CABLE.replace(END, 'kind = "matched"') + JUNCTION, tmp_path), begins)


def test_delays_that_are_too_far_apart(tmp_path):
    """5 ns and 5 s: no slab suits both."""
    begin = "lines.cable: slabs of 5e-09 s put 1e+10 samples on the lines at once, for lines.other takes 5 s"
    agree(mistakes_of(CABLE + 'line = "cable"\n' + JUNCTION, tmp_path), [begin])


def test_a_capacitor_under_a_switch(tmp_path):
    parts = '[loads.c]\nat = "far"\nkind = "parallel"\ncapacitance = 1e-12\n[loads.s]\nat = "far"\nkind = "switch"\n'
    parts += "before = 0\nafter = 5\ntime = 1e-9\n"
    agree(
        mistakes_of(CABLE + parts, tmp_path), ["loads.s: shorts node 'far', which loads.c holds, expected a resistance"]
    )


def test_all_mistakes_at_once(tmp_path):
    text = CABLE.replace('"40 ns"', '"40 m"').replace('"50 ohm"\n[loads', '"0 ohm"\n[loads').replace('"75', '"-75')
    text += '[probes.nowhere]\n[sources.other]\nat = "near"\nkind = "voltage"\nvalue = "2 V"\n'
    text += '[sources.third]\nat = "fra"\nkind = "voltage"\nvalue = {}\n'
    agree(
        mistakes_of(text, tmp_path),
        [
            "t_end: this unit",
            "sources.third.value.shape: is missing",
            "loads.end.resistance: resistance out of range",
            "sources.third.at: no line ends at this node",
            "sources.other: node 'near' is already held by sources.gen",
            "probes.nowhere: its place is not given once",
        ],
    )


def test_a_hundred_mistakes_are_enough(tmp_path):
    found = mistakes_of(CABLE + "".join(f"[loads.l{k}]\n" for k in range(1234)), tmp_path)
    assert len(found) == MOST + 1
    assert found[-1] == "and 1,134 more mistakes"


NOTHING = ["medium: is missing", "t_end: is missing", "lines: is missing", "probes: is missing"]
DEEP = ".".join("a" * 5000)
FILES = {
    "empty": ("", NOTHING),
    "a million comments": ("# x\n" * 10**6, NOTHING),
    "a million lines of junk": ("no scene at all\n" * 10**6, ["…scene.toml: is not valid TOML: Expected '='"]),
    "binary": (bytes(range(256)) * 4000, ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "zeros": (bytes(10**6), ["…scene.toml: is not valid TOML: Invalid statement (at line 1, column 1)"]),
    "utf-16": (CABLE.encode("utf-16"), ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "twice": (CABLE + CABLE, ["…scene.toml: is not valid TOML: Cannot declare"]),
    "deep lists": (CABLE + "x = " + "[" * 10**5, ["…scene.toml: is nested too deeply, expected a scene in TOML"]),
    "deep tables": (CABLE.replace("z0 =", f"z0.{DEEP} ="), ["lines.cable.z0: not a number, …got {'a'"]),
    "deep keys": (CABLE + f"[{DEEP}]", ["a: unknown key, expected one of 'title'"]),
    "5000 digits": (CABLE.replace('"40 ns"', "9" * 5000), ["…scene.toml: is not valid TOML: Exceeds the limit"]),
}  # fmt: skip


@pytest.mark.parametrize("what", FILES)
def test_files(what, tmp_path):
    text, begins = FILES[what]
    agree(mistakes_of(text, tmp_path), begins)


@pytest.mark.parametrize(
    ("what", "text"),
    [
        ("keys", "".join(f"x{k} = 1\n" for k in range(10**5)) + CABLE),
        ("loads", CABLE + "".join(f"[loads.l{k}]\nat = 'no{k}'\nkind = 'open'\n" for k in range(10**4))),
        ("lines", CABLE + "".join(f"[lines.l{k}]\nfoo = 1\n" for k in range(10**4))),
    ],
)
def test_useless_lines_are_told_of_quickly(what, text, tmp_path):
    """Not with the square of their number: some 1 s each, and the bound is for machines that do other things too."""
    started = time.process_time()
    assert len(mistakes_of(text, tmp_path)) == MOST + 1
    assert time.process_time() - started < 20.0


def test_no_file(tmp_path):
    for path, got in ((tmp_path / "none.toml", "No such file or directory"), (tmp_path, "Is a directory")):
        with pytest.raises(InputError) as caught:
            read_scene(path)
        assert str(caught.value) == f"{path}: cannot be read, got {got}"


POINT = "line {} of '…t.csv' is not a point, expected two finite numbers with a comma between"
TABLES = {
    "0,1\n1,nan\n": POINT.format(2),
    "0,1\n1,1e400\n": POINT.format(2),
    "0,1,2\n1,2,3\n": POINT.format(1),
    "t,u\ns,V\n0,1\n": POINT.format(2),
    "0;1\n1;2\n": POINT.format(2),
    "t,1\n0,1\n1,2\n": POINT.format(1),
    "0,1\n2,1\n1,3\n": "point 3 lies before the one in front of it, expected times in order, got 1 s",
    "0,1\n1,2\n1,3\n1,4\n": "point 4 is the third at one time, expected at most two, for a jump, got 1 s",
    "t,u\n0,1\n": "too few points in '…t.csv', expected at least two lines 'time, level', got 1",
    "": "too few points in '…t.csv', expected at least two lines 'time, level', got 0",
    "0," + "1" * 200_000: "line 1 of '…t.csv' cannot be read: field larger than field limit",
    "0,\xff": "'…t.csv' is not a text file, expected text in UTF-8",
}


@pytest.mark.parametrize("table", TABLES, ids=[problem[:40] for problem in TABLES.values()])
def test_tables(table, tmp_path):
    (tmp_path / "t.csv").write_bytes(table.encode("latin-1"))
    text = CABLE.replace('"1 V"', '{shape = "table", file = "t.csv"}')
    agree(found := mistakes_of(text, tmp_path), ["sources.gen.value.file: " + TABLES[table]])
    assert not any(line in str(sentence) for sentence in found for line in table.splitlines() if line)


# the same mistakes in Python


def scene(**parts) -> Scene:
    line = Cable(nodes=("a", "b"), z0=50, delay="0.1 s")
    return Scene(**{"medium": "electrical", "t_end": 1, "lines": {"c": line}, "probes": {"p": Probe(at="a")}} | parts)


PIPELINE = Pipe(nodes=("a", "b"), z0=5, delay=1)
SOURCE = {"at": "a", "kind": "voltage"}
TRAIN = Pulses(high=1, width=1e-9, period=2e-9, at=-1)
AMPERE = Source(at="a", kind="current", value=Step(to="1 A"))
OBJECTS = [
    ("lines", PIPELINE, "lines.x: not a line of electrical scenes, expected a table or a Cable, got a Pipe"),
    ("lines", Short(at="a"), "lines.x: not a line of electrical scenes, expected a table or a Cable, got a Short"),
    ("loads", Resistor(at="b", resistance="5 Pa s/m^3"), "loads.x.resistance: this unit measures something else"),
    ("loads", Series(at="b", inductance="5 F"), "loads.x.inductance: this unit measures something else"),
    ("loads", Parallel(at="b", capacitance="5 m^3/Pa"), "loads.x.capacitance: this unit measures something else"),
    ("loads", Reservoir(at="b", pressure="5 bar"), "loads.x.kind: not a word of electrical scenes"),
    ("loads", NoFlow(at="b", kind="closed"), "loads.x.kind: not a word of electrical scenes, expected 'open'"),
    ("loads", Switch(at="b", kind="valve", before=1, after=2, time=0), "loads.x.kind: not a word of electrical scenes"),
    ("loads", Matched(at="c"), "loads.x.at: no line ends at this node, expected one of 'a', 'b', got 'c'"),
    ("loads", Probe(at="b"), "loads.x.kind: is missing"),
    ("loads", AMPERE, "loads.x.kind: unknown, expected one of 'closed'"),
    ("loads", Impedance(at="b", expression="-50 ohm"), "loads.x: cancels the conductance of the lines at node 'b'"),
    ("loads", Impedance(at="b", expression="1e-200*s^3 + 1e300*s^2 + 1"), "loads.x: its coefficients are too far"),
    ("sources", Source(at="a", kind="pressure", value="1 bar"), "sources.x.kind: not a word of electrical scenes"),
    ("sources", Source(**SOURCE, value=1, resistance="1 bar"), "sources.x.resistance: this unit"),
    ("sources", {**SOURCE, "value": AMPERE.value}, "sources.x.value.to: this unit measures something else"),
    ("sources", Short(at="a"), "sources.x: not a table, expected keys with values, got Short("),
    ("sources", Source(**SOURCE, value=TRAIN), "sources.x.value.period: too many pulses before the end"),
    ("probes", Probe(line="c", position=0.5), "probes.x.position: the line's length is not known"),
    ("probes", Probe(at="a", position=0.5), "probes.x: its place is not given once"),
]  # fmt: skip


@pytest.mark.parametrize(("section", "element", "begin"), OBJECTS, ids=[case[2][:50] for case in OBJECTS])
def test_objects(section, element, begin):
    with pytest.raises(InputError) as caught:
        assemble(describe(scene(**{section: {"x": element}})), set())
    agree(str(caught.value).splitlines(), [begin])


PARTS = [
    ({"lines": [PIPELINE]}, "lines: not a table, expected keys with values, got [Pipe("),
    ({"lines": None}, "lines: not a table, expected keys with values, got None"),
    ({"lines": {}}, "lines: there is nothing to simulate, expected at least one table [lines.NAME]"),
    ({"lines": {1: Cable(nodes=("a", "b"), z0=5, delay=1)}}, "lines[1]: not a text, expected text in quotes, got 1"),
    ({"loads": {"r": Short(at="b"), "s": Short(at="b")}}, "loads.s: node 'b' is already held by loads.r"),
    (
        {"loads": {f"r{k}": Impedance(at="b", expression=f"1 + 1/(s + {k})^11") for k in (1, 2)}},
        "loads.r2: with the loads beside it, its degree in s is too high, expected at most 20, got 22",
    ),
    ({"probes": {}}, "probes: nothing would be recorded"),
    (
        {"solver": Solver(slab=2)},
        "solver.slab: longer than the shortest delay, expected at most that of lines.c, 0.1 s",
    ),
    ({"solver": None}, "solver: not a table"),
    ({"t_end": 10**5000}, "t_end: not a finite number"),
    ({"t_end": None}, "t_end: not a number, expected a time such as '1 s', got None"),
    ({"medium": None}, "medium: unknown, expected 'hydraulic' or 'electrical', got None"),
    ({"something": object()}, "something: unknown key, expected one of 'title', 'medium', 't_end'"),
    ({"self": 1}, "self: unknown key"),
]


@pytest.mark.parametrize(("parts", "begin"), PARTS, ids=[case[1][:50] for case in PARTS])
def test_parts(parts, begin):
    with pytest.raises(InputError) as caught:
        assemble(describe(scene(**parts)), set())
    agree(str(caught.value).splitlines(), [begin])


def test_a_hydraulic_scene_refuses_electrical_objects():
    with pytest.raises(SceneError) as caught:
        scene(
            medium="hydraulic",
            lines={"pipe": PIPELINE, "cable": Cable(nodes=("a", "b"), z0=1, delay=1)},
            loads={"r": Resistor(at="b", resistance="50 ohm")},
            probes={"p": Probe(at="a", line="pipe")},
        )
    begins = ["lines.cable: not a line of hydraulic scenes", "loads.r.resistance: this unit measures something else"]
    agree(str(caught.value).splitlines(), begins)


ELEMENTS = [
    (lambda: Resistor(at="a", resistance="x"), "Resistor.resistance: there is no number in front"),
    (lambda: Resistor(**{"at": "a", "resistanc": 1}), "Resistor.resistanc: unknown key, expected 'resistance'"),
    (lambda: Probe(at=""), "Probe.at: not a name"),
    (lambda: Cable(nodes=("a",), z0=1, delay=1), 'Cable.nodes: not two nodes, expected two names such as ["a", "b"]'),
    (lambda: Cable(nodes=("a", "b"), z0=1), "Cable: wave_speed or delay cannot be found"),
    (lambda: Cable(nodes=("a", "b"), z0="1 m", delay=1), "Cable.z0: this unit measures something else"),
    (lambda: Source(**SOURCE, value="1 A"), "Source.value: this unit measures something else, expected a voltage"),
    (lambda: Source(**SOURCE, value=Step(to="1 A")), "Source.value.to: this unit measures something else"),
    (lambda: Source(**SOURCE, value={"shape": "step", "t": 1, "to": 1}), "Source.value.t: unknown key"),
    (lambda: Impedance(at="a", expression="1+"), "Impedance.expression: column 3: the expression ends too early"),
    (lambda: Solver(order=0), "Solver.order: not a whole number in range, expected one from 1 to 16, got 0"),
]


@pytest.mark.parametrize(("make", "begin"), ELEMENTS, ids=[case[1][:50] for case in ELEMENTS])
def test_elements_alone(make, begin):
    with pytest.raises(SceneError) as caught:
        make()
    agree(str(caught.value).splitlines(), [begin])
