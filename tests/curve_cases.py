"""Random scenes with solutions from outside the solver, and how far a run to a tolerance is from them anywhere.

Linear lossless scenes have `tline.study.reference` (ball arithmetic along rays), lossy lines its inverse Laplace
transform. A law at the end of one line is a recursion by hand: what arrives left the other end a delay before.
"""

import warnings
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import wrightomega

from tline.cli.report import summary
from tline.scene.scene import Scene
from tline.solver.result.dense_output import curve
from tline.solver.result.result import ProbeResult
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.study.reference.exact import Solution
from tline.study.reference.lossy import LossySolution

BOLTZMANN = 1.380649e-23 / 1.602176634e-19  # V/K
INSTANTS, FEW = 400, 40  # at which a curve is looked at, and of a lossy line
BESIDE = 1e-7  # of the run, from a front: a reference and a run may differ about its instant by roundings
SIDE = 1e-14  # of the run, by which a reference is moved to either side of a front
PLATEAU = 1e-3  # of the run, around the instant of a printed extreme, where it is sought
FACTOR = 3.0

Reference = Callable[[str, NDArray], tuple[NDArray, NDArray]]


class Case(NamedTuple):
    """A scene that starts at rest, and its effort and flow at a probe."""

    scene: Scene
    exact: Reference
    instants: int = INSTANTS


def _linear(scene: Scene, kind: Callable[..., Any] = Solution, instants: int = INSTANTS) -> Case:
    longer = scene.with_changes(t_end=1.1 * scene.t_end)  # the last slab may end later

    def exact(probe: str, t: NDArray) -> tuple[NDArray, NDArray]:
        found = kind(longer, probe).at(np.maximum(t, 0.0).tolist(), 14)
        return np.array(found.u, float), np.array(found.y, float)

    return Case(scene, exact, instants)


def _recursion(scene: Scene, law: Callable[[NDArray], NDArray]) -> Case:
    """One line from a source to a law, which gives the effort at its end from the wave that arrives."""
    line, source = scene.lines["l"].parameters, scene.sources["s"]
    z0, delay, behind = float(line.z0), float(line.delay or 0), float(source.resistance or 0)

    def sent(t: NDArray) -> NDArray:
        if (t <= 0).all():
            return np.zeros_like(t)
        back = returned(t - delay)
        u = (source.value.value(t, t) * z0 + back * behind) / (z0 + behind)
        return np.where(t <= 0, 0.0, 2 * u - back)

    def returned(t: NDArray) -> NDArray:
        if (t <= 0).all():
            return np.zeros_like(t)
        w = sent(t - delay)
        return np.where(t <= 0, 0.0, 2 * law(w) - w)

    def exact(probe: str, t: NDArray) -> tuple[NDArray, NDArray]:
        x = {"near": 0.0, "mid": 0.3, "far": 1.0}[probe] * delay
        a, b = sent(t - x), returned(t - (delay - x))
        return (a + b) / 2, (a - b) / (2 * z0)

    return Case(scene, exact)


def _size(rng: np.random.Generator, decades: float = 0.5) -> float:
    return float(10 ** rng.uniform(-decades, decades))


def _begin(rng: np.random.Generator) -> float:
    """An instant: a round one, or any."""
    return float(rng.choice([0.0, 0.25, rng.uniform(0, 1)]))


def _waveform(rng: np.random.Generator, *kinds: str) -> dict[str, Any]:
    to, at = float(rng.uniform(0.5, 3)), _begin(rng)
    return {
        "step": {"shape": "step", "to": to, "at": at},
        "ramp": {"shape": "ramp", "to": to, "at": at, "duration": float(rng.uniform(0.1, 1))},
        "short ramp": {"shape": "ramp", "to": to, "at": at, "duration": 1.003e-4},
        "sine": {"shape": "sine", "amplitude": to, "frequency": float(rng.uniform(0.1, 0.6)), "at": at},
        "pulse": {"shape": "pulses", "high": to, "at": at, "width": float(rng.uniform(0.01, 0.2)), "rise": 0.02,
                  "fall": 0.02},
        "train": {"shape": "pulses", "high": to, "at": at, "width": 0.3, "rise": 0.1, "fall": 0.05,
                  "period": float(rng.uniform(0.5, 1.5))},
    }[str(rng.choice(kinds))]  # fmt: skip


