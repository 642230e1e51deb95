"""Energy stored in a scene: in the waves on its lines and in its inductances and capacitances."""

import numpy as np

from tline.scene.load import Parallel, Series
from tline.scene.scene import Scene
from tline.solver.assemble import Assembly
from tline.solver.load_step import reflection
from tline.solver.nodes import nodes_of


def on_lines(assembly: Assembly) -> float:
    """Integral of (a² + b²)/(4 z0) over the waves under way, the part of the last slab not yet delivered included."""
    net, state, basis, h = assembly.network, assembly.state, assembly.basis, assembly.resolution.h
    weights = basis.to_legendre.T @ np.diag(1 / (2 * np.arange(basis.s) + 1)) @ basis.to_legendre
    total = 0.0
    for k, line in enumerate(assembly.scene.lines.values()):
        o, n = net.offset[k], 2 * net.delay[k] * basis.s
        slabs = [state.waves[o : o + n].reshape(-1, basis.s)]
        if net.shift_row[k] >= 0:
            f = line.parameters.delay / h - net.delay[k]
            slabs.append(np.sqrt(f) * state.before[2 * k : 2 * k + 2] @ basis.restriction(1 - f, 1.0).T)
        for values in slabs:
            total += h * np.einsum("ni,ij,nj->", values, weights, values) / (4 * line.parameters.z0)
    return total


class InLoads:
    """Energy of the inductance and capacitance of each series or parallel load, one load at a node."""

    def __init__(self, scene: Scene, assembly: Assembly):
        self.forms = []
        nodes = nodes_of(scene)
        for load in scene.loads.values():
            if not isinstance(load, Series | Parallel) or (load.inductance is None and load.capacitance is None):
                continue
            z = 1 / nodes[load.at].total
            A, _, c, _ = reflection(load.rational().reduced(), z, "")
            # effort, flow and their slopes as functions of the state; what depends on the wave cancels
            u, i, du, di = c / 2, -c / (2 * z), c @ A / 2, -c @ A / (2 * z)
            L, C, R = load.inductance, load.capacitance, load.resistance
            if isinstance(load, Series):
                parts = [(L or 0.0, i), (C or 0.0, u - (R or 0.0) * i - (L or 0.0) * di)]
            else:
                parts = [(C or 0.0, u), (L or 0.0, i - (u / R if R else 0.0) - (C or 0.0) * du)]
            form = sum(size / 2 * np.outer(v, v) for size, v in parts)
            row = assembly.network.load_row[assembly.nodes.index(load.at)]
            self.forms.append((row, form))

    def __call__(self, assembly: Assembly) -> float:
        """Sum over the loads, J."""
        states = ((assembly.state.load[row][: len(form)], form) for row, form in self.forms)
        return float(sum(x @ form @ x for x, form in states))
