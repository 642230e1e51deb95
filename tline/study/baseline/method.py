"""Base of baseline methods, and their data from a scene: delays, impedances, steps, samples, limits of work."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss.line import Losses
from tline.scene.cavities import with_cavities
from tline.scene.scene import Scene
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node
from tline.study.baseline.loops import NodeScattering
from tline.words.wording import place


class BaselineRun(NamedTuple):
    """Instants, effort of each probe at these, and the time of the time stepping, s."""

    t: NDArray
    u: dict[str, NDArray]
    seconds: float


@dataclass(frozen=True)
class Baseline:
    """Baseline method for comparison with the production method.

    Attributes
    ----------
    label : str
        For charts.
    order : int
        Of the error in 1/n, for smooth waves between resistances.
    load_order : int
        Of the error in 1/n for dynamic loads; the lower of both holds.
    solve : callable
        From a scene and n to a trace.
    unfit : callable
        From a scene to the reason why this method is not applicable, or None.
    knows : str
        Losses of lines supported: "nothing", "resistance", or "friction", then also from a steady start.
    """

    label: str
    order: int
    load_order: int
    solve: Callable[[Scene, float], BaselineRun]
    unfit: Callable[[Scene], str | None] = lambda scene: None
    knows: str = "nothing"

    def incompatibility(self, scene: Scene) -> str | None:
        """Reason why this method is not applicable to a scene; None if it is."""
        for part, name in scene.laws:
            return f"{place(part, name)}: baseline methods know linear elements only"
        for name in with_cavities(scene.lines):
            return f"{place('lines', name, 'cavities')}: baseline methods know linear elements only"
        for where, _ in scene.between:
            return f"{where}: baseline methods know nothing between nodes"
        for name, load in scene.loads.items():
            if load.kind in ("switch", "valve"):
                return f"{place('loads', name)}: baseline methods have no switches"
        for name, probe in scene.probes.items():
            if probe.at is None:
                return f"{place('probes', name)}: baseline methods see nodes only"
        for name, line in scene.lines.items():
            if line.losses and not _takes(line.losses, self.knows):
                return f"{place('lines', name)}: loses what this method does not know"
        if scene.start != "rest" and self.knows != "friction":
            return "start: baseline methods start at rest only"
        return self.unfit(scene)

    def run(self, scene: Scene, n: float) -> BaselineRun:
        """Run a scene with n steps per shortest delay."""
        if why := self.incompatibility(scene):
            raise InputError("", f"{self.label}: {why}")
        if not n >= 2:
            raise InputError("n", "too few steps per shortest delay", "at least 2", f"{n}")
        return self.solve(scene, n)


def _takes(losses: Losses, known: str) -> bool:
    """Whether a method that supports these losses is applicable to a line."""
    if known == "friction":
        return losses.only_quadratic
    return known == "resistance" and losses.constant is not None and not losses.constant[1]


MOST_WORK = 2e9  # cells times steps
MOST_KEPT = 1e8  # samples
HALF = 0.5  # of a step, offset of the shortest delay in methods that interpolate: the worst case
COURANT = 0.9  # of methods that would be exact, or could not run, at 1


def delays_of(scene: Scene) -> NDArray:
    """Delay of each line, s."""
    return np.array([line.parameters.delay or 0.0 for line in scene.lines.values()])


def impedances_of(scene: Scene) -> NDArray:
    """Characteristic impedance of each line."""
    return np.array([line.parameters.z0 for line in scene.lines.values()])


def decays_of(scene: Scene) -> NDArray:
    """Resistance over inductance of each line."""
    series = [line.losses.exact.series if line.losses else None for line in scene.lines.values()]
    return np.array([law.loss / law.storage if law else 0.0 for law in series])


def shortest_delay(scene: Scene) -> float:
    """Shortest delay, s."""
    return float(delays_of(scene).min())


def count_steps(scene: Scene, dt: float) -> int:
    """Steps of width dt until the end time, the last one whole."""
    return ceil(scene.t_end / dt - 1e-9)


def cells_of(scene: Scene, dt: float, courant: float) -> NDArray:
    """Cells of each line, as many as the Courant number allows."""
    return np.maximum(np.floor(courant * delays_of(scene) / dt + 1e-9), 1).astype(int)


def sections_of(scene: Scene, n: float) -> NDArray:
    """Sections of each line, n on the shortest."""
    sections = np.ceil(n * delays_of(scene) / shortest_delay(scene) - 1e-9).astype(int)
    within(float(sections.max()) ** 2, MOST_KEPT)
    return sections


def within(work: float, most: float) -> None:
    """Raise an error if the number of operations or samples is beyond the most allowed."""
    if work > most:
        problem = f"takes {work:.2g} numbers, for the delays are far apart or the run is long"
        raise InputError("n", problem, f"at most {most:.0e}")


def probed(scene: Scene) -> list[int]:
    """Numbers of the nodes with probes."""
    names = list(dict.fromkeys(name for line in scene.lines.values() for name in line.nodes))
    return [names.index(str(probe.at)) for probe in scene.probes.values()]


def sampled(parts: list, t: NDArray, dt: float) -> NDArray:
    """Sum of waveforms; at a jump the value before it."""
    return sum((factor * waveform.value(t, t - 1e-9 * dt) for waveform, factor in parts), np.zeros(len(t)))


def stepped(scene: Scene, loop: Callable[..., None], dt: float, steps: int, parts: list) -> BaselineRun:
    """Sample the sources and run a compiled loop, which is compiled before the clock starts."""
    seen, t = np.array(probed(scene)), np.arange(steps + 1) * dt
    within((steps + 1) * (len(parts) + len(seen)), MOST_KEPT)
    record = np.zeros((len(seen), steps + 1))
    loop(np.zeros((len(parts), 1)), seen, 0, record)
    begun = time.process_time()
    loop(np.array([sampled(row, t, dt) for row in parts]), seen, steps, record)
    seconds = time.process_time() - begun
    return BaselineRun(t, dict(zip(scene.probes, record, strict=True)), seconds)


Euler = tuple[NDArray, NDArray, NDArray]  # x_next = first x + second w_now + third w_next


def forward_euler(A: NDArray, b: NDArray) -> Euler:
    """Integrate x' = A x + b w by forward Euler; A and b count time in steps."""
    return np.eye(len(A)) + A, b, 0 * b


