"""Scenes of the charts with water: a pipe at rest, the same with friction, and a network with friction."""

from tline.scene.scene import Scene


def hammer() -> Scene:
    """A pipe of 12 inches and 1 s, closed at rest; pressures count from that of its reservoir."""
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
    """The same pipe runs at 2.74 m/s, and friction takes 13.5 % of the surge; pressures count from the reservoir's."""
    given = hammer().table()
    pipe = given["lines"]["pipe"] | {"friction": {"kind": "darcy", "factor": 0.03}}
    shut = {"shape": "ramp", "from": "-200 L/s", "to": 0, "duration": 0.5}
    title = "Darcy's friction: 200 L/s stopped within 0.5 s, 20 transits"
    parts = {"lines": {"pipe": pipe}, "sources": {"draw": given["sources"]["draw"] | {"value": shut}}}
    return Scene(**given | parts | {"title": title, "start": "steady"})


def network() -> Scene:
    """Two loops, a branch and a dead end; delays are whole multiples of the shortest, and flows leave at ends alone."""
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
