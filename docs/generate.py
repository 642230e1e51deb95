"""Writes what in docs/ is generated: the scene reference and the pictures. Run: python docs/generate.py."""

import re
import runpy
import warnings
from pathlib import Path
from typing import Any

from tline.scene.file import read_scene, schema
from tline.scene.medium import ELECTRICAL, HYDRAULIC

DOCS = Path(__file__).parent
example = runpy.run_path(str(DOCS / "examples.py"))["example"]
SECTIONS = {
    "lines": ("Lines", "A line runs from its first node (end 1) to its second (end 2); flow counts positive that way."),
    "sources": (
        "Sources",
        "At a node, against the reference, or between two nodes. `value` is a number or text, or one of the waveforms "
        "below. A flow or current counts positive into the node, or into the first of two.",
    ),
    "loads": (
        "Loads",
        "What a node lets pass to earth, or to the open air at its height; several stand side by side. Flow counts "
        "positive out of the node.",
    ),
    "links": (
        "Links",
        "What stands between nodes without a delay, with flow positive from the first node to the second: R, L, C and "
        "switches, [laws](elements.md), and linear multiports, each port of which is a node and the reference, or two "
        "nodes. Links may meet at nodes where no line ends.",
    ),
    "probes": (
        "Probes",
        "Where effort, flow and waves are recorded. Flow counts positive from the line's end 1 to its end 2, wherever "
        "the probe stands: at end 1 it comes out of the node, at end 2 it goes into the node.",
    ),
    "measures": (
        "Measures",
        "Numbers that a run reads off what its probes saw, at any instant and not only at slab ends: printed below the "
        "probes, and in `--json`. What does not happen is told as such.",
    ),
    "nodes": (
        "Nodes",
        "Where nodes are, if that matters. With elevations reservoirs and sources prescribe piezometric pressures, "
        "density·g·head, and what leads to the open air sees the gauge pressure at its height: "
        "[heights](networks.md#heights).",
    ),
}
SHAPES = (
    "Constant", "Step", "Ramp", "PiecewiseLinear", "Table", "Pulses", "Sine", "ModulatedSine", "Exponential",
    "DoubleExponential",
)  # fmt: skip


def reference() -> str:
    """The scene reference page."""
    whole = schema()
    models = whole["$defs"]
    parts = [
        "# Scene reference",
        "",
        "Generated from the schema by `make docs`; `tline schema` prints the schema itself.",
        "",
        'A scene is a TOML file. Numbers are SI; texts carry a unit, such as `"10 cm"`. Elements are tables keyed by a',
        "name of your choice, such as `[lines.pipe]`. A node is any name that a line gives to an end; a node with",
        "nothing else is closed. Links and sources between nodes may name further ones, where no line ends.",
        "",
        "## Top level",
        "",
        *_keys({k: v for k, v in whole["properties"].items() if k not in (*SECTIONS, "solver")}, whole["required"]),
        "",
        "## `[solver]`",
        "",
        models["Solver"].get("description", ""),
        "",
        *_keys(models["Solver"]["properties"], []),
    ]
    for key, (title, text) in SECTIONS.items():
        parts += ["", f"## {title}: `[{key}.NAME]`", "", text]
        for name in _models_of(whole["properties"][key]["additionalProperties"]):
            parts += _model(models[name], name, heading=key in ("lines", "loads", "links", "measures"))
        if key == "sources":
            parts += ["", "### Waveforms"]
            for name in SHAPES:
                parts += _model(models[name], name, heading=True, level=4)
    return "\n".join(parts) + "\n"


def _models_of(node: dict[str, Any]) -> list[str]:
    found = [node["$ref"]] if "$ref" in node else [one["$ref"] for one in node.get("oneOf", node.get("anyOf", []))]
    return [reference.rsplit("/", 1)[1] for reference in found]


def _model(model: dict[str, Any], name: str, *, heading: bool, level: int = 3) -> list[str]:
    word = model["properties"].get("kind", {}) if "shape" not in model["properties"] else model["properties"]["shape"]
    words = [word["const"]] if "const" in word else word.get("enum", [])
    key = "shape" if "shape" in model["properties"] else "kind"
    tag = " or ".join(f'`{key} = "{one}"`' for one in words) if heading and words else name
    head = ["", f"{'#' * level} {tag}"] if heading else []
    keys = {k: v for k, v in model["properties"].items() if not (heading and words and k == key)}
    return [
        *head,
        "",
        model.get("description", "").split("\n\n")[0].replace("\n", " "),
        "",
        *_keys(keys, model.get("required", [])),
        "",
        "```toml",
        example(name).rstrip(),
        "```",
    ]


