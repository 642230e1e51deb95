"""Lines as chains of lumped sections, or of Padé approximants of their delay."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.groups import Group
from tline.solver.description.nodes import node_of_end
from tline.study.baseline.integrate import Chain, integrated
from tline.study.baseline.method import BaselineRun, decays_of, delays_of, impedances_of, sections_of, shortest_delay
from tline.study.baseline.nodes import HELD, NodeSystem, behind_inductor, half_sections, on_capacitor


def lumped_pi(scene: Scene, n: float) -> BaselineRun:
    """Each line a chain of sections, half of their capacitance before and half behind their inductance."""
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
    """Each line a chain of sections, half of their inductance before and half behind their capacitance."""
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
    """Each delay a chain of sections (6 - 2s)/(6 + 4s + s²), the Padé approximant [1/2] of exp(-s)."""
    from scipy import sparse

    nodes, unit, cells = describe(scene).nodes, shortest_delay(scene), sections_of(scene, n)
    share = np.empty(2 * len(cells))
    for node in nodes.values():
        share[node.ends] = 1 / impedances_of(scene)[np.array(node.ends) // 2] / (np.inf if node.held else node.total)
    A, b, c, chains = np.array([[-4.0, 1.0], [-6.0, 0.0]]), np.array([[-2.0], [6.0]]), np.array([[1.0, 0.0]]), []
    for j, (N, width) in enumerate(zip(cells, delays_of(scene) / cells / unit, strict=True)):
        one_way = sparse.kron(sparse.eye(N), A) + sparse.kron(sparse.eye(N, k=-1), b @ c)
        enter, leave = np.vstack([b, np.zeros((2 * N - 2, 1))]), np.hstack([np.zeros((1, 2 * N - 2)), c])
        back, none = -enter @ sparse.csr_array(leave), np.zeros((1, 2 * N))  # sent is 2 u less what arrives
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
    """Each of N + 1 values less the next, shape (N, N + 1)."""
    return np.eye(N, N + 1) - np.eye(N, N + 1, k=1)


def _skew(D: NDArray) -> NDArray:
    """[[0, D], [-D', 0]]."""
    n, m = D.shape
    return np.block([[np.zeros((n, n)), D], [-D.T, np.zeros((m, m))]])


def pushes_inductors(scene: Scene) -> str | None:
    """Why sections that end in inductances cannot do a scene; None if they can."""
    for source in scene.sources.values():
        node = describe(scene).nodes[source.terminals[0]]
        if node.held is None and node.conductance == 0.0:
            return f"node '{node.name}': an ideal flow would have to jump in the inductances there"
    return None
