"""Bad input gets one clear sentence a mistake that names the element: never a traceback, never a silent pass."""

import re

import pytest
from scene_mistakes import CABLE, PIPE, agree, changed, mistakes_of

from tline.scene.file import read_scene
from tline.scene.mistakes import MOST_MISTAKES
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe

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
{shape = "modulated sine", amplitude = 1, frequency = 1, index = 2}
  => .modulation: not given together with its index, expected both, or neither of them
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
~ expression = "R" | parameters = {R = "3 ohx"} => .parameters.R: unknown unit 'ohx'
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
        "loads.end: node 'far' is a junction, and only the end of one line can be matched, expected a resistor, got 2"
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
    assert len(found) == MOST_MISTAKES + 1
    assert found[-1] == "and 1,134 more mistakes"


# the same mistakes in Python
