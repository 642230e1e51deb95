"""Nodes with dynamic loads, integrated by a rule of one step."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node
from tline.study.baseline.kernel.nodes import NodeScattering

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
