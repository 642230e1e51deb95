"""Realistic scenes in which lines with a memory end at laws, switches and each other."""

from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from tline.scene.scene import Scene

SKIN = {"resistance": "25 ohm/m", "frequency": "1 GHz"}
TRACE = {"inductance": "350 nH/m", "capacitance": "140 pF/m", "resistance": "8 ohm/m", "skin": SKIN}
MEMORY = Path(__file__).parent.parent / "scenes" / "memory.ibs"


def electrical(t_end: Any, **parts: Any) -> Scene:
    """A scene with a probe at each node that it names."""
    probes = {name: {"at": name} for name in parts.pop("probes")}
    return Scene(medium="electrical", t_end=t_end, probes=probes, **parts)


def ramp(to: float, duration: float, at: float = 0.0) -> dict[str, Any]:
    """A straight edge."""
    return {"shape": "ramp", "to": to, "duration": duration, "at": at}


def source(at: str, value: Any, resistance: float = 50.0, kind: str = "voltage") -> dict[str, Any]:
    """A source behind a resistance."""
    return {"at": at, "kind": kind, "value": value, "resistance": resistance}


def resistor(at: str, resistance: float) -> dict[str, Any]:
    """A resistance to the reference."""
    return {"at": at, "kind": "resistor", "resistance": resistance}


def diode(at: str, saturation: float = 1e-14, reverse: bool = False) -> dict[str, Any]:
    """A diode between a node and the reference."""
    return {"at": at, "kind": "diode", "saturation": saturation, "reverse": reverse}


def stripline_with_ibis() -> Scene:
    """A buffer of an IBIS file, 10 cm of stripline, a package of L and C, and clamp diodes to ground and rail."""
    loss = {"value": 0.02, "frequency": 1e9, "low": 1e4, "high": 1e12}
    return electrical(
        6e-9,
        lines={"trace": {"nodes": ["ball", "far"], "length": 0.1, **TRACE, "loss_tangent": loss}},
        probes=["ball", "die"],
        loads={
            "driver": {"at": "ball", "kind": "ibis", "file": str(MEMORY), "pin": "A1", "bits": "0110", "bit": 1.2e-9},
            "pad": {"at": "die", "kind": "capacitor", "capacitance": 1e-12},
            "low": diode("die", reverse=True),
            "leak": resistor("die", 1e4),
        },
        links={
            "bond": {"kind": "series", "nodes": ["far", "die"], "inductance": 1e-9, "resistance": 0.1},
            "high": {"kind": "diode", "nodes": ["die", "rail"], "saturation": 1e-14},
        },
        sources={"rail": {"at": "rail", "kind": "voltage", "value": 1.5}},
    )


def cat5e_into_a_suppressor() -> Scene:
    """A surge of 200 V on 30 m of one pair of Cat 5e, and a suppressor of two diodes and 20 pF behind 2 ohm."""
    pair = {"nodes": ["outside", "inside"], "length": 30, "cable": "Cat 5e"}
    surge = {"shape": "double exponential", "peak": 200, "rise": 10e-9, "decay": 4e-7}
    suppressor = [[-14, -60], [-8.6, -6], [-7, -1e-3], [-5, -1e-6], [5, 1e-6], [7, 1e-3], [8.6, 6], [14, 60]]
    return electrical(
        1.2e-6,
        lines={"pair": pair},
        probes=["outside", "inside"],
        sources={"surge": source("outside", surge)},
        loads={
            "suppressor": {"at": "inside", "kind": "table", "points": suppressor},
            "receiver": {"at": "inside", "kind": "parallel", "resistance": 1e3, "capacitance": 20e-12},
        },
    )


def lightning_and_arrester() -> Scene:
    """10 kA into an overhead line over earth, and 500 m from there an arrester beside 2 nF."""
    wire = {"height": 12, "wire_diameter": 0.02, "wire": {"resistance": 1e-4}, "earth": 500}
    half = [[150e3, 1], [200e3, 100], [230e3, 1e3], [290e3, 1e4]]
    arrester = [[-u, -i] for u, i in half[::-1]] + half
    return electrical(
        30e-6,
        lines={
            "towards": {"nodes": ["struck", "station"], "length": 500, **wire},
            "away": {"nodes": ["struck", "west"], "length": 2000, **wire},
        },
        probes=["struck", "station"],
        sources={
            "stroke": {"at": "struck", "kind": "current", "value": {"shape": "ramp", "to": 5e3, "duration": 1.2e-6}}
        },
        loads={
            "west": {"at": "west", "kind": "matched"},
            "arrester": {"at": "station", "kind": "table", "points": arrester},
            "transformer": {"at": "station", "kind": "capacitor", "capacitance": 2e-9},
        },
    )


