"""Efforts and flows in equilibrium: laws of elements and lossy lines between parts of a network, solved by Newton.

The unknowns are an effort of each part, and of each law the effort behind an impedance r of its own, a = drop + r·flow.
Drop and flow are smooth functions of a even where a valve is shut or a check valve has no loss. Multiports add linear
equations, and flows; if these are underdetermined, the solution is the limit of a slow rise from rest.

References
----------
E. Todini, S. Pilati: A gradient method for the analysis of pipe networks (1987), whose unknowns are flows and heads.

The limit of linear equations (A + s B) z = f as s goes to zero: where a slow rise from rest leads.

Where A is singular, as in loops of inductances or at efforts that only capacitances determine, z + s z' with A z = f
and A z' + B z = 0 is left of the first orders: for each y with yᵀA = 0 also yᵀB z = 0.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.kernel.arithmetic import ACCEPTED_RESIDUAL

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

REVEALED, LARGE = 300, 1500  # unknowns up to which matrices that may be singular are dense; and those that are
REGULAR = 1e12  # condition below which a matrix is not singular
SINGULAR = 1e-13  # of the largest singular value, or pivot; so much ties what nothing else determines
CONTRADICTORY = 1e-11  # of the right side
INVOLVED = 1e-3  # of the largest entry of a null vector
ROUNDS = 4  # in which rows and columns are scaled
STEPS, HALVINGS = 400, 40
ROUNDED = 1e-15  # residual that is rounding, of the largest effort, and in the end of the terms of its own equation
VAIN = 3  # steps without gain on the way there
NO_FLOW = 1e-24  # residual that is none, relative to the largest effort
SHUT = 1e-9  # conductance of a closed law, in those units, beside multiports
LEAK = 1e-14  # conductance of a part, in those units, that determines its effort where nothing else does
LEAKS = 10.0 ** np.arange(0, -14, -1)  # leaks on the way to a state that is not found at once
MOST_DENSE = 99  # unknowns; with more, OpenBLAS takes threads, which wait for each other where cores are busy
STARTS = 10.0 ** np.arange(0, -7, -1)  # efforts over the largest
NOTHING = 1e-12  # of the largest effort, or of 1 without excitation: rest; and the slope of a drop that has none there
CORRECTIONS, EXACT = 2, 1e-9  # of linear systems
SYMMETRIC: dict[str, Any] = {
    "permc_spec": "MMD_AT_PLUS_A",
    "relax": 10,  # columns that factors treat alike; of panels one is the quickest, for networks are sparse
    "panel_size": 1,
    "options": {"SymmetricMode": True},
}  # of matrices with a symmetric pattern and a large diagonal


class Limit(NamedTuple):
    """Solution, with rows that contradict each other or undetermined columns, both empty at best."""

    z: NDArray
    rows: NDArray
    columns: NDArray


class Sparse(NamedTuple):
    """A square matrix by its entries; those at one place add up."""

    rows: NDArray
    columns: NDArray
    values: NDArray

    def __matmul__(self, z: NDArray) -> NDArray:
        return np.bincount(self.rows, self.values * z[self.columns], len(z))

    def plus(self, *others: "Sparse") -> "Sparse":
        """The sum with other matrices."""
        return Sparse(*(np.concatenate(each) for each in zip(self, *others, strict=True)))

    def scaled(self, row: NDArray, column: NDArray) -> "Sparse":
        """The matrix with scaled rows and columns."""
        return self._replace(values=self.values * row[self.rows] * column[self.columns])

    def dense(self, n: int) -> NDArray:
        """The matrix as an array, shape (n, n)."""
        return np.bincount(self.rows * n + self.columns, self.values, n * n).reshape(n, n)

    def factors(self, n: int, **given: Any) -> "SuperLU":
        """Factors of the matrix, shape (n, n); a RuntimeError if it is singular."""
        from scipy.sparse import coo_array
        from scipy.sparse.linalg import splu

        return splu(coo_array((self.values, (self.rows, self.columns)), shape=(n, n)).tocsc(), **given)


def slow_limit(A: Sparse, B: Sparse, f: NDArray) -> Limit:
    """The limit of z as s goes to zero from above."""
    n, none = len(f), np.zeros(0, int)
    row, column = _scales(A, n)
    A, B, f = A.scaled(row, column), B.scaled(row, column), f * row
    z = regular(A, f)
    if z is not None:
        return Limit(z * column, none, none)
    if n > LARGE:
        return Limit(np.full(n, np.nan), none, np.arange(n))
    left, values, right = np.linalg.svd(A.dense(n))
    rank = int((values > SINGULAR * values[0]).sum())
    z = right[:rank].T @ ((left[:, :rank].T @ f) / values[:rank])
    if rank == n:
        return Limit(z * column, none, none)
    vanishing, free = left[:, rank:].T, right[rank:].T
    torn = np.abs(vanishing @ f) > CONTRADICTORY * float(np.linalg.norm(f))
    if torn.any():
        return Limit(z * column, _involved(vanishing[torn].T), none)
    told = vanishing @ B.dense(n)
    told /= np.abs(told).max(axis=1, keepdims=True, initial=np.finfo(float).tiny)
    shares = told @ free
    loose, sizes, mixed = np.linalg.svd(shares)
    known = sizes > SINGULAR * n * max(float(sizes[0]), 1.0)
    if not known.all():
        return Limit(z * column, none, _involved(free @ mixed[~known].T))
    z = z - free @ (mixed.T @ ((loose.T @ (told @ z)) / sizes))
    return Limit(z * column, none, none)


def _scales(A: Sparse, n: int) -> tuple[NDArray, NDArray]:
    row, column, size = np.ones(n), np.ones(n), np.abs(A.values)
    for _ in range(ROUNDS):
        now = size * row[A.rows] * column[A.columns]
        for scale, at in ((row, A.rows), (column, A.columns)):
            largest = np.zeros(n)
            np.maximum.at(largest, at, now)
            scale[largest > 0] /= np.sqrt(largest[largest > 0])
    return row, column


def regular(A: Sparse, f: NDArray, symmetric: bool = False) -> NDArray | None:
    """The solution where the matrix is far from singular."""
    n = len(f)
    if n <= (MOST_DENSE if symmetric else REVEALED):
        matrix = A.dense(n)
        try:
            found = np.linalg.solve(matrix, np.column_stack([f, np.eye(n)]))
        except np.linalg.LinAlgError:
            return None
        condition = np.abs(matrix).sum(axis=0).max() * np.abs(found[:, 1:]).sum(axis=0).max()
        return found[:, 0] if condition < REGULAR else None
    try:
        factors = A.factors(n, **(SYMMETRIC if symmetric else {}))
    except RuntimeError:
        return None
    pivots = np.abs(factors.U.diagonal())
    return factors.solve(f) if pivots.min() > SINGULAR * pivots.max() else None


def _involved(vectors: NDArray) -> NDArray:
    """Places of the entries of null vectors that are not small."""
    size = np.abs(vectors).max(axis=1)
    return np.flatnonzero(size > INVOLVED * size.max())


class EdgeLaws(NamedTuple):
    """Laws between parts, by edge."""

    from_node: NDArray  # (edges,) part from which the flow counts, -1 for the reference
    to_node: NDArray  # (edges,) part to which it counts
    impedance: NDArray  # (edges,) r, of the size of drop/flow, > 0
    solved: Callable[[NDArray], tuple[NDArray, ...]]  # a -> drop, flow, and their slopes over a


class Linear(NamedTuple):
    """Linear equations; unknowns after the edges' are efforts of parts, then others of the size of efforts."""

    given: NDArray  # (parts,) effort where it is prescribed, else nan
    conductance: NDArray  # (parts,) to the reference
    driven: NDArray  # (parts,) flow of sources
    unit: float  # impedance by which balances of flows are multiplied, > 0
    # entries beside these, numbered with the edges first: (A + s B) z = known. Without B a leak fixes free efforts
    A: Sparse = Sparse(np.zeros(0, int), np.zeros(0, int), np.zeros(0))
    B: Sparse | None = None
    known: NDArray = np.zeros(0)  # (others,)

    def matrix(self, leaking: float, edges: int) -> tuple[Sparse, NDArray, NDArray]:
        """A and f with a leak, without the laws; and the leak of each part."""
        held = ~np.isnan(self.given)
        tied = held | ((self.conductance != 0) & (leaking <= LEAK))
        leak = np.where(tied, 0.0, leaking / self.unit)
        own = np.where(held, 1.0, self.unit * (self.conductance + leak))
        at = edges + np.arange(len(own))
        f = np.concatenate([np.zeros(edges), np.where(held, self.given, self.unit * self.driven), self.known])
        return Sparse(at, at, own).plus(self.A), f, leak


