"""Scenes as fuzz: drawn from the scene's own schema, or shipped ones, then damaged."""

from functools import lru_cache
from random import Random
from typing import Any

from fuzz.case import Case, shipped
from fuzz.mutate import TEXTS, damaged, value

SMALL = (
    "air_vessel", "antenna", "cable_mismatch", "cable_rc", "cable_rlc", "column_separation", "coupled_pair",
    "diode_clamp", "load_lines", "loop", "lossy_cable", "lossy_pair", "open_line", "overhead_line", "pipe_friction",
    "pump_trip", "tabulated_cable",
    "tdr", "transformer", "valve_closure", "water_pipe", "y_junction",
)  # fmt: skip
BESIDE = {"antenna": "antenna.s1p", "tabulated_cable": "tabulated_cable.csv"}
NODES = ("a", "b", "c", "d")
SIZES = {  # typical values by unit, and by quantity where the unit depends on the medium
    "electrical": {"s": 1e-9, "Hz": 1e8, "effort": 1.0, "resistance": 50.0, "capacitance": 1e-11, "inductance": 1e-8,
                   "level": 1.0, "m": 1.0, "": 0.5, "flow": 0.02, "position": 0.3},
    "hydraulic": {"s": 0.1, "Hz": 10.0, "effort": 1e5, "resistance": 1e8, "capacitance": 1e-9, "inductance": 1e7,
                  "level": 1e5, "m": 0.2, "": 0.5, "flow": 0.01, "position": 0.3, "kg/m^3": 1000.0, "m/s": 1200.0},
}  # fmt: skip
COMMANDS = (
    ["run"], ["run"], ["run"], ["run", "--json"], ["run", "--active"], ["run", "--ledger"], ["passivity"], ["export"],
    ["frequency", "--points", "20"], ["frequency", "--points", "20", "--ports", "a,b"], ["tdr", "--port", "a",
    "--rise", "1 ns"],
    ["eye", "--probe", "p", "--bit", "2 ns", "--rise", "0.2 ns", "--bits", "5"], ["run", "--csv", "out.csv"],
    ["run", "--envelope",
    "out.csv"],
    ["sweep", "--vary", "lines.l0.z0=uniform(40, 60)", "--sample", "random:20", "--workers", "1"],
    ["sweep", "--vary", "lines.l0.z0=40,60", "--workers", "1", "--csv", "out.csv"],
    ["surge", "--for", "2 s"], ["crosstalk", "--rise", "1 ns"], ["design", "separation"],
    ["run", "--order", "3", "--slab", "1 ns"], ["live"],
)  # fmt: skip
RARE = (
    ["run", "--animate", "out.html"], ["run", "--plot", "out.svg"], ["run", "--map", "out.svg"], ["run",
    "--profile", "out.svg"],
    ["run", "--lattice", "out.svg"], ["run", "--npz", "out.npz"], ["run", "--space-time", "out.png"],
)  # fmt: skip


def case(rng: Random) -> Case:
    """A scene and a command that reads it."""
    command = rng.choice(RARE if rng.random() < 0.02 else COMMANDS)
    asked = frozenset(word for word in command if word.startswith("out."))
    if rng.random() < 0.5:
        import tomli_w

        text, files = tomli_w.dumps(drawn(rng)), {}
        data = damaged(rng, text) if rng.random() < 0.4 else text.encode("utf-8", "replace")
    else:
        name = rng.choice(SMALL)
        files = {file: text.encode() for file, text in _shipped().items() if file == BESIDE.get(name)}
        data = damaged(rng, _shipped()[f"{name}.toml"])
    first, *rest = command
    return Case([first, "scene.toml", *rest], files | {"scene.toml": data}, asked)


@lru_cache
def _shipped() -> dict[str, str]:
    return shipped(*(f"{name}.toml" for name in SMALL), *BESIDE.values())


@lru_cache
def _schema() -> dict[str, Any]:
    from tline.scene.file import schema

    return schema()