def backward_euler(A: NDArray, b: NDArray) -> Euler:
    """Integrate x' = A x + b w by backward Euler; A and b count time in steps."""
    inverse = np.linalg.inv(np.eye(len(A)) - A)
    return inverse, 0 * b, inverse @ b


def trapezoid(A: NDArray, b: NDArray) -> Euler:
    """Integrate x' = A x + b w by the trapezoidal rule; A and b count time in steps."""
    inverse = np.linalg.inv(np.eye(len(A)) - A / 2)
    return inverse @ (np.eye(len(A)) + A / 2), inverse @ b / 2, inverse @ b / 2


def scattering(scene: Scene, nodes: list[Node], dt: float, rule: Callable[[NDArray, NDArray], Euler]) -> NodeScattering:
    """Scattering at the nodes of a scene, with their loads integrated by a rule."""
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


class NodeSystem(NamedTuple):
    """Node as a system x' = A x + B v, effort = C x + D v, v the input of lines and of sources; k states."""

    A: NDArray  # (k, k)
    B: NDArray  # (k, 2)
    C: NDArray  # (1, k)
    D: NDArray  # (1, 2)


HELD = NodeSystem(np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((1, 0)), np.array([[0.0, 1.0]]))


def _companion(tops: list[NDArray], bottom: NDArray) -> NodeSystem:
    """State space of transfer functions of one denominator, highest power first. The effort is x[0] + D v."""
    bottom = np.trim_zeros(bottom, "f")
    k, a = len(bottom) - 1, bottom / bottom[0]
    b = np.array([np.pad(top, (k + 1 - len(top), 0)) for top in tops]).T / bottom[0]
    A = np.eye(k, k=1)
    A[:, :1] -= a[1:, None]
    return NodeSystem(A, b[1:] - np.outer(a[1:], b[0]), np.eye(1, k), b[:1])


def _admittance(node: Node, unit: float) -> tuple[NDArray, NDArray]:
    """Numerator and denominator of the admittance at a node without its lines; s counts in 1/unit."""
    if node.load is None:
        return np.array([node.conductance]), np.ones(1)
    p, q = (
        np.array([float(a) / unit**k for k, a in zip(range(len(side) - 1, -1, -1), side, strict=True)])
        for side in (node.load.numerator, node.load.denominator)
    )
    scale = max(np.abs(p).max(), np.abs(q).max())
    return np.polyadd(node.conductance * p, q) / scale, p / scale


def half_sections(scene: Scene, nodes: dict[str, Node], cells: NDArray) -> list[tuple[Node, float]]:
    """Nodes, each with the capacitance of the half cells there."""
    half = np.repeat(delays_of(scene) / cells / impedances_of(scene) / 2, 2)
    return [(node, float(half[node.ends].sum())) for node in nodes.values()]


def on_capacitor(node: Node, capacitance: float, unit: float) -> NodeSystem:
    """Return the system from the flows into a node with a capacitance to its effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    return _companion([under, under], np.polyadd(np.append(capacitance / unit * under, 0.0), over))


def behind_inductor(node: Node, inductance: float, unit: float) -> NodeSystem:
    """System from the effort behind an inductance, in units of time times z0, and the sources' flow to the effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    source = np.append(inductance * under, 0.0) if node.flows else np.zeros(1)
    return _companion([under, source], np.polyadd(under, np.append(inductance * over, 0.0)))
