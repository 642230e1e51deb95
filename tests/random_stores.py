"""Random pipelines in which things with a state stand beside what moves, and what is right: runs fixed by hand.

A reservoir or a pump that trips feeds one or two pipes; a valve or an opening moves, at a shared instant or another,
beside a vessel, a tank, a cavity, a regulating valve, or the laws of `random_events`' kinds. A run to a tolerance
refines, cuts and compares; at a fixed order and slab none of that happens, and halved slabs tell how good that is.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline import Result, Scene, simulate

FIXED_ORDER, SLABS = 3, (96, 192, 768, 3072)  # slabs of ever finer references in the shortest delay
INSTANTS, FAINT, ROUNDED = 200, 1e-6, 1e-9
MOST, LEFT = 3.0, 3.0  # times what is told; times that a reference changes, by which it may be wrong
HEAD = 5e5  # Pa
STORES = "vessel", "tank", "cavity", "vapour cavity", "none"
BESIDE = "orifice", "leak", "demand", "relief valve", "check valve"


def _moving(rng: np.random.Generator, instant: float) -> dict[str, Any]:
    """A valve that shuts or opens at once or slowly, or a burst."""
    flow = float(rng.uniform(5e-3, 4e-2))
    if rng.random() < 0.3:
        before, after = (float(10 ** rng.uniform(7, 8.5)) for _ in range(2))
        return {"kind": "valve", "before": before, "after": after, "time": instant}
    start, end = [(1.0, 0.2), (1.0, 0.5), (0.3, 1.0), (0.0, 1.0)][int(rng.integers(4))]  # the last one is a burst
    shape = {"shape": "step", "from": start, "to": end, "at": instant}
    if rng.random() < 0.5:
        shape |= {"shape": "ramp", "duration": float(rng.uniform(0.1, 1.0))}
    return {"kind": "orifice", "flow": flow, "pressure_drop": HEAD, "opening": shape}


def _store(rng: np.random.Generator) -> dict[str, Any] | None:
    throttle = {"flow": 0.02, "pressure_drop": float(10 ** rng.uniform(3.5, 5))} if rng.random() < 0.7 else {}
    match STORES[int(rng.integers(len(STORES)))]:
        case "vessel":
            volume = float(10 ** rng.uniform(-2, 0))
            return {"kind": "air vessel", "gas_volume": volume, "gas_pressure": HEAD, **throttle}
        case "tank":
            return {"kind": "surge tank", "tank_area": float(10 ** rng.uniform(-0.5, 1)), **throttle}
        case "cavity":
            return {"kind": "cavity", "gas_volume": float(10 ** rng.uniform(-5, -3))}
        case "vapour cavity":
            return {"kind": "vapour cavity"}
    return None


def _beside(rng: np.random.Generator) -> dict[str, Any]:
    flow, at = float(rng.uniform(2e-3, 2e-2)), float(rng.uniform(0.5, 1.3)) * HEAD
    rated = {"flow": flow, "pressure_drop": HEAD}
    match BESIDE[int(rng.integers(len(BESIDE)))]:
        case "leak":
            return {"kind": "leak", "flow": flow, "pressure": HEAD}
        case "demand":
            return {"kind": "demand", "flow": flow, "required_pressure": at}
        case "relief valve":
            return {"kind": "relief valve", "set_pressure": at, "band": 0.2 * HEAD, **rated}
        case kind:
            return {"kind": kind, **rated, "back_pressure": float(rng.choice([0.0, 0.5])) * HEAD}


def _between(rng: np.random.Generator) -> dict[str, Any]:
    """What joins the two pipes."""
    if rng.random() < 0.5:
        return {"kind": "check valve", "flow": 0.03, "pressure_drop": 0.1 * HEAD}
    keeps = {"keeps": "downstream", "set_pressure": 0.6 * HEAD, "band": HEAD}
    if rng.random() < 0.3:
        keeps = {"keeps": "flow", "set_flow": float(rng.uniform(5e-3, 3e-2))}
    size = {"loss_coefficient": 3, "diameter": 0.2}
    return {"kind": "regulating valve", "time_constant": float(rng.uniform(0.5, 3)), **keeps, **size}


def random_stores(seed: int) -> Scene:
    """One or two pipes, what moves, a store, and perhaps a law beside them."""
    rng = np.random.default_rng(seed)
    delays = rng.choice([0.5, 1.0], 2) if rng.random() < 0.5 else rng.uniform(0.4, 1.2, 2)
    two, pump = rng.random() < 0.5, rng.random() < 0.3
    instant = float(rng.choice([0.5, 1.0])) if rng.random() < 0.6 else float(rng.uniform(0.2, 2))
    pipe = {"diameter": 0.2, "wave_speed": 1000, "density": 1000}
    lines = {"up": {"nodes": ["feed", "a"], "length": 1000 * float(delays[0]), **pipe}}
    links: dict[str, Any] = {}
    end = "a"
    if two:
        end, begin = "end", "a" if rng.random() < 0.4 else "b"
        lines["down"] = {"nodes": [begin, end], "length": 1000 * float(delays[1]), **pipe}
        if begin == "b":
            links["between"] = {"nodes": ["a", "b"], **_between(rng)}
    loads = {"lake": {"at": "feed", "kind": "reservoir", "pressure": HEAD}}
    if pump:
        trip = instant if rng.random() < 0.5 else float(rng.uniform(0.2, 2))
        loads["lake"] |= {"at": "sump", "pressure": 0.1 * HEAD}
        curve, turning = [[0, 1.2 * HEAD], [0.04, 0.8 * HEAD]], {"inertia": 1.5, "rated_speed": 150.0}
        links["pump"] = {"kind": "pump", "nodes": ["sump", "feed"], "curve": curve, "trip": trip, **turning}
        links["pump"] |= {"check_valve": True}
    places = ["a", end]
    loads["moving"] = {"at": end, **_moving(rng, instant)}
    if store := _store(rng):
        loads["store"] = {"at": places[int(rng.integers(2))], **store}
    if rng.random() < 0.6:
        loads["beside"] = {"at": places[int(rng.integers(2))], **_beside(rng)}
    probes = {
        f"{name}{e}": {"at": at, "line": name} for name, line in lines.items() for e, at in enumerate(line["nodes"])
    }
    return Scene(medium="hydraulic", t_end=4.0, start="steady", lines=lines, loads=loads, links=links, probes=probes)


def excess(result: Result) -> float:
    """Largest error of a run at any end over what it tells, or over its tolerance if that is less.

    References are refined while it seems to be more than three, and count as wrong as they change.
    """
    assert result.accuracy is not None
    scene, tol, most = result.scene, result.accuracy.tol or 0.0, 0.0
    shortest = min(line.parameters.delay or 0.0 for line in scene.single_lines.values())
    t = np.sort(np.random.default_rng(0).uniform(0, scene.t_end, INSTANTS))
    ours, before = _seen(result, t), None
    for n in SLABS:
        right = _seen(simulate(scene.change({"solver": {"order": FIXED_ORDER, "slab": shortest / n}})), t)
        if before is not None:
            told = {name: (max(each.u, ROUNDED), max(each.y, ROUNDED)) for name, each in result.accuracy.inside.items()}
            off = [
                (np.abs(ours[name][k] - values[k]).max() - LEFT * np.abs(before[name][k] - values[k]).max())
                / (np.abs(values[k]).max() * min(told.get(name, (tol, tol))[k], tol))
                for name, values in right.items()
                for k in (0, 1)
                if np.abs(values[k]).max() > FAINT * HEAD
            ]
            most = max(off, default=0.0)
            if most <= MOST:
                break
        before = right
    return most


def _seen(result: Result, t: NDArray) -> dict[str, tuple[NDArray, NDArray]]:
    """Effort and flow times impedance at all ends of lines."""
    seen = {name: (probe.at(t), probe.record.z0) for name, probe in result.probes.items()}
    return {name: (each.u, z0 * each.y) for name, (each, z0) in seen.items()}
