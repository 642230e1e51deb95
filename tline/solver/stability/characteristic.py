"""The characteristic function of a scene: its zeros are the exponents s of waves exp(st) that sustain themselves."""

import numpy as np
from numpy.typing import NDArray

from tline.solver.stability.scattering import Scattering

CHUNK = 2e6  # complex entries held at once


class Characteristic(Scattering):
    """D(s) = det(I - P S) times the product of all f: without poles; see `scattering` for the names."""

    @property
    def corner(self) -> float:
        """Beyond this modulus of s the loads behave as at infinity: that of the largest root of all p, q and f."""
        roots = [np.roots(side) for over, f in self.loads for side in (over, f, np.polysub(f, over))]
        return float(max((np.abs(r).max() for r in roots if len(r)), default=0.0))

    def log(self, s: NDArray) -> NDArray:
        """Logarithm of D, its imaginary part up to multiples of 2 pi; s and result of shape (n,)."""
        return np.concatenate([self._log(part) for part in np.array_split(s, int(len(s) * self.size**2 / CHUNK) + 1)])

    def _log(self, s: NDArray) -> NDArray:
        sign, size = np.linalg.slogdet(np.eye(self.size) - self.returned(s))
        return size + np.log(sign) + sum(np.log(f) for _, f in self.sides(s))
