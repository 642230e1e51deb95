"""Random pipes on a slope with an element of a given kind, and the same scene lifted by some metres."""

import numpy as np

from tline.scene.heights import GRAVITY
from tline.scene.scene import Scene
from tline.scene.user_defined import UserLink, UserLoad

WEIGHT = 1000 * GRAVITY  # Pa/m
RATED = {"flow": "20 L/s", "pressure_drop": "2 bar"}
OPENING = {"opening": {"shape": "ramp", "from": 1, "to": 0.2, "at": 0.7, "duration": 0.9}}
CURVE = {"points": [["-1 bar", "-5 L/s"], ["0 bar", "0 L/s"], ["1 bar", "3 L/s"], ["4 bar", "20 L/s"]]}
WAVES = {"resistance": "1e7 Pa s/m^3"}


class Screen(UserLoad):
    """Flow in proportion to the pressure, none in."""

    def flow(self, effort, opening):
        return max(effort, 0.0) * 3e-8 * opening


class Gate(UserLink):
    """Flow in proportion to the drop."""

    def flow(self, effort, opening):
        return effort * 1e-7 * opening


LOADS = {
    "closed": {},
    "short": {},
    "matched": {},
    "resistor": WAVES,
    "valve": {"before": "1e7 Pa s/m^3", "after": "5e8 Pa s/m^3", "time": 0.63},
    "series": {"resistance": "2e6 Pa s/m^3", "inductance": "3e6 Pa s^2/m^3", "capacitance": "1e-7 m^3/Pa"},
    "parallel": WAVES | {"capacitance": "1e-8 m^3/Pa"},
    "impedance": {"expression": "R + s*L", "parameters": {"R": 1e7, "L": 3e6}},
    "orifice": RATED | OPENING,
    "check valve": RATED | {"cracking_pressure": "0.3 bar"},
    "relief valve": RATED | {"set_pressure": "2 bar", "band": "1 bar"},
    "leak": {"flow": "10 L/s", "pressure": "3 bar", "exponent": 0.7},
    "demand": {"flow": "10 L/s", "required_pressure": "4 bar"},
    "diode": {"saturation": 1e-3, "temperature": 5000, "emission": 100, "reverse": True},
    "table": CURVE,
    "air vessel": {"gas_volume": "0.5 m^3", "gas_pressure": "3 bar"},
    "surge tank": {"tank_diameter": "0.8 m"},
    "cavity": {"gas_volume": "1e-3 m^3"},
    "vapour cavity": {},
    "air valve": {"inlet_diameter": "5 cm", "outlet_diameter": "2 cm"},
    "own": Screen,
    "inductor": {"kind": "parallel", "inductance": "3e6 Pa s^2/m^3"},
    "capacitor": {"kind": "series", "capacitance": "1e-8 m^3/Pa"},
    "switched capacitor": {"kind": "valve", "before": "inf", "after": "0 Pa s/m^3", "time": 0.4},
}
LINKS = {
    "orifice": RATED | OPENING,
    "check valve": RATED,
    "relief valve": RATED | {"set_pressure": "0.1 bar", "band": "0.2 bar"},
    "pump": {"curve": [["0 L/s", "4 bar"], ["30 L/s", "2 bar"]]},
    "tripping pump": {
        "kind": "pump", "curve": [["0 L/s", "4 bar"], ["30 L/s", "2 bar"]],
        "trip": 0.5, "inertia": "2 kg m^2", "rated_speed": "20 Hz",
    },
    "diode": {"saturation": 1e-3, "temperature": 5000, "emission": 100},
    "table": CURVE,
    "own": Gate,
}  # fmt: skip
MULTIPORTS = {
    "transformer": {"ratio": 1.4},
    "gyrator": {"resistance": "2e7 Pa s/m^3"},
    "controlled source": {"gain": 0.5, "resistance": "2e7 Pa s/m^3"},
    "coupled inductors": {"inductance": ["2e6 Pa s^2/m^3", "3e6 Pa s^2/m^3"], "coupling": 0.5},
    "junction": {"z0": "2e7 Pa s/m^3", "scattering": [[0, 0.8], [0.8, 0]]},
}
HOLDING = {"short", "inductor"}  # the effort at their node, in a steady state


def sloping(seed: int, lift: float = 0.0, load: str = "closed", link: str = "", **scene) -> Scene:
    """A tank and two pipes, perhaps with a link between them, and a load at their end, on random heights."""
    rng = np.random.default_rng(seed)
    z = dict(zip("abcd", rng.uniform(0, 40, 4).tolist(), strict=True))
    far = "c" if link else "b"
    head = WEIGHT * (45 + lift)
    sources = {
        "tank": {
            "at": "a", "kind": "pressure",
            "value": {"shape": "ramp", "from": head, "to": head + WEIGHT * float(rng.uniform(-10, 20)), "at": 0.3,
                      "duration": 0.11},
        } | ({"resistance": "1e6 Pa s/m^3"} if rng.random() < 0.5 or load in HOLDING else {}),
    }  # fmt: skip
    if link not in MULTIPORTS and rng.random() < 0.5:
        sources["inflow"] = {"at": "a", "kind": "flow", "value": "-3 L/s", "resistance": "4e7 Pa s/m^3"}
        sources["tank"] |= {"resistance": "1e6 Pa s/m^3"}
    loads = {"end": _element(LOADS[load], load, at="d")}
    if link not in MULTIPORTS:
        loads["leak"] = {"at": far, "kind": "leak", "flow": "2 L/s", "pressure": "3 bar"}
    friction = {"friction": {"kind": "darcy", "factor": 0.02}} if rng.random() < 0.4 else {}
    pipe = {"wave_speed": 1000, "density": 1000, "diameter": "20 cm"}
    if link == "tripping pump":
        loads.pop("leak")
    return Scene(
        medium="hydraulic",
        t_end=2.4,
        nodes={node: {"elevation": height + lift} for node, height in z.items() if node in {"a", "b", far, "d"}},
        lines={
            "upper": {"nodes": ["a", "b"], "length": float(rng.uniform(150, 300))} | pipe | friction,
            "lower": {"nodes": [far, "d"], "length": float(rng.uniform(150, 300))} | pipe | friction,
        },
        links={"link": _element(LINKS.get(link) or MULTIPORTS[link], link, nodes=["b", far])} if link else {},
        loads=loads,
        sources=sources,
        probes={"near": {"at": "b", "line": "upper"}, "far": {"at": "d"}}
        | ({} if friction else {"middle": {"line": "upper", "position": "40 %"}}),
        rating="6 bar",
        **scene,
    )


def _element(given, kind: str, **where):
    return given(**where) if isinstance(given, type) else {"kind": kind} | given | where
