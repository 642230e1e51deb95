"""Arrays of lines with distributed losses: their friction, and matrices of half diamonds.

On the triangle 0 ≤ p ≤ q ≤ 1 polynomials of degree s are held by K = (s + 1)(s + 2)/2 orthonormal modes. Friction is
projected on these, and the flow likewise before friction is looked up. The waves that leave the triangle are
interpolated at Radau's points: accurate at slab ends. Where that would make energy, they are projected on the
polynomials of a slab: the transposed matrices do that, so energy is lost under any law (docs/theory.md).
"""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tline.compiled.structure import empty, pack
from tline.distinct import distinct
from tline.loss import Foster
from tline.loss.flow_law import PowerLaw, SwameeJain, Tabulated
from tline.solver.description.laws import tools_of
from tline.solver.description.lines import Circuits, Columns, Line, one_step
from tline.solver.description.slab import WHOLE
from tline.solver.kernel.network import (
    CELL_ORDER,
    POWER,
    SQUARE,
    SWAMEE_JAIN,
    TABULATED,
    Diamonds,
    Memory,
    Network,
    State,
)
from tline.solver.radau import Basis, basis, gauss
from tline.solver.steady.edges import Ends

if TYPE_CHECKING:
    from tline.solver.assembly.layout import Junctions, SlabGrid

EXPONENT = 1023  # of 1.0, as numbers hold it
EXACT, SHARE = 1e-15, 1e-6  # of the largest wave, and of what may be left out: changes that end an iteration
STEP, WEAK = 1e-5, 8.0  # of the largest wave, and of what may be left out: jumps that part a cell


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
    here, rests, ends, columns = grid.diamonds, np.array([*grid.rests, 0.0]), junctions.ends, grid.columns
    row, rest = np.full(len(grid.lines), -1), rests[grid.shift_row[here]]
    if not len(here):
        return empty(Diamonds)._replace(row=row, at_group=np.zeros(len(junctions.group) - 1, bool))
    cell, blocks = grid.cell, junctions.blocks
    if not cell:
        row[here] = np.arange(len(here))
    sizes = np.stack([grid.delay[here], rest, np.where(blocks.waits[here], blocks.stride, 1)])
    each, like = np.unique(sizes, axis=1, return_inverse=True)
    cells = np.array([_cell(int(D), f, int(step), cell) for D, f, step in each.T.tolist()]).reshape(-1, 2)[like.ravel()]
    names = [] if columns.instant.all() else [*grid.lines]
    lasting = {k: names[line] for k, line in enumerate(here.tolist()) if not columns.instant[line]}
    resistance = columns.resistance[here]
    for k, name in lasting.items():
        resistance[k] = grid.circuits[name].series.loss
    at_end = np.concatenate([[0], np.cumsum(row[ends >> 1] >= 0)])
    halves = len(here) and not cell
    matrices = [(order.projection(0.0, f), order.restriction(1.0 - f, 1.0)) for f in grid.rests if halves]
    found = Diamonds(
        here,
        row,
        np.diff(at_end[junctions.first[junctions.group]]) > 0,
        rest,
        *_friction(columns, here, resistance, grid.h),
        tools_of(basis(min(order.s, CELL_ORDER)) if cell else order),
        order.A[-1],
        *triangle(order.s if halves else 1),
        ends=np.array(matrices).reshape(-1, 2, order.s, order.s),
        exact=max(EXACT, SHARE * same),
        cell=cells[:, 0].astype(int),
        over=cells[:, 1].copy(),
        begin=order.evaluation([0.0])[0],
        jump=max(STEP, WEAK * same) if order.s > 1 else inf,  # constants jump everywhere
        steady=np.zeros((len(here), 4)),
        memory=_memory(grid, lasting, cells, sizes[0] + rest, basis(min(order.s, CELL_ORDER))),
    )
    if cell:
        begin_steady(found, sent, y, grid.z0)
    return found


def begin_steady(diamonds: Diamonds, sent: NDArray, y: NDArray, z0: NDArray) -> None:
    """Write down the state before t = 0, shape (L, 2) each, from which cells count changes."""
    a1, b2 = sent[diamonds.line].T
    d = 2 * z0[diamonds.line] * y[diamonds.line].mean(axis=1)
    diamonds.steady[:, :3] = np.stack([a1 - b2, a1 + b2, d], axis=1)
    from tline.solver.kernel.diamonds.full import lose_steadily

    lose_steadily(pack(diamonds))


