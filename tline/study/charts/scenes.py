"""Scenes of the charts; most are linear and from rest, so that their exact solutions are known."""

from typing import Any, NamedTuple

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.words.wording import nearest


class ChartScene(NamedTuple):
    """Scene of a chart with its title."""

    title: str
    scene: Scene


def _of(scene: Scene) -> ChartScene:
    return ChartScene(scene.title, scene)


RAMP = {"shape": "ramp", "to": 1, "duration": "0.1 ns"}


def _scene(title: str, **parts: Any) -> ChartScene:
    return _of(Scene(medium="electrical", title=title, **parts))


def _cable(
    title: str, load: dict[str, Any], value: Any = RAMP, resistance: float = 25, t_end: str = "20 ns"
) -> ChartScene:
    return _scene(
        title,
        t_end=t_end,
        lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
        sources={"source": {"at": "near", "kind": "voltage", "value": value, "resistance": resistance}},
        loads={"load": {"at": "far", **load}},
        probes={"far": {"at": "far"}},
    )


def _lossy() -> ChartScene:
    """Scene of a ramp that ends on a slab's edge from eight slabs per transit on: inside slabs cells ignore corners."""
    title, end = "Ramp of 0.125 ns into 0.2 m of 20 Ω/m, 20 transits", {"kind": "resistor", "resistance": 100}
    given = _cable(title, end, RAMP | {"duration": "0.125 ns"}).scene
    line = given.table()["lines"]["line"] | {"length": "0.2 m", "resistance": "20 ohm/m"}
    return _of(Scene(**given.table() | {"lines": {"line": line}}))


def _smooth() -> ChartScene:
    value = {
        "shape": "sine", "amplitude": 0.5, "offset": 0.5, "phase": "-90 deg", "frequency": "0.5 GHz", "until": "2 ns",
    }  # fmt: skip
    return _scene(
        "Smooth pulse through two lines into a resistor",
        t_end="20 ns",
        lines={
            "first": {"nodes": ["near", "mid"], "z0": 50, "delay": "1 ns"},
            "second": {"nodes": ["mid", "far"], "z0": 100, "delay": "1.4142135623731 ns"},
        },
        sources={"source": {"at": "near", "kind": "voltage", "value": value, "resistance": 25}},
        loads={"load": {"at": "far", "kind": "resistor", "resistance": 200}},
        probes={"far": {"at": "far"}},
    )


def _y(title: str, delays: tuple[str, str, str], t_end: str = "20 ns", **load: Any) -> ChartScene:
    ends = (("near", "mid", 50), ("mid", "far", 75), ("mid", "side", 60))
    lines = {
        name: {"nodes": [i, j], "z0": z0, "delay": T} for name, (i, j, z0), T in zip("abc", ends, delays, strict=True)
    }
    return _scene(
        title,
        t_end=t_end,
        lines=lines,
        sources={"source": {"at": "near", "kind": "voltage", "value": RAMP, "resistance": 25}},
        loads={"load": {"at": "far", "kind": "resistor", "resistance": 100}} | load,
        probes={"far": {"at": "far"}},
    )


def _chain() -> ChartScene:
    z0 = [50, 75, 40, 90, 60, 110, 45, 70, 55, 85]
    ticks = [10, 7, 12, 9, 11, 8, 13, 10, 6, 14]  # of 0.1 ns
    return _scene(
        "Ten lines in a chain, delays on a common tick of 0.1 ns",
        t_end="40 ns",
        lines={
            f"line{k}": {"nodes": [f"n{k}", f"n{k + 1}"], "z0": z, "delay": f"{tick / 10} ns"}
            for k, (z, tick) in enumerate(zip(z0, ticks, strict=True))
        },
        sources={"source": {"at": "n0", "kind": "voltage", "value": RAMP, "resistance": 25}},
        loads={"load": {"at": "n10", "kind": "resistor", "resistance": 200}},
        probes={"n10": {"at": "n10"}, "n5": {"at": "n5", "line": "line5"}},
    )


def _behind_inductor() -> ChartScene:
    """Source behind an inductance as a current, the integral of its voltage over L, parallel to that inductance."""
    return _scene(
        "100 km line behind a 50 mH source of 1 V",
        t_end="20 ms",
        lines={"line": {"nodes": ["near", "far"], "z0": 300, "length": "100 km", "wave_speed": "3e8 m/s"}},
        sources={
            "source": {
                "at": "near",
                "kind": "current",
                "value": {"shape": "piecewise linear", "points": [[0, 0], ["1 s", 20]]},
            }
        },
        loads={
            "coil": {"at": "near", "kind": "series", "inductance": "50 mH"},
            "load": {"at": "far", "kind": "resistor", "resistance": 1000},
        },
        probes={"far": {"at": "far"}},
    )


