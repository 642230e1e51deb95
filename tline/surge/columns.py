"""Columns that separate in an operated network: cavities are laid where the liquid would boil, and the run made again.

They are of vapour alone, at nodes and at equal stretches along the pipes beside them, and delays are rounded to whole
slabs. Spikes between cavities depend on their places (`tline.design.columns`), so there are further runs with twice the
places and slabs half as wide each time, until they leave one class or agree; the change of the highest pressure by the
last two is reported as its band.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from itertools import pairwise
from math import ceil, log2
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.cavities import MOST_PLACES, with_cavities
from tline.scene.heights import weight_at
from tline.scene.held import held_nodes
from tline.scene.scene import Scene
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import Result
from tline.solver.result.states import StateTrace
from tline.solver.result.wave import LineRecord
from tline.solver.tolerance.grids import CAUTION
from tline.solver.tolerance.ladder import Budget
from tline.surge.worst import BOILS, CAVITIES, boils, class_of, extremes

FEWEST = 2  # stretches of the longest pipe that boils, in the first run; shorter ones have as many fewer
RUNS = 3  # at least, each with twice the places
ROUNDS = 12  # of runs, in which more nodes may boil
PLACES = 12  # of a pipe at which it is checked for boiling
SAMPLES, WIDEST = 4e6, 4.0  # line-end samples of the finest run, and the same over those of the first
FINER = 4.0  # times that a run may take as long as the one before it
GONE = 1e-2  # of its largest volume, below which a cavity has collapsed
LARGEST = 3  # cavities in the report
ROUGHLY = {"rounded": True, "tol": 1e-2}  # solver of a run that finds slabs for others


class Columns(NamedTuple):
    """Results for columns that separate."""

    places: tuple[int, ...]  # cavities at nodes and inside pipes, of the last two runs
    spread: float  # how far the number of places moves the highest pressure, Pa; 0 if there was time for one alone
    cavities: tuple["Vapour", ...]  # the largest first


class Vapour(NamedTuple):
    """A cavity."""

    where: str  # node, or place inside a pipe
    volume: float  # the largest, m³
    at: float  # when, s
    collapse: float | None  # when it is gone after that, s; None if it is not


def separated(
    result: Result, run: Callable[[Scene], Result], budget: Budget
) -> tuple[Result, Columns | None, tuple[str, ...]]:
    """Return the run with cavities where the first one boils, their results, and notes; else the first one."""
    scene, nodes, pipes = result.scene, set[str](), set[str]()
    still, seen, found, notes, takes = _still(scene), result, list[Result](), list[str](), result.seconds
    try:
        for _ in range(ROUNDS):
            wet = {one.node for one in extremes(seen) if boils(one) and one.before >= BOILS} - still - nodes
            inner = {*_boiling_inside(seen)} - pipes
            if wet or inner:
                found, nodes = found[:-1], nodes | wet  # runs before it do not boil there
                pipes |= inner | {name for name, line in scene.lines.items() if wet & {*line.nodes}}
            if not nodes | pipes or _are_enough(found):
                break
            if budget.left < takes:
                notes.append(f"columns that separate: another run would take the total beyond {budget.seconds:g} s")
                break
            if not result.resolution.rounded:
                result = run(scene.with_changes(solver=ROUGHLY))
            before, finer = budget.left, 2 ** len(found)
            slab = result.resolution.h * 2.0 ** max(ceil(log2(WIDEST * result.samples / SAMPLES)), 0) / finer
            seen = run(laid(scene, nodes, pipes, FEWEST * finer, slab))
            if found:
                seen = replace(seen, envelope=_envelope(seen).compared(_envelope(found[-1]), CAUTION))
            found, takes = [*found, seen], FINER * (before - budget.left)
    except InputError as error:
        notes.append(f"columns that separate could not be computed: {error}")
    if not found:
        return result, None, tuple(notes)
    places = tuple(map(_places, found[-2:]))
    return found[-1], Columns(places, _spread(found), tuple(_cavities(found[-1]))), tuple(notes)


def surely(result: Result) -> bool:
    """Whether water surely boils at a node where a cavity may follow, within errors: no finer run is needed."""
    still = _still(result.scene)
    seen = (one for one in extremes(result) if one.lowest + one.lowest_error < BOILS <= one.before)
    return any(one.node not in still for one in seen)


def _still(scene: Scene) -> set[str]:
    """Nodes at which no cavity is laid."""
    return held_nodes(scene) | {load.at for load in scene.loads.values() if load.kind in (*CAVITIES, "air valve")}


def _are_enough(found: list[Result]) -> bool:
    """Whether two comparisons agree as far as is asked, or leave one class; or a finer run would be too long."""
    if len(found) < RUNS:
        return False
    highest, spread = _highest(found[-1]), _spread(found)
    decided = class_of(highest - spread) == class_of(highest + spread)
    too_long = found[-1].samples ** 2 / found[-2].samples > SAMPLES
    return decided or too_long or spread <= ROUGHLY["tol"] * highest


def _spread(found: list[Result]) -> float:
    """Error of the highest pressure by its last two differences, Pa, where errors halve with each run."""
    off = [abs(_highest(one) - _highest(two)) for one, two in pairwise(found)]
    return max((CAUTION * each / 2**k for k, each in enumerate(off[-1:-RUNS:-1])), default=0.0)


def laid(scene: Scene, nodes: Collection[str], pipes: Collection[str], stretches: int, slab: float) -> Scene:
    """Return the scene with cavities of vapour at nodes, and inside pipes, of which the longest has `stretches`.

    It runs on slabs of this width, s, and no stretch is shorter.
    """
    tables: dict[str, Any] = scene.with_lines()
    for node in nodes:
        loads = tables.setdefault("loads", {})
        for name in [name for name, load in loads.items() if load["at"] == node and load["kind"] == "closed"]:
            del loads[name]  # a node with a cavity lets nothing else pass
        loads[f"{node}:cavity"] = {"at": node, "kind": "vapour cavity"}
    delays = {name: float(scene.lines[name].parameters.delay or 0.0) for name in pipes}
    reach = max(max(delays.values(), default=1.0) / stretches, slab)
    for name in delays.keys() - with_cavities(scene.lines).keys():
        number = min(round(delays[name] / reach), MOST_PLACES) - 1
        if number > 0:
            tables["lines"][name] = scene.lines[name].table() | {"cavities": {"places": number}}
    return Scene(scene.folder, **tables | {"solver": {"rounded": True, "slab": slab}})


def _boiling_inside(result: Result) -> Iterator[str]:
    """Recorded pipes in which the liquid boils between their ends, without cavities that follow it."""
    weight = weight_at(result.scene)
    for name in result.lines.keys() - with_cavities(result.scene.lines).keys():
        near, far = (weight.get(node, 0.0) for node in result.scene.lines[name].nodes)
        record, least = result.lines[name], BOILS + min(near, far)
        ends = [each.values[:, -1] for each in (record.a1, record.a2, record.b1, record.b2)]
        if sum(min(each.min() for each in pair) for pair in (ends[:2], ends[2:])) / 2 >= least:
            continue  # whatever meets whatever
        places = np.arange(1, PLACES) / PLACES
        seen = np.array([_inside(record, place, *ends) for place in places]) - (near + places * (far - near))[:, None]
        if ((seen[:, 1:].min(axis=1) < BOILS) & (seen[:, 0] >= BOILS)).any():
            yield name


def _inside(record: LineRecord, place: float, a1: NDArray, a2: NDArray, b1: NDArray, b2: NDArray) -> NDArray:
    """Effort at a share of the delay, before the run and at slab ends, where waves lose evenly on their way."""
    whole = max(round(record.delay / record.a1.h), 1)
    way = round(place * whole)
    a, b = (np.append(np.full(whole + 1, wave.before), at) for wave, at in ((record.a1, a1), (record.b2, b2)))
    n, share = len(a1) + 1, way / whole
    lost_a, lost_b = a[:n] - np.append(record.a2.before, a2), b[:n] - np.append(record.b1.before, b1)
    from_1, from_2 = a[whole - way :][:n] - share * lost_a, b[way:][:n] - (1 - share) * lost_b
    return (from_1 + from_2) / 2


def _envelope(result: Result) -> Envelope:
    assert result.envelope is not None
    return result.envelope


def _highest(result: Result) -> float:
    """Highest gauge pressure at nodes and places, Pa."""
    seen = _envelope(result.parts or result)
    return float((seen.highest - np.nan_to_num(seen.weight)).max())


def _places(result: Result) -> int:
    whole = (result.parts or result).scene
    return sum(load.kind in CAVITIES for load in whole.loads.values())


def _cavities(result: Result) -> Iterator[Vapour]:
    traces = [trace for trace in result.states if trace.word == "cavity" and trace.values.max() > 0]
    for trace in sorted(traces, key=lambda trace: -trace.values.max())[:LARGEST]:
        yield _vapour(trace)


def _vapour(trace: StateTrace) -> Vapour:
    k = int(np.argmax(trace.values))
    gone = np.flatnonzero(trace.values[k:] <= GONE * trace.values[k])
    where = trace.where.partition(".")[2].strip('"').removesuffix(":cavity")
    collapse = float(trace.t[k + gone[0]]) if len(gone) else None
    return Vapour(where, float(trace.values[k]), float(trace.t[k]), collapse)
