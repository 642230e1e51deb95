"""Cost of the automatic order and slab over the best ones by hand: `python -m benchmarks.cheapest_grid [NAME…]`.

Prints a page and writes it to benchmarks/pages/grid.md. By hand a scene is run once for each of many orders and slabs,
and the cheapest run counts whose true error is not larger. The automatic cost includes all its runs, and their
estimate. Times are of whole calls, of the processor; errors are relative to the amplitude at each probe, at random
instants, against a run to a far smaller tolerance.
"""

import sys
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import table, timed, write
from tline.errors import InputError
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.result.result import Result
from tline.solver.simulate import UnresolvedWarning, simulate

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
TOLERANCES = 1e-3, 1e-6
FINEST = 1e-3, 1e-9  # of the tolerance, and the least: tolerance of the reference run
ORDERS = 1, 2, 3, 4, 5, 6, 8, 10, 12
PARTS = 2.0 ** np.arange(-5, 8)  # of the automatic slab
OF_DELAY = 1, 2, 4, 8  # parts of the shortest delay
INSTANTS = 2000
BESIDE_JUMPS = 1e-6  # of the run; largest error in the instants of jumps
EXACT = 1e-11  # smaller errors are rounding
LARGEST_RATIO = 3.0
HOPELESS = 2.0  # times the cheapest so far, beyond which higher orders by hand are not tried


def _scene(delays: Sequence[float], nodes: list[tuple[str, str]], value: Table, load: Table, ns: float) -> Scene:
    """Lines of given delays, ns, from a source at 'n0' to a load at the last node; z0 of 50, 60 and 70 in turn."""
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
    """All scenes by name, without order, slab and tolerance of their own."""
    shipped = {name: read_scene(Path(__file__).parents[1] / "scenes" / f"{name}.toml") for name in SHIPPED}
    return {name: scene.with_changes(solver={}) for name, scene in [*shipped.items(), *_made()]}


class Run(NamedTuple):
    """Run of a scene, automatic or by hand."""

    seconds: float
    error: float
    order: int
    slab: float


class Row(NamedTuple):
    """Scene at a tolerance."""

    name: str
    tol: float
    met: bool
    automatic: Run
    by_hand: Run
    judged: float  # seconds of that including the run for its error estimate

    @property
    def ratio(self) -> float:
        """Time of the automatic choice over that by hand, both with their estimates."""
        return self.automatic.seconds / self.judged

    @property
    def bare(self) -> float:
        """Time of the automatic choice over that of a run by hand without an error estimate."""
        return self.automatic.seconds / self.by_hand.seconds


def searched(scene: Scene, tol: float) -> Result:
    """Run to a tolerance without knowledge of earlier searches."""
    describe(scene).known.clear()
    return simulate(scene, tol=tol)


def seen(result: Result, t: NDArray) -> dict[str, NDArray]:
    """Efforts, and flows times impedance, at all probes."""
    found = {name: probe.at(t) for name, probe in result.probes.items()}
    return {name: np.stack([each.u, result.probes[name].record.z0 * each.y]) for name, each in found.items()}


def instants(truth: Result) -> NDArray:
    """Random instants, none of them right at a jump."""
    t_end = truth.scene.t_end
    t = np.sort(np.random.default_rng(1).uniform(0.0, t_end * (1 - BESIDE_JUMPS), INSTANTS))
    calm = np.ones(len(t), bool)
    before, after = seen(truth, np.maximum(t - BESIDE_JUMPS * t_end, 0.0)), seen(truth, t + BESIDE_JUMPS * t_end)
    for name, values in before.items():
        calm &= (np.abs(values - after[name]) < 1e-2 * np.abs(values).max(initial=1e-300)).all(axis=0)
    return t[calm]


def error(found: dict[str, NDArray], truth: dict[str, NDArray]) -> float:
    """Largest difference over the amplitude of effort or flow at its probe."""
    largest = max(float(np.abs(values).max()) for values in truth.values())
    worst = 0.0
    for name, values in truth.items():
        most = np.abs(values).max(axis=1)
        off = np.abs(found[name] - values).max(axis=1)
        worst = max(worst, *(float(o / m) for o, m in zip(off, most, strict=True) if m > 1e-9 * largest))
    return worst


def compared(name: str, scene: Scene, tol: float) -> Row:
    """Compare the automatic choice for a scene with the best by hand."""
    truth = simulate(scene, tol=max(FINEST[0] * tol, FINEST[1]))
    t = instants(truth)
    exact = seen(truth, t)
    simulate(scene, tol=tol)
    result, seconds = timed(lambda: searched(scene, tol))
    assert result.accuracy is not None
    at = result.accuracy.attempts[0].slab, min(line.delay for line in describe(scene).lines.values())
    automatic = Run(seconds, error(seen(result, t), exact), result.resolution.s, result.resolution.h)
    slabs = sorted({*(at[0] / PARTS), *(at[1] / np.array(OF_DELAY)), result.resolution.h}, reverse=True)
    best, given = automatic._replace(seconds=np.inf), scene
    for slab in slabs:
        for order in ORDERS:
            try:
                by_hand = scene.with_changes(solver={"order": order, "slab": float(slab)})
                one, spent = timed(lambda by_hand=by_hand: simulate(by_hand), 1)
            except InputError:
                break
            off = error(seen(one, t), exact)
            if off <= max(automatic.error, EXACT):
                _, spent = timed(lambda by_hand=by_hand: simulate(by_hand))
                if spent < best.seconds:
                    best, given = Run(spent, off, order, float(slab)), by_hand
                break
            if spent > HOPELESS * min(best.seconds, seconds):
                break
    _, judged = timed(lambda: searched(given, tol))
    return Row(name, tol, result.accuracy.met, automatic, best, judged)


def page(rows: list[Row]) -> str:
    """Format the sums and the table of the page."""
    ratios, bare = [row.ratio for row in rows], [row.bare for row in rows]
    beyond = sum(ratio > LARGEST_RATIO for ratio in ratios)
    sums = (
        f"{len({row.name for row in rows})} scenes, {len(rows)} rows. Automatic over by hand, both with their errors: "
        f"median {median(ratios):.2g}, largest {max(ratios):.2g}, {beyond} beyond {LARGEST_RATIO:g}. Over one run that "
        f"tells no error: median {median(bare):.2g}, largest {max(bare):.2g}.\n"
    )
    return sums + "\n" + table(COLUMNS, map(cells, rows))


def cells(row: Row) -> list[str]:
    """Format a row of the table."""
    shown = [row.name, f"{row.tol:.0e}", "yes" if row.met else "no"]
    for run in (row.automatic, row.by_hand):
        shown += [f"{run.order}, {run.slab:.3g} s", f"{run.error:.1e}", f"{1e3 * run.seconds:.3g}"]
    return [*shown, f"{1e3 * row.judged:.3g}", f"{row.ratio:.2g}", f"{row.bare:.2g}"]


COLUMNS = "<scene|asked|<met|<automatic|error|ms|<by hand|error|ms|with its error, ms|times|bare"


def main(names: list[str]) -> None:
    """Measure the scenes of these names, or all and write the page."""
    warnings.simplefilter("ignore", UnresolvedWarning)
    rows = []
    for name, scene in scenes().items():
        if not names or name in names:
            for tol in TOLERANCES:
                rows.append(compared(name, scene, tol))
                print(*cells(rows[-1]), sep=" | ", flush=True)
    if not names:
        write("benchmarks/pages/grid.md", page(rows), "measured")


if __name__ == "__main__":
    main(sys.argv[1:])
