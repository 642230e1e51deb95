"""Lossy lines in a steady flow as arrays: waves and memories of loss elements and segments before t = 0."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.loss_elements import shares
from tline.solver.assembly.lossy_segments import InCells
from tline.solver.kernel.network import REMEMBERED, TABLED, Lumps, Network, State
from tline.solver.radau import Basis
from tline.solver.steady.lossy_lines import Ends, Table


def tables_of(lumps: Lumps, names: list[str]) -> dict[str, Table]:
    """Of lines whose friction is tabled, by name."""
    found: dict[str, Table] = {}
    for r in np.flatnonzero(lumps.kind == TABLED):
        name, at, count = names[lumps.line[r]], int(lumps.at[r]), int(lumps.first[r + 1] - lumps.first[r])
        known = found[name].lumps if name in found else 0
        found[name] = Table(known + count, lumps.entries[at : at + 3 + int(lumps.entries[at + 2])])
    return found


def fill_lumped(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves between lumps and states of circuits in them."""
    lumps, s = network.lumps, order.s
    first = [*np.flatnonzero(np.diff(lumps.line, prepend=-1)).tolist(), len(lumps.line)]
    begin, remembered = lumps.first.tolist(), lumps.kind == REMEMBERED
    known: dict[tuple[int, bytes], NDArray] = {}  # shares of the line that lies before place p and the next
    for low, high in pairwise(first):
        k = int(lumps.line[low])
        D, here = int(network.delay[k]), lumps.place[begin[low] : begin[high]]
        passed = known.get((D, here.tobytes()))
        if passed is None:
            places = np.unique(here)
            even = bool(np.isin(lumps.kind[low:high], (REMEMBERED, TABLED)).any())
            before = np.cumsum([0.0, *shares(len(places), even)])
            passed = before[np.searchsorted(places, np.arange(2 * D), side="right")]
            known[D, here.tobytes()] = passed
        u, q = flows[k].at(passed)
        ring = state.waves[network.offset[k] :][: 2 * D * s].reshape(2, D, s)
        ring[0], ring[1] = (u - q)[::2, None], (u + q)[::-2, None]
        rows = np.arange(low, high)
        for r in rows[remembered[low:high]]:
            n, p = int(lumps.modes[r]), lumps.place[lumps.first[r] : lumps.first[r + 1]]
            _, _, into, decay = _maps(lumps.entries[lumps.at[r] :], s, n)
            same = [j for j in rows if lumps.sign[j] == lumps.sign[r] and lumps.place[lumps.first[j]] == p[0]]
            before, after = (p - 1, p) if r == same[0] else (p, p - 1)  # what another law here has taken already
            seen = (u + q)[before] + lumps.sign[r] * (u - q)[after]
            state.lumps[lumps.memory[r] :][: n * len(p)] = np.outer(into.sum(axis=1) / (1 - decay), seen).ravel()


def _maps(entries: NDArray, s: int, n: int) -> list[NDArray]:
    D, C, B, decay = np.split(entries[: s * s + 2 * s * n + n], np.cumsum([s * s, s * n, s * n]))
    return [D.reshape(s, s), C.reshape(s, n), B.reshape(n, s), decay]


def fill_cells(network: Network, state: State, lines: Mapping[int, InCells], flows: Mapping[int, Ends], order: Basis):
    """Write what cells hold, what leaves them next, and what arrives at the nodes."""
    s = order.s
    for (k, line), x0 in zip(lines.items(), network.cells.state, strict=True):
        cell, D = line.cell, line.number
        here = (np.arange(D)[:, None] + order.c) / D
        u, q = flows[k].at(here)
        series, shunt = line.memories
        fields = np.stack([u + q, u - q, *[q] * series, *[u] * shunt], axis=1).reshape(D, -1)
        leaving = fields @ cell.left.T
        state.cells[x0:][: D * (fields.shape[1] + 2 * s)] = np.hstack([fields, leaving]).ravel()
        R = np.linalg.inv(np.eye(s) + cell.back)
        arriving = np.concatenate([R @ leaving[0, s:], R @ leaving[-1, :s]])
        state.cells[x0 + D * (fields.shape[1] + 2 * s) :][: 2 * s] = arriving
        state.waves[network.offset[k] :][: 2 * s] = arriving
