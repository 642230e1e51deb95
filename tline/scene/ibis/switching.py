"""How a driver passes from pull-down to pull-up and back: shares of its two tables over time.

Into a fixture of resistance R toward V, with the die's capacitance C, a waveform u(t) of the file means

    (V - u)/R - C du/dt - i_clamps(u) = p·i_up(u) + q·i_down(u),

one equation for each waveform. Two of them, into different fixtures, give both shares p and q; of one alone q = 1 - p;
without any p is the ramp. The method is that of two waveforms, as in the IBIS Modeling Cookbook (2005), section 2.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.ibis.buffer import Buffer, CurrentTable, EdgeWaveform

STRAIGHT = 1e-2  # of a share: so far may straight lines between fewer instants be from it; cubics are a tenth of that


class Edge(NamedTuple):
    """Shares of pull-up and pull-down after an edge, straight between instants, from 0 to 1 or back."""

    t: NDArray
    up: NDArray
    down: NDArray
    misfit: float  # largest distance of the shares at both ends from 0 and 1, before they were drawn there


def edge_of(buffer: Buffer, rises: bool) -> Edge:
    """The edge that a model's waveforms give, or else its ramp.

    Examples
    --------
    >>> table = CurrentTable(0.0, False, np.array([0.0, 1.0]), np.array([0.0, 0.02]))
    >>> buffer = Buffer("x", "output", 1e-12, 1.0, {"pulldown": table}, {True: 1e-9}, [], (0, 0, 0), [])
    >>> edge = edge_of(buffer, True)
    >>> edge.t.tolist(), edge.up.tolist(), edge.down.tolist()
    ([0.0, 1e-09], [0.0, 1.0], [1.0, 0.0])
    """
    waveforms = [each for each in buffer.waveforms if each.rises == rises]
    if not waveforms:
        up = np.array([0.0, 1.0])
        return Edge(np.array([0.0, buffer.ramps[rises]]), up if rises else 1 - up, 1 - up if rises else up, 0.0)
    t = np.unique(np.concatenate([each.t for each in waveforms]))
    up, down = _shares(buffer, waveforms, t)
    wanted = (0.0, 1.0) if rises else (1.0, 0.0)
    misfit = max(abs(up[0] - wanted[0]), abs(up[-1] - wanted[1]), abs(down[0] - wanted[1]), abs(down[-1] - wanted[0]))
    up, down = _drawn(up, *wanted), _drawn(down, *wanted[::-1])
    kept = np.union1d(_kept(t, up), _kept(t, down))
    return Edge(t[kept] - min(t[0], 0.0), up[kept], down[kept], float(misfit))


def _shares(buffer: Buffer, waveforms: list[EdgeWaveform], t: NDArray) -> tuple[NDArray, NDArray]:
    """Shares of both tables by least squares over all waveforms."""
    u = np.array([np.interp(t, each.t, each.u) for each in waveforms])
    toward, R, C = np.array([(each.toward, each.resistance, each.capacitance) for each in waveforms]).T[:, :, None]
    flow = (toward - u) / R - (buffer.capacitance + C) * np.gradient(u, t, axis=1)
    flow -= sum(_current(buffer.tables.get(name), u) for name in ("power clamp", "gnd clamp"))
    up, down = (_current(buffer.tables.get(name), u) for name in ("pullup", "pulldown"))
    if len(waveforms) == 1 or not (up.any() and down.any()):  # q = 1 - p
        p = _quotient(((flow - down) * (up - down)).sum(axis=0), ((up - down) ** 2).sum(axis=0))
        return p, 1 - p
    a, b, c = (up * up).sum(axis=0), (up * down).sum(axis=0), (down * down).sum(axis=0)
    x, y, determinant = (flow * up).sum(axis=0), (flow * down).sum(axis=0), a * c - b * b
    return _quotient(c * x - b * y, determinant), _quotient(a * y - b * x, determinant)


def _current(table: CurrentTable | None, u: NDArray) -> NDArray:
    return np.zeros_like(u) if table is None else table.current(u)


def _quotient(a: NDArray, b: NDArray) -> NDArray:
    """a/b, between neighbours where nothing follows from the waveforms."""
    sure = b > 1e-9 * b.max(initial=0.0)
    k = np.arange(len(b))
    return np.interp(k, k[sure], a[sure] / b[sure]) if sure.any() else np.zeros_like(a)


def _drawn(share: NDArray, first: float, last: float) -> NDArray:
    """A share moved and scaled so that it begins and ends where it should; never below zero."""
    span = share[-1] - share[0]
    moved = first + (last - first) * (share - share[0]) / span if span else np.linspace(first, last, len(share))
    return np.maximum(moved, 0.0)


def _kept(t: NDArray, y: NDArray) -> NDArray:
    """Instants between which straight lines are near enough (Ramer 1972, Douglas and Peucker 1973)."""
    kept, parts = {0, len(t) - 1}, [(0, len(t) - 1)]
    while parts:
        low, high = parts.pop()
        line = y[low] + (y[high] - y[low]) * (t[low : high + 1] - t[low]) / (t[high] - t[low])
        off = np.abs(y[low : high + 1] - line)[1:-1]  # each part is shorter than what it is of, whatever rounding does
        if off.size and off.max() > STRAIGHT:
            k = low + 1 + int(off.argmax())
            kept.add(k)
            parts += [(low, k), (k, high)]
    return np.array(sorted(kept))


def over_time(
    first: bool, edges: dict[bool, Edge], instants: list[tuple[float, bool]]
) -> dict[str, tuple[NDArray, NDArray]]:
    """Shares over time of a driver that begins high or low and has edges at instants, each a rise or a fall.

    What each edge changes adds up, so that one which comes before the last has ended goes on from there.
    """
    found = {}
    for name, begin in (("up", float(first)), ("down", float(not first))):
        t, bend = [np.zeros(0)], [np.zeros(0)]
        for at, rises in instants:
            edge = edges[rises]
            t.append(at + edge.t)
            bend.append(np.diff(np.diff(getattr(edge, name)) / np.diff(edge.t), prepend=0.0, append=0.0))
        times, where = np.unique(np.concatenate(t), return_inverse=True)
        slope = np.cumsum(np.bincount(where, np.concatenate(bend), len(times)))
        level = begin + np.concatenate([[0.0], np.cumsum(slope[:-1] * np.diff(times))])[: len(times)]
        found[name] = times, np.maximum(level, 0.0)
    return found
