"""The characteristic function of a scene: its zeros are the exponents s of waves exp(st) that sustain themselves."""

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.given import Ports
from tline.solver.stability.scattering import CHUNK, Scattering


class Characteristic(Scattering):
    """D(s) = det(I - P S) times the product of all f: without poles; see `scattering` for the names.

    Of nodes that branches join, the determinants of their balance and of the branches' s - Q stand for the f.
    """

    @property
    def corner(self) -> float:
        """Beyond this modulus of s the loads behave as at infinity: that of the largest root of all p, q and f.

        Of branches, that of the largest root of their Q, and of the determinants of M u and N i alone.
        """
        roots = [
            np.roots(side)
            for (p, f), total in zip(self.loads, self.totals, strict=True)
            for side in (p, f, np.polysub(f, p * total))
        ]
        for _, branches in self.groups:
            roots += [each * self.second for branch in branches for each in _roots(branch.ports)]
        return float(max((np.abs(r).max() for r in roots if len(r)), default=0.0))

    def log(self, s: NDArray) -> NDArray:
        """Logarithm of D, its imaginary part up to multiples of 2 pi; s and result of shape (n,)."""
        return np.concatenate([self._log(part) for part in np.array_split(s, int(len(s) * self.size**2 / CHUNK) + 1)])

    def _log(self, s: NDArray) -> NDArray:
        balances = list(self.balances(s))
        total = _log_det(np.eye(self.size) - self.sent_back(*self.carried(s), self.answered(balances)))
        for (_, branches), (_, _, matrix) in zip(self.groups, balances, strict=True):
            total = total + _log_det(matrix)
            for branch in branches:
                Q = branch.ports.Q * self.second
                total = total + _log_det(s[:, None, None] * np.eye(len(Q)) - Q)
        return total


def _log_det(matrices: NDArray) -> NDArray:
    sign, size = np.linalg.slogdet(matrices)
    return size + np.log(sign.astype(complex))


def _roots(ports: Ports) -> list[NDArray]:
    """Roots of s - Q, and of the determinants of what stands before the efforts and before the flows, 1/s."""
    found: list[NDArray] = [np.linalg.eigvals(ports.Q)]
    for matrix, driven in ((ports.M, ports.P), (ports.N, ports.R)):
        if np.linalg.matrix_rank(matrix) == len(matrix):
            found.append(np.linalg.eigvals(ports.Q + driven @ np.linalg.solve(matrix, ports.E)))
    return found
