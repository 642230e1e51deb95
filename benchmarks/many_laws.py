"""Time of a step at many nodes with laws: python -m benchmarks.many_laws [NUMBER...].

A chain of pipes with an orifice after each; then with a capacitor beside each too, so that circuits have states.
"""

import sys
import time
from statistics import median

import numpy as np

from tline.scene.scene import Scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import Stepper

SLABS, REPEATED = 100, 5


def chain(number: int, *, capacitors: bool) -> Scene:
    """Pipes of one to two slabs' delay, with an orifice between each two."""
    delays = 1 + np.random.default_rng(1).random(number)
    lines = {f"p{k}": {"nodes": [f"a{k}", f"b{k}"], "z0": 1.0, "delay": float(delays[k])} for k in range(number)}
    orifice = {"kind": "orifice", "flow": 1.0, "pressure_drop": 1.0}
    links = {f"o{k}": orifice | {"nodes": [f"b{k}", f"a{k + 1}"]} for k in range(number - 1)}
    beside = {f"c{k}": {"at": f"a{k}", "kind": "capacitor", "capacitance": 0.5} for k in range(1, number)}
    return Scene(
        medium="hydraulic",
        t_end=float(SLABS),
        solver={"order": 3, "slab": 0.9},
        lines=lines,
        links=links,
        loads=beside if capacitors else {},
        probes={"p": {"at": "a0"}},
    )


def seconds(number: int, *, capacitors: bool) -> tuple[float, float]:
    """Time to assemble a chain, and the median time of its steps."""
    begun = time.perf_counter()
    assembly = assemble(describe(chain(number, capacitors=capacitors)), set())
    assembled, times = time.perf_counter() - begun, []
    assembly.state.waves[:] = np.random.default_rng(2).normal(size=assembly.state.waves.shape)
    steps = Stepper(assembly, SLABS * REPEATED, np.zeros((0, 2, SLABS * REPEATED * 3)))
    steps.compile()
    for part in range(REPEATED):
        begun = time.perf_counter()
        steps.advance(part * SLABS, (part + 1) * SLABS)
        times.append(time.perf_counter() - begun)
    return assembled, median(times[1:])


if __name__ == "__main__":
    for capacitors in (False, True):
        for number in map(int, sys.argv[1:] or (1000, 10_000)):
            assembled, stepped = seconds(number, capacitors=capacitors)
            each = 1e9 * stepped / SLABS / number / 3
            print(
                f"{'with' if capacitors else 'without'} capacitors, {number} pipes: assembled in {assembled:.2f} s, ",
                end="",
            )
            print(f"{SLABS} slabs in {stepped:.3f} s, {each:.0f} ns a sample of a node", flush=True)
