"""Equations of linear multiports, and the base of all elements that give them."""

from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.element import Element, Name


class Ports(NamedTuple):
    """Equations of a multiport in efforts u, flows i and states x: M u + N i = E x, dx/dt = Q x + P u + R i."""

    M: NDArray  # (k, k)
    N: NDArray  # (k, k)
    E: NDArray  # (k, n)
    Q: NDArray  # (n, n)
    P: NDArray  # (n, k)
    R: NDArray  # (n, k)


def floating(grounded: Ports) -> Ports:
    """Equations of two ports between two nodes each, from those of ports between a node and the reference.

    Each port's effort is that of its first node less that of its second, and its flow leaves at the second.
    """
    M, N, E, Q, P, R = grounded
    across = np.array([[1, -1, 0, 0], [0, 0, 1, -1]], float)  # from nodes to ports
    into = across.clip(min=0)
    none, leaving = np.zeros((2, 4)), abs(across)
    return Ports(
        np.vstack([M @ across, none]), np.vstack([N @ into, leaving]), np.vstack([E, np.zeros_like(E)]), Q,
        P @ across, R @ into,
    )  # fmt: skip


class Multiport(Element):
    """Base of all linear multiports."""

    section: ClassVar[str] = "links"
    nodes: tuple[Name, ...]

    @property
    def is_grounded(self) -> bool:
        """Whether the ports are between a node and the reference."""
        return True

    def ports(self) -> Ports:
        """Equations of the multiport, with an effort and a flow for each node, in the order of its nodes."""
        raise NotImplementedError
