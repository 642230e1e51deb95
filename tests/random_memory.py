"""Random trees and bundles of lines that remember, with laws at their nodes, and the same in s and at BDF2's steps."""

import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from memory_by_bdf2 import efforts_at_nodes
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from tline.scene.scene import Scene
from tline.solver.convolution.rays import arrivals
from tline.solver.description.description import describe
from tline.solver.simulate import UnresolvedWarning, simulate

KINDS = "tree", "laws", "bundle", "laws at a bundle"
STEPS, STEPS_BESIDE_LAWS, WIDE = 2**14, 4000, 41
TRUE, CLOSER = 3, 30  # times as wrong as told, from which on a run to a tolerance so much closer is asked, too
BESIDE = 5e-3  # s, and steps, from a jump, where nothing is asked
BOLTZMANN_OVER_CHARGE = 1.380649e-23 / 1.602176634e-19
Law = tuple[tuple[str | None, str | None], Callable[[float, float], tuple[float, float]]]


class Case(NamedTuple):
    """A scene, and what a twin needs: lines, loads that are linear, laws, and sources by node."""

    scene: Scene
    lines: list[dict[str, Any]]
    loads: list[dict[str, Any]]
    laws: list[Law]
    sources: list[tuple[str, float, Callable[[NDArray], NDArray], bool]]


class Judged(NamedTuple):
    """How a run kept what it told."""

    met: bool
    over: float  # largest excess of the error over what is known, over the error told
    told: float  # the error told there, of the amplitude
    error: float
    knows: float  # what the reference knows there, at the median of instants
    where: str


def random_memory(seed: int) -> Case:
    """One to six lines of delays 0.1 to 3 s, at least one of which remembers, of a kind in KINDS."""
    rng = np.random.default_rng([34, seed])
    kind = KINDS[seed % 4]
    lines = _bundle(rng) if "bundle" in kind else _tree(rng)
    nodes = list(dict.fromkeys(node for line in lines for node in (*line["nodes1"], *line["nodes2"])))
    leaves = [node for node in nodes[1:] if sum(node in (*x["nodes1"], *x["nodes2"]) for x in lines) == 1]
    longest = max(line["delay"] for line in lines)
    t_end = float(rng.uniform(3, 8) * longest)
    loads: dict[str, Any] = {}
    laws: list[Law] = []
    for node in leaves:
        at_law = "laws" in kind and (rng.random() < 0.6 or (node == leaves[-1] and not laws))
        if at_law:
            table, law = _law(rng, t_end)
            loads[f"x {node}"] = table | {"at": node}
            laws.append(((node, None), law))
        if not at_law or rng.random() < 0.7:
            loads[f"r {node}"] = _linear(rng) | {"at": node}
    sources, functions = {}, []
    for node in (nodes[0], *([str(rng.choice(nodes))] if rng.random() < 0.3 else [])):
        flows = bool(sources)
        value, function = _waveform(rng, longest)
        resistance = _size(rng)
        sources[f"s{len(sources)}"] = (
            {"at": node, "kind": "current", "value": value} if flows
            else {"at": node, "kind": "voltage", "value": value, "resistance": resistance}
        )  # fmt: skip
        functions.append((node, resistance, function, flows))
    probed = dict.fromkeys([nodes[0], leaves[-1], str(rng.choice(nodes))])
    scene = Scene(
        medium="electrical",
        t_end=t_end,
        lines={f"l{k}": _of_scene(line) for k, line in enumerate(lines)},
        sources=sources,
        loads=loads,
        probes={node: {"at": node} for node in probed},
    )
    return Case(scene, lines, list(loads.values()), laws, functions)


