"""Nodes of baseline methods: with loads integrated by a rule, or as ordinary differential equations."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node
from tline.study.baseline.loops import NodeScattering
from tline.study.baseline.method import delays_of, impedances_of

Euler = tuple[NDArray, NDArray, NDArray]  # x_next = first x + second w_now + third w_next


def forward_euler(A: NDArray, b: NDArray) -> Euler:
    """x' = A x + b w by its value at the step's start; A and b count time in steps."""
    return np.eye(len(A)) + A, b, 0 * b


def backward_euler(A: NDArray, b: NDArray) -> Euler:
    """The same by its value at the step's end."""
    inverse = np.linalg.inv(np.eye(len(A)) - A)
    return inverse, 0 * b, inverse @ b


def trapezoid(A: NDArray, b: NDArray) -> Euler:
    """The same by the mean of both."""
    inverse = np.linalg.inv(np.eye(len(A)) - A / 2)
    return inverse @ (np.eye(len(A)) + A / 2), inverse @ b / 2, inverse @ b / 2


def scattering(scene: Scene, nodes: list[Node], dt: float, rule: Callable[[NDArray, NDArray], Euler]) -> NodeScattering:
    """The nodes of a scene, their loads integrated by a rule."""
    z0 = np.array([line.parameters.z0 for line in scene.lines.values()])
    own = [1 / z0[np.array(node.ends) // 2] / (np.inf if node.held else node.total) for node in nodes]
    dynamic = [node.load is not None and node.held is None for node in nodes]
    systems = [
        Group([node], [], [], []).circuit(0.0).system for node, moves in zip(nodes, dynamic, strict=True) if moves
    ]
    m = max((len(system.A) for system in systems), default=0)
    maps = [(*rule(dt * system.A, dt * system.b[:, 0]), system.c[0]) for system in systems]
    x_x, x_before, x_now, u_x = (
        np.array([np.pad(each[k], (0, m - len(each[3]))) for each in maps]).reshape(len(maps), *(m,) * (2 - (k > 0)))
        for k in range(4)
    )
    ends, first = np.array([end for node in nodes for end in node.ends]), np.cumsum([0, *(len(n.ends) for n in nodes)])
    row, u_w = np.where(dynamic, np.cumsum(dynamic) - 1, -1), np.array([system.d[0, 0] for system in systems])
    return NodeScattering(first, ends, np.concatenate(own), row, x_x, x_before, x_now, u_x, u_w)


class NodeSystem(NamedTuple):
    """A node: x' = A x + B v, effort = C x + D v, v what the lines and what the sources drive; k states."""

    A: NDArray  # (k, k)
    B: NDArray  # (k, 2)
    C: NDArray  # (1, k)
    D: NDArray  # (1, 2)


HELD = NodeSystem(np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((1, 0)), np.array([[0.0, 1.0]]))


def _companion(tops: list[NDArray], bottom: NDArray) -> NodeSystem:
    """Transfer functions of one denominator; coefficients with the highest power first. The effort is x[0] + D v."""
    bottom = np.trim_zeros(bottom, "f")
    k, a = len(bottom) - 1, bottom / bottom[0]
    b = np.array([np.pad(top, (k + 1 - len(top), 0)) for top in tops]).T / bottom[0]
    A = np.eye(k, k=1)
    A[:, :1] -= a[1:, None]
    return NodeSystem(A, b[1:] - np.outer(a[1:], b[0]), np.eye(1, k), b[:1])


def _admittance(node: Node, unit: float) -> tuple[NDArray, NDArray]:
    """Numerator and denominator of what stands at a node, lines apart; s counts in 1/unit."""
    if node.load is None:
        return np.array([node.conductance]), np.ones(1)
    p, q = (
        np.array([float(a) / unit**k for k, a in zip(range(len(side) - 1, -1, -1), side, strict=True)])
        for side in (node.load.numerator, node.load.denominator)
    )
    scale = max(np.abs(p).max(), np.abs(q).max())
    return np.polyadd(node.conductance * p, q) / scale, p / scale


def half_sections(scene: Scene, nodes: dict[str, Node], cells: NDArray) -> list[tuple[Node, float]]:
    """Nodes and the capacitance of the half cells there."""
    half = np.repeat(delays_of(scene) / cells / impedances_of(scene) / 2, 2)
    return [(node, float(half[node.ends].sum())) for node in nodes.values()]


def on_capacitor(node: Node, capacitance: float, unit: float) -> NodeSystem:
    """From the flows into a node with a capacitance to its effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    return _companion([under, under], np.polyadd(np.append(capacitance / unit * under, 0.0), over))


def behind_inductor(node: Node, inductance: float, unit: float) -> NodeSystem:
    """From the effort behind an inductance, in units of time times z0, and the flow of the sources to the effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    source = np.append(inductance * under, 0.0) if node.flows else np.zeros(1)
    return _companion([under, source], np.polyadd(under, np.append(inductance * over, 0.0)))
