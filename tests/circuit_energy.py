"""Energy in the inductances, capacitances, vessels and tanks of circuits, by the states that each of them has."""

import numpy as np
from energy import on_lines, silent

from tline.scene.vessel import Gas, Tank, Vapour
from tline.solver.assembly.assemble import Assembly
from tline.solver.description.circuit import StateSpace, equations, reflection
from tline.solver.description.elements import Branch
from tline.solver.description.given import Scene
from tline.solver.description.groups import Group
from tline.solver.kernel.stores import gas, tank
from tline.solver.loop.march import Stepper

ROUNDED = 1e-9
GAS, TANK, VAPOUR = (kind.number for kind in (Gas, Tank, Vapour))


class InCircuits:
    """Of scenes in which no node has two loads with states."""

    def __init__(self, scene: Scene, assembly: Assembly):
        self.forms = []
        for group, at in zip(assembly.groups, assembly.network.load_at, strict=True):
            if at >= 0:
                forms = [_form(scene, group, branch) for branch in (*group.loads, *group.branches)]
                states = _all_states(group, assembly.resolution.h)
                whole = np.zeros((len(states), len(states)))
                o = 0
                for form in forms:
                    whole[o : o + len(form), o : o + len(form)] = form
                    o += len(form)
                self.forms.append((at, states.T @ whole @ states))

    def __call__(self, assembly: Assembly) -> float:
        """Sum over all of them, J."""
        states = ((assembly.state.load[at : at + len(form)], form) for at, form in self.forms)
        return float(sum(x @ form @ x for x, form in states)) + in_vessels(assembly)


def in_vessels(assembly: Assembly) -> float:
    """Energy of gas, tanks and vapour cavities, J."""
    laws, states, total = assembly.network.laws, assembly.state.load, 0.0
    for kind, at, place in zip(laws.kind, laws.at, laws.state_at, strict=True):
        c = laws.constants[at:]
        if kind == VAPOUR:
            total -= c[0] * states[place]
        elif kind in (GAS, TANK):
            unit, store = (c[2] * c[3], gas) if kind == GAS else (c[2], tank)
            total += unit * store.stored(laws.constants, at, states[place])[0] ** 2 / 2
    return total


def _all_states(group: Group, h: float) -> np.ndarray:
    """States of all branches by those that the circuit keeps: what binds the others tells efforts and flows nothing."""
    branches = [*group.loads, *group.branches]
    kept = group.circuit(0.0, group.matched(1 / h)).kept
    n = sum(len(branch.ports.Q) for branch in branches)
    if len(kept) == n:
        return np.eye(n)
    F, G, *_ = equations(group.nodes, branches, group.ports(group.matched(1 / h)))
    size = np.abs(F).max(axis=0)
    left, values, _ = np.linalg.svd(F / np.where(size == 0, 1, size))
    silent = left[:, values < ROUNDED * values[0]].T
    bound = silent @ G
    bound[np.abs(bound) < ROUNDED * (np.abs(silent) @ np.abs(G))] = 0.0
    gone = np.setdiff1d(np.arange(n), kept)
    states = np.zeros((n, len(kept)))
    states[kept] = np.eye(len(kept))
    states[gone] = -np.linalg.lstsq(bound[:, gone], bound[:, kept])[0]
    return states


def _form(scene: Scene, group: Group, branch: Branch) -> np.ndarray:
    part, name = branch.where.split(".")
    element = getattr(scene, part)[name]
    if not len(branch.ports.Q):
        return np.zeros((0, 0))
    if element.kind == "coupled inductors":
        (one, two), k = element.inductance, element.coupling
        mutual = k * np.sqrt(one * two)
        return np.array([[one, mutual], [mutual, two]]) / 2
    node = group.nodes[branch.nodes[0]]
    g = node.total if part == "loads" else node.alone
    impedance = node.load if part == "loads" else element.ratio
    return stored(reflection(impedance, 1 / g, ""), g, element)


def stored(system: StateSpace, g: float, element) -> np.ndarray:
    """Quadratic form of the state of R, L and C in a row or side by side, realised by their reflection against 1/g."""
    A, _, c, _ = system
    u, i = c / 2, -c * g / 2  # effort and flow as functions of the state; what depends on the wave cancels
    L, C, R = (float(getattr(element, name, None) or 0) for name in ("inductance", "capacitance", "resistance"))
    if element.kind == "series":
        parts = [(L, i), (C, u - R * i - L * i @ A)]
    else:
        parts = [(C, u), (L, i - (u / R if R else 0.0) - C * u @ A)]
    return np.sum([size / 2 * v.T @ v for size, v in parts], axis=0)


def largest_growth(table: dict, seed: int, slabs: int) -> float:
    """Most that a slab adds to what waves, circuits and vessels hold, over what random waves held at the start."""
    scene = Scene(**table)
    assembly = silent(scene, seed)
    stored_in, order = InCircuits(scene, assembly), table["solver"]["order"]
    steps = Stepper(assembly, slabs, np.zeros((0, 2, slabs * order)))
    energies = [on_lines(assembly) + stored_in(assembly)]
    for slab in range(slabs):
        steps.advance(slab, slab + 1)
        energies.append(on_lines(assembly) + stored_in(assembly))
    return float(max(0.0, np.diff(energies).max() / energies[0]))
