"""Arrays of lines with distributed losses: their friction, and matrices of half diamonds.

On the triangle 0 ≤ p ≤ q ≤ 1 polynomials of degree s are held by K = (s + 1)(s + 2)/2 orthonormal modes. Friction is
projected on these, and the flow likewise before friction is looked up. The waves that leave the triangle are
interpolated at Radau's points: accurate at slab ends. Where that would make energy, they are projected on the
polynomials of a slab: the transposed matrices do that, so energy is lost under any law (docs/theory.md).
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.loss import Foster
from tline.loss.flow_law import Colebrook, PowerLaw, SwameeJain, colebrook_table
from tline.solver.description.laws import tools_of
from tline.solver.description.lines import Circuits, Line, distinct, one_step
from tline.solver.description.slab import WHOLE
from tline.solver.kernel.diamonds.cells import CELL_ORDER
from tline.solver.kernel.diamonds.full import PLACES, TERMS, lose_steadily, lost
from tline.solver.kernel.network import COLEBROOK, POWER, SQUARE, SWAMEE_JAIN, Diamonds, Memory, Network, State
from tline.solver.radau import Basis, basis, gauss
from tline.solver.steady.edges import Ends

if TYPE_CHECKING:
    from tline.solver.assembly.layout import Junctions, SlabGrid

EXPONENT = 1023  # of 1.0, as numbers hold it
EXACT, SHARE = 1e-15, 1e-6  # of the largest wave, and of what may be left out: changes that end an iteration
STEP, WEAK = 1e-5, 8.0  # of the largest wave, and of what may be left out: jumps that part a cell
KIND = {PowerLaw: POWER, SwameeJain: SWAMEE_JAIN, Colebrook: COLEBROOK}


@lru_cache
def triangle(s: int) -> tuple[NDArray, ...]:
    """Matrices of the half diamond of order s, as in `Diamonds` from `sent` to `left`."""
    p, q, weights = _points(s + 3)
    rough = _graded(p, q, s) * np.sqrt(weights)[:, None]
    to_modes = np.linalg.inv(np.linalg.qr(rough)[1])

    def modes(p: NDArray, q: NDArray) -> NDArray:
        return _graded(p, q, s) @ to_modes

    def behind(p: NDArray, q: NDArray) -> NDArray:
        """Integrals of modes along leaving characteristics, from the end p = q on."""
        parts = [((q - p) * w)[:, None] * modes(p, p + (q - p) * x) for x, w in zip(*gauss(s + 1), strict=True)]
        return np.sum(parts, axis=0)

    def before(p: NDArray, q: NDArray) -> NDArray:
        """Integrals of modes along arriving characteristics, from p = 0 on."""
        return np.sum([(p * w)[:, None] * modes(p * x, q) for x, w in zip(*gauss(s + 1), strict=True)], axis=0)

    order, here = basis(s), modes(p, q).T * weights
    sent, seen, inside = here @ order.evaluation(p), here @ order.evaluation(q), here @ (behind(p, q) + before(p, q))
    p, q, weights = _points(s + 1)
    values, by_weight, c = modes(p, q), 1 / order.A[-1][:, None], order.c
    gained = np.stack([before(c, c), by_weight * seen.T])
    left = np.stack([behind(c, np.ones(s)), by_weight * sent.T])
    return tuple(map(np.ascontiguousarray, (sent, seen, inside, values, values.T * weights, gained, left)))


def _points(n: int) -> tuple[NDArray, NDArray, NDArray]:
    """Gauss points (p, q) in the triangle, and their weights."""
    x, w = gauss(n)
    share, q = (each.ravel() for each in np.meshgrid(x, x))
    across, along = (each.ravel() for each in np.meshgrid(w, w))
    return share * q, q, across * along * q


def _graded(p: NDArray, q: NDArray, s: int) -> NDArray:
    """A basis of the polynomials of degree s at points, shape (points, modes)."""
    across = legendre.legvander(2 * p / q - 1, s) * q[:, None] ** np.arange(s + 1)
    along = legendre.legvander(2 * q - 1, s)
    return np.stack([across[:, m] * along[:, n] for m in range(s + 1) for n in range(s + 1 - m)], axis=1)


def diamonds_of(
    grid: "SlabGrid", order: Basis, junctions: "Junctions", same: float, sent: NDArray, y: NDArray
) -> Diamonds:
    """Diamonds of the lines with distributed losses; breakpoints below `same` of the largest wave are dropped.

    Friction is in cells of `grid.cell` slabs, or in diamonds of one slab if that is 0. `sent` are waves as sent and y
    flows, both at the ends of lines before t = 0; cells compute changes from these.
    """
    here, rests, ends = np.array(grid.diamonds, int), np.array([*grid.rests, 0.0]), junctions.ends
    row, rest = np.full(len(grid.lines), -1), rests[grid.shift_row[here]]
    cell, blocks, lossy = grid.cell, junctions.blocks, [line for line in grid.lines.values() if line.dispersive]
    if not cell:
        row[here] = np.arange(len(here))
    each, like = distinct(lossy)
    first = np.unique(like, return_index=True)[1]
    steps, slabs = np.where(blocks.waits[here], blocks.stride, 1)[first], grid.delay[here][first]
    cells = [_cell(*each, cell) for each in zip(slabs.tolist(), rest[first].tolist(), steps.tolist(), strict=True)]
    tables, table_at = _tables(each)
    at_end = np.concatenate([[0], np.cumsum(row[ends >> 1] >= 0)])
    halves = len(here) and not cell
    matrices = [(order.projection(0.0, f), order.restriction(1.0 - f, 1.0)) for f in grid.rests if halves]
    circuits = [grid.circuits[name] for name, line in grid.lines.items() if line.dispersive]
    alike = [circuits[k] for k in first.tolist()]
    friction = [_friction(line, own.series.loss, grid.h) for line, own in zip(each, alike, strict=True)]
    found = Diamonds(
        here,
        row,
        np.diff(at_end[junctions.first[junctions.group]]) > 0,
        rest,
        np.array([kind for kind, _ in friction], int)[like],
        np.array([constants for _, constants in friction]).reshape(-1, 5)[like],
        tables,
        table_at[like],
        tools_of(basis(min(order.s, CELL_ORDER)) if cell else order),
        order.A[-1],
        *triangle(order.s if halves else 1),
        ends=np.array(matrices).reshape(-1, 2, order.s, order.s),
        exact=max(EXACT, SHARE * same),
        cell=np.array([k for k, _ in cells], int)[like],
        over=np.array([over for _, over in cells])[like],
        begin=order.evaluation([0.0])[0],
        jump=max(STEP, WEAK * same) if order.s > 1 else inf,  # constants jump everywhere
        steady=np.zeros((len(here), 4)),
        memory=_memory(
            zip(each, alike, cells, (slabs + rest[first]).tolist(), strict=True),
            like.tolist(),
            basis(min(order.s, CELL_ORDER)),
            grid.h,
        ),
    )
    if cell:
        begin_steady(found, sent, y, grid.z0)
    return found


def begin_steady(diamonds: Diamonds, sent: NDArray, y: NDArray, z0: NDArray) -> None:
    """Write down the state before t = 0, shape (L, 2) each, from which cells count changes."""
    a1, b2 = sent[diamonds.line].T
    d = 2 * z0[diamonds.line] * y[diamonds.line].mean(axis=1)
    diamonds.steady[:, :3] = np.stack([a1 - b2, a1 + b2, d], axis=1)
    lose_steadily(pack(diamonds))


def _memory(
    kinds: Iterable[tuple[Line, Circuits, tuple[int, float], float]], like: list[int], order: Basis, h: float
) -> Memory:
    """Circuits of the columns of cells, half a cell apart; the outermost include the rest of the line.

    Each row is like a kind of lines, whose maps it shares.
    """
    maps, size, known = [np.empty(0)], 0, []
    for line, circuits, (k, over), slabs in kinds:
        left, own = np.ones(2), []
        for sign, law, per in _laws(line, circuits) if k else ():
            number, half = 2 * int(slabs // k) - 1, k / (2 * slabs)
            ends = (1.5 + over / k) * half if number > 1 else 1.0
            each = [one_step(law, share * per, order, k * h) for share in (half, ends)]
            left /= 1 + per * np.array([half, ends]) * (law.loss + law.strengths.sum()) / 2
            own.append((sign, law.rates.size, [size, size + each[0].size], number))
            maps, size = [*maps, *each], size + 2 * each[0].size
        known.append((own, left))
    laws = [law for k in like for law in known[k][0]]
    first, rest = np.cumsum([0, *(len(known[k][0]) for k in like)]), [known[k][1] for k in like]
    signs, modes, at, numbers = zip(*laws, strict=True) if laws else ((), (), (), ())
    states = np.cumsum([0, *(number * n for number, n in zip(numbers, modes, strict=True))])
    places = np.array(at, int).reshape(-1, 2)
    each = first, np.array(signs, float), np.array(modes, int), places, np.concatenate(maps), states[:-1]
    return Memory(*each, np.array(rest).reshape(-1, 2), int(states[-1]))


def _laws(line: Line, circuits: Circuits) -> Iterator[tuple[float, Foster, float]]:
    """Yield sign, circuit and factor of the memory in series and of the losses across a line."""
    assert line.losses is not None
    length, series, shunt = line.losses.exact.length, circuits.series, circuits.shunt
    if series.strengths.size:
        yield -1.0, Foster(0.0, 0.0, series.strengths, series.rates), length / line.z0
    if shunt.strengths.size or shunt.loss:
        yield 1.0, shunt, length * line.z0


def _cell(D: int, f: float, step: int, wanted: float) -> tuple[int, float]:
    """Slabs in a cell of a line D + f slabs long, in whole steps, with the least remainder, and the remainder."""
    if not wanted:
        return 0, 0.0
    most = min(int(wanted * (1 + WHOLE)), D)
    k = min(range(most - most % step, most // 2, -step), key=lambda k: (D % k + f) / k)
    return k, D % k + f


def _friction(line: Line, resistance: float, h: float) -> tuple[int, list[float]]:
    """Kind and constants of the friction of half a slab of a line, with its resistance per metre."""
    losses, y = line.losses, 1 / (2 * line.z0)  # flow over d
    assert losses is not None
    law, length = losses.flow_law, losses.exact.length * h / (2 * line.delay)
    r = resistance * length * y
    if law is None:
        return SQUARE, [r, 0.0, 0.0, 0.0, 0.0]
    k = law.square * length * y**2
    if isinstance(law, PowerLaw):
        c = law.strength * length * y**law.exponent
        return (SQUARE, [r, k + c, 0.0, 0.0, 0.0]) if law.exponent == 2 else (POWER, [r, k, c, law.exponent - 1, 0.0])
    assert isinstance(law, Colebrook | SwameeJain)
    return KIND[type(law)], [r, k, law.strength * length * y**2, law.reynolds * y, law.roughness]


def _tables(lines: list[Line]) -> tuple[NDArray, NDArray]:
    """Tables of friction factors and powers, those that lines share once, and the place of each line's."""
    known, kept, at, n = {}, [np.empty(0)], [], 0
    for line in lines:
        law = line.losses.flow_law if line.losses else None
        if not isinstance(law, Colebrook | PowerLaw):
            at.append(0)
            continue
        key = law.roughness if isinstance(law, Colebrook) else (law.exponent,)
        if key not in known:
            if isinstance(law, PowerLaw):
                kept.append(_power_table(law.exponent - 1))
            else:
                first, step, y = colebrook_table(law.roughness)
                kept.append(np.concatenate([[first, step, len(y)], y]))
            known[key], n = n, n + len(kept[-1])
        at.append(known[key])
    return np.concatenate(kept), np.array(at, int)


@lru_cache
def _power_table(n: float) -> NDArray:
    """Table for `tline.solver.kernel.diamonds.full.power`."""
    k, places = np.arange(TERMS), 1 + (np.arange(PLACES) + 0.5) / PLACES
    binomials = np.cumprod(np.append(1.0, (n - k[:-1]) / k[1:]))
    exponents = np.arange(2 * EXPONENT + 1) - EXPONENT
    with np.errstate(over="ignore"):
        powers = np.exp2(n * exponents)
    powers[0] = 0.0  # of nothing, and of what is too little to be a number
    return np.concatenate([binomials, places**n, 1 / places, powers])


def fill_diamonds(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves on lines with distributed losses, each slab on its next edge, and the losses of half diamonds."""
    s, c = order.s, order.c
    for row, k in enumerate(network.diamonds.line.tolist()):
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