def _scene(rng: np.random.Generator, value: dict[str, Any], load: dict[str, Any], **more: Any) -> Scene:
    """One line between a source and a load."""
    z0 = _size(rng) if "z0" not in more else more.pop("z0")
    delay = more.pop("delay", float(rng.choice([1.0, rng.uniform(0.5, 1.5)])))
    table = {
        "medium": "electrical",
        "t_end": 6.0,
        "lines": {"l": {"nodes": ["a", "b"], "z0": z0, "delay": delay}},
        "sources": {"s": {"at": "a", "kind": "voltage", "value": value, "resistance": _size(rng)}},
        "loads": {"x": load | {"at": "b"}},
        "probes": {"near": {"at": "a"}, "mid": {"line": "l", "position": "30 %"}, "far": {"at": "b"}},
    }
    return Scene(**(table | more))


def _network(rng: np.random.Generator, delays: list[float], load: dict[str, Any], value: dict[str, Any]) -> Scene:
    """A chain of lines."""
    nodes = [f"n{k}" for k in range(len(delays) + 1)]
    return Scene(
        medium="electrical",
        t_end=6.0,
        lines={
            f"l{k}": {"nodes": nodes[k : k + 2], "z0": _size(rng), "delay": delay} for k, delay in enumerate(delays)
        },
        sources={"s": {"at": "n0", "kind": "voltage", "value": value, "resistance": _size(rng)}},
        loads={"x": load | {"at": nodes[-1]}},
        probes={"near": {"at": "n0"}, "far": {"at": nodes[-1]}},
    )


def rc(rng: np.random.Generator) -> Case:
    load = {"kind": "parallel", "resistance": _size(rng), "capacitance": float(10 ** rng.uniform(-2, 0))}
    return _linear(_scene(rng, _waveform(rng, "step", "ramp", "sine", "pulse"), load))


def rl(rng: np.random.Generator) -> Case:
    load = {"kind": "series", "resistance": _size(rng), "inductance": float(10 ** rng.uniform(-2, 0))}
    return _linear(_scene(rng, _waveform(rng, "step", "ramp", "short ramp"), load))


def tank(rng: np.random.Generator) -> Case:
    """A resonance of a quality of some 30 to 300."""
    w, q = float(rng.uniform(2, 12)), float(10 ** rng.uniform(1.5, 2.5))
    load = {"kind": "parallel", "resistance": q, "inductance": 1 / w, "capacitance": 1 / w}
    return _linear(_scene(rng, _waveform(rng, "step", "ramp", "sine"), load, z0=_size(rng) * 3))


def trains(rng: np.random.Generator) -> Case:
    load = {"kind": "parallel", "resistance": _size(rng), "capacitance": 0.1 * _size(rng)}
    return _linear(_scene(rng, _waveform(rng, "train"), load))


def ring(rng: np.random.Generator) -> Case:
    delays = [1.0, float(rng.uniform(0.4, 1.2)), float(rng.uniform(0.4, 1.2))]
    corners = ["n0", "n1", "n2", "n0"]
    return _linear(
        Scene(
            medium="electrical",
            t_end=4.0,
            lines={f"l{k}": {"nodes": corners[k : k + 2], "z0": _size(rng), "delay": d} for k, d in enumerate(delays)},
            sources={
                "s": {"at": "n0", "kind": "voltage", "value": _waveform(rng, "step", "ramp", "sine", "pulse"),
                      "resistance": _size(rng)}
            },
            loads={"x": {"at": "n1", "kind": "parallel", "resistance": _size(rng), "capacitance": 0.2 * _size(rng)}},
            probes={"near": {"at": "n0", "line": "l0"}, "far": {"at": "n1", "line": "l0"}},
        )
    )  # fmt: skip


def ends(rng: np.random.Generator) -> Case:
    """Ends that are nearly shorts, or nearly open."""
    load = {"kind": "resistor", "resistance": float(10.0 ** rng.choice([-6, -3, 3, 6]))}
    return _linear(_scene(rng, _waveform(rng, "ramp", "sine", "pulse", "short ramp"), load))