class Balance(NamedTuple):
    """Solution of laws and balances, with residuals."""

    unknowns: NDArray  # (edges + parts + others,)
    effort: NDArray  # (parts,)
    others: NDArray
    flow: NDArray  # (edges,)
    rest: NDArray  # (edges + parts + others,) residual of each equation, relative to the largest effort
    leak: NDArray  # (parts,) flow that only the leak takes
    limit: Limit | None  # of the linear equations there, with B

    @property
    def worst(self) -> float:
        """Largest relative residual."""
        return float(self.rest.max(initial=0.0))


def balanced(laws: EdgeLaws, linear: Linear, near: NDArray | None = None) -> Balance:
    """Efforts at which all flows balance.

    `near` are unknowns of the same network with other numbers.
    """
    least = 0.0 if linear.B is not None else LEAK
    if not len(laws.from_node) and linear.B is None:  # each part by itself
        A, f, leak = linear.matrix(least, 0)
        effort, none = f / A.values, np.zeros(0)
        return Balance(effort, effort, none, none, none, leak * effort, None)
    if near is not None and (found := _newton(laws, linear, least, near)).worst <= ACCEPTED_RESIDUAL:
        return found
    starts = _starts(laws, linear)
    tried = []
    for start in starts:
        found = _newton(laws, linear, least, start)
        if found.worst <= ACCEPTED_RESIDUAL:
            return found
        tried.append(found)
    at = starts[0]
    for leak in LEAKS:  # all tight things leak, less and less
        at = _newton(laws, linear, leak, at).unknowns
    return min(*tried, _newton(laws, linear, least, at), key=lambda found: found.worst)


