"""Lossy lines in a steady flow as arrays: waves and memories of loss elements before t = 0."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.loss_elements import shares
from tline.solver.kernel.diamonds.friction import lost
from tline.solver.kernel.network import REMEMBERED, TABLED, LossElements, Network, State
from tline.solver.radau import Basis
from tline.solver.steady.lossy_lines import Ends, FrictionTable


def tables_of(losses: LossElements, names: list[str]) -> dict[str, FrictionTable]:
    """Of lines whose friction is tabled, by name."""
    found: dict[str, FrictionTable] = {}
    for r in np.flatnonzero(losses.kind == TABLED):
        name, count = names[losses.line[r]], int(losses.first[r + 1] - losses.first[r])
        known = found[name].elements if name in found else 0
        scale = float(losses.strength[losses.first[r]])
        found[name] = FrictionTable(known + count, scale, losses.entries, int(losses.at[r]))
    return found


def fill_losses(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves between loss elements and states of circuits in them."""
    losses, s = network.losses, order.s
    first = [*np.flatnonzero(np.diff(losses.line, prepend=-1)).tolist(), len(losses.line)]
    begin, remembered = losses.first.tolist(), losses.kind == REMEMBERED
    known: dict[tuple[int, bytes], NDArray] = {}  # shares of the line that lies before place p and the next
    for low, high in pairwise(first):
        k = int(losses.line[low])
        D, here = int(network.delay[k]), losses.place[begin[low] : begin[high]]
        passed = known.get((D, here.tobytes()))
        if passed is None:
            places = np.unique(here)
            even = bool(np.isin(losses.kind[low:high], (REMEMBERED, TABLED)).any())
            before = np.cumsum([0.0, *shares(len(places), even)])
            passed = before[np.searchsorted(places, np.arange(2 * D), side="right")]
            known[D, here.tobytes()] = passed
        u, q = flows[k].at(passed)
        ring = state.waves[network.offset[k] :][: 2 * D * s].reshape(2, D, s)
        ring[0], ring[1] = (u - q)[::2, None], (u + q)[::-2, None]
        rows = np.arange(low, high)
        for r in rows[remembered[low:high]]:
            n, p = int(losses.modes[r]), losses.place[losses.first[r] : losses.first[r + 1]]
            _, _, into, decay = _maps(losses.entries[losses.at[r] :], s, n)
            same = [j for j in rows if losses.sign[j] == losses.sign[r] and losses.place[losses.first[j]] == p[0]]
            before, after = (p - 1, p) if r == same[0] else (p, p - 1)  # what another law here has taken already
            seen = (u + q)[before] + losses.sign[r] * (u - q)[after]
            state.loss_states[losses.memory[r] :][: n * len(p)] = np.outer(into.sum(axis=1) / (1 - decay), seen).ravel()


def _maps(entries: NDArray, s: int, n: int) -> list[NDArray]:
    D, C, B, decay = np.split(entries[: s * s + 2 * s * n + n], np.cumsum([s * s, s * n, s * n]))
    return [D.reshape(s, s), C.reshape(s, n), B.reshape(n, s), decay]


def fill_diamonds(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves on lines that lose all along, each slab on its next edge, and what half diamonds take."""
    s, c = order.s, order.c
    for row, k in enumerate(network.diamonds.line.tolist()):
        if network.diamonds.cell[row]:
            _fill_cells(network, state, row, flows[k], order)
            continue
        D, f = int(network.delay[k]), float(network.diamonds.rest[row])
        m, n = np.arange(-D, 0)[:, None], np.arange(D)[:, None]
        ring = state.waves[network.offset[k] :][: 2 * D * s].reshape(2, D, s)

        def wave(xi: NDArray, eta: NDArray, sign: int, k: int = k, long: float = D + f) -> NDArray:
            u, q = flows[k].at((eta - xi) / (2 * long))
            return u + sign * q

        ring[0], ring[1] = wave(-n + 0 * c, n + f + c, -1), wave(m + c, -m + f + 0 * c, 1)
        state.before[2 * k] = wave(0 * c, f * c, -1)
        state.before[2 * k + 1] = wave(f * c - D - f, D + f + 0 * c, 1)
        d = 2 * flows[k].line.z0 * float(flows[k].y[0])
        state.halves[2 * k] = lost(network.diamonds, row, d)[0]
        state.halves[2 * k + 1] = -state.halves[2 * k]


def _fill_cells(network: Network, state: State, row: int, flow: Ends, order: Basis) -> None:
    """Write waves on a line whose friction is in cells: what each slab has lost in those that it has passed."""
    line, k, over = network.diamonds.line[row], int(network.diamonds.cell[row]), float(network.diamonds.over[row])
    D, s, long = int(network.delay[line]), order.s, float(network.delay[line] + network.diamonds.rest[row])
    since, most = np.arange(D)[::-1, None], D // k - 1  # slabs since each has left its end
    passed, place = since // k, (k - 1 - since % k + order.c) / k
    share = np.where(passed < most, (2 * passed + 3 - place + over / k) * k / (2 * long), 1.0)
    ring = state.waves[network.offset[line] :][: 2 * D * s].reshape(2, D, s)
    (ua, qa), (ub, qb) = flow.at(share), flow.at(1 - share)
    ring[0], ring[1] = ub - qb, ua + qa
