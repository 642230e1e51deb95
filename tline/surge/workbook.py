"""Workbooks of spreadsheets (Office Open XML, ECMA-376): sheets of texts and numbers, and nothing else."""

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr
from zipfile import ZIP_DEFLATED, ZipFile

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
KIND = "application/vnd.openxmlformats-officedocument.spreadsheetml"
HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>'


def is_known(value: Any) -> bool:
    """Whether a cell has anything to say."""
    return isfinite(value) if isinstance(value, int | float) else value != ""


def write_workbook(path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]]) -> None:
    """Write sheets of rows of texts and numbers; numbers that are none leave a cell empty."""
    files = {f"xl/worksheets/sheet{k}.xml": _sheet(rows) for k, rows in enumerate(sheets.values(), 1)}
    numbered = [(k, quoteattr(name)) for k, name in enumerate(sheets, 1)]
    names = "".join(f'<sheet name={name} sheetId="{k}" r:id="r{k}"/>' for k, name in numbered)
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
