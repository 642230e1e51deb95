"""Readable twin of a linear circuit between line ends: nodal analysis, and Radau IIA on its descriptor form.

With x the efforts at nodes and the flows through inductors, E x' = A x + B w, w the waves that arrive; no state space
is made of it, and nothing is reduced. A stage matrix a and a slab h give (1⊗E - h a⊗A) X = 1⊗E x0 + h (a⊗1) B w.
"""

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray


def radau(s: int) -> tuple[NDArray, NDArray]:
    """Right Radau points on (0, 1], and the integrals up to them of polynomials by their values there."""
    c = np.sort((legendre.legroots(legendre.legsub(np.eye(s + 1)[s], np.eye(s + 1)[s - 1])).real + 1) / 2)
    c[-1] = 1.0
    powers = np.vander(c, s + 1, increasing=True)
    return c, powers[:, 1:] / np.arange(1, s + 1) @ np.linalg.inv(powers[:, :-1])


class Twin:
    """Nodes are numbered from 0; -1 is the reference."""

    def __init__(self, nodes: int, z0: list[float]):
        self.nodes, self.z0 = nodes, z0
        self.conductances: list[tuple[int, int, float]] = [(k, -1, 1 / z) for k, z in enumerate(z0)]
        self.capacitances: list[tuple[int, int, float]] = []
        self.coils: list[tuple[int, int]] = []
        self.inductances: list[NDArray] = []

    def windings(self, places: list[tuple[int, int]], inductance: NDArray) -> None:
        """Coils between places, by their matrix of inductances."""
        self.coils += places
        self.inductances.append(inductance)

    def efforts(self, arriving, s: int, h: float, slabs: int) -> NDArray:
        """At all nodes and slab ends, from rest; line k ends at node k, and `arriving` gives its wave over time."""
        n, m, p = self.nodes, len(self.coils), len(self.z0)
        E, A, B = np.zeros((n + m, n + m)), np.zeros((n + m, n + m)), np.zeros((n + m, p))
        for matrix, sign, parts in ((A, -1.0, self.conductances), (E, 1.0, self.capacitances)):
            for i, j, value in parts:
                across = np.zeros(n + m)
                across[[k for k in (i, j) if k >= 0]] = [1.0, -1.0][: 1 + (j >= 0)]
                matrix += sign * value * np.outer(across, across)
        at = n
        for matrix in self.inductances:
            E[at : at + len(matrix), at : at + len(matrix)] = matrix
            at += len(matrix)
        for k, (i, j) in enumerate(self.coils, n):
            for node, sign in ((i, 1.0), (j, -1.0)):
                if node >= 0:
                    A[k, node] += sign
                    A[node, k] -= sign
        B[range(p), range(p)] = 1 / np.array(self.z0)
        c, a = radau(s)
        whole = np.kron(np.eye(s), E) - h * np.kron(a, A)
        started = np.linalg.solve(whole, np.kron(np.ones((s, 1)), E))
        driven = np.linalg.solve(whole, h * np.kron(a, B))
        x, found = np.zeros(n + m), [np.zeros(n)]
        for k in range(slabs):
            w = np.array([[wave((k + point) * h) for wave in arriving] for point in c])
            x = (started @ x + driven @ w.ravel())[-n - m :]
            found.append(x[:n])
        return np.array(found)
