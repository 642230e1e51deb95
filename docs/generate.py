"""Write the generated files of docs/: ``python -m docs.generate [NAME]``.

Without a name all but the charts; the scene reference alone, in seconds, with ``reference``.
"""

import runpy
import sys
from pathlib import Path
from typing import Any

from tline.scene.file import schema
from tline.scene.medium import ELECTRICAL, HYDRAULIC
from tline.scene.waveform import WAVEFORMS

DOCS = Path(__file__).parent
example = runpy.run_path(str(DOCS / "examples.py"))["example"]
SECTIONS = {
    "lines": (
        "Lines",
        "A line runs from its first node (end 1) to its second (end 2); flow counts positive that way. Many pipes may "
        'come from a CSV or NPZ file in place of tables, `lines = "pipes.csv"`: '
        "[large networks](networks.md#large-networks).",
    ),
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


def reference() -> str:
    """Compose the scene reference page."""
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
            for shape in WAVEFORMS:
                parts += _model(models[shape.__name__], shape.__name__, heading=True, level=4)
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


GENERATED = "pictures", "drives", "losses", "measured"

if __name__ == "__main__":
    (DOCS / "scene-reference.md").write_text(reference(), encoding="utf-8")
    for each in sys.argv[1:2] or GENERATED:
        if each != "reference":
            runpy.run_module(f"docs.generate_{each}", run_name="__main__", alter_sys=True)
