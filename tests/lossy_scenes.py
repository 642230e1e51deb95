"""Scenes with one lossy line, for tests of several kinds."""

from tline.scene.scene import Scene

PROBES = {"near": {"at": "a"}, "far": {"at": "b"}}


def cable(value=1, load=100, t_end="20 ns", **losses) -> Scene:
    """0.2 m of 50 ohm, 1 ns, behind 25 ohm."""
    line = {"nodes": ["a", "b"], "length": "0.2 m", "inductance": "250 nH/m", "capacitance": "100 pF/m", **losses}
    return Scene(
        medium="electrical",
        t_end=t_end,
        lines={"line": line},
        sources={"s": {"at": "a", "kind": "voltage", "value": value, "resistance": 25}},
        loads={"r": {"at": "b", "kind": "resistor", "resistance": load}},
        probes=PROBES,
    )


def pipe(value=1, t_end=0.3, **line) -> Scene:
    """The pipe of Holmboe and Rouleau, a pressure at one end, the other closed."""
    given = {"length": "36.09 m", "radius": "12.7 mm", "density": 878, "wave_speed": 1324}
    return Scene(
        medium="hydraulic",
        t_end=t_end,
        lines={"line": {"nodes": ["a", "b"], **given, **line}},
        sources={"s": {"at": "a", "kind": "pressure", "value": value, "resistance": 0}},
        probes=PROBES,
    )