def _starts(laws: EdgeLaws, linear: Linear) -> list[NDArray]:
    held, edges = ~np.isnan(linear.given), len(laws.from_node)
    effort = np.where(held, linear.given, linear.given[held].mean() if held.any() else 0.0)
    largest = _largest(linear)
    system, starts = _System(laws, linear, 0.0), []
    for share in STARTS if edges else STARTS[:1]:
        z = np.concatenate([np.full(edges, share * largest), effort, np.zeros(len(linear.known))])
        starts.append((float(np.abs(_Point(system, z).left).max()), z))
    found = [z for _, z in sorted(starts, key=lambda start: start[0])]
    return found if linear.B is None else [np.zeros(len(system.f)), *found]  # nothing drives a circulating flow


def _largest(linear: Linear) -> float:
    held = np.nanmax(np.abs(linear.given), initial=0.0)
    return max(held, linear.unit * np.abs(linear.driven).max(initial=0.0)) or 1.0


class _System:
    """Laws and balances at a leak."""

    def __init__(self, laws: EdgeLaws, linear: Linear, leaking: float):
        self.laws, self.linear, self.edges = laws, linear, len(laws.from_node)
        self.balances, self.f, self.leak = linear.matrix(leaking, self.edges)
        self.least, efforts, flows = NOTHING * _largest(linear), [], []
        self.ends = (laws.from_node, 1.0), (laws.to_node, -1.0)
        for end, sign in self.ends:
            there = np.flatnonzero(end >= 0)
            free = there[np.isnan(linear.given[end[there]])]
            efforts.append(Sparse(there, self.edges + end[there], np.full(len(there), -sign)))
            flows.append(Sparse(self.edges + end[free], free, np.full(len(free), sign * linear.unit)))
        self.matrix, self.flows = self.balances.plus(*efforts), flows[0].plus(flows[1])


class _Point:
    """Residuals of laws and balances at some unknowns, and their derivatives."""

    def __init__(self, system: _System, z: NDArray):
        linear, edges, flows = system.linear, system.edges, system.flows
        self.z, self.system = z, system
        drop, self.flow, steep, self._slope = system.laws.solved(z[:edges])
        self.own = np.maximum(steep, NOTHING)
        if linear.B is not None:
            self._slope = np.maximum(self._slope, SHUT / linear.unit)
        self.left = system.matrix @ z - system.f
        self.left[:edges] += drop
        self.left += np.bincount(flows.rows, flows.values * self.flow[flows.columns], len(z))
        self.worst = float(np.abs(self.left).max())
        sizes = np.abs(drop).max(initial=0.0), linear.unit * np.abs(self.flow).max(initial=0.0)
        self.scale = max(*sizes, np.abs(z[edges:]).max(), system.least)

    @property
    def inexact(self) -> float:
        """Largest residual over what rounding leaves of the terms of its equation, be efforts elsewhere far larger."""
        (rows, columns, values), flows, f = self.system.matrix, self.system.flows, self.system.f
        own = np.bincount(rows, np.abs(values * self.z[columns]), len(f)) + np.abs(f)
        own += np.bincount(flows.rows, np.abs(flows.values * self.flow[flows.columns]), len(f))
        return float((np.abs(self.left) / (ROUNDED * own + NO_FLOW * self.scale)).max())

    @property
    def flows(self) -> Sparse:
        """Derivatives of balances by the unknowns of laws."""
        flows = self.system.flows
        return flows._replace(values=flows.values * self._slope[flows.columns])

    def jacobian(self) -> Sparse:
        """Jacobian of the residuals: laws first, then balances."""
        edges = np.arange(len(self.flow))
        return self.system.matrix.plus(Sparse(edges, edges, self.own), self.flows)


