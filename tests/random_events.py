"""Random scenes in which things move beside laws that kink, at shared and at different instants; and what is right.

Lines are lossless and the elements keep nothing, so waves follow by recursion from bounce to bounce: at each instant
the flows out of a node, or of two that a link joins, rise with their efforts, and have one root, found by halving.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene

HALVINGS, INNER = 52, 50
ROUNDING = 1e-9, 2e-7  # of exact values, and behind a link: its flow is the root of a small difference
Flow = Callable[[NDArray, NDArray], NDArray]  # of effort and time
INSTANTS = (0.3, 0.5, 0.7, 1.0)  # shared ones; delays are about 1


@dataclass
class Element:
    """Something at a node, or between the two nodes of the scene that a link joins."""

    table: dict[str, Any]
    flow: Flow


@dataclass
class EventScene:
    """A tree of lines from a source at node 0, and perhaps, behind a link from its last node, one more line.

    Flows of elements at the nodes; the link is between the last two nodes named in `joined`.
    """

    medium: str
    lines: list[tuple[int, int, float, float]]  # nodes, z0, delay
    source: tuple[dict[str, Any] | float, float, Flow]  # value, resistance, effort over time
    at: dict[int, list[Element]]
    joined: tuple[int, int] | None = None
    links: list[Element] = field(default_factory=list)
    t_end: float = 4.0

    @property
    def scene(self) -> Scene:
        effort = "pressure" if self.medium == "hydraulic" else "voltage"
        value, behind, _ = self.source
        ends = [(k, e) for k in range(len(self.lines)) for e in (0, 1)]
        loads = {
            f"x{n}{k}": element.table | {"at": f"n{n}"} for n, here in self.at.items() for k, element in enumerate(here)
        }
        nodes = [f"n{n}" for n in self.joined or ()]
        return Scene(
            medium=self.medium,
            t_end=self.t_end,
            start="steady",
            lines={
                f"l{k}": {"nodes": [f"n{a}", f"n{b}"], "z0": z0, "delay": delay}
                for k, (a, b, z0, delay) in enumerate(self.lines)
            },
            sources={"s": {"at": "n0", "kind": effort, "value": value, "resistance": behind}},
            loads=loads,
            links={f"y{k}": element.table | {"nodes": nodes} for k, element in enumerate(self.links)},
            probes={f"p{k}{e}": {"at": f"n{self.lines[k][e]}", "line": f"l{k}"} for k, e in ends},
        )

    def exact(self, t: NDArray) -> dict[str, tuple[NDArray, NDArray]]:
        """Effort and flow at both ends of all lines, at instants up to the end."""
        return Bounces(self, t).all()


class Bounces:
    """The recursion, at some instants."""

    def __init__(self, scene: EventScene, t: NDArray):
        self.scene, self.t = scene, t
        self.before = self._steady()
        self.known: dict[tuple[int, tuple[int, ...]], NDArray] = {}

    def all(self) -> dict[str, tuple[NDArray, NDArray]]:
        found, none = {}, (0,) * len(self.scene.lines)
        for k, line in enumerate(self.scene.lines):
            for e in (0, 1):
                u = self.node(line[e], none)
                w = self.arriving(k, e, none)
                found[f"p{k}{e}"] = u, (w - u) / line[2] * (1 if e else -1)
        return found

    def clock(self, shift: tuple[int, ...]) -> NDArray:
        return self.t - sum(times * line[3] for times, line in zip(shift, self.scene.lines, strict=True))

    def arriving(self, k: int, end: int, shift: tuple[int, ...]) -> NDArray:
        """The wave that arrives at an end of a line so many delays earlier: what left the other one."""
        earlier = (*shift[:k], shift[k] + 1, *shift[k + 1 :])
        left = self.clock(earlier)
        rest = self.before[1][k, 1 - end]  # what left before the start
        if (left <= 0).all():
            return np.full_like(self.t, rest)
        sent = 2 * self.node(self.scene.lines[k][1 - end], earlier) - self.arriving(k, 1 - end, earlier)
        return np.where(left > 0, sent, rest)

    def node(self, n: int, shift: tuple[int, ...]) -> NDArray:
        if (n, shift) not in self.known:
            pair = self.scene.joined if self.scene.joined and n in self.scene.joined else (n,)
            here = self.clock(shift)
            balances = [self._balance(m, shift, here) for m in pair]
            for m, u in zip(pair, solved(balances, self._link(here)), strict=True):
                self.known[m, shift] = np.where(here > 0, u, self.before[0][m])
        return self.known[n, shift]

    def _link(self, here: NDArray) -> Callable[[NDArray], NDArray]:
        return lambda e: sum((link.flow(e, here) for link in self.scene.links), np.zeros_like(here))

    def _balance(self, n: int, shift: tuple[int, ...], here: NDArray) -> Callable[[NDArray], NDArray]:
        """The flow out of a node as a function of its effort."""
        waves = [
            (self.arriving(k, e, shift), line[2])
            for k, line in enumerate(self.scene.lines)
            for e in (0, 1)
            if line[e] == n
        ]

        def flow(u: NDArray) -> NDArray:
            return sum(((u - w) / z0 for w, z0 in waves), np.zeros_like(u)) + self._out(n, u, here)

        return flow

    def _out(self, n: int, u: NDArray, t: NDArray) -> NDArray:
        out = sum((element.flow(u, t) for element in self.scene.at.get(n, [])), np.zeros_like(u))
        _, behind, value = self.scene.source
        return out + (u - value(u, t)) / behind if n == 0 else out

    def _steady(self) -> tuple[dict[int, float], dict[tuple[int, int], float]]:
        """Efforts of nodes, and the waves that leave the ends of lines, before the start."""
        scene, before = self.scene, np.array([-1e-9])
        nodes = sorted({n for line in scene.lines for n in line[:2]})
        behind = {n for n in nodes if scene.joined and n >= scene.joined[1]}
        parts = [[n for n in nodes if n not in behind], sorted(behind)][: 2 if behind else 1]
        totals = [lambda u, part=part: sum(self._out(n, u, before) for n in part) for part in parts]
        found = solved(totals, self._link(before))
        u = {n: float(each[0]) for part, each in zip(parts, found, strict=True) for n in part}
        left = {}
        through = self._link(before)(found[0] - found[-1])[0] if behind else 0.0
        for k, (a, b, z0, _) in enumerate(scene.lines):
            y = self._beyond(b, behind, through, u, before) if b in behind or a not in behind else 0.0
            left[k, 0], left[k, 1] = u[a] + z0 * y, u[b] - z0 * y
        return u, left

    def _beyond(self, b: int, behind: set[int], through: float, u: dict[int, float], before: NDArray) -> float:
        """Flow into all that hangs on a node, away from node 0."""
        scene, total = self.scene, 0.0
        hanging, pending = [], [b]
        while pending:
            n = pending.pop()
            hanging.append(n)
            pending += [line[1] for line in scene.lines if line[0] == n]
        for n in hanging:
            total += float(self._out(n, np.array([u[n]]), before)[0])
            if scene.joined and n == scene.joined[0]:
                total += float(through)
        return total


def solved(balances: list[Callable[[NDArray], NDArray]], link: Callable[[NDArray], NDArray]) -> list[NDArray]:
    """Efforts of one node, or of two that a link joins, at which no flow is left over."""
    size = 1e3
    if len(balances) == 1:
        return [halved(balances[0], size)]

    def second(u: NDArray) -> NDArray:
        return halved(lambda v: balances[1](v) - link(u - v), size, u, INNER)

    first = halved(lambda u: balances[0](u) + link(u - second(u)), size)
    return [first, second(first)]


def halved(rising: Callable[[NDArray], NDArray], size: float, like: NDArray | None = None, times: int = HALVINGS):
    """Root of a rising function, elementwise."""
    shape = np.shape(rising(np.zeros(1) if like is None else np.zeros_like(like)))
    low, high = np.full(shape, -10.0), np.full(shape, 10.0)
    while size > 10 and ((rising(low) > 0).any() or (rising(high) < 0).any()):
        low, high, size = low * 10, high * 10, size / 10
    for _ in range(times):
        middle = (low + high) / 2
        above = rising(middle) > 0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return (low + high) / 2


def _instant(rng: np.random.Generator, shared: list[float]) -> float:
    return float(shared[0] if rng.random() < 0.5 else rng.uniform(0.1, 3.0))


def _moving(rng: np.random.Generator, medium: str, instant: float, link: bool) -> Element:
    """A valve or switch, or an orifice that is opened or shut."""
    before, after = 10 ** rng.uniform(-1, 1.5, 2)
    kind = "valve" if medium == "hydraulic" else "switch"
    table = {"kind": kind, "before": float(before), "after": float(after), "time": instant}
    if medium == "hydraulic" and rng.random() < 0.35:
        size, a, b = float(10 ** rng.uniform(-1, 0.5)), *rng.choice([0.0, 0.3, 1.0], 2, replace=False)
        opening = {"shape": "step", "from": float(a), "to": float(b), "at": instant}
        table = {"kind": "orifice", "flow": size, "pressure_drop": 1.0, "opening": opening}
        return Element(table, lambda e, t: size * np.where(t <= instant, a, b) * np.sign(e) * np.sqrt(np.abs(e)))
    return Element(table, lambda e, t: e / np.where(t <= instant, before, after))


def _kinking(rng: np.random.Generator, medium: str, link: bool) -> Element:
    """A law that kinks."""
    size, at, band = float(10 ** rng.uniform(-1, 0.5)), float(rng.uniform(0.1, 1.5)), float(rng.uniform(0.1, 0.5))
    if medium == "electrical":
        if rng.random() < 0.3:
            table = {"kind": "diode", "saturation": 1e-6, "temperature": 1000.0}
            thermal = 1000.0 * 1.380649e-23 / 1.602176634e-19
            return Element(table, lambda e, t: 1e-6 * np.expm1(np.minimum(e / thermal, 300.0)))
        steep = float(10 ** rng.uniform(-1, 1))
        table = {"kind": "table", "points": [[-1, 0], [at, 0], [at + 1, steep]]}
        return Element(table, lambda e, t: steep * np.maximum(e - at, 0.0))
    back = 0.0 if link else float(rng.choice([0.0, rng.uniform(0.2, 1.5)]))
    rated = {"flow": size, "pressure_drop": 1.0} | ({"back_pressure": back} if back else {})
    made = [
        ({"kind": "orifice"} | rated, lambda e, t: size * np.sign(e - back) * np.sqrt(np.abs(e - back))),
        ({"kind": "check valve"} | rated, lambda e, t: size * np.sqrt(np.maximum(e - back, 0))),
        (
            {"kind": "relief valve", "set_pressure": at, "band": band, "flow": size, "pressure_drop": 1.0},
            lambda e, t: size * np.clip((e - at) / band, 0, 1) * np.sqrt(np.maximum(e, 0)),
        ),
        (
            {"kind": "table", "points": [[-1, -size], [0, 0], [at, 0], [at + 1, size]]},
            lambda e, t: np.where(e < 0, size * e, size * np.maximum(e - at, 0)),
        ),
    ]
    if not link:
        made += [
            ({"kind": "leak", "flow": size, "pressure": 1.0}, lambda e, t: size * np.sqrt(np.maximum(e, 0))),
            (
                {"kind": "demand", "flow": size, "required_pressure": at},
                lambda e, t: size * np.sqrt(np.clip(e / at, 0, 1)),
            ),
        ]
    return Element(*made[int(rng.integers(len(made)))])


def random_events(seed: int) -> EventScene:
    """One to three lines; one or two things that move beside one or two laws, at one node or at neighbouring ones."""
    rng = np.random.default_rng(seed)
    medium = "hydraulic" if rng.random() < 0.7 else "electrical"
    count = int(rng.integers(1, 4))
    delays = np.ones(count) if rng.random() < 0.4 else rng.uniform(0.6, 1.4, count)
    shared = [float(rng.choice(INSTANTS)) if rng.random() < 0.6 else float(rng.uniform(0.1, 2.0))]
    linked = count > 1 and rng.random() < 0.5
    nodes, far = list(range(count + 1)), count
    lines = [(k, k + 1, float(10 ** rng.uniform(-0.5, 0.5)), float(delays[k])) for k in range(count)]
    joined = None
    if linked:  # the last line begins behind a link
        joined = (count - 1, count)
        lines[-1] = (count, count + 1, *lines[-1][2:])
        nodes, far = list(range(count + 2)), count - 1
    at: dict[int, list[Element]] = {}
    links: list[Element] = []
    moving = [_moving for _ in range(int(rng.integers(1, 3)))]
    kinking = [_kinking for _ in range(int(rng.integers(1, 3)))]
    for make in (*moving, *kinking):
        link = linked and rng.random() < 0.5
        given = (_instant(rng, shared),) if make is _moving else ()
        element = make(rng, medium, *given, link)
        if link:
            links.append(element)
        else:
            neighbour = int(rng.choice(nodes[1:])) if rng.random() < 0.3 else far
            at.setdefault(neighbour, []).append(element)
    if linked:  # or nothing says what the effort behind a check valve is
        behind = float(10 ** rng.uniform(0, 1.5))
        bleed = Element({"kind": "resistor", "resistance": behind}, lambda e, t: e / behind)
        at.setdefault(far + 2, []).append(bleed)
    if linked and not links:
        links.append(_moving(rng, medium, _instant(rng, shared), True))
    to = float(rng.uniform(0.5, 3))
    if rng.random() < 0.4:
        instant, begin = _instant(rng, shared), float(rng.uniform(0, 2))
        value = {"shape": "step", "from": begin, "to": to, "at": instant}
        source = value, lambda u, t: np.where(t <= instant, begin, to)
    else:
        source = to, lambda u, t: np.full_like(t, to)
    return EventScene(medium, lines, (source[0], float(10 ** rng.uniform(-1, 0.5)), source[1]), at, joined, links)