def _keys(properties: dict[str, Any], required: list[str]) -> list[str]:
    rows = ["| key | value | default | |", "|---|---|---|---|"]
    for name, node in properties.items():
        default = "needed" if name in required else _default(node)
        rows.append(f"| `{name}` | {_value(node)} | {default} | {node.get('description', '')} |")
    return rows


def _default(node: dict[str, Any]) -> str:
    default = node.get("default")
    default = str(default).lower() if isinstance(default, bool) else default
    return "" if default in (None, "") or isinstance(default, dict) else f"`{default}`"


def _value(node: dict[str, Any]) -> str:
    choices = [one for one in node.get("anyOf", []) if one.get("type") != "null"]
    if len(choices) == 1:
        return _value(choices[0])
    if "$ref" in node:
        return "table"
    if "unit" in node:
        return _unit(node)
    if "enum" in node or "const" in node:
        return ", ".join(f'`"{word}"`' for word in node.get("enum", [node.get("const")]))
    if any("$ref" in one or "oneOf" in one for one in choices):
        return "number, text or waveform"
    words = {"string": "text", "integer": "whole number", "number": "number", "array": "list", "object": "table"}
    words["boolean"] = "true or false"
    return words.get(node.get("type", ""), "number or text")


def _unit(node: dict[str, Any]) -> str:
    if node["unit"] != "by medium":
        return f"number or text, {node['unit']}" if node["unit"] else "number or text"
    role = node.get("title", "")
    if role in HYDRAULIC.units:
        return f"number or text, {HYDRAULIC.units[role]} or {ELECTRICAL.units[role]}"
    return "number or text"


def pictures() -> None:
    """The pictures of README and docs."""
    import numpy as np

    from passivity import RationalFunction, check_positive_real
    from passivity.one_port.picture import draw_verdict
    from tline.frequency.oscillations import resonances
    from tline.frequency.response import respond
    from tline.pictures.bode import plot_bode
    from tline.pictures.lattice import plot_lattice
    from tline.pictures.network import plot_network
    from tline.pictures.path import route
    from tline.pictures.space_time import plot_space_time
    from tline.pictures.style import save_figure, styled
    from tline.pictures.traces import plot
    from tline.pictures.waves import plot_line_waves
    from tline.solver.simulate import UnresolvedWarning, simulate

    warnings.simplefilter("ignore", UnresolvedWarning)
    scene = read_scene(DOCS.parent / "scenes" / "water_pipe.toml")
    result, way = simulate(scene), route(scene)
    (DOCS / "pictures").mkdir(exist_ok=True)
    save_figure(plot(result), str(DOCS / "pictures" / "pressure.png"))
    save_figure(plot_space_time(result, way), str(DOCS / "pictures" / "space_time.png"))
    save_figure(plot_lattice(result), str(DOCS / "pictures" / "lattice.png"))
    save_figure(plot_line_waves(result, "pipe"), str(DOCS / "pictures" / "waves.png"))
    save_figure(plot_network(read_scene(DOCS.parent / "scenes" / "town.toml")), str(DOCS / "pictures" / "network.png"))
    cable, f = read_scene(DOCS.parent / "scenes" / "cable_rlc.toml"), np.geomspace(1e6, 1e9, 1001)
    seen = {name: probe.u for name, probe in respond(cable, 2j * np.pi * f).items()}
    save_figure(
        plot_bode(f, seen, "voltage / source", "V/V", resonances(cable, f[-1]), cable.title),
        str(DOCS / "pictures" / "bode.png"),
    )
    _signals()
    _network()
    _sweep()
    _design()
    _oil()
    _cavities()
    _circuits()
    refuted = check_positive_real(RationalFunction.from_expression("(s + 2)/(s^2 + s + 1)"))
    save_figure(styled(draw_verdict)(refuted, refuted.margins), str(DOCS / "pictures" / "passivity.png"))


