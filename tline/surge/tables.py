"""Tables of a run, with coordinates: extremes and forces at nodes, flows in pipes, and states of elements."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from math import isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from tline.atomic import replacing, suffix_of, write_table
from tline.errors import import_extra
from tline.scene.line import Pipe
from tline.solver.result.dense_output import inside
from tline.solver.result.result import Result
from tline.surge.thrust import thrusts
from tline.surge.worst import extremes

if TYPE_CHECKING:
    from xarray import Dataset


MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
KIND = "application/vnd.openxmlformats-officedocument.spreadsheetml"
HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>'
PLACES = 12  # stretches of a pipe at whose ends extremes are sought
WRITTEN = ".csv", ".xlsx", ".geojson"


def is_known(value: Any) -> bool:
    """Whether a cell has a finite number or a text."""
    return isfinite(value) if isinstance(value, int | float) else value != ""


def write_workbook(path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]]) -> None:
    """Write sheets of rows of texts and numbers; numbers that are not finite leave a cell empty."""
    files = {f"xl/worksheets/sheet{k}.xml": _sheet(rows) for k, rows in enumerate(sheets.values(), 1)}
    numbered = [(k, escape(name)) for k, name in enumerate(sheets, 1)]
    names = "".join(f'<sheet name="{name}" sheetId="{k}" r:id="r{k}"/>' for k, name in numbered)
    files["xl/workbook.xml"] = f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{names}</sheets></workbook>'
    files["xl/_rels/workbook.xml.rels"] = _relations(
        {f"r{k}": f"worksheet worksheets/sheet{k}.xml" for k, _ in numbered}
    )
    files["_rels/.rels"] = _relations({"r1": "officeDocument xl/workbook.xml"})
    kinds = [("/xl/workbook.xml", "main"), *((f"/xl/worksheets/sheet{k}.xml", "worksheet") for k, _ in numbered)]
    parts = "".join(
        f'<Override PartName="{part}" ContentType="{KIND}.{"sheet.main" if kind == "main" else kind}+xml"/>'
        for part, kind in kinds
    )
    relations = '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    files["[Content_Types].xml"] = f'<Types xmlns="{PACKAGE}/content-types">{relations}{parts}</Types>'
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, HEAD + text)


def _relations(targets: Mapping[str, str]) -> str:
    each = (f'<Relationship Id="{key}" Type="{OFFICE}/{kind}" Target="{to}"/>' for key, (kind, to) in _split(targets))
    return f'<Relationships xmlns="{PACKAGE}/relationships">{"".join(each)}</Relationships>'


def _split(targets: Mapping[str, str]) -> list[tuple[str, list[str]]]:
    return [(key, text.split()) for key, text in targets.items()]


def _sheet(rows: Sequence[Sequence[Any]]) -> str:
    lines = "".join(f"<row>{''.join(map(_cell, row))}</row>" for row in rows)
    return f'<worksheet xmlns="{MAIN}"><sheetData>{lines}</sheetData></worksheet>'


def _cell(value: Any) -> str:
    if not is_known(value):
        return "<c/>"
    if isinstance(value, int | float):
        return f"<c><v>{value!r}</v></c>"
    return f'<c t="inlineStr"><is><t>{escape(value)}</t></is></c>'


class Table(NamedTuple):
    """Rows under heads with units; the first column names the subject of a row."""

    name: str
    head: Sequence[str]
    rows: Sequence[Sequence[Any]]


def tables(result: Result) -> list[Table]:
    """Nodes, pipes that were recorded, and states, in the units of the scene."""
    return [_nodes(result), _pipes(result), _states(result)]


def save_tables(result: Result, path: str | Path) -> None:
    """Write tables as NAME-nodes.csv, NAME-pipes.csv and NAME-states.csv, as sheets (.xlsx), or as a map (.geojson)."""
    path, found = Path(path), tables(result)
    suffix = suffix_of(path, WRITTEN)
    if suffix == ".csv":
        for table in found:
            write_table(path.with_name(f"{path.stem}-{table.name}.csv"), table.head, table.rows)
        return
    with replacing(path) as temporary:
        if suffix == ".geojson":
            temporary.write_text(json.dumps(_on_a_map(result, found), allow_nan=False), encoding="utf-8")
            return
        write_workbook(temporary, {table.name: [table.head, *table.rows] for table in found})


def as_dataset(result: Result) -> "Dataset":
    """The tables of nodes and of pipes as one dataset of xarray, with coordinates and units as attributes."""
    xarray = import_extra("xarray", "xarray", "data", "to_xarray")
    variables, names = {}, {}
    for dim, (_, head, rows) in zip(("node", "pipe"), tables(result), strict=False):
        columns = [*zip(*rows, strict=True)] or [()] * len(head)
        names[dim] = np.array(columns[0], object)
        for key, column in zip(head[1:], columns[1:], strict=True):
            word, _, unit = key.rstrip("]").partition(" [")
            texts = any(isinstance(x, str) and x for x in column)
            values = np.array(column, object) if texts else np.array([nan if x == "" else x for x in column], float)
            variables[word if dim == "node" else f"pipe {word}"] = (dim, values, {"units": unit} if unit else {})
    places = {key: variables.pop(key) for key in ("x", "y", "elevation")}
    return xarray.Dataset(variables, names | places, {"title": result.scene.title})


def _nodes(result: Result) -> Table:
    units = (result.medium.unit(each, written=True) for each in ("effort", "m", "N"))
    (size, unit), (metre, length), (newton, force) = units
    low, high = ([f"{word} [{unit}]", f"{word} at [s]", f"{word} ± [{unit}]"] for word in ("lowest", "highest"))
    head = ["node", "x", "y", f"elevation [{length}]", f"before [{unit}]", *low, *high]
    head += [f"force before [{force}]", f"force highest [{force}]", "force highest at [s]"]
    rows, forces = [], thrusts(result)
    for one in extremes(result):
        site = result.scene.nodes.get(one.node)
        x, y = (site.position if site else None) or ("", "")
        height = "" if site is None or site.elevation is None else site.elevation / metre
        low = one.lowest / size, one.lowest_at, one.lowest_error / size
        high = one.highest / size, one.highest_at, one.highest_error / size
        push = forces.get(one.node)
        pushed = ("", "", "") if push is None else (push.before / newton, push.highest / newton, push.at)
        rows.append([one.node, x, y, height, one.before / size, *low, *high, *pushed])
    return Table("nodes", head, rows)


def _pipes(result: Result) -> Table:
    units = (result.medium.unit(each, written=True) for each in ("m", "flow", "m/s"))
    (metre, length), (size, flow), (pace, speed) = units
    rows, words = [], [f"{what} at end {end}" for end in (1, 2) for what in ("before", "lowest", "highest")]
    words += ["lowest along it", "highest along it"]
    heads = [f"{what} {word} [{unit}]" for what, unit in (("flow", flow), ("velocity", speed)) for word in words]
    for name in result.lines:
        line = result.scene.lines[name]
        if not isinstance(line, Pipe):
            continue
        area = getattr(line.parameters, "area", None)
        seen = inside(result, name, PLACES)
        flows = [_flow(seen.waves, result, line.parameters.z0, share) for share in seen.places.tolist()]
        ends = [x for y in (flows[0], flows[-1]) for x in (y[0], y.min(), y.max())]
        found = [*ends, min(y.min() for y in flows), max(y.max() for y in flows)]
        values = [float(x / unit) for unit in (size, (area or nan) * pace) for x in found]
        rows.append([name, *line.nodes, (line.parameters.length or nan) / metre, *values])
    return Table("pipes", ["pipe", "end 1", "end 2", f"length [{length}]", *heads], rows)


def _flow(waves: Callable[..., Any], result: Result, z0: float, share: float) -> Any:
    a, b = waves(result.t, share)
    return (a - b) / (2 * z0)


def _states(result: Result) -> Table:
    rows = []
    for trace in result.states:
        size, unit = result.medium.unit(trace.unit, written=True)
        rows.append([trace.where.partition(".")[2], trace.word, unit or "1", *trace.row(size)])
    ends = [f"{word}{at}" for word in ("lowest", "highest") for at in ("", " at [s]")]
    head = ["element", "quantity", "unit", "before", *ends, "at the end"]
    return Table("states", head, rows)


def _on_a_map(result: Result, found: Sequence[Table]) -> dict[str, Any]:
    """Features of GeoJSON, in the coordinates of the scene."""
    nodes, pipes, states = found
    places = {row[0]: [row[1], row[2]] for row in nodes.rows if row[1] != ""}
    placed = {name: element for (_, name), element in result.scene.placed}
    features = [_feature("Point", places[row[0]], nodes.head, row) for row in nodes.rows if row[0] in places]
    for row in pipes.rows:
        line = result.scene.lines[row[0]]
        if {*line.nodes} <= places.keys():
            middle = [list(map(float, vertex)) for vertex in getattr(line, "vertices", None) or ()]
            course = [places[line.nodes[0]], *middle, places[line.nodes[1]]]
            features.append(_feature("LineString", course, pipes.head, row))
    for row in states.rows:
        element = placed.get(row[0])
        node = None if element is None else next((n for n in element.terminals if n in places), None)
        if node is not None:
            features.append(_feature("Point", places[node], states.head, row))
    return {"type": "FeatureCollection", "features": features}


def _feature(kind: str, coordinates: Any, head: Iterable[str], row: Iterable[Any]) -> dict[str, Any]:
    told = {key: x for key, x in zip(head, row, strict=True) if is_known(x)}
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": told}