def bus_with_diodes() -> Scene:
    """Eight traces of 20 cm beside each other with skin effect, and a clamp diode beside 1 pF at each far end."""
    n, speed = 8, 1.5e8
    C = 140e-12 * np.eye(n) - 25e-12 * (np.eye(n, k=1) + np.eye(n, k=-1))
    L = np.linalg.inv(C) / speed**2
    near, far = [f"n{k}" for k in range(n)], [f"f{k}" for k in range(n)]
    skin = {"resistance": np.diag([40.0] * n).tolist(), "frequency": 1e9}
    bus = {"nodes1": near, "nodes2": far, "length": 0.2, "skin": skin}
    bus |= {"inductance": L.tolist(), "capacitance": C.tolist()}
    loads: dict[str, Any] = {f"clamp{k}": diode(at) for k, at in enumerate(far)}
    loads |= {f"pad{k}": {"at": at, "kind": "capacitor", "capacitance": 1e-12} for k, at in enumerate(far)}
    return electrical(
        8e-9,
        lines={"bus": bus},
        probes=["n0", "f0", "f1", "f7"],
        sources={f"s{k}": source(at, ramp(2.0 if k == 0 else 0.0, 0.2e-9), 40) for k, at in enumerate(near)},
        loads=loads,
    )


def breaker_beside_rg58() -> Scene:
    """100 m of RG-58 at 1 V are shorted at the near end by a breaker, and a diode stands at the far one."""
    return electrical(
        3e-6,
        lines={"coax": {"nodes": ["near", "far"], "length": 100, "cable": "RG-58"}},
        probes=["near", "far"],
        start="steady",
        sources={"s": source("near", 1.0)},
        loads={
            "breaker": {"at": "near", "kind": "switch", "before": "inf", "after": 0.1, "time": 0.2e-6},
            "end": resistor("far", 1e3),
            "clamp": diode("far", 1e-9, reverse=True),
        },
    )


def rg58_fault() -> Scene:
    """A step on 60 m of RG-58 with a fault of 20 ohm in the middle, over 1 µs."""
    coax = {"length": 30, "cable": "RG-58"}
    return electrical(
        1e-6,
        lines={"p": {"nodes": ["near", "fault"], **coax}, "q": {"nodes": ["fault", "far"], **coax}},
        probes=["near", "fault"],
        sources={"s": source("near", ramp(1.0, 1e-9))},
        loads={"fault": resistor("fault", 20), "end": resistor("far", 50)},
    )


def two_clamps() -> Scene:
    """3 V behind 50 ohm and a clamp, 2 m of cable with skin effect, 2 pF and 200 ohm beside a second clamp."""
    cable = {"length": 2, "inductance": 250e-9, "capacitance": 100e-12, "resistance": 1.0}
    skin = {"resistance": 3e-4 * sqrt(pi * 1e9), "frequency": 1e9}
    pulse = {"shape": "piecewise linear", "points": [[0, 0], [2e-9, 3], [30e-9, 3], [32e-9, 0]]}
    return electrical(
        45e-9,
        lines={"cable": {"nodes": ["near", "far"], **cable, "skin": skin}},
        probes=["near", "far"],
        sources={"s": source("near", pulse)},
        loads={
            "near": diode("near", 1e-12),
            "far": diode("far", 1e-12),
            "end": {"at": "far", "kind": "parallel", "resistance": 200, "capacitance": 2e-12},
        },
    )


def tree_with_clamps() -> Scene:
    """A trace that parts in two of unlike lengths, with a clamp and a pad at either end."""
    return electrical(
        6e-9,
        lines={
            "stem": {"nodes": ["driver", "fork"], "length": 0.08, **TRACE},
            "left": {"nodes": ["fork", "a"], "length": 0.05, **TRACE},
            "right": {"nodes": ["fork", "b"], "length": 0.0713, **TRACE},
        },
        probes=["driver", "a", "b"],
        sources={"s": source("driver", ramp(2.5, 0.15e-9), 30)},
        loads={
            "a": diode("a"),
            "b": diode("b"),
            "pad a": {"at": "a", "kind": "capacitor", "capacitance": 0.5e-12},
            "pad b": {"at": "b", "kind": "capacitor", "capacitance": 1e-12},
        },
    )


SCENES = {
    one.__name__: one
    for one in (
        stripline_with_ibis,
        cat5e_into_a_suppressor,
        lightning_and_arrester,
        bus_with_diodes,
        breaker_beside_rg58,
        rg58_fault,
        two_clamps,
        tree_with_clamps,
    )
}
