"""Columns that separate in an operated network: cavities are laid where the liquid would boil, and the run made again.

They are of vapour alone, at nodes and at equal stretches along the pipes beside them, in the method of textbooks
(order 1). What spikes between cavities do depends on their places (`tline.design.columns`), so there is a second run
with twice the places and slabs half as wide, and how far it moves the highest pressure is told as its band.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.scene.cavities import MOST, with_cavities
from tline.scene.heights import weight_at
from tline.scene.held import held_nodes
from tline.scene.scene import Scene
from tline.solver.result.interior import inside
from tline.solver.result.result import Result
from tline.solver.result.states import StateTrace
from tline.surge.worst import BOILS, CAVITIES, extremes

STRETCHES = 4, 8  # of the longest pipe that boils; shorter ones have as many fewer
ROUNDS = 4  # of runs in which more nodes may boil
PLACES = 12  # of a pipe at which it is looked whether it boils
GONE = 1e-2  # of its largest volume, below which a cavity has collapsed
LARGEST = 3  # cavities that are told


class Columns(NamedTuple):
    """What came of columns that separate."""

    places: tuple[int, ...]  # cavities at nodes and inside pipes, of each run
    spread: float  # how far the number of places moves the highest pressure, Pa
    cavities: tuple["Vapour", ...]  # the largest first


class Vapour(NamedTuple):
    """A cavity."""

    where: str  # node, or place inside a pipe
    volume: float  # the largest, m³
    at: float  # when, s
    collapse: float | None  # when it is gone after that, s; None if it is not


def separated(result: Result, run: Callable[[Scene], Result]) -> tuple[Result, Columns | None, tuple[str, ...]]:
    """The run with cavities where the first one boils, what these do, and notes; the first one where nothing boils.

    Parameters
    ----------
    result : Result
        Of a run without them, with an envelope.
    run : callable
        Of a scene, with an envelope.
    """
    scene, nodes, pipes = result.scene, set[str](), set[str]()
    still = held_nodes(scene) | {load.at for load in scene.loads.values() if load.kind in (*CAVITIES, "air valve")}
    seen, found = result, list[Result]()
    try:
        for _ in range(ROUNDS):
            wet = {one.node for one in extremes(seen) if one.lowest < BOILS <= one.before} - still - nodes
            inner = {*_boiling_inside(seen)} - pipes
            if not wet and not inner:
                break
            nodes |= wet
            pipes |= inner | {name for name, line in scene.lines.items() if wet & {*line.nodes}}
            seen = run(laid(scene, nodes, pipes, STRETCHES[0]))
        if seen is result:
            return result, None, ()
        found = [seen, run(laid(scene, nodes, pipes, STRETCHES[1], seen.resolution.h / 2))]
    except InputError as error:
        return result, None, (f"columns that separate could not be computed: {error}",)
    coarse, fine = found
    assert fine.envelope is not None
    assert coarse.envelope is not None
    spread = abs(_highest(fine) - _highest(coarse))
    told = Columns(tuple(_places(each) for each in found), spread, tuple(_cavities(fine)))
    return replace(fine, envelope=fine.envelope.compared(coarse.envelope, 1.0)), told, ()


def laid(
    scene: Scene, nodes: Collection[str], pipes: Collection[str], stretches: int, slab: float | None = None
) -> Scene:
    """The scene with cavities of vapour at nodes, and inside pipes of which the longest has so many stretches.

    It runs with order 1, in slabs that suit it or have that width, s.
    """
    tables: dict[str, Any] = scene.table()
    for node in nodes:
        loads = tables.setdefault("loads", {})
        for name in [name for name, load in loads.items() if load["at"] == node and load["kind"] == "closed"]:
            del loads[name]  # a node with a cavity lets nothing else pass
        loads[f"{node}:cavity"] = {"at": node, "kind": "vapour cavity"}
    delays = {name: float(scene.lines[name].parameters.delay or 0.0) for name in pipes}
    reach = max(delays.values(), default=1.0) / stretches
    for name in delays.keys() - with_cavities(scene.lines).keys():
        number = min(round(delays[name] / reach), MOST) - 1
        if number > 0:
            tables["lines"][name]["cavities"] = {"places": number}
    return Scene(scene.folder, **tables | {"solver": {"order": 1} | ({"slab": slab} if slab else {})})


def _boiling_inside(result: Result) -> Iterator[str]:
    """Recorded pipes in which the liquid boils between their ends, without cavities that follow it."""
    weight = weight_at(result.scene)
    followed = with_cavities(result.scene.lines)
    for name in result.lines.keys() - followed.keys():
        near, far = (weight.get(node, 0.0) for node in result.scene.lines[name].nodes)
        seen = inside(result, name, PLACES)
        start, lowest, _ = seen.extremes(result.t)
        ground = near + seen.places * (far - near)
        if ((lowest - ground < BOILS) & (start - ground >= BOILS))[1:-1].any():
            yield name


def _highest(result: Result) -> float:
    """Highest gauge pressure at nodes and places, Pa."""
    seen = (result.parts or result).envelope
    assert seen is not None
    return float((seen.highest - np.nan_to_num(seen.weight)).max())


def _places(result: Result) -> int:
    whole = (result.parts or result).scene
    return sum(load.kind in CAVITIES for load in whole.loads.values())


def _cavities(result: Result) -> Iterator[Vapour]:
    traces = [trace for trace in result.states if trace.word == "cavity"]
    for trace in sorted(traces, key=lambda trace: -trace.values.max())[:LARGEST]:
        yield _vapour(trace)


def _vapour(trace: StateTrace) -> Vapour:
    k = int(np.argmax(trace.values))
    gone = np.flatnonzero(trace.values[k:] <= GONE * trace.values[k])
    where = trace.where.partition(".")[2].strip('"').removesuffix(":cavity")
    collapse = float(trace.t[k + gone[0]]) if len(gone) else None
    return Vapour(where, float(trace.values[k]), float(trace.t[k]), collapse)