def judge(case: Case, tol: float) -> Judged:
    """Run a case to a tolerance and compare its probes with BDF2 at random instants, as far as two grids agree."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        result = simulate(case.scene, tol=tol)
    accuracy = result.accuracy
    names, t_end = list(result.probes), float(case.scene.t_end)
    n = STEPS_BESIDE_LAWS if case.laws else STEPS
    t, rough = _by_bdf2(case, names, t_end, n)
    fine = _by_bdf2(case, names, t_end, 2 * n)[1][1::2]
    better = fine + (fine - rough) / 3
    jumps = arrivals(describe(case.scene))
    worst = Judged(accuracy.met, 0.0, 0.0, 0.0, 0.0, "")
    for name, exact, one, other in zip(names, better.T, rough.T, fine.T, strict=True):
        amplitude, knows = np.abs(exact).max(), np.abs(one - other)
        wide = maximum_filter1d(knows, WIDE)  # beside fronts two grids agree by accident
        off = np.maximum(np.abs(result.probes[name].at(t).u - exact) - 2 * wide, 0.0)
        off[_beside(jumps[name], t)] = 0.0
        told = max(accuracy.inside[name].u if name in accuracy.inside else tol, 1e-11)
        k = int(off.argmax())
        if off[k] / amplitude / told > worst.over:
            at = f"{name} at {t[k]:.5g} s"
            worst = Judged(
                accuracy.met, off[k] / amplitude / told, told, off[k] / amplitude,
                float(np.median(knows)) / amplitude, at,
            )  # fmt: skip
    if worst.over > TRUE and worst.met:  # two grids may err alike
        name = worst.where.split()[0]
        finer, far = simulate(case.scene, tol=tol / CLOSER).probes[name].at(t).u, ~_beside(jumps[name], t)
        off = np.abs(result.probes[name].at(t).u - finer)[far].max() / np.abs(finer).max()
        worst = worst._replace(over=min(worst.over, off / worst.told), error=min(worst.error, off))
    return worst


def _beside(jumps: NDArray, t: NDArray) -> NDArray:
    """Whether instants are just beside a jump."""
    edges = np.concatenate([[-np.inf], jumps, [np.inf]])
    k = np.searchsorted(jumps, t)
    return np.minimum(t - edges[k], edges[k + 1] - t) < max(BESIDE, WIDE * (t[1] - t[0]))


def _by_bdf2(case: Case, names: list[str], t_end: float, n: int) -> tuple[NDArray, NDArray]:
    numbers: dict[str | None, int] = {}
    for line in case.lines:
        for node in (*line["nodes1"], *line["nodes2"]):
            numbers.setdefault(node, len(numbers))

    def rest(s: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        Y = np.zeros((len(s), len(numbers), len(numbers)), complex)
        for line in case.lines:
            one, other = ([numbers[node] for node in line[key]] for key in ("nodes1", "nodes2"))
            own, across = admittances(line, s)
            for here, there in ((one, other), (other, one)):
                Y[:, np.array(here)[:, None], here] += own
                Y[:, np.array(here)[:, None], there] += across
        for load in case.loads:
            k = numbers[load["at"]]
            if load["kind"] in ("parallel", "resistor"):
                Y[:, k, k] += 1 / load["resistance"]
            if load["kind"] in ("parallel", "capacitor"):
                Y[:, k, k] += s * load["capacitance"]
            if load["kind"] == "series":
                Y[:, k, k] += 1 / (load["resistance"] + s * load["inductance"])
        for node, resistance, _, flows in case.sources:
            if not flows:
                Y[:, numbers[node], numbers[node]] += 1 / resistance
        Z = np.linalg.inv(Y)
        at = [numbers[node] for (node, _), _ in case.laws]
        seen = [numbers[node] for node in names]
        into = np.zeros((len(numbers), len(case.sources)))
        for k, (node, resistance, _, flows) in enumerate(case.sources):
            into[numbers[node], k] = 1.0 if flows else 1 / resistance
        driven = Z @ into
        return Z[:, at][:, :, at], driven[:, at], Z[:, seen][:, :, at], driven[:, seen]

    return efforts_at_nodes(rest, [f for *_, f, _ in case.sources], [law for _, law in case.laws], t_end, n)


def admittances(line: dict[str, Any], s: NDArray) -> tuple[NDArray, NDArray]:
    """Y11 and Y12 (n, k, k) of coupled conductors of length 1, by eigenvectors of Z Y."""
    R, K, G, L, C = (np.atleast_2d(line[key]) for key in ("R", "K", "G", "L", "C"))
    s = s[:, None, None]
    if len(R) == 1:
        Z, Y = s * L + np.sqrt(R**2 + K**2 * s), G + s * C
        if line["tangent"]:
            Y = G + s * _dielectric(line, s)
    else:
        Z, Y = s * L + R + K * np.sqrt(s), G + s * C
    squares, vectors = np.linalg.eig(Z @ Y)
    gamma = np.sqrt(squares)
    passed = np.exp(-gamma)
    own, other = ((vectors * (gamma * share)[:, None, :]) @ np.linalg.inv(vectors) for share in (
        (1 + passed**2) / (1 - passed**2), -2 * passed / (1 - passed**2)
    ))  # fmt: skip
    return np.linalg.solve(Z, own), np.linalg.solve(Z, other)


def _dielectric(line: dict[str, Any], s: NDArray) -> NDArray:
    """C(s) of a loss tangent at 1 Hz between 1 mHz and 1 kHz, whose value at high frequencies is C."""
    low, high, at = 2e-3 * np.pi, 2e3 * np.pi, 2j * np.pi
    shape = np.log((high + at) / (low + at))
    # C_inf + K·log: tan δ = -Im/Re at `at`
    K = line["tangent"] * line["C"] / (-shape.imag - line["tangent"] * shape.real)
    return line["C"] + K * np.log((high + s) / (low + s))


def _size(rng: np.random.Generator) -> float:
    return float(10 ** rng.uniform(-0.5, 0.5))


def _delays(rng: np.random.Generator, n: int) -> NDArray:
    return (rng.choice([0.5, 1.0, 1.5], n), rng.uniform(0.5, 1.5, n), 10 ** rng.uniform(-1, 0.477, n))[
        int(rng.integers(3))
    ]


def _tree(rng: np.random.Generator) -> list[dict[str, Any]]:
    n = int(rng.integers(1, 7))
    pairs = [(0, 1), *((int(rng.integers(k)), k) for k in range(2, n + 1))]
    lines = []
    for k, ((a, b), delay) in enumerate(zip(pairs, _delays(rng, n), strict=True)):
        z0, what = _size(rng), rng.choice(["none", "R", "RG", "skin", "R skin", "tangent", "all"])
        what = str(rng.choice(["skin", "R skin", "tangent"])) if k == 0 else str(what)
        lost = float(10 ** rng.uniform(-2, 0)) * z0 * (1 + delay) / 2
        lines.append({
            "nodes1": [f"n{a}"], "nodes2": [f"n{b}"], "delay": float(delay), "z0": z0,
            "L": z0 * delay, "C": delay / z0,
            "R": lost if "R" in what or what == "all" else 0.0, "G": 0.3 * lost / z0**2 if what == "RG" else 0.0,
            "K": 0.3 * lost if "skin" in what or what == "all" else 0.0,
            "tangent": float(10 ** rng.uniform(-3, -1.3)) if what in ("tangent", "all") else 0.0,
        })  # fmt: skip
    return lines


def _bundle(rng: np.random.Generator) -> list[dict[str, Any]]:
    n = int(rng.integers(2, 5))
    speeds = rng.uniform(0.5, 1.5) * (1 + 0.1 * rng.random((n, n)))
    C = np.diag(rng.uniform(1, 2, n) + 0.5) - 0.2 * (np.eye(n, k=1) + np.eye(n, k=-1))
    root = np.linalg.cholesky(C)
    mix = np.eye(n) + 0.15 * (speeds - speeds.T) + 0.05 * np.diag(rng.random(n))
    L = np.linalg.inv(root).T @ (mix @ mix.T) @ np.linalg.inv(root) * rng.uniform(0.3, 2)
    L = (L + L.T) / 2
    lost = float(10 ** rng.uniform(-1.5, 0))
    K = lost * (0.5 * np.diag(rng.uniform(0.3, 1, n)) + 0.1 * np.ones((n, n)))
    kind = int(rng.integers(3))
    R = lost * (np.diag(rng.uniform(0.3, 1, n)) + 0.1) * (kind > 0)
    G = 0.2 * lost * (np.diag(rng.uniform(0.3, 1, n)) + 0.05 * (n * np.eye(n) - np.ones((n, n)))) * (kind == 2)
    delay = float(np.sqrt(np.linalg.eigvals(L @ C).real.max()))
    near, far = [f"n{k}" for k in range(n)], [f"f{k}" for k in range(n)]
    bundle = {"nodes1": near, "nodes2": far, "delay": delay, "L": L, "C": C, "R": R, "G": G, "K": K, "tangent": 0.0}
    lines = [bundle]
    for k in range(int(rng.integers(0, 3))):
        delay, z0 = float(_delays(rng, 1)[0]), _size(rng)
        lines.append({
            "nodes1": [f"f{k}"], "nodes2": [f"g{k}"], "delay": delay, "z0": z0, "L": z0 * delay, "C": delay / z0,
            "R": 0.0, "G": 0.0, "K": 0.1 * z0 * float(rng.integers(2)), "tangent": 0.0,
        })  # fmt: skip
    return lines


def _of_scene(line: dict[str, Any]) -> dict[str, Any]:
    table: dict[str, Any]
    if len(line["nodes1"]) > 1:
        table = {"nodes1": line["nodes1"], "nodes2": line["nodes2"], "length": 1.0}
        table |= {"inductance": line["L"].tolist(), "capacitance": line["C"].tolist()}
        table |= {"skin": {"resistance": (np.sqrt(np.pi) * line["K"]).tolist(), "frequency": 1.0, "added": True}}
        table |= {"resistance": line["R"].tolist()} if line["R"].any() else {}
        return table | ({"conductance": line["G"].tolist()} if line["G"].any() else {})
    table = {"nodes": [*line["nodes1"], *line["nodes2"]], "length": 1.0, "z0": line["z0"], "delay": line["delay"]}
    table |= {"resistance": line["R"]} if line["R"] else {}
    table |= {"conductance": line["G"]} if line["G"] else {}
    table |= {"skin": {"resistance": float(np.sqrt(np.pi) * line["K"]), "frequency": 1.0}} if line["K"] else {}
    tangent = {"value": line["tangent"], "frequency": 1.0, "low": 1e-3, "high": 1e3}
    return table | ({"loss_tangent": tangent} if line["tangent"] else {})


def _linear(rng: np.random.Generator) -> dict[str, Any]:
    return [
        {"kind": "resistor", "resistance": _size(rng)},
        {"kind": "parallel", "resistance": _size(rng), "capacitance": 0.1 * _size(rng)},
        {"kind": "capacitor", "capacitance": 0.1 * _size(rng)},
        {"kind": "series", "resistance": _size(rng), "inductance": 0.1 * _size(rng)},
    ][int(rng.integers(4))]


def _law(rng: np.random.Generator, t_end: float) -> tuple[dict[str, Any], Callable]:
    which = int(rng.integers(4))
    if which == 0:
        thermal, reverse = float(10 ** rng.uniform(-1.5, -0.5)), bool(rng.integers(2))
        saturation, sign = 1e-3, -1.0 if reverse else 1.0

        def diode(v: float, t: float) -> tuple[float, float]:
            grown = saturation * np.exp(min(sign * v / thermal, 60.0))
            return sign * (grown - saturation), grown / thermal

        temperature = thermal / BOLTZMANN_OVER_CHARGE
        return {"kind": "diode", "saturation": saturation, "temperature": temperature, "reverse": reverse}, diode
    if which == 3:
        before, after = rng.permutation([_size(rng), 100.0]).tolist()
        time = float(rng.uniform(0, 0.5) * t_end)

        def switch(v: float, t: float) -> tuple[float, float]:
            r = after if t > time * (1 + 1e-12) else before
            return v / r, 1 / r

        return {"kind": "switch", "before": before, "after": after, "time": time}, switch
    points = np.array(
        [[[-1, -2], [0, 0], [0.5, 0.5], [1, 2]], [[-1.5, -8], [-1, -0.01], [1, 0.01], [1.5, 8]]][which - 1]
    )
    slopes = np.diff(points[:, 1]) / np.diff(points[:, 0])

    def tabled(v: float, t: float) -> tuple[float, float]:
        k = int(np.clip(np.searchsorted(points[:, 0], v) - 1, 0, len(slopes) - 1))
        return points[k, 1] + slopes[k] * (v - points[k, 0]), slopes[k]

    return {"kind": "table", "points": points.tolist()}, tabled


def _waveform(rng: np.random.Generator, longest: float) -> tuple[dict[str, Any], Callable[[NDArray], NDArray]]:
    to, at = float(rng.uniform(0.5, 3)), float(rng.choice([0.0, rng.uniform(0, 1)]))
    which = int(rng.integers(4))
    if which == 0:
        return {"shape": "step", "to": to, "at": at}, lambda t: to * (t > at)
    if which == 1:
        duration = float(10 ** rng.uniform(-1.5, 0.2))
        return (
            {"shape": "ramp", "to": to, "at": at, "duration": duration},
            lambda t: to * np.clip((t - at) / duration, 0, 1),
        )
    if which == 2:
        frequency = float(rng.uniform(0.1, 0.6))
        return (
            {"shape": "sine", "amplitude": to, "frequency": frequency},
            lambda t: to * np.sin(2 * np.pi * frequency * t),
        )
    bits = rng.integers(0, 2, 8)
    bit = float(rng.uniform(0.3, 1) * longest)
    edge = bit * float(rng.uniform(0.05, 0.3))
    points = [[0.0, 0.0]]
    for k, now in enumerate(bits.tolist()):
        points += [[at + k * bit + edge, to * now], [at + (k + 1) * bit, to * now]]
    points = points if at == 0 else [[0.0, 0.0], [at, 0.0], *points[1:]]
    x, y = np.array(points).T
    return {"shape": "piecewise linear", "points": points}, lambda t: np.interp(t, x, y)