def _newton(laws: EdgeLaws, linear: Linear, leaking: float, start: NDArray) -> Balance:
    system = _System(laws, linear, leaking)
    edges, n = system.edges, len(linear.given)
    here, limit, order, least, vain = _Point(system, start), None, None, np.inf, 0
    for _ in range(STEPS):
        close = here.worst <= ROUNDED * here.scale
        if close:
            least, vain = min(least, here.inexact), 0 if here.inexact < least else vain + 1
            if least <= 1 or vain == VAIN:
                break
        J = here.jacobian()
        if linear.B is None:
            step, order = _solved(here, J, order)
        else:
            limit = slow_limit(J, linear.B, J @ here.z - here.left)
            step = here.z - limit.z
        share = 1.0
        for _ in range(1 if close else HALVINGS):
            there = _Point(system, here.z - share * step)
            if there.worst < here.worst or (close and there.worst <= ROUNDED * there.scale):
                break
            share /= 2
        else:
            break
        here = there
    effort, others = np.split(here.z[edges:], [n])
    rest = np.abs(here.left) / here.scale
    return Balance(here.z, effort, others, here.flow, rest, system.leak * effort, limit)


def _solved(here: _Point, J: Sparse, order: NDArray | None) -> tuple[NDArray, NDArray | None]:
    """Newton's step, and the order of its factors.

    The first unknowns, one for each law, form a diagonal block of their own. In large networks these are eliminated,
    which leaves a symmetric pattern of parts alone: a quarter of the time and a sixth of the memory. Accuracy
    lost where a drop is nearly flat is restored by a correction, or else all is solved at once.
    """
    system, own, flows, left, n = here.system, here.own, here.flows, here.left, len(here.left)
    if n <= MOST_DENSE:
        matrix = J.dense(n)
        try:
            return np.linalg.solve(matrix, left), order
        except np.linalg.LinAlgError:
            return np.linalg.lstsq(matrix, left)[0], order
    edges, at = system.edges, system.balances.rows - system.edges
    values, rows = flows.values / own[flows.columns], flows.rows - edges
    schur = Sparse(at, at, system.balances.values)
    for end, sign in system.ends:
        far = end[flows.columns]
        schur = schur.plus(Sparse(rows[far >= 0], far[far >= 0], sign * values[far >= 0]))
    try:
        parts, cut_off = Factors(schur, len(at), order), False
    except RuntimeError:  # parts that only a leak ties down
        tie = SINGULAR * np.abs(np.bincount(schur.rows, schur.values * (schur.rows == schur.columns)))
        parts, cut_off = Factors(schur.plus(Sparse(at, at, tie)), len(at), order), True
    step = np.zeros(n)
    for _ in range(CORRECTIONS):
        rest = left - J @ step
        level = parts.solve(rest[edges:] - np.bincount(rows, values * rest[flows.columns], len(at)))
        for end, sign in system.ends:
            rest[:edges] += sign * np.append(level, 0.0)[end]
        step += np.concatenate([rest[:edges] / own, level])
    exact = np.abs(left - J @ step).max() <= EXACT * np.abs(left).max()
    return step if exact or cut_off else J.factors(n).solve(left), parts.order


class Factors:
    """Factors of a matrix with a symmetric pattern and a large diagonal, in an order that keeps them small."""

    def __init__(self, matrix: Sparse, n: int, order: NDArray | None = None):
        self._known, how = order is not None, SYMMETRIC if order is None else SYMMETRIC | {"permc_spec": "NATURAL"}
        if order is not None:
            rank = np.argsort(order)
            matrix = Sparse(rank[matrix.rows], rank[matrix.columns], matrix.values)
        self._found = matrix.factors(n, **how)
        self.order = np.argsort(self._found.perm_c) if order is None else order

    def solve(self, right: NDArray) -> NDArray:
        """Solve for a right side."""
        if not self._known:
            return self._found.solve(right)
        found = np.empty_like(right)
        found[self.order] = self._found.solve(right[self.order])
        return found
