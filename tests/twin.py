"""The scheme in its plainest form: slab by slab, line by line, no buffers shared, no blocks. Slow and obvious."""

from itertools import pairwise

import numpy as np

from tline.solver.assembly.assemble import Assembly
from tline.solver.description.circuit import load_step
from tline.solver.description.excitation import sampled


def states_of(assembly: Assembly, g: int, x: np.ndarray) -> np.ndarray:
    """The part of the states that belongs to a group."""
    at, n = assembly.network.load_at[g], len(assembly.systems.spaces[assembly.network.step_row[g]].A)
    return x[at : at + n]


def efforts(assembly: Assembly, n_slabs: int) -> np.ndarray:
    """Effort of each node at the points of each slab, no slab in pieces; shape (nodes, slabs, s)."""
    net, s, h = assembly.network, assembly.resolution.s, assembly.resolution.h
    starts = np.array(list(assembly.start.values()))
    sent = [[np.full(s, starts[e // 2, e % 2])] * (int(net.delay[e // 2]) + 1) for e in range(2 * len(net.delay))]
    steps = [load_step(system, assembly.basis, h) for system in assembly.systems.spaces]
    u = np.zeros((len(net.first) - 1, n_slabs, s))
    x, step_row = assembly.state.load.copy(), net.step_row.copy()
    for k in range(n_slabs):
        for slab, g, row in assembly.events:
            if int(slab) == k:
                step_row[g] = row
        arriving = {}
        for e in net.ends:
            line, history = e // 2, sent[e ^ 1]
            now, before = history[-int(net.delay[line])], history[-int(net.delay[line]) - 1]
            row = net.shift_row[line]
            arriving[e] = now if row < 0 else net.shift[row, 0] @ now + net.shift[row, 1] @ before
        for node in range(len(net.first) - 1):
            for e in range(net.first[node], net.first[node + 1]):
                u[node, k] += net.weight[e] * arriving[net.ends[e]]
            if net.excitation_row[node] >= 0:
                for waveform, share in assembly.excitations[net.excitation_row[node]]:
                    u[node, k] += share * sampled(waveform, assembly.basis, h, k, 1)[0]
        for g, (low, high) in enumerate(pairwise(net.group)):
            if net.load_at[g] >= 0:
                wave, state = u[low:high, k].ravel(), states_of(assembly, g, x)
                both = steps[step_row[g]] @ np.concatenate([wave, state])
                u[low:high, k], state[:] = both[: len(wave)].reshape(-1, s), both[len(wave) :]
        for node in range(len(net.first) - 1):
            for e in net.ends[net.first[node] : net.first[node + 1]]:
                sent[e].append(2 * u[node, k] - arriving[e])
    return u


SAME = 1e-11  # slabs; times nearer than this are one
Piece = tuple[float, float, np.ndarray]  # start, stop, in slabs, and values at the Radau points


def projected(assembly: Assembly, pieces: list[Piece], p: float, q: float) -> np.ndarray:
    """A piecewise polynomial on [p, q]."""
    values = np.zeros(assembly.basis.s)
    for a, b, own in pieces:
        low, high = max(a, p), min(b, q)
        if high > low:
            part = assembly.basis.restriction((low - a) / (b - a), (high - a) / (b - a)) @ own
            values += assembly.basis.projection((low - p) / (q - p), (high - p) / (q - p)) @ part
    return values


def pieces_between(k: int, fronts: list[float]) -> list[tuple[float, float]]:
    """The pieces into which fronts cut slab k."""
    edges = [float(k)]
    for t in sorted(fronts):
        if edges[-1] + SAME < t < k + 1 - SAME:
            edges.append(t)
    return list(zip(edges, [*edges[1:], k + 1.0], strict=True))


def efforts_in_pieces(assembly: Assembly, n_slabs: int) -> np.ndarray:
    """Effort of each node at slab ends, every front a breakpoint for ever; shape (nodes, slabs)."""
    net, basis, s, h = assembly.network, assembly.basis, assembly.basis.s, assembly.resolution.h
    starts = np.array(list(assembly.start.values()))
    own = np.array([line.delay / h for line in assembly.lines.values()])
    delay = np.where(net.shift_row < 0, net.delay, own)
    sent: list[list[Piece]] = [
        [(-delay[e // 2] - 2, 0.0, np.full(s, starts[e // 2, e % 2]))] for e in range(2 * len(delay))
    ]
    fronts: list[list[float]] = [[] for _ in sent]
    breaks = [sorted({0.0, *(t / h for w, _ in parts for t in w.breaks(1e3))}) for parts in assembly.excitations]
    u, x, step_row = np.zeros((len(net.first) - 1, n_slabs)), assembly.state.load.copy(), net.step_row.copy()
    for k in range(n_slabs):
        for g, (low, high) in enumerate(pairwise(net.group)):
            ends = net.ends[net.first[low] : net.first[high]]
            rows, moves = net.excitation_row[low:high], [(t, r) for t, where, r in assembly.events if where == g]
            here = [t + delay[e // 2] for e in ends for t in fronts[e ^ 1]] + [t for t, _ in moves]
            here += [t for row in rows if row >= 0 for t in breaks[row]]
            here = [t for t in here if k - SAME / 2 <= t < k + 1 - SAME / 2]
            driven: list[list[Piece]] = [[] for _ in rows]
            for row, mine in zip(rows, driven, strict=True):
                for p, q in pieces_between(k, breaks[row]) if row >= 0 else []:
                    t, inside = h * (p + (q - p) * basis.c), np.array(h * (p + q) / 2)
                    mine.append((p, q, sum(share * w.value(t, inside) for w, share in assembly.excitations[row])))
            for p, q in pieces_between(k, here):
                for t, r in moves:
                    if abs(t - p) < SAME:
                        step_row[g] = r
                arriving = {}
                for e in ends:
                    recent = [(a + delay[e // 2], b + delay[e // 2], v) for a, b, v in sent[e ^ 1]]
                    arriving[e] = projected(assembly, recent, p, q)
                wave = np.array([projected(assembly, mine, p, q) for mine in driven])
                for node in range(low, high):
                    for i in range(net.first[node], net.first[node + 1]):
                        wave[node - low] += net.weight[i] * arriving[net.ends[i]]
                if net.load_at[g] >= 0:
                    step, state = (
                        load_step(assembly.systems.spaces[step_row[g]], basis, (q - p) * h),
                        states_of(assembly, g, x),
                    )
                    both = step @ np.concatenate([wave.ravel(), state])
                    wave, state[:] = both[: wave.size].reshape(-1, s), both[wave.size :]
                for node in range(low, high):
                    for e in net.ends[net.first[node] : net.first[node + 1]]:
                        sent[e].append((p, q, 2 * wave[node - low] - arriving[e]))
                u[low:high, k] = wave[:, -1]
            for e in ends:
                fronts[e] += here
                sent[e] = [piece for piece in sent[e] if piece[1] > k - delay[e // 2] - 1]
                fronts[e] = [t for t in fronts[e] if t > k - delay[e // 2] - 1]
    return u