def _signals() -> None:
    """Crosstalk, reflectometry, an eye, load lines and a measured load."""
    from tline.pictures.crosstalk import plot_crosstalk
    from tline.pictures.eye import plot_eye
    from tline.pictures.load_lines import plot_load_lines
    from tline.pictures.misfit import plot_misfit
    from tline.pictures.reflections import plot_reflections
    from tline.pictures.style import save_figure
    from tline.pictures.traces import plot
    from tline.signal.crosstalk import crosstalk
    from tline.signal.eye_diagram import eye
    from tline.signal.load_line import bergeron
    from tline.signal.tdr import reflectometry
    from tline.solver.simulate import simulate

    pair, cascade, ringing, antenna = (
        read_scene(DOCS.parent / "scenes" / f"{name}.toml") for name in ("coupled_pair", "tdr", "load_lines", "antenna")
    )
    pair_with_skin, coax, net, overhead = (
        read_scene(DOCS.parent / "scenes" / f"{name}.toml")
        for name in ("skin_pair", "coax_fault", "ddr_ibis", "overhead_line")
    )
    seen = reflectometry(cascade, "near", "100 ps")
    opened = eye(cascade, "far", "0.8 ns", "0.2 ns")
    for name, picture in (
        ("crosstalk", plot(simulate(pair))),
        ("tdr", plot_reflections(seen, ELECTRICAL, cascade.title)),
        ("eye", plot_eye(opened, ELECTRICAL, cascade.title)),
        ("load_lines", plot_load_lines(bergeron(ringing), ELECTRICAL, ringing.title)),
        ("fit", plot_misfit(antenna.loads["antenna"].model, "antenna.s1p")),
        ("skin_pair", plot_crosstalk(crosstalk(pair_with_skin), pair_with_skin.title)),
        ("coax_fault", plot_reflections(reflectometry(coax, "near", "5 ns"), ELECTRICAL, coax.title)),
        ("overhead_line", plot(simulate(overhead))),
        ("ddr_eye", plot_eye(eye(net, "die", "1 ns"), ELECTRICAL, net.title)),
    ):
        save_figure(picture, str(DOCS / "pictures" / f"{name}.png"))


def _network() -> None:
    """A profile and a map of a town."""
    from tline.pictures.map import plot_map
    from tline.pictures.path import route
    from tline.pictures.profile import plot_profile
    from tline.pictures.style import save_figure
    from tline.solver.simulate import simulate

    town = read_scene(DOCS.parent / "scenes" / "town.toml")
    result = simulate(town, record=town.lines, envelope=True)
    save_figure(plot_profile(result, route(town, "lake", "tower")), str(DOCS / "pictures" / "profile.png"))
    save_figure(plot_map(result), str(DOCS / "pictures" / "map.png"))


def _sweep() -> None:
    from tline.pictures.style import save_figure
    from tline.pictures.sweep import plot_sweep
    from tline.sweeps import sweep

    closure = read_scene(DOCS.parent / "scenes" / "valve_closure.toml")
    found = sweep(closure, {"loads.valve.opening.duration": "0.5 s:3 s:26"})
    save_figure(plot_sweep(found), str(DOCS / "pictures" / "sweep.png"))


def _design() -> None:
    from tline.design import vessel
    from tline.pictures.style import save_figure

    scene = read_scene(DOCS.parent / "scenes" / "air_vessel.toml").with_changes(t_end=40)
    found = vessel(scene, "vessel", path=("pump", "tank"), lowest="2 bar", highest="7 bar")
    save_figure(found.plot(), str(DOCS / "pictures" / "vessel.png"))


def _oil() -> None:
    """The scenes of docs/oil.md."""
    from tline.pictures.style import save_figure
    from tline.pictures.traces import plot
    from tline.solver.simulate import simulate

    for name in ("hydraulic_hose", "brake_line", "injection_pipe"):
        picture = plot(simulate(read_scene(DOCS.parent / "scenes" / f"{name}.toml")))
        save_figure(picture, str(DOCS / "pictures" / f"{name}.png"))


def _cavities() -> None:
    """Column separation in a pipe, with the highest pressure measured: 1015 kPa, absolute."""
    from tline.pictures.style import INK, save_figure
    from tline.pictures.traces import plot
    from tline.solver.simulate import simulate

    picture = plot(simulate(read_scene(DOCS.parent / "scenes" / "column_separation.toml")))
    measured = (1015e3 - 101_325) / 1e5
    axes = picture.axes[0]
    axes.axhline(measured, color=INK, linestyle=":", linewidth=1.4)
    axes.annotate("highest measured", (0.99, measured), (0, 3), ("axes fraction", "data"), "offset points", ha="right")
    save_figure(picture, str(DOCS / "pictures" / "column_separation.png"))


def _circuits() -> None:
    """Every scene of which a page shows a picture named circuit_NAME."""
    from tline.pictures.style import save_figure
    from tline.pictures.traces import plot
    from tline.solver.simulate import simulate

    page = "".join(path.read_text(encoding="utf-8") for path in sorted(DOCS.glob("*.md")))
    for name in re.findall(r"\(pictures/circuit_(\w+)\.png\)", page):
        result = simulate(read_scene(DOCS.parent / "scenes" / f"{name}.toml"))
        save_figure(plot(result), str(DOCS / "pictures" / f"circuit_{name}.png"))


if __name__ == "__main__":
    (DOCS / "scene-reference.md").write_text(reference(), encoding="utf-8")
    pictures()