def drawn(rng: Random) -> dict[str, Any]:
    """Tables of a scene that is nearly valid: elements of the schema, with typical numbers and some awkward ones."""
    medium = rng.choice(("electrical", "electrical", "hydraulic"))
    draw = _Draw(rng, medium)
    properties = _schema()["properties"]
    lines = {f"l{k}": draw.line(k) for k in range(rng.choice((1, 1, 2, 3)))}
    scene: dict[str, Any] = {"medium": medium, "t_end": SIZES[medium]["s"] * rng.uniform(1, 20), "lines": lines}
    for part, chance in (("sources", 0.9), ("loads", 0.8), ("links", 0.2), ("nodes", 0.1)):
        if rng.random() < chance:
            kind = properties[part]["additionalProperties"]
            scene[part] = {draw.name(part[0], k): draw.any(kind, part) for k in range(rng.choice((1, 1, 2)))}
    scene["probes"] = {"p": {"at": "a"}} | ({"q": {"line": "l0", "position": "50 %"}} if rng.random() < 0.2 else {})
    for key in ("title", "start", "solver", "rating"):
        if rng.random() < 0.1:
            scene[key] = draw.any(properties[key], key)
    return scene


class _Draw:
    """Values for a schema."""

    def __init__(self, rng: Random, medium: str):
        self.rng, self.medium, self.sizes = rng, medium, SIZES[medium]

    def name(self, letter: str, k: int) -> str:
        return (
            f"{letter}{k}" if self.rng.random() < 0.97 else self.rng.choice(TEXTS).encode("utf-8", "replace").decode()
        )

    def line(self, k: int) -> dict[str, Any]:
        """Mostly of z0 and delay; now and then of anything."""
        kind = {"electrical": "Cable", "hydraulic": "Pipe"}[self.medium]
        table: dict[str, Any] = {"nodes": [NODES[k], NODES[k + 1]]}
        if self.rng.random() < 0.8:
            table |= {"z0": self.sizes["resistance"], "delay": self.sizes["s"] * self.rng.choice((1, 1, 0.5, 0.3, 1.7))}
        if self.rng.random() < 0.3:
            model = _schema()["$defs"][kind]
            keys = self.rng.sample(sorted(model["properties"]), self.rng.randint(1, 4))
            table |= {key: self.any(model["properties"][key], key) for key in keys if key != "nodes"}
        return table

    def any(self, schema: dict[str, Any], key: str, depth: int = 0) -> Any:
        """A value that the schema allows, or nearly."""
        rng = self.rng
        if rng.random() < 0.02 or depth > 8:
            return rng.choice((True, -1, 0, [], {}, "x", 1e308, float("nan"), [1], {"a": 1}))
        if "$ref" in schema:
            return self.any(_schema()["$defs"][schema["$ref"].rpartition("/")[2]], key, depth + 1)
        if "unit" in schema:
            return self.quantity(schema)
        for several in ("anyOf", "oneOf"):
            if several in schema:
                return self.any(rng.choice(schema[several]), key, depth + 1)
        if "const" in schema or "enum" in schema:
            return rng.choice(schema.get("enum") or [schema["const"]])
        match schema.get("type"):
            case "object" if "properties" in schema:
                required = schema.get("required", ())
                kept = [name for name in schema["properties"] if rng.random() < (0.97 if name in required else 0.3)]
                return {name: self.any(schema["properties"][name], name, depth + 1) for name in kept}
            case "object":
                return {}
            case "array":
                items = schema.get("prefixItems") or [schema.get("items", {})] * rng.randint(0, 4)
                return [self.any(item, key, depth + 1) for item in items]
            case "string":
                return self.text(key)
            case "boolean":
                return rng.random() < 0.5
            case "integer":
                return rng.choice((1, 2, 3, 5, 12, 0, -1, 10**9))
            case "null":
                return 0
            case _:
                return self.sizes[""] * rng.choice((0, 1, 2))

    def quantity(self, schema: dict[str, Any]) -> Any:
        if self.rng.random() < 0.07:
            return value(self.rng).encode("utf-8", "replace").decode()
        size = self.sizes.get(schema["unit"]) or self.sizes.get(schema.get("title", ""), 1.0)
        return size * self.rng.choice((0.0, 0.3, 1.0, 1.0, 1.0, 1.5, 2.0, 3.0))

    def text(self, key: str) -> str:
        rng = self.rng
        if rng.random() < 0.05:
            return rng.choice(TEXTS).encode("utf-8", "replace").decode()
        if key in ("at", "nodes", "from", "to", "control"):
            return rng.choice(NODES[:3])
        if key == "line":
            return "l0"
        if key == "expression":
            return rng.choice(("50", "50 + 1e-9*s", "1/(1/50 + 1e-11*s)", "s", "R + s*L", "(s+1)/(s+2)", "exp(-s)"))
        return rng.choice(NODES) if key != "file" else rng.choice(("antenna.s1p", "scene.toml", "nothing.csv", "."))
