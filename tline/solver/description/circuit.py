"""State spaces: of rational loads, of the circuits between the line ends of groups, and their maps over a slab.

A load is realised through its reflection (Z - z)/(Z + z) against the node's Thévenin impedance z, which is proper for
every passive Z, be Z or 1/Z improper. A switch beside it only feeds part of the reflected wave back. A measured load
has its poles as they were fitted. One slab of Radau IIA collocation is a constant linear map from the Thévenin wave w
at the points and the state at its start to the effort u at the points and the state at its end.

At a node with conductance g flows balance: g (w - u) flows into the branches there, with the Thévenin wave w of
line ends, resistors and sources. A law, with its non-linear flow, is connected like a line end of no length: the
circuit receives its wave β behind an impedance ρ, e - ρ i = β. With the equations of the branches,
M u + N i = E x, that is one linear system for efforts and flows; the states x follow them.

Where it is singular, as in loops of capacitors and where inductors alone meet, some states depend on others: these are
eliminated, and the missing efforts or flows follow from the rates of the dependent states (index reduction; Hairer,
Wanner: Solving Ordinary Differential Equations II, 1996, section VII.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.given import Ratio
from tline.solver.radau import Basis, Matrix

if TYPE_CHECKING:
    from passivity import PoleResidueModel
    from tline.solver.description.elements import Branch
    from tline.solver.description.nodes import Node


ILL, SINGULAR = 1e11, 1e-12  # condition from which on singular values are looked at, and which of these count as none
COEFFICIENT_ROUNDING = 1e-9  # relative size of coefficients that are rounding
SMALLEST_BOUND = 1e-6  # relative size of the coefficient of a dependent state, at least


class StateSpace(NamedTuple):
    """dx/dt = A x + b w, output c x + d w, with n states and k inputs and outputs."""

    A: Matrix  # (n, n)
    b: Matrix  # (n, k)
    c: Matrix  # (k, n)
    d: Matrix  # (k, k)


def reflection(impedance: Ratio, z: float, where: str) -> StateSpace:
    """Realise the reflection of a rational impedance against z in balanced companion form.

    For Z of degree 1 or more, and 0 < z finite; refused where Z + z falls to a lower degree, so that no wave is
    defined.
    """
    p, q = impedance
    n = max(len(p), len(q)) - 1
    p, q = (0,) * (n + 1 - len(p)) + p, (0,) * (n + 1 - len(q)) + q
    top, bottom = float(z).as_integer_ratio()
    if bottom * p[0] + top * q[0] < 0:  # let the leading coefficient be positive
        top, bottom = -top, -bottom
    numerator, denominator = [], []
    for a, b in zip(p, q, strict=True):
        numerator.append(bottom * a - top * b)
        denominator.append(bottom * a + top * b)
    leading, too_far = denominator[0], "its coefficients are too far apart for floating-point numbers"
    if leading == 0:
        raise InputError(
            where, f"its impedance tends to minus the line's {z:.6g} at high frequency: no wave is defined"
        )
    lowest = n
    while denominator[lowest] == 0:
        lowest -= 1
    larger = denominator[lowest].bit_length() - leading.bit_length()
    exponent = larger // lowest if lowest else 0  # of the rate 2**exponent, at which all are of one size

    def scaled(a: int, b: int, k: int) -> float:  # a/(b rate^k), rounded once
        return (a << max(-k * exponent, 0)) / (b << max(k * exponent, 0))

    try:
        rate, through = 2.0**exponent, numerator[0] / leading
        back = [-rate * scaled(denominator[k], leading, k) for k in range(1, n + 1)]
        out = [scaled(numerator[k] * leading - numerator[0] * denominator[k], leading**2, k) for k in range(1, n + 1)]
    except OverflowError:
        raise InputError(where, too_far) from None
    if not all(map(isfinite, (rate, through, *back, *out))):
        raise InputError(where, too_far)
    c, d = np.array([out]), np.array([[through]])
    if n == 1:
        return StateSpace(np.array([back]), np.array([[rate]]), c, d)
    A, b = np.zeros((n, n)), np.zeros((n, 1))
    A[0], b[0] = back, rate
    A.ravel()[n :: n + 1] = rate
    with np.errstate(all="ignore"):
        scale = _balance(A)
        system = StateSpace(A / scale[:, None] * scale, b / scale[:, None], c * scale, d)
    if not all(np.isfinite(part).all() for part in system):
        raise InputError(where, too_far)
    return system


def _balance(A: Matrix) -> Matrix:
    """Powers of two by which to scale the states so that rows and columns of A have one size (Osborne 1960).

    As scipy.linalg.matrix_balance, whose import would cost a short run a tenth of its time.
    """
    size, scale = np.abs(A) * (1 - np.eye(len(A))), np.ones(len(A))
    for _ in range(8 if size.any() else 0):
        before = scale.copy()
        for k in range(len(A)):
            row, column = (size[k] * scale).sum() / scale[k], (size[:, k] / scale).sum() * scale[k]
            if row > 0 and column > 0:
                scale[k] *= 2.0 ** np.round(np.log2(row / column) / 2)
        if (scale == before).all():
            break
    return scale


def load_step(system: StateSpace, basis: Basis, h: float | Matrix) -> Matrix:
    """Radau IIA over one slab of width h for dx/dt = A x + b w, u = c x + d w (order 2s - 1 at the slab's end).

    A matrix (k s + n, k s + n) from (w, x) to (u, x at the slab's end): port by port the s points, then the states.
    Of many systems and widths, on axes in front that broadcast against each other, as many matrices.
    """
    s, (n, k) = basis.s, system.b.shape[-2:]
    size, given = n * s, k * s + n
    if n == k == 1 and system.b.ndim == 2:  # most often, and then arrays of two dimensions will do
        A, b, c, d = system
        integral, drive, step = h * basis.A, np.empty((s, given)), np.empty((given, given))
        implicit = -A * integral
        drive[:, :s], drive[:, s] = b * integral, 1.0
        implicit.ravel()[:: s + 1] += 1.0
        x = np.linalg.solve(implicit, drive)  # states at all points
        np.multiply(x, c, out=step[:s])
        step.ravel()[: s * given : given + 1] += d[0]  # of each point to itself
        step[s] = x[-1]
        return step
    integral = np.asarray(h)[..., None, None, None, None] * basis.A[:, None]
    implicit = -system.A[..., :, None, :, None] * integral
    lead = implicit.shape[:-4]
    implicit = implicit.reshape(*lead, size, size)
    implicit[..., range(size), range(size)] += 1.0
    drive = np.zeros((*lead, n, s, given))
    drive[..., : k * s] = (system.b[..., :, None, :, None] * integral).reshape(*lead, n, s, k * s)
    for j in range(n):
        drive[..., j, :, k * s + j] = 1.0
    x = np.linalg.solve(implicit, drive.reshape(*lead, size, given))
    step, points = np.empty((*lead, given, given)), np.arange(s)
    step[..., : k * s, :] = (system.c @ x.reshape(*lead, n, s * given)).reshape(*lead, k * s, given)
    for i, j in np.ndindex(k, k):
        step[..., i * s + points, j * s + points] += system.d[..., i, j, None]
    step[..., k * s :, :] = x[..., s - 1 :: s, :]
    return step


def reflection_of_poles(model: PoleResidueModel, ratio: float) -> StateSpace:
    """Realise a load, whose reflection S against z0 is given by poles, by its reflection against z.

    Each pole is a state, each pair two of a rotation; S is kept to the last bit. The waves against z0 are combinations
    of those against z, a0 = (1 + z/z0)/2 a + (1 - z/z0)/2 r at the load, so that only the feedback of S is rounded.

    The model is of S, |S| <= 1; `ratio` is z0/z > 0.
    """
    n = len(model.coefficients) - 2
    A, b, c, k = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n)), 0
    for a, r in zip(model.poles, model.residues, strict=True):
        size = np.sqrt(abs(r)) or 1.0  # of inputs and outputs alike
        if a.imag > 0:
            A[k : k + 2, k : k + 2] = [[a.real, a.imag], [-a.imag, a.real]]
            b[k], c[0, k : k + 2] = 2 * size, [r.real / size, r.imag / size]
        else:
            A[k, k], b[k], c[0, k] = a.real, size, r.real / size
        k += 1 + (a.imag > 0)
    # u = (a0 + r0)/2 and z0 i = (a0 - r0)/2: with g = z0/z, a = u + z i = ((g + 1) a0 + (g - 1) r0)/(2 g)
    d = np.array([[model.constant]])
    direct = (ratio + 1) + (ratio - 1) * model.constant
    given, back = 2 * ratio / direct, (1 - ratio) / direct  # a0 = given a + back c x
    through = (ratio - 1) / (2 * ratio) + (ratio + 1) / (2 * ratio) * d  # r of a0
    output = (ratio + 1) / (2 * ratio) * c + back * through * c
    return StateSpace(A + back * b @ c, given * b, output, given * through)


class Circuit(NamedTuple):
    """State space of a circuit, and the indices of its states among those of all branches."""

    system: StateSpace
    kept: NDArray


LawPorts = Sequence[tuple[int, int, float]]  # nodes from and to, and the impedance in front: see `Group.ports`


Equations = tuple[NDArray, NDArray, NDArray, NDArray, NDArray]


def circuit(
    nodes: Sequence[Node], branches: Sequence[Branch], laws: LawPorts = (), switched: Sequence[float] = ()
) -> Circuit:
    """State space of a circuit, from the waves of its nodes and of its laws to the efforts at nodes and across laws.

    If branches depend on the gauge pressure at heights, a last state is always 1.

    Loads with states are branches, too; `switched` has the conductance of the switches at each node.
    """
    k, m = len(nodes), len(laws)
    F, G, H, Q, L = equations(nodes, branches, laws, switched)
    n, kept = len(Q), np.arange(len(Q))
    bound, solution = _solved(F, np.hstack([G, H]))
    if len(bound):
        x, w, Q, L, kept = _reduced((F, G, H, Q, L), bound, nodes, branches)
    else:
        x, w = solution[:, :n], solution[:, n:]
    A, B = Q + L @ x, L @ w
    C, D = np.zeros((k + m, A.shape[1])), np.zeros((k + m, k + m))
    C[:k], D[:k] = x[:k], w[:k]
    for p, (from_node, to_node, _) in enumerate(laws, k):
        for at, sign in ((from_node, 1.0), (to_node, -1.0)):
            if at >= 0:
                C[p] += sign * x[at]
                D[p] += sign * w[at]
    return Circuit(StateSpace(A, B, C, D), kept)


def equations(
    nodes: Sequence[Node], branches: Sequence[Branch], laws: LawPorts = (), switched: Sequence[float] = ()
) -> Equations:
    """F, G, H, Q, L of F v = G x + H w and dx/dt = Q x + L v, with efforts and flows v, states x, and waves w.

    First come the balances of nodes, then branches, then laws; flows are in units of the conductances.
    """
    switched = switched or [0.0] * len(nodes)
    k, m, levels = len(nodes), len(laws), np.array([node.above_level for node in nodes])
    states, flows = sum(len(b.ports.Q) for b in branches), sum(len(b.nodes) for b in branches)
    lifted = bool(levels.any()) and (any(b.to_air for b in branches) or any(node.switches for node in nodes))
    n, size = states + lifted, k + flows + m
    unit = nodes[0].alone  # of flows, so that all unknowns are of one size
    F, G, H, Q, L = (np.zeros(shape) for shape in ((size, size), (size, n), (size, k + m), (n, n), (n, size)))
    for p, (node, g) in enumerate(zip(nodes, switched, strict=True)):
        scale = max(abs(node.total), 0.0 if np.isinf(g) else g, unit)
        if node.held is not None:
            F[p, p] = H[p, p] = 1.0
        elif np.isinf(g):
            F[p, p] = 1.0
            G[p, states:] = levels[p]
        else:
            F[p, p] = ((0.0 if node.dead else node.total) + g) / scale
            H[p, p] = node.total / scale if node.flows or not node.dead else 0.0
            G[p, states:] = g * levels[p] / scale
    free = [node.held is None and not np.isinf(g) for node, g in zip(nodes, switched, strict=True)]

    def leave(at: int, column: int, sign: float) -> None:
        """Let a flow leave a node."""
        if at >= 0 and free[at]:
            F[at, column] += sign * unit / max(abs(nodes[at].total), switched[at], unit)

    row, state = k, 0
    for branch in branches:
        M, N, E, own, P, R = branch.ports
        rows, those = slice(row, row + len(M)), slice(state, state + len(own))
        size_ = np.maximum(np.abs(M).max(axis=1), np.abs(N).max(axis=1) * unit)[:, None]
        for j, at in enumerate(branch.nodes):  # a node may have several of them
            F[rows, at] += (M / size_)[:, j]
            L[those, at] += P[:, j]
            leave(at, row + j, 1.0)
        F[rows, rows] = N * unit / size_
        L[those, rows] = R * unit
        G[rows, those], Q[those, those] = E / size_, own
        if lifted and branch.to_air:
            G[rows, states] += M @ levels[branch.nodes] / size_[:, 0]
            Q[those, states] -= P @ levels[branch.nodes]
        row, state = rows.stop, those.stop
    for p, (from_node, to_node, impedance) in enumerate(laws, row):
        size_ = max(1.0, impedance * unit)
        for at, sign in ((from_node, 1.0), (to_node, -1.0)):
            if at >= 0:
                F[p, at] += sign / size_
            leave(at, p, sign)
        F[p, p], H[p, k + p - row] = -impedance * unit / size_, 1.0 / size_
    return F, G, H, Q, L


def _solved(F: NDArray, given: NDArray) -> tuple[NDArray, NDArray]:
    """Combinations of the equations that tell nothing of efforts and flows, so that they bind states; or all these."""
    number, size = len(F), np.abs(F).max(axis=0)
    size[size == 0.0] = 1.0
    F = F / size  # a column that is small throughout is no dependence
    try:
        solution = np.linalg.solve(F, np.hstack([np.eye(number), given]))
    except np.linalg.LinAlgError:
        solution = np.full((number, number + given.shape[1]), np.inf)
    bound = F[:0]
    if not _norm(solution[:, :number]) * _norm(F) < ILL:
        left, values, _ = np.linalg.svd(F)
        bound = left[:, values < SINGULAR * values[0]].T
        bound = np.where(np.abs(bound) < COEFFICIENT_ROUNDING, 0.0, bound)
    return bound, solution[:, number:] / size[:, None]


def _norm(matrix: NDArray) -> float:
    return float(np.abs(matrix).sum(axis=0).max())


def _reduced(
    equations: Equations, bound: NDArray, nodes: Sequence[Node], branches: Sequence[Branch]
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """Efforts and flows by the states that are left and by waves, rates of these in terms of both, and which."""
    F, G, H, Q, L = equations
    where = " and ".join(dict.fromkeys(branch.where for branch in branches))
    together = bound @ G
    together[np.abs(together) < COEFFICIENT_ROUNDING * (np.abs(bound) @ np.abs(G))] = 0.0  # rounding of what cancels
    given = np.abs(bound @ H).max(axis=0, initial=0.0) > COEFFICIENT_ROUNDING
    if given.any():
        problem = "no efforts and flows follow from what is at its nodes"
        at = [node for node, share in zip(nodes, given, strict=False) if share]
        if np.abs(together).max(initial=0.0) > COEFFICIENT_ROUNDING and at:
            problem = f"what an ideal source prescribes at node '{at[0].name}' is held by it, and cannot jump"
            if at[0].held is None:
                problem = f"it alone takes the flow that a source drives into node '{at[0].name}', and that cannot jump"
                raise InputError(where, problem, "a resistance beside the source")
        raise InputError(where, problem, "a resistance in between, or beside it")
    follow = together @ L
    scale = np.abs(follow).max(axis=1, keepdims=True, initial=0.0)
    scale[scale == 0.0] = 1.0
    whole = np.vstack([F, follow / scale])
    _, values, back = np.linalg.svd(whole)
    if values[-1] < SINGULAR * values[0]:
        loose = [node.name for node, share in zip(nodes, back[-1], strict=False) if abs(share) > COEFFICIENT_ROUNDING]
        if not loose:
            raise InputError(where, "no efforts and flows follow from what is at its nodes", "a resistance in between")
        raise InputError(f"node '{loose[0]}'", "nothing ties its effort to the reference", "a load, or a line")
    size = np.abs(G).max(axis=0, initial=0.0)
    size[size == 0.0] = 1.0
    others, of_others = _eliminated(together, size, np.array(Q.any(axis=1) | L.any(axis=1)))
    x = np.linalg.lstsq(whole, np.vstack([G, -together @ Q / scale]) @ of_others)[0]
    w = np.linalg.lstsq(whole, np.vstack([H, np.zeros((len(bound), H.shape[1]))]))[0]
    return x, w, Q[others] @ of_others, L[others], others


def _eliminated(together: NDArray, size: NDArray, moving: NDArray) -> tuple[NDArray, NDArray]:
    """Independent states under constraints that combinations of states vanish, and all states in terms of them.

    The first dependent states are eliminated: the same ones for all positions of switches and all impedances of laws.
    """
    rest, gone = together / size * moving, []
    for column in range(together.shape[1]):
        row = int(np.argmax(np.abs(rest[:, column])))
        if abs(rest[row, column]) > SMALLEST_BOUND:
            gone.append(column)
            rest = rest - np.outer(rest[:, column] / rest[row, column], rest[row])
    others = np.setdiff1d(np.arange(together.shape[1]), gone)
    of_others = np.zeros((together.shape[1], len(others)))
    of_others[others, np.arange(len(others))] = 1.0
    if gone:
        of_others[gone] = -np.linalg.lstsq(together[:, gone], together[:, others])[0]
    return others, of_others
