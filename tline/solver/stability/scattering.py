"""A scene in s: lines between nodes that scatter waves.

Waves w that arrive at the line ends come back as w = P(s) (S(s) w + g), with the lines' passage P, exp(-sT) without
losses, the scattering S of the nodes and what the sources send, g. At a node with lines and resistances of conductance
Y and a load Z = p/q, the effort is u = p/f (sum of w/z0 + J) with f = Y p + q and J the flow of its sources; 2u - w
leaves each end.
"""

from collections.abc import Iterator, Mapping
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.scene.touchstone import Touchstone
from tline.solver.nodes import Node, nodes_of
from tline.solver.stability.lossy_line import carried, losses_of


class Scattering:
    """A scene after its last switch has moved; s counts in units of 1/`second`.

    Parameters
    ----------
    scene : Scene
        Its sources count with their resistances only.
    terminations : mapping of str to float, optional
        Conductances at nodes, beside what stands there.
    """

    def __init__(self, scene: Scene, terminations: Mapping[str, float] | None = None):
        scene.check_linear("transfer functions and growth rates")
        lines = list(scene.lines.values())
        delays = np.array([line.parameters.delay or 0.0 for line in lines])
        self.second = float(delays.min())
        self.delays = delays / self.second
        self.z0 = np.array([line.parameters.z0 for line in lines])
        nodes = nodes_of(scene)
        self.names = list(nodes)
        more = terminations or {}
        self.totals = np.array([node.total + node.switched(np.inf) + more.get(k, 0.0) for k, node in nodes.items()])
        self.held = np.array([node.held is not None or np.isinf(node.switched(np.inf)) for node in nodes.values()])
        self.ends = [np.array(node.ends) for node in nodes.values()]
        self.lossy = {k: losses_of(name, line) for k, (name, line) in enumerate(scene.lines.items()) if line.losses}
        self.measured = [node.measured for node in nodes.values()]
        self.loads = [self._polynomials(*each) for each in zip(nodes.values(), self.totals, self.held, strict=True)]

    def _polynomials(self, node: Node, total: float, held: bool) -> tuple[NDArray, NDArray]:
        """Coefficients of Y p and of f = Y p + q, one scale for both; Y p = 0 where the effort is held."""
        if held:
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
    def size(self) -> int:
        """Number of line ends."""
        return 2 * len(self.z0)

    def sides(self, s: NDArray) -> Iterator[tuple[NDArray, NDArray]]:
        """Y p and f of each node, of the shape of s."""
        for (over, f), load, total, held in zip(self.loads, self.measured, self.totals, self.held, strict=True):
            if load is None or held:
                yield np.polyval(over, s), np.polyval(f, s)
            else:
                yield self._measured(load, total, s)

    def _measured(self, load: Touchstone, total: float, s: NDArray) -> tuple[NDArray, NDArray]:
        """The same from the poles a of S = (Z - z0)/(Z + z0), as good as these: Z = z0 (1 + S)/(1 - S)."""
        model = load.model.model
        S = model.at(s / (1j * self.second))
        a = np.concatenate([model.poles, model.poles[model.poles.imag > 0].conj()]) * self.second
        size, over = np.prod(s[..., None] - a, axis=-1), load.z0 * total * (1 + S)
        return size * over, size * (1 - S + over)

    def passed(self, s: NDArray) -> NDArray:
        """p/f of each node: its effort where a unit flow is driven in and no wave arrives; shape (n, nodes)."""
        totals = np.where(self.held, 1.0, self.totals)
        quotients = [over / f for over, f in self.sides(s)]
        return np.stack(quotients, axis=1) / totals

    def carried(self, s: NDArray) -> tuple[NDArray, NDArray]:
        """P by the end that sends: what arrives at the other end, and what comes back; two of shape (n, ends)."""
        across = np.exp(-np.outer(s, self.delays))
        back = np.zeros_like(across)
        for k, line in self.lossy.items():
            across[:, k], back[:, k] = carried(line, self.z0[k], s / self.second)
        return np.repeat(across, 2, axis=1), np.repeat(back, 2, axis=1)

    def returned(self, s: NDArray) -> NDArray:
        """What comes back of the waves that arrive, P S, shape (n, ends, ends) for s of shape (n,)."""
        matrix = np.zeros((len(s), self.size, self.size), complex)
        passed, (across, back) = 2 * self.passed(s), self.carried(s)
        for k, ends in enumerate(self.ends):
            scattering = passed[:, k, None, None] / self.z0[ends // 2] - np.eye(len(ends))
            matrix[:, (ends ^ 1)[:, None], ends] += across[:, ends, None] * scattering
            matrix[:, ends[:, None], ends] += back[:, ends, None] * scattering
        return matrix
