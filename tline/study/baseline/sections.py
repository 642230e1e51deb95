"""Lines as chains of lumped sections, or of Padé approximants of their delay, integrated by SciPy."""

import time
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.groups import Group
from tline.solver.description.nodes import node_of_end
from tline.study.baseline.method import (
    HELD,
    MOST_KEPT,
    BaselineRun,
    NodeSystem,
    behind_inductor,
    count_steps,
    decays_of,
    delays_of,
    half_sections,
    impedances_of,
    on_capacitor,
    probed,
    sampled,
    sections_of,
    shortest_delay,
    within,
)

MOST_EVALUATIONS = 3_000_000  # of a differential equation
STIFF = 30  # times the rate of a section: above, the integration is implicit
TINY = 1e-150  # floor of the efforts


class Chain(NamedTuple):
    """Line as a system x' = A x + b (efforts at its ends); c x is its input to the nodes there; k states."""

    A: Any  # (k, k)
    b: Any  # (k, 2)
    c: Any  # (2, k)


def integrated(
    scene: Scene, n: float, chains: list[Chain], systems: list[NodeSystem], order: int, thevenin: bool = False
) -> BaselineRun:
    """Connect lines and nodes, and integrate to a hundredth of the error of the sections."""
    from scipy import sparse
    from scipy.linalg import block_diag

    nodes, unit = describe(scene).nodes, shortest_delay(scene)
    at = node_of_end(nodes.values())
    select = sparse.csr_array((np.ones(len(at)), (range(len(at)), at)), (len(at), len(nodes)))
    lines, b, c = (
        sparse.block_diag([sparse.coo_array(part) for part in parts], "csr") for parts in zip(*chains, strict=True)
    )
    b, c = b @ select, select.T @ c
    own, out = (sparse.csr_array(block_diag(*(s[k] for s in systems))) for k in (0, 2))
    by_lines, by_sources = (sparse.csr_array(block_diag(*(s.B[:, k : k + 1] for s in systems))) for k in (0, 1))
    through, directly = (sparse.diags_array([s.D[0, k] for s in systems]) for k in (0, 1))
    A = sparse.block_array([[lines + b @ through @ c, b @ out], [by_lines @ c, own]], format="csr")
    B = sparse.vstack([b @ directly, by_sources], format="csr")
    efforts = sparse.hstack([through @ c, out], format="csr")
    parts = [node.excitations if thevenin or node.held else node.flows for node in nodes.values()]
    return _solved(scene, A, B, efforts, directly, parts, unit / n, 0.01 * n**-order)


def _solved(scene: Scene, A, B, efforts, directly, parts: list, dt: float, rtol: float) -> BaselineRun:
    """Integrate x' = A x + B v from rest, time in shortest delays; efforts x + directly v at every step.

    The method is explicit (DOP853), or implicit (Radau) if a load is far faster than the sections.
    """
    from scipy.integrate import solve_ivp

    steps, unit = count_steps(scene, dt), shortest_delay(scene)
    within(max(steps * len(parts), A.nnz), MOST_KEPT)
    t, evaluations = np.arange(steps + 1) * dt, 0
    breaks = np.unique(np.round(np.concatenate([[], *(w.breaks(t[-1]) for row in parts for w, _ in row)]) / dt, 9))
    edges = [0.0, *breaks[(breaks > 0) & (breaks < steps)] * dt, t[-1]]
    begun = time.process_time()
    v = np.array([sampled(row, t, dt) for row in parts])
    x, u = np.zeros(A.shape[0]), directly @ v
    sizes = [np.abs(sampled(node.excitations, t, dt)).max() for node in describe(scene).nodes.values()]
    atol = rtol * max(*sizes, TINY)  # states are efforts, or flows times z0
    stiff = abs(A).sum(axis=1).max() > STIFF * unit / dt
    method, jacobian = ("Radau", {"jac": A}) if stiff else ("DOP853", {})
    driven = [k for k, row in enumerate(parts) if row]
    pushes = B.tocsc()[:, driven].tocsr()

    def rate(now: float, x: NDArray) -> NDArray:
        nonlocal evaluations
        evaluations += 1
        if evaluations > MOST_EVALUATIONS:
            problem = f"{MOST_EVALUATIONS:,} evaluations do not reach the end: too many sections, or too stiff a load"
            raise InputError("n", problem)
        at = np.array(now * unit)
        v = [sum(factor * float(w.value(at, inside)) for w, factor in parts[k]) for k in driven]
        return A @ x + pushes @ np.array(v)

    for start, stop in pairwise(edges):
        inside = np.array((start + stop) / 2)
        here = np.flatnonzero((t > start + 1e-9 * dt) & (t <= stop + 1e-9 * dt))
        wanted = np.unique(np.append(np.minimum(t[here], stop), stop) / unit)
        with np.errstate(over="ignore", invalid="ignore"):
            run = solve_ivp(rate, (start / unit, stop / unit), x, method, wanted, rtol=rtol, atol=atol, **jacobian)
        if not run.success:  # the waves grew beyond all bounds
            u[:, t > start] = np.inf
            break
        u[:, here] += efforts @ run.y[:, : len(here)]
        x = run.y[:, -1]
    seconds = time.process_time() - begun
    return BaselineRun(t, dict(zip(scene.probes, u[probed(scene)], strict=True)), seconds)


