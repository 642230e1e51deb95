"""Chains of sections between nodes as one sparse linear system, integrated by SciPy."""

import time
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import node_of_end
from tline.study.baseline.method import MOST_KEPT, BaselineRun, count_steps, probed, sampled, shortest_delay, within
from tline.study.baseline.nodes import NodeSystem

MOST_EVALUATIONS = 3_000_000  # of a differential equation
STIFF = 30  # times the rate of a section: beyond, implicitly
TINY = 1e-150  # no efforts are smaller


class Chain(NamedTuple):
    """A line: x' = A x + b (efforts at its ends); c x is what drives the nodes there; k states."""

    A: Any  # (k, k)
    b: Any  # (k, 2)
    c: Any  # (2, k)


def integrated(
    scene: Scene, n: float, chains: list[Chain], systems: list[NodeSystem], order: int, thevenin: bool = False
) -> BaselineRun:
    """Join lines and nodes, and integrate to a hundredth of the error that the sections leave."""
    from scipy import sparse
    from scipy.linalg import block_diag

    nodes, unit = describe(scene).nodes, shortest_delay(scene)
    at = node_of_end(nodes.values())
    select = sparse.csr_array((np.ones(len(at)), (range(len(at)), at)), (len(at), len(nodes)))
    lines = sparse.block_diag([chain.A for chain in chains], "csr")
    b = sparse.block_diag([chain.b for chain in chains], "csr") @ select
    c = select.T @ sparse.block_diag([chain.c for chain in chains], "csr")
    own, out = (sparse.csr_array(block_diag(*(s[k] for s in systems))) for k in (0, 2))
    by_lines, by_sources = (sparse.csr_array(block_diag(*(s.B[:, k : k + 1] for s in systems))) for k in (0, 1))
    through, directly = (sparse.diags_array([s.D[0, k] for s in systems]) for k in (0, 1))
    A = sparse.block_array([[lines + b @ through @ c, b @ out], [by_lines @ c, own]], format="csr")
    B = sparse.vstack([b @ directly, by_sources], format="csr")
    efforts = sparse.hstack([through @ c, out], format="csr")
    parts = [node.excitations if thevenin or node.held else node.flows for node in nodes.values()]
    return _solved(scene, A, B, efforts, directly, parts, unit / n, 0.01 * n**-order)


def _solved(scene: Scene, A, B, efforts, directly, parts: list, dt: float, rtol: float) -> BaselineRun:
    """x' = A x + B v from rest with time in shortest delays; efforts x + directly v at every step.

    Explicitly (DOP853), or implicitly (Radau) where a load is far faster than the sections.
    """
    from scipy.integrate import solve_ivp

    steps, unit = count_steps(scene, dt), shortest_delay(scene)
    within(max(steps * len(parts), A.nnz), MOST_KEPT)
    t, evaluations = np.arange(steps + 1) * dt, 0
    breaks = np.unique(np.round(np.concatenate([[], *(w.breaks(t[-1]) for row in parts for w, _ in row)]) / dt, 9))
    edges = [0.0, *breaks[(breaks > 0) & (breaks < steps)] * dt, t[-1]]
    begun = time.perf_counter()
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
    seconds = time.perf_counter() - begun
    return BaselineRun(t, dict(zip(scene.probes, u[probed(scene)], strict=True)), seconds)
