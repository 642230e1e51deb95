"""Lossy lines in cells one slab long, each advanced by its exact evolution over a slab, projected on polynomials.

In units of a slab, of z0 and of the travel time x, with u the effort, v the flow and a = u + v, b = u - v,

    a_t + a_x = u_t + v_t without travel,   b_t - b_x = u_t - v_t without travel,
    v_t = -r0 v - sum r_k (v - w_k),  w_k' = p_k (v - w_k),   u_t = -g0 u - sum g_k (u - q_k),  q_k' = p_k (u - q_k).

What a cell holds (a, b, the w and q over x) and what enters it during a slab (a at its left end, b at its right end,
over t) are polynomials of degree s - 1; so is, after projection, what it holds a slab later, and what has left it. The
equations dissipate and the projections lose energy, so a cell cannot create any. There is no other error: a front that
enters on a slab's edge leaves on one, and all between is smooth.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss import Law
from tline.loss.foster import Foster
from tline.scene.line import SceneLine
from tline.solver.circuits import Circuits
from tline.solver.network import Cells
from tline.solver.radau import Basis, Matrix, basis
from tline.solver.resolution import WHOLE

FINER = (2, 3, 4, 6, 8, 12, 16, 24, 32)  # lattices one after the other; their error is a series in 1/N²
FEWEST, STIFF = 8, 16  # half the steps of the first lattice: at least, and rates over it
CLOSE = 1e-13  # where the series of lattices ends
KNOWN = 0.01  # of what circuits are off the laws they stand for: so well cells are known
MOST_DIFFERENT = 50  # cells, for each takes some hundredths of a second to find


class Cell(NamedTuple):
    """Maps of a cell over a slab: n fields at s points each; what enters or leaves is b at the left, a at the right."""

    held: Matrix  # (n s, n s) from what it holds to what it holds a slab later
    entered: Matrix  # (n s, 2 s) from what enters (a, b) to what it holds then
    left: Matrix  # (2 s, n s) from what it holds to what leaves (a, b)
    back: Matrix  # (s, s) from what enters at an end to what leaves at the same end


def rates(series: Foster, shunt: Foster, h: float) -> Matrix:
    """Matrix of the equations without travel, for the fields (a, b, w.., q..), in slabs of width h."""
    r0, r, p = h * series.loss / series.storage, h * series.strengths / series.storage, h * series.rates
    g0, g, q = h * shunt.loss / shunt.storage, h * shunt.strengths / shunt.storage, h * shunt.rates
    m, n = len(p), 2 + len(p) + len(q)
    u, v = np.zeros(n), np.zeros(n)
    u[:2], v[:2] = 0.5, (0.5, -0.5)
    into_w, into_q = np.zeros(n), np.zeros(n)
    into_w[2 : 2 + m], into_q[2 + m :] = r, g
    v_t, u_t = into_w - (r0 + r.sum()) * v, into_q - (g0 + g.sum()) * u
    memory = np.concatenate([p[:, None] * v, q[:, None] * u])
    memory[:, 2:] -= np.diag(np.concatenate([p, q]))
    return np.vstack([u_t + v_t, u_t - v_t, memory])


def cell(equations: Matrix, s: int, close: float = CLOSE) -> Cell:
    """The cell of a line whose equations without travel are given, with entries known to `close`."""
    return _cell(equations.tobytes(), len(equations), s, close)


@lru_cache(maxsize=256)
def _cell(equations: bytes, n: int, s: int, close: float) -> Cell:
    """Neville's extrapolation of lattices to infinitely many steps."""
    matrix = np.frombuffer(equations).reshape(n, n)
    fewest = max(FEWEST, s, int(np.abs(matrix).max() / STIFF))
    table: list[Matrix] = []
    for k, finer in enumerate(FINER):
        row = [_lattice(matrix, s, finer * fewest)]
        for j in range(1, k + 1):
            row.append(row[-1] + (row[-1] - table[j - 1]) / ((finer / FINER[k - j]) ** 2 - 1))
        done = k > 0 and np.abs(row[-1] - table[-1]).max() < close
        table = row
        if done:
            break
    whole, inside = table[-1], n * s
    return Cell(
        whole[:inside, :inside], whole[:inside, inside:], whole[inside:, :inside], whole[inside + s :, inside:-s]
    )


