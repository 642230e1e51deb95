"""The scheme in its plainest form: slab by slab, line by line, no buffers shared, no blocks. Slow and obvious."""

import numpy as np

from tline.solver.assemble import Assembly
from tline.solver.drive import on_slabs
from tline.solver.load_step import load_step


def efforts(assembly: Assembly, n_slabs: int) -> np.ndarray:
    """Effort of each node at the points of each slab, no slab in pieces; shape (nodes, slabs, s)."""
    net, s, h = assembly.network, assembly.resolution.s, assembly.resolution.h
    starts = np.array(list(assembly.start.values()))
    sent = [[np.full(s, starts[e // 2, e % 2])] * (int(net.delay[e // 2]) + 1) for e in range(2 * len(net.delay))]
    u = np.zeros((len(net.first) - 1, n_slabs, s))
    x, step_row = assembly.state.load.copy(), net.step_row.copy()
    for k in range(n_slabs):
        for slab, node, row in assembly.changes:
            if int(slab) == k:
                step_row[node] = row
        arriving = {}
        for e in net.ends:
            line, history = e // 2, sent[e ^ 1]
            now, before = history[-int(net.delay[line])], history[-int(net.delay[line]) - 1]
            row = net.shift_row[line]
            arriving[e] = now if row < 0 else net.shift[row, 0] @ now + net.shift[row, 1] @ before
        for node in range(len(net.first) - 1):
            at = range(net.first[node], net.first[node + 1])
            wave = sum((net.weight[e] * arriving[net.ends[e]] for e in at), np.zeros(s))
            if net.drive_row[node] >= 0:
                for waveform, share in assembly.drives[net.drive_row[node]]:
                    breaks = waveform.breaks(1e9)
                    wave = wave + share * on_slabs(waveform, breaks, assembly.basis, h, k, 1)[0]
            if net.load_row[node] >= 0:
                both = net.step[step_row[node]] @ np.concatenate([wave, x[net.load_row[node]]])
                wave, x[net.load_row[node]] = both[:s], both[s:]
            u[node, k] = wave
            for e in at:
                sent[net.ends[e]].append(2 * wave - arriving[net.ends[e]])
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
    own = np.array([line.parameters.delay / h for line in assembly.scene.lines.values()])
    delay = np.where(net.shift_row < 0, net.delay, own)
    sent: list[list[Piece]] = [
        [(-delay[e // 2] - 2, 0.0, np.full(s, starts[e // 2, e % 2]))] for e in range(2 * len(delay))
    ]
    fronts: list[list[float]] = [[] for _ in sent]
    breaks = [sorted({0.0, *(t / h for w, _ in parts for t in w.breaks(1e3))}) for parts in assembly.drives]
    u, x, step_row = np.zeros((len(net.first) - 1, n_slabs)), assembly.state.load.copy(), net.step_row.copy()
    for k in range(n_slabs):
        for node in range(len(net.first) - 1):
            ends = net.ends[net.first[node] : net.first[node + 1]]
            row, moves = net.drive_row[node], [(t, r) for t, where, r in assembly.changes if where == node]
            here = [t + delay[e // 2] for e in ends for t in fronts[e ^ 1]] + [t for t, _ in moves]
            here += breaks[row] if row >= 0 else []
            here = [t for t in here if k - SAME / 2 <= t < k + 1 - SAME / 2]
            driven: list[Piece] = []
            for p, q in pieces_between(k, breaks[row]) if row >= 0 else []:
                t, inside = h * (p + (q - p) * basis.c), np.array(h * (p + q) / 2)
                driven.append((p, q, sum(share * w.value(t, inside) for w, share in assembly.drives[row])))
            for p, q in pieces_between(k, here):
                for t, r in moves:
                    if abs(t - p) < SAME:
                        step_row[node] = r
                arriving = {}
                for e in ends:
                    recent = [(a + delay[e // 2], b + delay[e // 2], v) for a, b, v in sent[e ^ 1]]
                    arriving[e] = projected(assembly, recent, p, q)
                weights = net.weight[net.first[node] : net.first[node + 1]]
                wave = projected(assembly, driven, p, q)
                wave = wave + sum((w * arriving[e] for w, e in zip(weights, ends, strict=True)), np.zeros(s))
                if net.load_row[node] >= 0:
                    system = assembly.systems[step_row[node]]
                    step, state = load_step(system, basis, (q - p) * h), x[net.load_row[node]][: len(system.A)]
                    effort = step.u_w @ wave + step.u_x @ state
                    x[net.load_row[node], : len(state)] = step.x_w @ wave + step.x_x @ state
                    wave = effort
                for e in ends:
                    sent[e].append((p, q, 2 * wave - arriving[e]))
                u[node, k] = wave[-1]
            for e in ends:
                fronts[e] += here
                sent[e] = [piece for piece in sent[e] if piece[1] > k - delay[e // 2] - 1]
                fronts[e] = [t for t in fronts[e] if t > k - delay[e // 2] - 1]
    return u
