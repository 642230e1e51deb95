"""Energy stored in a scene: in the waves on its lines and in its inductances and capacitances."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import pairwise

import numpy as np

from tline.scene.load import Load
from tline.scene.multiport import CoupledInductors
from tline.scene.rational import Parallel, Series
from tline.scene.scene import Scene
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.description.circuit import StateSpace, reflection
from tline.solver.description.description import describe
from tline.solver.description.nodes import NONE
from tline.solver.description.resolution import resolution
from tline.solver.loop.march import Stepper
from tline.solver.radau import basis


def on_lines(assembly: Assembly) -> float:
    """Integral of (a² + b²)/(4 z0) over the waves under way, the part of the last slab not yet delivered included."""
    net, state, s, h = assembly.network, assembly.state, assembly.basis.s, assembly.resolution.h
    squares = (state.waves.reshape(-1, s) @ assembly.basis.to_legendre.T) ** 2 @ (1 / np.arange(1, 2 * s, 2))
    total = 0.0
    for k, line in enumerate(assembly.lines.values()):
        o, n, part = net.offset[k] // s, 2 * net.delay[k], squares[0:0]
        if net.shift_row[k] >= 0:
            part = (state.before[2 * k : 2 * k + 2] @ last_part(s, line.delay / h - net.delay[k])) ** 2
        total += h * float(squares[o : o + n].sum() + part.sum()) / (4 * line.z0)
    return total


@lru_cache
def last_part(s: int, f: float) -> np.ndarray:
    """Matrix from a slab's values to numbers whose squares add up to the integral of the square over its last part."""
    part = basis(s)
    return (part.to_legendre @ part.restriction(1 - f, 1.0)).T * np.sqrt(f / np.arange(1, 2 * s, 2))


class InLoads:
    """Energy of each inductance and capacitance: one series or parallel load at a node, lumped lines, and windings."""

    def __init__(self, scene: Scene, assembly: Assembly):
        self.forms = []
        sections, nodes, net = assembly.resolution.sections, assembly.nodes, assembly.network
        names = list(nodes)
        loads = {load.at: load for load in scene.loads.values() if dynamic(load)}
        for low, high, at in zip(net.group[:-1], net.group[1:], net.load_at, strict=True):
            for name in names[low:high]:
                node = nodes[name]
                if node.held is None and node.load is not None:
                    beside = sum(
                        capacitance(scene, line) / 2 / n * ends(scene, line, name) for line, n in sections.items()
                    )
                    form = stored(reflection(node.load, 1 / node.total, ""), node.total, loads.get(name), beside)
                    self.forms.append((at, form))
                    at += len(form)
            for line, n in sections.items():
                if scene.lines[line].nodes[0] in names[low:high]:
                    self.forms.append((at, np.eye(2 * n - 1) * capacitance(scene, line) / n / 2))
                    at += 2 * n - 1
            for link in scene.links.values():
                if isinstance(link, CoupledInductors) and link.nodes[0] in names[low:high]:
                    self.forms.append((at, np.linalg.inv(link.ports().P) / 2))
                    at += 2

    def __call__(self, assembly: Assembly) -> float:
        """Sum over the loads, J."""
        states = ((assembly.state.load[at : at + len(form)], form) for at, form in self.forms)
        return float(sum(x @ form @ x for x, form in states))


def dynamic(load: Load) -> bool:
    """Whether it is of inductances and capacitances."""
    return isinstance(load, Series | Parallel) and (load.inductance, load.capacitance) != (None, None)


def capacitance(scene: Scene, line: str) -> float:
    """Of a whole line: T/z0."""
    return scene.lines[line].parameters.delay / scene.lines[line].parameters.z0


def ends(scene: Scene, line: str, node: str) -> int:
    """How many ends a line has at a node."""
    return scene.lines[line].nodes.count(node)


def stored(system: StateSpace, g: float, load: Series | Parallel | None, beside: float) -> np.ndarray:
    """Quadratic form of the state of a load, realised by its reflection against 1/g, with a capacitance beside it."""
    A, _, c, _ = system
    # effort, flow and their slopes as functions of the state; what depends on the wave cancels
    u, i = c / 2, -c * g / 2
    i, du = i - beside * u @ A, u @ A
    L, C, R = (load.inductance, load.capacitance, load.resistance) if load else (None, None, None)
    if isinstance(load, Series):
        parts = [(L or 0.0, i), (C or 0.0, u - (R or 0.0) * i - (L or 0.0) * i @ A), (beside, u)]
    else:
        parts = [((C or 0.0) + beside, u), (L or 0.0, i - (u / R if R else 0.0) - (C or 0.0) * du)]
    return sum(size / 2 * np.outer(v, v) for size, v in parts)


def silent(scene, seed: int, sections: Mapping[str, int] = NONE) -> Assembly:
    """The scene without sources, its lines filled with random waves; some may be lumped, in so many LC sections."""
    chosen = resolution(describe(scene), sections=sections)
    assembly = assemble(describe(scene), set(), chosen)
    rng = np.random.default_rng(seed)
    assembly.state.waves[:] = rng.normal(size=assembly.state.waves.shape)
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape)
    return assembly


def edges_of(pieces, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Starts and ends of the pieces of a row."""
    edges = pieces.start[row, : pieces.number[row] + 1]
    return edges[:-1], edges[1:]


def in_pieces(steps: Stepper) -> float:
    """Energy of the slabs under way that are in pieces, as `on_lines` counts the others."""
    assembly, fronts = steps.assembly, steps.fronts
    net, s, h = assembly.network, assembly.basis.s, assembly.resolution.h
    pieces, total = fronts.pieces, 0.0

    norms, (x, weights) = 1 / np.arange(1, 2 * s, 2), np.polynomial.legendre.leggauss(s)
    z0 = [line.z0 for line in assembly.lines.values()]

    def energy(row: int, line: int, start: float) -> float:
        """Of what lies behind the start; by Parseval, or by Gauss where a piece is cut."""
        part = 0.0
        for a, b, coef in zip(*edges_of(pieces, row), pieces.coef[row], strict=False):
            if a >= start:
                part += (b - a) * float(norms @ coef**2)
            elif b > start:
                y = 2 * (start + (b - start) * (x + 1) / 2 - a) / (b - a) - 1
                part += (b - start) / 2 * float(weights @ np.polynomial.legendre.legval(y, coef) ** 2)
        return h * part / (4 * z0[line])

    for slab in np.flatnonzero(pieces.of_slab >= 0):
        line = int(np.searchsorted(net.offset, slab * s, side="right")) - 1
        total += energy(pieces.of_slab[slab], line, 0.0)
    for end in np.flatnonzero(pieces.before >= 0):
        total += energy(pieces.before[end], end // 2, 1.0 - fronts.rest[end // 2])
    return total


def never_grows(scene: Scene, seed: int, held: Callable[[Assembly], float], least: float) -> None:
    """From random waves on, energy on lines and what is held at their ends grow by no more than that share a slab."""
    assembly = silent(scene, seed)
    n = int(scene.t_end / float(scene.solver.slab))
    steps, energies = Stepper(assembly, n, np.zeros((0, 2, n * scene.solver.order))), []
    for low, high in pairwise(range(n)):
        waiting = 0.0 if steps.fronts is None else in_pieces(steps)
        energies.append(on_lines(assembly) + waiting + held(assembly))
        assert energies[-1] <= energies[max(len(energies) - 2, 0)] + least * energies[0]
        steps.advance(low, high)