def lumped_pi(scene: Scene, n: float) -> BaselineRun:
    """Chains of pi sections, with half of the capacitance before and half behind each inductance."""
    nodes, unit, cells = describe(scene).nodes, shortest_delay(scene), sections_of(scene, n)
    chains = []
    widths = delays_of(scene) / cells / unit
    for N, width, z0, decay in zip(cells, widths, impedances_of(scene), decays_of(scene), strict=True):
        D = _differences(N)  # states: z0 times the flows, then the efforts between
        ends = np.vstack([D[:, [0, N]], np.zeros((N - 1, 2))])
        A = _skew(D[:, 1:N]) / width
        A[range(N), range(N)] -= decay * unit
        chains.append(Chain(A, ends / width, -ends.T / z0))
    systems = [on_capacitor(node, half, unit) for node, half in half_sections(scene, nodes, cells)]
    return integrated(scene, n, chains, systems, order=2)


def lumped_t(scene: Scene, n: float) -> BaselineRun:
    """Chains of T sections, with half of the inductance before and half behind each capacitance."""
    nodes, unit, cells = describe(scene).nodes, shortest_delay(scene), sections_of(scene, n)
    widths = delays_of(scene) / cells / unit
    half = np.repeat(widths * impedances_of(scene) / 2, 2)  # inductance at each end
    behind = [1 / (1 / half[node.ends]).sum() for node in nodes.values()]
    share = np.array([behind[k] for k in node_of_end(nodes.values())]) / half
    chains = []
    for j, (N, width) in enumerate(zip(cells, widths, strict=True)):
        A, ends, first_last = _skew(_differences(N)), np.zeros((2 * N + 1, 2)), np.zeros((2, 2 * N + 1))
        ends[N, 0], ends[2 * N, 1] = 1.0, -1.0  # states: the efforts, then z0 times the flows
        A[[N, 2 * N]] *= 2.0
        first_last[0, 0], first_last[1, N - 1] = share[2 * j : 2 * j + 2]
        chains.append(Chain(A / width, 2 * ends / width, first_last))
    systems = [behind_inductor(node, series, unit) for node, series in zip(nodes.values(), behind, strict=True)]
    return integrated(scene, n, chains, systems, order=2)


def pade(scene: Scene, n: float) -> BaselineRun:
    """Chains of sections (6 - 2s)/(6 + 4s + s²), the Padé approximant [1/2] of exp(-s), for each delay."""
    from scipy import sparse

    nodes, unit, cells = describe(scene).nodes, shortest_delay(scene), sections_of(scene, n)
    share = np.empty(2 * len(cells))
    for node in nodes.values():
        share[node.ends] = 1 / impedances_of(scene)[np.array(node.ends) // 2] / (np.inf if node.held else node.total)
    A, b, c, chains = np.array([[-4.0, 1.0], [-6.0, 0.0]]), np.array([[-2.0], [6.0]]), np.array([[1.0, 0.0]]), []
    for j, (N, width) in enumerate(zip(cells, delays_of(scene) / cells / unit, strict=True)):
        one_way = sparse.kron(sparse.eye_array(N), A) + sparse.kron(sparse.eye_array(N, k=-1), b @ c)
        enter, leave = np.vstack([b, np.zeros((2 * N - 2, 1))]), np.hstack([np.zeros((1, 2 * N - 2)), c])
        back, none = -enter @ sparse.csr_array(leave), np.zeros((1, 2 * N))  # wave sent: 2 u less the arriving one
        both = sparse.block_array([[one_way, back], [back, one_way]]) / width
        sides = np.block([[none, share[2 * j] * leave], [share[2 * j + 1] * leave, none]])
        chains.append(Chain(both, 2 / width * np.kron(np.eye(2), enter), sides))
    systems = []
    for node in nodes.values():
        A, b, c, d = Group([node], [], [], []).circuit(0.0).system
        both = np.repeat(unit * b, 2, axis=1)
        systems.append(HELD if node.held else NodeSystem(unit * A, both, c, np.repeat(d, 2, axis=1)))
    return integrated(scene, n, chains, systems, order=3, thevenin=True)


def _differences(N: int) -> Any:
    """Difference matrix of N + 1 values, each less the next, shape (N, N + 1)."""
    return np.eye(N, N + 1) - np.eye(N, N + 1, k=1)


def _skew(D: NDArray) -> NDArray:
    """Skew matrix [[0, D], [-D', 0]]."""
    n, m = D.shape
    return np.block([[np.zeros((n, n)), D], [-D.T, np.zeros((m, m))]])


def pushes_inductors(scene: Scene) -> str | None:
    """Reason why sections that end in inductances are not applicable to a scene; None if they are."""
    for source in scene.sources.values():
        node = describe(scene).nodes[source.terminals[0]]
        if node.held is None and node.conductance == 0.0:
            return f"node '{node.name}': an ideal flow would have to jump in the inductances there"
    return None