RC = {"kind": "parallel", "resistance": 100, "capacitance": "4 pF"}
SERIES_RLC = {"kind": "series", "resistance": 10, "inductance": "50 nH", "capacitance": "2 pF"}
MAKERS = {
    "smooth": _smooth,
    "step": lambda: _cable("Step at 0.371 ns into 100 Ω ∥ 4 pF", RC, {"shape": "step", "to": 1, "at": "0.371 ns"}),
    "rc": lambda: _cable("Ramp of 0.1 ns into 100 Ω ∥ 4 pF, 20 transits", RC),
    "rlc": lambda: _cable("Ramp of 0.1 ns into 10 Ω + 50 nH + 2 pF in series", SERIES_RLC),
    "lossy": _lossy,
    "y": lambda: _y("Y of 1, √2 and 1/√3 ns, ramp of 0.1 ns", ("1 ns", "1.4142135623731 ns", "0.57735026918963 ns")),
    "long": lambda: _cable(
        "Lightly damped, 200 transits: 5 Ω into 1 kΩ ∥ 1 pF",
        {"kind": "parallel", "resistance": 1000, "capacitance": "1 pF"},
        resistance=5,
        t_end="200 ns",
    ),
    "chain": _chain,
    "hammer": lambda: _of(hammer()),
    "friction": lambda: _of(friction()),
    "network": lambda: _of(network()),
    "inductor": _behind_inductor,
    "stub": lambda: _y("An open stub of 0.1 ps between two lines of 1 ns", ("1 ns", "1 ns", "0.0001 ns"), t_end="3 ns"),
    "stiff": lambda: _cable(
        "Ramp into 100 Ω ∥ 0.01 pF: a load 3000 times faster than the line",
        {"kind": "parallel", "resistance": 100, "capacitance": "0.01 pF"},
    ),
    "twins": lambda: _y(
        "Y of 1, 0.7 and 0.7000001 ns: fronts that arrive almost together",
        ("1 ns", "0.7 ns", "0.7000001 ns"),
        t_end="12 ns",
        side={"at": "side", "kind": "parallel", "capacitance": "1 pF"},
    ),
}
NAMES = tuple(MAKERS)


def chart_scene(name: str) -> ChartScene:
    """Look up a scene of the charts."""
    if name not in MAKERS:
        raise InputError("scene", "no such chart scene", nearest(name, list(NAMES)), f"'{name}'")
    return MAKERS[name]()


def hammer() -> Scene:
    """Pipe of 12 inches and 1 s, closed at rest; pressures count from that of its reservoir."""
    pipe = {"nodes": ["tank", "far"], "length": "4000 ft", "delay": 1, "density": 1000, "radius": "6 in"}
    drawn = {"shape": "ramp", "to": "-30 L/s", "duration": 0.5}
    return Scene(
        title="Water hammer: 30 L/s drawn within 0.5 s, 20 transits",
        medium="hydraulic",
        t_end=20,
        lines={"pipe": pipe},
        sources={"draw": {"at": "far", "kind": "flow", "value": drawn}},
        loads={"tank": {"at": "tank", "kind": "short"}},
        probes={"far": {"at": "far"}},
    )


def friction() -> Scene:
    """Pipe of `hammer` at 2.74 m/s, with friction of 13.5 % of the surge; pressures count from the reservoir's."""
    given = hammer().table()
    pipe = given["lines"]["pipe"] | {"friction": {"kind": "darcy", "factor": 0.03}}
    shut = {"shape": "ramp", "from": "-200 L/s", "to": 0, "duration": 0.5}
    title = "Darcy's friction: 200 L/s stopped within 0.5 s, 20 transits"
    parts = {"lines": {"pipe": pipe}, "sources": {"draw": given["sources"]["draw"] | {"value": shut}}}
    return Scene(**given | parts | {"title": title, "start": "steady"})


def network() -> Scene:
    """Two loops, a branch and a dead end; delays are multiples of the shortest, and flows leave at ends alone."""
    pipes = {  # nodes, how many times 1000 ft and 0.25 s, radius in inches
        "main": ("tank", "gate", 4, 7),
        "north": ("gate", "mill", 2, 5),
        "south": ("gate", "square", 3, 5),
        "link": ("mill", "square", 1, 4),
        "upper": ("mill", "bridge", 3, 4),
        "lower": ("square", "bridge", 2, 4),
        "works": ("bridge", "plant", 2, 4),
        "village": ("mill", "houses", 3, 4),
        "stub": ("square", "hydrant", 1, 3),
    }
    water = {"density": 1000, "friction": {"kind": "darcy", "factor": 0.02}}
    shut = {"shape": "ramp", "from": "-100 L/s", "to": 0, "duration": 0.5}
    return Scene(
        title="Looped network with Darcy's friction: 100 of 150 L/s stopped within 0.5 s",
        medium="hydraulic",
        t_end=20,
        start="steady",
        lines={
            name: {"nodes": [i, j], "length": f"{1000 * n} ft", "delay": n / 4, "radius": f"{r} in"} | water
            for name, (i, j, n, r) in pipes.items()
        },
        sources={
            "plant": {"at": "plant", "kind": "flow", "value": shut},
            "houses": {"at": "houses", "kind": "flow", "value": "-50 L/s"},
        },
        loads={"tank": {"at": "tank", "kind": "short"}},
        probes={"plant": {"at": "plant"}, "mill": {"at": "mill", "line": "north"}, "hydrant": {"at": "hydrant"}},
    )