def switch(rng: np.random.Generator) -> Case:
    """A switch about as near to an arrival as instants can be."""
    begin = _begin(rng)
    delay = float(rng.choice([1.0, 0.7310]))
    at = begin + delay * float(rng.choice([1.0, 3.0])) + float(rng.choice([-1e-4, 1e-7, 1e-3]))
    load = {"kind": "switch", "before": _size(rng), "after": 50.0, "time": at}
    value = _waveform(rng, "step", "ramp") | {"at": begin}
    return _linear(_scene(rng, value, load, delay=delay))


def ratio(rng: np.random.Generator) -> Case:
    """Delays of 1 to 137."""
    short = 1.0 / 137 if rng.random() < 0.5 else float(rng.uniform(0.02, 0.1))
    load = {"kind": "parallel", "resistance": _size(rng), "capacitance": 0.3 * _size(rng)}
    return _linear(_network(rng, [1.0, short], load, _waveform(rng, "ramp", "sine", "step")))


def chain(rng: np.random.Generator) -> Case:
    load = {"kind": "series", "resistance": _size(rng), "inductance": 0.3 * _size(rng)}
    delays = [float(d) for d in rng.uniform(0.4, 1.3, 3)]
    return _linear(_network(rng, delays, load, _waveform(rng, "ramp", "sine", "step", "pulse")))


def diode(rng: np.random.Generator, *shapes: str) -> Case:
    saturation, temperature = float(10 ** rng.uniform(-6, -2)), float(10 ** rng.uniform(2.2, 3.3))
    load = {"kind": "diode", "saturation": saturation, "temperature": temperature}
    scene, volts = (
        _scene(rng, _waveform(rng, *(shapes or ("sine", "pulse", "ramp", "step"))), load),
        BOLTZMANN * temperature,
    )
    drop = float(scene.lines["l"].parameters.z0) * saturation

    def law(w: NDArray) -> NDArray:
        return w + drop - volts * wrightomega(np.log(drop / volts) + (w + drop) / volts)

    return _recursion(scene, law)


def orifice(rng: np.random.Generator, *shapes: str) -> Case:
    flow = _size(rng)
    load = {"kind": "orifice", "flow": flow, "pressure_drop": 1.0}
    value = _waveform(rng, *(shapes or ("step", "ramp", "sine")))
    source = {"s": {"at": "a", "kind": "pressure", "value": value, "resistance": _size(rng)}}
    scene = _scene(rng, value, load, medium="hydraulic", sources=source)
    z0 = float(scene.lines["l"].parameters.z0)

    def law(w: NDArray) -> NDArray:
        through = 2 * np.abs(w) / (z0 + np.sqrt(z0**2 + 4 * np.abs(w) / flow**2))
        return w - z0 * np.copysign(through, w)

    return _recursion(scene, law)


def table(rng: np.random.Generator) -> Case:
    u, i = np.array([-1.0, 0.0, 0.5, 1.0]), np.array([-2.0, 0.0, 0.5, 2.0])
    load = {"kind": "table", "points": np.stack([u, i], axis=1).tolist()}
    scene = _scene(rng, _waveform(rng, "ramp", "sine"), load)
    z0 = float(scene.lines["l"].parameters.z0)
    knots = np.concatenate([[u[0] - 100, *u, u[-1] + 100]])
    flows = np.concatenate([[i[0] - 200, *i, i[-1] + 300]])
    return _recursion(scene, lambda w: np.interp(w, knots + z0 * flows, knots))


def cable(rng: np.random.Generator) -> Case:
    """A lossy line, from short to long, with a step or a ramp at any instant."""
    more = {"length": 1.0, "resistance": float(10 ** rng.uniform(-1, 0.7))}
    line = {"l": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0, **more}}
    probes = {"near": {"at": "a"}, "far": {"at": "b"}}
    scene = _scene(
        rng, _waveform(rng, "step", "ramp"), {"kind": "resistor", "resistance": _size(rng)}, lines=line, probes=probes
    )
    return _linear(scene, LossySolution, FEW)


