"""Slabs of the production method with interpolation in place of the projection."""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.scene.solver import Solver
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.excitation import EDGE, Waveform, sampled
from tline.solver.loop.march import advance
from tline.solver.radau import Basis, gauss
from tline.study.baseline.method import HALF, MOST_KEPT, BaselineRun, count_steps, delays_of, shortest_delay, within


def pointwise(basis: Any, f: float) -> tuple[NDArray, NDArray]:
    """In place of `Basis.shift`: the delayed wave read off at the points."""
    late = (basis.c < f)[:, None]
    return np.where(late, 0.0, basis.evaluation(basis.c - f)), np.where(late, basis.evaluation(basis.c - f + 1), 0.0)


def projected(waveform: Waveform, breaks: NDArray, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """A waveform at the Radau points of n slabs from number `first` on, shape (n, s).

    Without breakpoints that travel a slab with a jump is L2-projected: that keeps the moments across it, so that what
    passes it is right again at the slab's end.
    """
    start = (first + np.arange(n)) * h
    values = sampled(waveform, basis, h, first, n)
    place = breaks[(breaks > start[0]) & (breaks < start[-1] + h)] / h - first
    near = place - np.floor(place)
    place = place[(near > EDGE) & (near < 1 - EDGE)]
    if not place.size:
        return values
    cut = np.unique(np.floor(place))
    edges = np.unique(np.concatenate([cut, place, cut + 1]))
    slab = np.floor((edges[:-1] + edges[1:]) / 2)
    of_cut = np.isin(slab, cut)  # the others lie between cut slabs
    slab, p, width = slab[of_cut].astype(int), edges[:-1][of_cut], np.diff(edges)[of_cut]
    x, weights = gauss(basis.s + 4)
    t = (p - slab)[:, None] + width[:, None] * x  # in slab time, shape (pieces, nodes)
    seen = waveform.value(start[slab][:, None] + h * t, start[slab][:, None] + h * (p - slab + width / 2)[:, None])
    moments = basis.moments(t.ravel(), (width[:, None] * weights).ravel())
    values[cut.astype(int)] = 0.0
    np.add.at(values, slab, (moments * seen.ravel()).reshape(basis.s, *t.shape).sum(axis=2).T)
    return values


def slabs_pointwise(scene: Scene, n: float, order: int = 4, offset: float = HALF) -> BaselineRun:
    """The slabs of the production method, with interpolation in place of the projection; n slabs per delay."""

    h = shortest_delay(scene) / (n + offset)
    steps = count_steps(scene, h)
    probed = {name: _a_line_at(scene, probe.at) for name, probe in scene.probes.items()}
    within(4 * len(probed) * steps * order, MOST_KEPT)
    cut = scene.model_copy(update={"solver": Solver.model_validate({"order": order, "slab": h})})
    assembly = assemble(describe(cut), {line for line, _ in probed.values()})
    rests = delays_of(scene) / h - assembly.network.delay
    shift = np.array([pointwise(assembly.basis, f) for f in rests])
    rows = np.where(assembly.network.shift_row < 0, -1, np.arange(len(rests)))
    network = assembly.network._replace(shift=shift, shift_row=rows)
    record = np.full((2 * len(assembly.recorded), 2, steps * order), np.inf)  # what stays so grew beyond all bounds
    advance(network, assembly.state, 0, np.zeros((len(assembly.excitations), 0)), record, 0)
    begun = time.perf_counter()
    excitation = np.zeros((len(assembly.excitations), steps, order))
    for row, parts in zip(excitation, assembly.excitations, strict=True):
        for waveform, share in parts:
            row += share * projected(waveform, waveform.breaks(steps * h), assembly.basis, h, 0, steps)
    advance(network, assembly.state, steps, excitation.reshape(len(excitation), -1), record, 0)
    seconds = time.perf_counter() - begun
    at_ends = record[:, :, order - 1 :: order] / 2
    u = {
        name: np.append(0.0, at_ends[assembly.recorded[line] + side].sum(axis=0))
        for name, (line, side) in probed.items()
    }
    return BaselineRun(np.arange(steps + 1) * h, u, seconds)


def _a_line_at(scene: Scene, node: str | None) -> tuple[str, int]:
    return next((name, side) for name, line in scene.lines.items() for side in (0, 1) if line.nodes[side] == node)