def _lattice(equations: Matrix, s: int, N: int) -> Matrix:
    """All maps by N steps of travel by 1/N, with half a step without travel before and after each (Strang 1968)."""
    from scipy.linalg import expm

    n, order = len(equations), basis(s)
    x = (np.arange(N) + 0.5) / N
    values, moments = order.evaluation(x), order.moments(x, np.full(N, 1 / N))
    columns = (n + 2) * s
    fields, entering = np.zeros((n, N, columns)), np.zeros((2, N, columns))
    for k in range(n + 2):
        (fields[k] if k < n else entering[k - n])[:, k * s : (k + 1) * s] = values
    half = expm(equations / (2 * N))
    whole, leaving = half @ half, np.empty((2, N, columns))
    fields = (half @ fields.reshape(n, -1)).reshape(fields.shape)
    for k in range(N):
        leaving[0, k], leaving[1, k] = fields[0, -1], fields[1, 0]
        fields[0, 1:], fields[1, :-1] = fields[0, :-1].copy(), fields[1, 1:].copy()
        fields[0, 0], fields[1, -1] = entering[0, k], entering[1, k]
        fields = ((whole if k < N - 1 else half) @ fields.reshape(n, -1)).reshape(fields.shape)
    return np.concatenate([moments @ fields, moments @ leaving]).reshape(-1, columns)


class InCells(NamedTuple):
    """A line in cells, and what of a wave sent from an end its own node feels in the same slab."""

    number: int
    cell: Cell
    memories: tuple[int, int]  # of the series and of the shunt circuit

    @property
    def echo(self) -> Matrix:
        """Q = K/(1 + K) of `pass_cells`, shape (s, s)."""
        return np.linalg.solve(np.eye(len(self.cell.back)) + self.cell.back, self.cell.back)

    def maps(self) -> Matrix:
        """All maps in the order of `Cells.maps`."""
        held, entered, left, K = self.cell
        one = np.eye(len(K))
        X, R = np.linalg.inv(one - K @ K), np.linalg.inv(one + K)
        next_, then = np.vstack([held, left @ held]), np.vstack([entered, left @ entered])
        return np.concatenate([part.T.ravel() for part in (next_, then, X, X @ K, R, R @ K)])


def fits(lines: Mapping[str, SceneLine], h: float) -> bool:
    """Whether all lossy lines can be cut in cells: linear ones whose delay is whole slabs, unless too many differ."""
    different: set[tuple[Law, Law]] = set()
    for line in lines.values():
        if line.losses is not None and not line.losses.distortionless:
            different.add((line.losses.exact.series, line.losses.exact.shunt))
            if len(different) > MOST_DIFFERENT or not _fits(line, h):
                return False
    return True


def _fits(line: SceneLine, h: float) -> bool:
    slabs = (line.parameters.delay or 0.0) / h
    return line.losses is not None and line.losses.linear and abs(slabs - round(slabs)) <= WHOLE * slabs


def lines_in_cells(
    lines: Mapping[str, SceneLine], circuits: Mapping[str, Circuits], order: Basis, h: float
) -> dict[int, InCells]:
    """Lines that are cut in cells, by their numbers; none where one does not fit."""
    found: dict[int, InCells] = {}
    for k, (name, line) in enumerate(lines.items() if fits(lines, h) else ()):
        if line.losses is not None and not line.losses.distortionless:
            series, shunt, error = circuits[name]
            made = cell(rates(series, shunt, h), order.s, max(CLOSE, KNOWN * error))
            found[k] = InCells(round((line.parameters.delay or 0.0) / h), made, (len(series.rates), len(shunt.rates)))
    return found


def cells_of(lines: Mapping[int, InCells], groups: list[list[NDArray | None]]) -> tuple[Cells, int]:
    """All lines in cells by their numbers, and how many values they hold.

    Parameters
    ----------
    groups : list of lists of ndarray, shape (s, s), or None
        Of each node of each group the echo that its map does not have in it.
    """
    rows = list(lines.values())
    maps, echoes = [row.maps() for row in rows], [echo for group in groups for echo in group]
    held = np.array([len(row.cell.held) for row in rows], int)
    number = np.array([row.number for row in rows], int)
    values = np.cumsum([0, *(row.number * sum(row.cell.left.shape) + len(row.cell.left) for row in rows)])
    felt = np.array([echo is not None for echo in echoes])
    size = len(rows[0].cell.back) ** 2 if rows else 0
    cells = Cells(
        line=np.array(list(lines), int),
        number=number,
        held=held,
        at=np.cumsum([0, *map(len, maps)])[:-1],
        maps=np.concatenate([np.empty(0), *maps]),
        state=values[:-1],
        beside=np.array([any(echo is not None for echo in group) for group in groups]),
        echo_at=np.where(felt, (np.cumsum(felt) - 1) * size, -1),
        echo=np.concatenate([np.empty(0), *(echo.T.ravel() for echo in echoes if echo is not None)]),
    )
    return cells, int(values[-1])