def _memory(grid: "SlabGrid", lasting: Mapping[int, str], cells: NDArray, slabs: NDArray, order: Basis) -> Memory:
    """Circuits of the columns of cells, half a cell apart; the outermost include the rest of the line.

    `lasting` are names of the lines that have some, by row; those that are alike share their maps.
    """
    maps, size, known, rows, rest = [np.empty(0)], 0, {}, [], np.ones((len(cells), 2))
    for row, name in lasting.items():
        line, circuits, (k, over) = grid.lines[name], grid.circuits[name], cells[row]
        key = line.z0, line.delay, id(line.losses), k, over
        if key not in known:
            left, own = np.ones(2), []
            for sign, law, per in _laws(line, circuits) if k else ():
                number, half = 2 * int(int(slabs[row]) // k) - 1, k / (2 * slabs[row])
                ends = (1.5 + over / k) * half if number > 1 else 1.0
                each = [one_step(law, share * per, order, k * grid.h) for share in (half, ends)]
                left /= 1 + per * np.array([half, ends]) * (law.loss + law.strengths.sum()) / 2
                own.append((sign, law.rates.size, [size, size + each[0].size], number))
                maps, size = [*maps, *each], size + 2 * each[0].size
            known[key] = own, left
        own, rest[row] = known[key]
        rows += [(row, law) for law in own]
    first = np.searchsorted([row for row, _ in rows], np.arange(len(cells) + 1))
    signs, modes, at, numbers = zip(*(law for _, law in rows), strict=True) if rows else ((), (), (), ())
    states = np.cumsum([0, *(number * n for number, n in zip(numbers, modes, strict=True))])
    places = np.array(at, int).reshape(-1, 2)
    each = first, np.array(signs, float), np.array(modes, int), places, np.concatenate(maps), states[:-1]
    return Memory(*each, rest, int(states[-1]))


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


def _friction(
    columns: Columns, here: NDArray, resistance: NDArray, h: float
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Kind and constants of the friction of half a slab of some lines, with their resistance per metre.

    Returned are also tables of friction factors and powers, those that lines share once, and the place of each line's.
    """
    y, length = 1 / (2 * columns.z0[here]), columns.length[here] * h / (2 * columns.delay[here])  # y: flow over d
    row, kind, table_at = np.full(len(columns.z0), -1), np.full(len(here), SQUARE), np.zeros(len(here), int)
    row[here] = np.arange(len(here))
    constants, tables, size = np.zeros((len(here), 5)), [np.empty(0)], 0
    constants[:, 0] = resistance * length * y
    for places, law in columns.laws:
        k = row[places]
        square = length[k] * y[k] ** 2
        constants[k, 1] = law.square * square
        if isinstance(law, PowerLaw):
            key, c = np.asarray(law.exponent), law.strength * length[k] * y[k] ** law.exponent
            plain = key == 2
            kind[k], constants[k, 1] = np.where(plain, SQUARE, POWER), constants[k, 1] + np.where(plain, c, 0.0)
            constants[k, 2], constants[k, 3] = np.where(plain, 0.0, c), np.where(plain, 0.0, key - 1)
        else:
            assert isinstance(law, Tabulated | SwameeJain)
            key, plain = np.asarray(law.roughness), np.full(len(k), False)
            kind[k] = TABULATED if isinstance(law, Tabulated) else SWAMEE_JAIN
            constants[k, 2:] = np.stack([law.strength * square, law.reynolds * y[k], key], axis=1)
        for each in distinct(key[~plain]) if not isinstance(law, SwameeJain) else ():
            table = law.table(float(each)) if isinstance(law, Tabulated) else _power_table(each - 1)
            table_at[k[key == each]], tables, size = size, [*tables, table], size + len(table)
    return kind, constants, np.concatenate(tables), table_at


@lru_cache
def _power_table(n: float) -> NDArray:
    """Table for `tline.solver.kernel.diamonds.full.power`."""
    from tline.solver.kernel.diamonds.full import PLACES, TERMS

    k, places = np.arange(TERMS), 1 + (np.arange(PLACES) + 0.5) / PLACES
    binomials = np.cumprod(np.append(1.0, (n - k[:-1]) / k[1:]))
    exponents = np.arange(2 * EXPONENT + 1) - EXPONENT
    with np.errstate(over="ignore"):
        powers = np.exp2(n * exponents)
    powers[0] = 0.0  # of nothing, and of what is too little to be a number
    return np.concatenate([binomials, places**n, 1 / places, powers])


def fill_diamonds(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves on lines with distributed losses, each slab on its next edge, and the losses of half diamonds."""
    if not len(network.diamonds.line):
        return
    from tline.solver.kernel.diamonds.full import lost

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
