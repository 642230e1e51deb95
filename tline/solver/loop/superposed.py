"""Runs of scenes with lines in segments whose fronts lie inside slabs: slabs begin before the scene does.

A segment is exact for what is smooth in a slab. Where all fronts lie at one place of their slabs, slabs begin so much
earlier that it is an edge. Where they lie at several, and the scene is linear and stays what it is, each family of
fronts has a run of its own; the waves are their sum, in each slab of the scene in pieces between the fronts.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.assemble import Assembly
from tline.solver.description.excitation import Waveform
from tline.solver.description.families import MOST, Changes, changes_of, family_of, leads
from tline.solver.loop.march import March, Noted, march
from tline.solver.radau import Basis

MOST_SAMPLES = 4e7  # in pieces between fronts


class Family(NamedTuple):
    """Fronts at one place of their slabs, in an assembled scene without the others."""

    ahead: float  # slabs by which its slabs begin before t = 0
    assembly: Assembly


def families_of(assembly: Assembly) -> list[Family]:
    """Families of fronts in a scene with lines in segments; none where slabs from t = 0 on suit them."""
    network, h, t_end = assembly.network, assembly.resolution.h, assembly.description.t_end
    if not network.segments.line.size or assembly.follows_edges:
        return []
    steady, controls = assembly.description.steady, set(network.laws.excitation_row.tolist())
    rows = [
        [(changes_of(waveform, steady or row in controls, t_end), share) for waveform, share in parts]
        for row, parts in enumerate(assembly.excitations)
    ]
    every = [changes for parts in rows for changes, _ in parts]
    moves = np.array([event.at for event in assembly.events])
    ahead = leads(np.concatenate([moves, *(changes.at / h for changes in every)]))
    inseparable = moves.size or network.laws.kind.size or any(_several(changes, h, ahead) for changes in every)
    pieces = len(ahead) * assembly.kept * t_end / h * assembly.basis.s
    if not ahead.any() or len(ahead) > (1 if inseparable or pieces > MOST_SAMPLES else MOST):
        return []
    return list(_families(assembly, rows, ahead))


def _families(assembly: Assembly, rows: list[list[tuple[Changes, float]]], ahead: NDArray) -> Iterator[Family]:
    h, state = assembly.resolution.h, assembly.state
    for k, slabs in enumerate(ahead.tolist()):

        def part(changes: Changes, k: int = k, late: float = slabs * h) -> Waveform:
            return changes.part(family_of(changes.at / h, ahead) == k, late, first=k == 0)

        excitations = [[(part(changes), share) for changes, share in parts] for parts in rows]
        begin = state if k == 0 else state._replace(**{key: 0 * values for key, values in state._asdict().items()})
        events = [event._replace(at=event.at + slabs) for event in assembly.events]
        yield Family(slabs, replace(assembly, state=begin, excitations=excitations, events=events))


def _several(changes: Changes, h: float, ahead: NDArray) -> bool:
    """Whether a waveform that is not a sum of parts has fronts in several families."""
    return changes.curved and len(set(family_of(changes.at / h, ahead))) > 1


def superposed(families: list[Family], n: int, *, progress: bool = False) -> tuple[NDArray, March]:
    """Advance an assembled scene by n slabs, family by family; returned is what `march` returns, with every row."""
    done: list[March] = []

    def records() -> Iterator[NDArray]:
        for family in families:
            record, run = march(family.assembly, n + (family.ahead > 0.0), every_row=True, progress=progress)
            done.append(run)
            yield record

    ahead = np.array([family.ahead for family in families])
    whole, pieces = summed(records(), ahead, n, families[0].assembly.basis)
    return whole, done[-1]._replace(seconds=sum(run.seconds for run in done), pieces=pieces)


def summed(records: Iterable[NDArray], ahead: NDArray, n: int, order: Basis) -> tuple[NDArray, Noted]:
    """The sum of records on slabs that begin so many slabs earlier each, on n slabs from t = 0 on.

    Parameters
    ----------
    records : iterable of ndarray, shape (rows, 2, slabs * s)
        One for each of `ahead`.
    ahead : ndarray
    n : int
    order : Basis

    Returns
    -------
    ndarray, shape (rows, 2, n * s)
        In whole slabs.
    Noted
        In pieces between the places at which slabs begin.
    """
    edges = np.append(np.unique([0.0, *(1.0 - ahead[ahead > 0.0])]), 1.0)
    values = np.zeros((1, 1, 1, 1, 1))
    for record, slabs in zip(records, ahead.tolist(), strict=True):
        values = values + _pieces(record, slabs, edges, n, order)
    rows, _, _, m, s = values.shape
    places = np.minimum(np.searchsorted(edges[1:], order.c), m - 1)
    local = (order.c - edges[places]) / np.diff(edges)[places]
    whole = np.einsum("rdnis,is->rdni", values[:, :, :, places], order.evaluation(local))
    row, slab, span = np.arange(rows), np.arange(n), np.column_stack([edges[:-1], edges[1:]])
    pieces = Noted(
        np.repeat(row, n * m),
        np.tile(np.repeat(slab, m), rows),
        np.tile(span, (rows * n, 1)),
        values.transpose(0, 2, 3, 1, 4).reshape(rows * n * m, 2, s),
    )
    return np.ascontiguousarray(whole).reshape(rows, 2, n * s), pieces


def _pieces(record: NDArray, ahead: float, edges: NDArray, n: int, order: Basis) -> NDArray:
    """The scene's slabs in pieces, of a record on slabs that begin so many of them earlier; (rows, 2, n, pieces, s)."""
    rows, s = len(record), order.s
    waves = record.reshape(rows, 2, -1, s)
    start, stop = edges[:-1] + ahead, edges[1:] + ahead
    later = ((start + stop) / 2 >= 1.0).astype(int)
    return np.stack(
        [
            waves[:, :, k : k + n] @ order.restriction(a - k, b - k).T
            for a, b, k in zip(start, stop, later.tolist(), strict=True)
        ],
        axis=3,
    )
