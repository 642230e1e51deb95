"""Speed of the wave kernel against a plain copy and against its plain twin: python -m benchmarks.kernel.

Prints tables and writes them to docs/benchmarks.md. Every figure is a median; every claim is a ratio measured in the
same run.
"""

import sys
import time
from pathlib import Path
from statistics import median

import numpy as np

from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.blocks import blocks_of
from tline.solver.assembly.lossy_segments import segments_of
from tline.solver.description.description import describe
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of
from tline.solver.kernel.network import NO_LOSSES, Network, State
from tline.solver.loop.kernel import advance
from tline.solver.radau import basis

ROOT = Path(__file__).parent.parent
SILENT, UNRECORDED = np.zeros((0, 0)), np.zeros((0, 2, 0))
RUNS = 7


def ring(lines: int, s: int, *, fractional: bool, seed: int = 0) -> tuple[Network, State]:
    """Lines of 50 to 150 slabs, one after the other, the last joined to the first; random waves on them."""
    rng = np.random.default_rng(seed)
    delay = rng.integers(50, 151, lines)
    offset = np.concatenate([[0], np.cumsum(2 * delay * s)[:-1]])
    before_me = (np.arange(lines) - 1) % lines
    ends = np.stack([2 * before_me + 1, 2 * np.arange(lines)], axis=1).ravel()
    y = 1 / rng.uniform(0.5, 2, lines)
    weight = (np.stack([y[before_me], y], axis=1) / (y[before_me] + y)[:, None]).ravel()
    none, first, group = np.full(lines, -1), np.arange(0, 2 * lines + 1, 2), np.arange(lines + 1)
    rests = [basis(s).shift(f) for f in rng.uniform(0.1, 0.9, lines)] if fractional else []
    shift = np.array(rests).reshape(len(rests), 2, s, s)
    rows = np.arange(lines) if fractional else none
    network = Network(
        delay,
        offset,
        rows,
        shift,
        first,
        ends,
        weight,
        none,
        group,
        none,
        none,
        np.zeros(0, np.int64),
        np.zeros(0, np.int64),
        np.zeros(0, bool),
        np.zeros(0),
        np.full(2 * lines, -1),
        none,
        laws_of([Group([], [], [], [])] * lines, [], 0, 0)[0],
        segments_of({})[0],
        NO_LOSSES,
        blocks_of(delay, first, ends, group, NO_LOSSES),
    )
    zeros = np.zeros(lines, np.int64)
    waves = rng.normal(size=int(2 * delay.sum() * s))
    return network, State(waves, zeros, zeros.copy(), np.zeros((2 * lines, s)), np.zeros(0), np.zeros(0), np.zeros(0))


def timed(work) -> float:
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def against_copy(lines: int, s: int, *, fractional: bool) -> tuple[float, float]:
    """Line-end samples per second, and time over that of copying as many bytes within a set of the same size."""
    network, state = ring(lines, s, fractional=fractional)
    slabs = max(int(2e7 / (2 * lines * s)), 50)
    samples = 2 * lines * slabs * s
    target, rounds = np.empty_like(state.waves), max(round(samples / state.waves.size), 1)

    def copy() -> None:
        for _ in range(rounds):
            np.copyto(target, state.waves)

    advance(network, state, slabs, SILENT, UNRECORDED, 0)
    copy()
    rates, ratios = [], []
    for _ in range(RUNS):
        seconds = timed(lambda: advance(network, state, slabs, SILENT, UNRECORDED, 0)) / samples
        rates.append(1 / seconds)
        ratios.append(seconds / (timed(copy) / (rounds * state.waves.size)))
    return median(rates), median(ratios)


def against_twin() -> float:
    """How many times faster than the same scheme in plain numpy, slab by slab."""
    sys.path.insert(0, str(ROOT / "tests"))
    from random_scenes import random_scene
    from twin import efforts

    ratios = []
    for run in range(RUNS):
        assembly = assemble(describe(random_scene(run, lines=12, solver={"order": 5, "slab": 0.1})), set())
        twin = timed(lambda assembly=assembly: efforts(assembly, 200)) / 200
        for _, node, row in assembly.events:
            assembly.network.step_row[node] = row
        silent = np.zeros((len(assembly.excitations), 20_000 * 5))
        kernel = timed(lambda a=assembly, d=silent: advance(a.network, a.state, 20_000, d, UNRECORDED, 0)) / 20_000
        ratios.append(twin / kernel)
    return median(ratios)


def decayed() -> float:
    """Time per step after 10⁶ steps of decay over that at the start."""
    network, state = ring(100, 3, fractional=True)
    network = network._replace(weight=network.weight * 0.9)
    steps = 2_000
    first = median(timed(lambda: advance(network, state, steps, SILENT, UNRECORDED, 0)) for _ in range(RUNS))
    advance(network, state, 1_000_000, SILENT, UNRECORDED, 0)
    last = median(timed(lambda: advance(network, state, steps, SILENT, UNRECORDED, 0)) for _ in range(RUNS))
    return last / first


def report() -> str:
    rows = [
        "# Benchmarks",
        "",
        "Written by `make bench`; medians of 7 runs on one core. A *ratio to copy* is the time per line-end sample",
        "over that of copying as many bytes (`numpy.copyto`) within a working set of the same size, in the same run.",
        "Networks are rings of lines of 50 to 150 slabs with a junction between each two.",
        "",
        "| lines | delays | s | line-end samples/s | ratio to copy |",
        "|---:|---|---:|---:|---:|",
    ]
    for lines in (1, 100, 10_000, 100_000):
        for fractional in (False, True):
            for s in (1, 3, 6):
                rate, ratio = against_copy(lines, s, fractional=fractional)
                delays = "fractional" if fractional else "whole"
                rows.append(f"| {lines} | {delays} | {s} | {rate:.2g} | {ratio:.1f} |")
    return "\n".join(
        [
            *rows,
            "",
            "| measure | value |",
            "|---|---:|",
            f"| plain numpy twin over the kernel, random networks of 12 lines, s = 5 | {against_twin():.0f} |",
            f"| time per step after 10⁶ steps of decay over that at the start | {decayed():.2f} |",
            "",
        ]
    )


if __name__ == "__main__":
    text = report()
    print(text)
    (ROOT / "docs" / "benchmarks.md").write_text(text, encoding="utf-8")