def zielke(rng: np.random.Generator) -> Case:
    """Laminar friction of any speed."""
    line = {"nodes": ["a", "b"], "length": "36.09 m", "radius": "12.7 mm", "density": 878, "wave_speed": 1324}
    scene = Scene(
        medium="hydraulic",
        t_end=0.1,
        lines={"l": line | {"friction": {"kind": "zielke", "viscosity": "0.03 Pa s"}}},
        sources={"s": {"at": "a", "kind": "pressure", "resistance": 0,
                       "value": {"shape": "ramp", "to": 1e5, "duration": float(rng.uniform(0.002, 0.02))}}},
        probes={"near": {"at": "a"}, "far": {"at": "b"}},
    )  # fmt: skip
    return _linear(scene, LossySolution, FEW)


LOSSLESS: Mapping[str, Callable[[np.random.Generator], Case]] = {
    each.__name__: each
    for each in (rc, rl, tank, trains, ring, ends, switch, ratio, chain, diode, orifice, table)
}  # fmt: skip
LOSSY = {each.__name__: each for each in (cable, zielke)}


class Found(NamedTuple):
    """Errors of a run, by the worst quantity of the worst probe."""

    met: bool
    over: float  # largest error over the tolerance times the amplitude
    beyond: float  # the same over the error told
    extreme: float  # by how much a printed extreme is off, over its own ±
    where: str

    @property
    def outside(self) -> bool:
        """Whether more is wrong than was told."""
        return self.met and max(self.over, self.beyond, self.extreme) > FACTOR


def found(case: Case, tol: float, seed: int = 0) -> Found:
    """Run a case to a tolerance and compare it with its solution at random instants, and the extremes printed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        result = simulate(case.scene, tol=tol)
        told = summary(result, result.accuracy)["probes"]
    assert result.accuracy is not None
    worst = Found(result.accuracy.met, 0.0, 0.0, 0.0, "")
    end = float(result.t[-1])
    t = np.sort(np.random.default_rng(seed).uniform(0, end, case.instants))
    for name, probe in result.probes.items():
        fronts = np.concatenate([wave.breakpoints() for wave in probe.waves])
        here = t[np.abs(t[:, None] - fronts).min(axis=1, initial=np.inf) > BESIDE * end]
        seen, exact = probe.at(here), case.exact(name, here)
        for letter, true, (word, printed) in zip("uy", exact, told[name].items(), strict=True):
            amplitude = float(np.abs(true).max())
            if amplitude < 1e-9 * float(np.abs(exact[0]).max() + probe.record.z0 * np.abs(exact[1]).max()):
                continue
            error = np.abs(getattr(seen, letter) - true)
            margin = printed["error_inside_slabs"] + 1e-13 * amplitude
            k = int(error.argmax())
            off = max(true.max() - printed["maximum"], printed["minimum"] - true.min())
            off = max(
                off, *(_nearest(case, probe, letter, printed, which, end, margin) for which in ("minimum", "maximum"))
            )
            measures = error[k] / (tol * amplitude), error[k] / margin, off / margin
            if max(measures) > max(worst[1:4]):
                worst = worst._replace(where=f"{name} {word} at {here[k]:.6g} ± {margin / amplitude:.1g}")
            worst = worst._replace(
                over=max(worst.over, measures[0]),
                beyond=max(worst.beyond, measures[1]),
                extreme=max(worst.extreme, measures[2]),
            )
    return worst


def _nearest(
    case: Case, probe: ProbeResult, letter: str, printed: dict[str, float], which: str, end: float, enough: float
) -> float:
    """How far the curve is from a printed extreme, on either side of a front: where it is said to be first reached to a
    billionth of the range, or about where the run's own curve is highest; sought until it is as little as is enough.
    """
    sign, value, drawn = (1 if which == "maximum" else -1), printed[which], curve(probe)
    highest, width = float(drawn.t[(sign * getattr(drawn, letter)).argmax()]), PLATEAU * end
    t = np.array([[printed[f"{which}_time"]], [highest]]) + SIDE * end * np.array([-1, 0, 1])
    off = float(np.abs(case.exact(probe.name, np.clip(t.ravel(), 0, end))["uy".index(letter)] - value).min())
    while case.instants == INSTANTS and width > SIDE * end and off > enough:
        t = np.clip(highest + width * np.linspace(-1, 1, 41), 0, end)
        seen = sign * case.exact(probe.name, t)["uy".index(letter)]
        highest, width = float(t[seen.argmax()]), width / 10
        off = min(off, abs(sign * float(seen.max()) - value))
    return off
