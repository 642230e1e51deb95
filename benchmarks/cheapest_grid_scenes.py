"""Scenes of every kind: shipped ones that run fast enough, ladders, Y's, rings, trains, diodes, vessels, friction."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from tline.scene.file import read_scene
from tline.scene.scene import Scene

SHIPPED = [
    "ac_coupled", "antenna", "balun", "cable_mismatch", "cable_rc", "cable_rlc", "coupled_pair",
    "ddr_receiver", "diode_clamp", "filter", "l_match", "lightning", "load_lines", "loop", "lossy_pair",
    "multi_drop_bus", "open_line", "pad_6db", "pipe_friction", "pump_group", "pump_trip", "surge_tank", "tdr",
    "transformer", "valve_closure", "vessel_valve", "via_tdr", "water_pipe", "y_junction",
]  # fmt: skip
Table = dict[str, Any]
STEP, EDGE = {"shape": "step", "to": 1}, {"shape": "ramp", "to": 1, "duration": "0.1003 ps"}
RAMP = {"shape": "ramp", "to": 1, "duration": "0.2 ns"}
TRAIN = {"shape": "pulses", "high": 1, "width": "1 ns", "rise": "0.1 ns", "fall": "0.1 ns", "period": "4.3 ns"}
SINE = {"shape": "sine", "amplitude": 1, "frequency": "200 MHz"}
RESISTOR: Table = {"kind": "resistor", "resistance": 80}
RC: Table = {"kind": "parallel", "resistance": 200, "capacitance": "2 pF"}
DIODE: Table = {"kind": "diode", "saturation": "1 pA"}
VESSEL: Table = {"kind": "air vessel", "gas_volume": "0.4 m^3", "gas_pressure": "5 bar", "kv": 800}
TICKS = [7, 11, 13, 17, 19, 23, 29, 31, 37, 41]


def _scene(delays: Sequence[float], nodes: list[tuple[str, str]], value: Table, load: Table, ns: float) -> Scene:
    """Lines of so many ns from a source at 'n0' to a load at the last node; z0 of 50, 60 and 70 in turn."""
    end = nodes[-1][1]
    return Scene(
        medium="electrical",
        t_end=ns * 1e-9,
        lines={f"l{k}": {"nodes": ends, "z0": 50 + 10 * (k % 3), "delay": delay * 1e-9}
               for k, (delay, ends) in enumerate(zip(delays, nodes, strict=True))},
        sources={"s": {"at": "n0", "kind": "voltage", "value": value, "resistance": 20}},
        loads={"x": load | {"at": end}},
        probes={"near": {"at": "n0"}, "far": {"at": end}},
    )  # fmt: skip


def _ladder(delays: Sequence[float], value: Table, load: Table, ns: float) -> Scene:
    return _scene(delays, [(f"n{k}", f"n{k + 1}") for k in range(len(delays))], value, load, ns)


def _pipes(lines: int, closing: str, factor: float, vessel: Table) -> Scene:
    """Pipes in a row from a reservoir to a valve that closes, with friction if its factor is not 0."""
    line: Table = {"diameter": "300 mm", "wave_speed": "1200 m/s", "density": "1000 kg/m^3"}
    line |= {"friction": {"kind": "darcy", "factor": factor}} if factor else {}
    shut = {"shape": "ramp", "from": 1, "to": 0, "duration": closing}
    valve = {"kind": "orifice", "flow": "60 L/s", "pressure_drop": "3 bar", "opening": shut, "at": f"n{lines}"}
    tank = {"at": "n0", "kind": "reservoir", "pressure": "5 bar"}
    return Scene(
        medium="hydraulic",
        t_end="20 s",
        start="steady",
        lines={f"l{k}": line | {"nodes": [f"n{k}", f"n{k + 1}"], "length": 600 + 137 * k} for k in range(lines)},
        loads={"tank": tank, "valve": valve} | ({"vessel": vessel | {"at": "n1"}} if vessel else {}),
        probes={"valve": {"at": f"n{lines}"}},
    )


def _made() -> Iterator[tuple[str, Scene]]:
    y, ring = [("n0", "j"), ("j", "open"), ("j", "n1")], [("n0", "a"), ("a", "b"), ("b", "n0"), ("b", "n1")]
    yield "ten lines of 1 ns, step", _ladder([1] * 10, STEP, RESISTOR, 200)
    yield "ten lines of 1 ns, train, RC", _ladder([1] * 10, TRAIN, RC, 100)
    yield "ten lines of whole ns, step", _ladder(TICKS, STEP, RESISTOR, 500)
    yield "ten lines of whole ns, ramp, RC", _ladder(TICKS, RAMP, RC, 500)
    yield "two lines 1:137, step", _ladder([1, 137], STEP, RESISTOR, 2000)
    yield "two lines 1:1.37, step", _ladder([1, 1.37], STEP, RESISTOR, 100)
    yield "two lines 1:1.37, ramp, RC", _ladder([1, 1.37], RAMP, RC, 40)
    yield "two lines 1:√2, step", _ladder([1, 2**0.5], STEP, RESISTOR, 40)
    yield "two lines 1:√2, sine, RC", _ladder([1, 2**0.5], SINE, RC, 40)
    yield "three lines, irrational, ramp, RC", _ladder([1, 2**0.5, 3**0.5], RAMP, RC, 20)
    yield "edge of 0.1003 ps", _ladder([1, 1], EDGE, RESISTOR, 20)
    yield "edge of 0.1003 ps, RC", _ladder([1, 1], EDGE, RC, 20)
    yield "edge of 0.1003 ps, 1:1.37", _ladder([1, 1.37], EDGE, RC, 20)
    yield "Y with a stub of 0.3 ns, step", _scene([1, 0.3, 1.7], y, STEP, RESISTOR, 60)
    yield "Y with a stub, train, RC", _scene([1, 0.3, 1.7], y, TRAIN, RC, 60)
    yield "Y with odd delays, ramp, RC", _scene([1.013, 0.317, 1.771], y, RAMP, RC, 30)
    yield "ring, step", _scene([1, 1.5, 2, 1], ring, STEP, RESISTOR, 60)
    yield "ring with odd delays, sine", _scene([1.013, 1.517, 2.031, 1], ring, SINE, RESISTOR, 40)
    yield "one line, sine, RC", _ladder([1], SINE, RC, 40)
    yield "one line, diode, sine", _ladder([1], SINE, DIODE, 30)
    yield "one line, diode, ramp", _ladder([1], RAMP, DIODE, 20)
    yield "one pipe, friction, closing valve", _pipes(1, "2 s", 0.02, {})
    yield "three pipes, friction, closing valve", _pipes(3, "2 s", 0.02, {})
    yield "three pipes, closing valve", _pipes(3, "2 s", 0, {})
    yield "three pipes, valve closed at once", _pipes(3, "1 ms", 0, {})
    yield "two pipes, vessel between, closing valve", _pipes(2, "2 s", 0, VESSEL)


def scenes() -> dict[str, Scene]:
    """All of them by name, without order, slab and tolerance of their own."""
    shipped = {name: read_scene(Path(__file__).parents[1] / "scenes" / f"{name}.toml") for name in SHIPPED}
    return {name: scene.with_changes(solver={}) for name, scene in [*shipped.items(), *_made()]}
