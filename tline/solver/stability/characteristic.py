"""The characteristic function of a scene: its zeros are the exponents s of the waves exp(st) that sustain themselves.

Waves w that arrive at the line ends come back as w = P(s) S(s) w, with the delays P = diag(exp(-sT)) and the scattering
S of the nodes. At a node with lines and resistances of conductance Y and a load Z = p/q, S holds 2 (1/z_k) p/f - delta
with f = Y p + q, so D(s) = det(I - P S) times the product of all f has no poles.
"""

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.nodes import Node, nodes_of

CHUNK = 2e6  # complex entries held at once


class Characteristic:
    """D(s) of a scene after its last switch has moved; s in units of 1/`second`.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Scene):
        lines = list(scene.lines.values())
        delays = np.array([line.parameters.delay or 0.0 for line in lines])
        self.second = float(delays.min())
        self.delays = delays / self.second
        self.z0 = np.array([line.parameters.z0 for line in lines])
        self.nodes = list(nodes_of(scene).values())
        self.totals = np.array([node.total + node.switched(np.inf) for node in self.nodes])
        self.loads = [self._polynomials(node, total) for node, total in zip(self.nodes, self.totals, strict=True)]

    def _polynomials(self, node: Node, total: float) -> tuple[NDArray, NDArray]:
        """Coefficients of Y p and of f = Y p + q, one scale for both; Y p = 0 where the node holds its effort."""
        if node.held is not None or np.isinf(total):
            return np.zeros(1), np.ones(1)
        if node.load is None:
            return np.ones(1), np.ones(1)
        p, q = node.load.numerator, node.load.denominator
        over = [a * Fraction(total) / Fraction(self.second) ** k for k, a in enumerate(reversed(p))][::-1]
        rest = [b / Fraction(self.second) ** k for k, b in enumerate(reversed(q))][::-1]
        scale = max(map(abs, over + rest))
        through = np.array([float(a / scale) for a in over])
        return through, np.polyadd(through, np.array([float(b / scale) for b in rest]))

    @property
    def corner(self) -> float:
        """Beyond this modulus of s the loads behave as at infinity: that of the largest root of all p, q and f."""
        roots = [np.roots(side) for over, f in self.loads for side in (over, f, np.polysub(f, over))]
        return float(max((np.abs(r).max() for r in roots if len(r)), default=0.0))

    def log(self, s: NDArray) -> NDArray:
        """Logarithm of D, its imaginary part up to multiples of 2 pi; s and result of shape (n,)."""
        ends = 2 * len(self.z0)
        return np.concatenate([self._log(part) for part in np.array_split(s, int(len(s) * ends**2 / CHUNK) + 1)])

    def _log(self, s: NDArray) -> NDArray:
        sign, size = np.linalg.slogdet(np.eye(2 * len(self.z0)) - self.returned(s))
        return size + np.log(sign) + sum(np.log(np.polyval(f, s)) for _, f in self.loads)

    def returned(self, s: NDArray) -> NDArray:
        """What comes back of the waves that arrive, P S, shape (n, 2 lines, 2 lines) for s of shape (n,)."""
        matrix = np.zeros((len(s), 2 * len(self.z0), 2 * len(self.z0)), complex)
        for node, total, (over, f) in zip(self.nodes, self.totals, self.loads, strict=True):
            ends = np.array(node.ends)
            passed = 2 * np.polyval(over, s) / np.polyval(f, s) / total
            scattering = passed[:, None, None] / self.z0[ends // 2] - np.eye(len(ends))
            delayed = np.exp(-np.outer(s, self.delays[ends // 2]))
            matrix[:, (ends ^ 1)[:, None], ends] = delayed[:, :, None] * scattering
        return matrix
