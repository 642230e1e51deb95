"""Pipes of a large network as columns of a file: read, checked and computed as arrays, without an object for each."""

import csv
import io
import re
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from math import pi
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, SceneError
from tline.line.hydraulic import QUANTITIES
from tline.loss.flow_law import FlowLaw
from tline.scene.element import is_name
from tline.scene.friction import KINDS, ByFlow, VardyBrown
from tline.scene.line import Pipe, SceneLine
from tline.scene.medium import MEDIA
from tline.scene.mistakes import validator
from tline.scene.quantity import LARGEST, SMALLEST, Role
from tline.scene.text_file import Folder, read_text
from tline.units import to_si
from tline.words.wording import nearest, place, shown

WORDS = "name", "from", "to", "friction.kind"
KEYS = "length", "diameter", "wave_speed", "density", "z0", "delay"
ROLES = {q.name: Role(q.name, q.unit, above=0) for q in QUANTITIES if q.name in KEYS}
LAWS: dict[str, Any] = {  # friction that follows the flow at once
    kind: model for kind, model in KINDS.items() if issubclass(model, ByFlow) and not issubclass(model, VardyBrown)
}
OPTIONAL = "length", "unsteady", "minor_loss", "kind"  # of these
LARGEST_UNPACKED = 1_000_000_000  # bytes
BLANK = "", "nan"  # cells without a number, in texts and in arrays
HEADING = re.compile(r"\s*([^\[\]]*?)\s*(?:\[([^\[\]]*)\])?\s*")


class PipeTable(Mapping[str, SceneLine]):
    """Pipes by name, node by node, each made only where it is looked up; scenes take one in place of their lines.

    Parameters
    ----------
    given : str or mapping
        Name of the file, or the columns themselves; what the scene says of its lines in a file.
    columns : mapping of str to sequence
        Columns of one length L. ``name`` (if missing, p1, p2, …), ``from`` and ``to``: pipes and the nodes at their
        ends. ``delay``, or ``length`` and ``wave_speed``; ``z0``, or ``density``, ``diameter`` and ``wave_speed``.
        ``friction.kind``, empty for none, and the keys of that friction, such as ``friction.factor``. A heading may
        have a unit, such as ``length [km]``; else a column is in SI.

    Raises
    ------
    InputError
        A column is missing, unknown or too short, or a value out of range; names the first pipe that is wrong.

    Examples
    --------
    >>> pipes = PipeTable("", {"from": ["a", "b"], "to": ["b", "c"], "z0": [2e6, 2e6], "delay [ms]": [80, 90]})
    >>> list(pipes), pipes["p2"].parameters.delay
    (['p1', 'p2'], 0.09)
    """

    def __init__(self, given: Any, columns: Mapping[str, Any]):
        self.given, self._cells, self._factors = given, dict[str, Any](), dict[str, tuple[float, str]]()
        for heading, cells in columns.items():
            key, unit = self._of_heading(heading)
            self._cells[key], self._factors[key] = cells, unit
        number = np.size(next(iter(columns.values()), ()))
        for key, cells in self._cells.items():
            if isinstance(cells, np.ndarray) and (cells.ndim != 1 or cells.dtype.kind not in "iufU"):
                got = f"{cells.dtype} in {cells.ndim} dimensions"
                raise InputError(place("lines", key), "not a column", "numbers or words in one dimension", got)
            if len(cells) != number:
                raise InputError(place("lines", key), "a column too short or too long", f"{number}", f"{len(cells)}")
        self.names = self._words("name") if "name" in self._cells else [f"p{k + 1}" for k in range(number)]
        if len({*self.names}) < number:
            again, _ = Counter(self.names).most_common(1)[0]
            raise InputError("lines", "a name that two pipes have", "another name", shown(again))
        known = dict[str, int]()
        pairs = zip(self._words("from"), self._words("to"), strict=True)
        each = [known.setdefault(node, len(known)) for pair in pairs for node in pair]
        ends = np.array(each, int).reshape(-1, 2)
        order = np.argsort(ends.min(axis=1), kind="stable")  # neighbours lie side by side in memory: a third faster
        self.nodes, self.ends = [*known], ends[order]  # names of nodes, and (L, 2) their numbers
        self.names = [self.names[k] for k in order.tolist()]
        self._cells = {key: [cells[k] for k in order.tolist()] for key, cells in self._cells.items()}
        self._determine()
        self._cells.clear()

    def __getitem__(self, name: str) -> SceneLine:
        k = self._number[name]
        table: dict[str, Any] = {"nodes": [self.nodes[node] for node in self.ends[k]]}
        kind = self.kinds[k]
        for key, values in self._values.items():
            part, _, own = key.rpartition(".")
            if not part:
                table[key] = float(values[k])
            elif kind and own in LAWS[kind].model_fields and not np.isnan(values[k]):
                table.setdefault("friction", {"kind": kind})[own] = float(values[k])
        context = {"medium": "hydraulic", "units": MEDIA["hydraulic"].units}
        return validator(Pipe).validate_python(table, context=context)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def at(self) -> dict[str, list[str]]:
        """Lines that end at each node, twice if with both ends."""
        found: dict[str, list[str]] = {node: [] for node in self.nodes}
        for name, (one, other) in zip(self.names, self.ends.tolist(), strict=True):
            found[self.nodes[one]].append(name)
            found[self.nodes[other]].append(name)
        return found

    @cached_property
    def _number(self) -> dict[str, int]:
        """Place of each pipe in the columns."""
        return {name: k for k, name in enumerate(self.names)}

    def density(self, name: str) -> float | None:
        """Density of the liquid in a pipe, kg/m³, if it is given."""
        return float(self._values["density"][self._number[name]]) if "density" in self._values else None

    def _of_heading(self, heading: str) -> tuple[str, tuple[float, str]]:
        """Key of a column, with the size and the name of its unit."""
        found = HEADING.fullmatch(heading)
        key, unit = (found[1], found[2] or "") if found else (heading, "")
        fields = {f"friction.{own}" for model in LAWS.values() for own in model.model_fields} - {"friction.unsteady"}
        if key not in {*WORDS, *ROLES, *fields}:
            raise InputError(place("lines"), "an unknown column", nearest(key, [*WORDS, *ROLES, *fields]), shown(key))
        if key in self._cells:
            raise InputError(place("lines"), "two columns of one name", "one of them", shown(key))
        try:
            return key, (to_si(f"1 {unit}", self._role(key).unit or "") if unit else 1.0, unit)
        except InputError as error:
            raise InputError(place("lines", key), error.problem, error.expected, error.got) from None

    @staticmethod
    def _role(key: str, kind: str = "") -> Role:
        """Role of a column."""
        own = key.removeprefix("friction.")
        models = [LAWS[kind]] if kind else [model for model in LAWS.values() if own in model.model_fields]
        if key == "friction.length" or key in ROLES:
            return ROLES[own]
        return next(each for model in models for each in model.model_fields[own].metadata if isinstance(each, Role))

    def _words(self, key: str) -> list[str]:
        """Names in a column."""
        if key not in self._cells:
            raise InputError("lines", "a column is missing", shown(key))
        cells = self._cells[key]
        found = [*map(str, cells.tolist() if isinstance(cells, np.ndarray) else cells)]
        if key != "friction.kind" and not ("".join(found).isprintable() and all(map(str.strip, found))):
            k = next(k for k, one in enumerate(found) if not is_name(one))
            expected = "letters, digits and other visible characters"
            raise InputError(place("lines", key), f"row {k + 1} has no name", expected, shown(found[k]))
        return found

    def _read(self, key: str, rows: NDArray, kind: str = "") -> NDArray:
        """Values of a column in SI at some rows, in range; others are not looked at. Shape (L,)."""
        if key not in self._cells:
            raise InputError("lines", "a column is missing", shown(key))
        cells, role, (factor, unit) = self._cells[key], self._role(key, kind), self._factors[key]
        try:
            values = factor * np.array(cells, float)
        except (ValueError, TypeError):
            values = np.array([factor * _number(cell) for cell in cells])
        least = SMALLEST if role.at_least is None else role.at_least
        if key.rpartition(".")[2] in OPTIONAL and kind:
            rows = rows[[str(cells[k]).strip() not in BLANK for k in rows]]
        for k in rows[~((values[rows] >= least) & (values[rows] <= role.at_most))]:
            where = place("lines", self.names[k], *key.split("."))
            typed = str(cells[k])
            try:
                role.parse(f"{typed} {unit}".strip(), role.unit)
            except InputError as error:
                raise InputError(where, error.problem, error.expected, error.got) from None
            raise InputError(where, f"{role.name} out of range", f"{least:g} to {role.at_most:g}", shown(typed))
        return values

    def _determine(self) -> None:
        """Impedances, delays, and what friction takes."""
        every = np.arange(len(self))
        self._values = {key: self._read(key, every) for key in ROLES if key in self._cells}
        own, known = self._values, self._values.keys()
        if not {"delay"} <= known and not {"length", "wave_speed"} <= known:
            raise InputError("lines", "the delay of pipes does not follow", "columns length and wave_speed, or delay")
        if not {"z0"} <= known and not {"density", "wave_speed", "diameter"} <= known:
            expected = "columns density, wave_speed and diameter, or z0"
            raise InputError("lines", "the impedance of pipes does not follow", expected)
        if {"delay", "length", "wave_speed"} <= known or {"z0", "density", "wave_speed", "diameter"} <= known:
            raise InputError("lines", "columns say a quantity in two ways", "one of them")
        area = pi * own["diameter"] ** 2 / 4 if "diameter" in own else None
        self.delay = own["delay"] if "delay" in own else own["length"] / own["wave_speed"]
        self.z0 = own["z0"] if "z0" in own else own["density"] * own["wave_speed"] / area
        for name, values in (("z0", self.z0), ("delay", self.delay)):
            for k in np.flatnonzero(~((values >= SMALLEST) & (values <= LARGEST)))[:1]:
                where, expected = place("lines", self.names[k]), f"{SMALLEST:g} to {LARGEST:g}"
                raise InputError(where, f"its {name} is out of range", expected, f"{values[k]:g}")
        self.length = own.get("length", np.zeros(len(self)))  # m; 0 where it is not known
        self.kinds = self._words("friction.kind") if "friction.kind" in self._cells else [""] * len(self)
        self.laws: list[tuple[NDArray, FlowLaw]] = []  # after the pipes that they are of
        kinds = np.array(self.kinds)
        for kind in np.unique(kinds[kinds != ""]).tolist():
            self.laws.append(self._law(kind, np.flatnonzero(kinds == kind), area))

    def _law(self, kind: str, rows: NDArray, area: NDArray | None) -> tuple[NDArray, FlowLaw]:
        """Law of the friction of a kind in some pipes."""
        if kind not in LAWS:
            where = place("lines", self.names[rows[0]], "friction", "kind")
            raise InputError(where, "unknown in a table", nearest(kind, [*LAWS]), shown(kind))
        for key in ("density", "diameter", "length"):
            if key not in self._values:
                raise InputError("lines", "friction needs its columns density, diameter and length", shown(key))
        fields = {name: f"friction.{name}" for name in LAWS[kind].model_fields}
        there = {name: key for name, key in fields.items() if key in self._cells or name not in OPTIONAL}
        values = {name: self._read(key, rows, kind) for name, key in there.items() if name != "kind"}
        self._values |= {fields[name]: each for name, each in values.items()}
        given = {name: each[rows] for name, each in values.items()}
        for name, usual in (("length", self.length[rows]), ("minor_loss", np.zeros(len(rows)))):
            given[name] = np.where(np.isnan(given[name]), usual, given[name]) if name in given else usual
        friction = LAWS[kind].model_construct(unsteady=None, **given)
        assert area is not None
        law = friction.flow_law(self._values["density"][rows], area[rows], self._values["length"][rows])
        parameters = {name: np.broadcast_to(each, rows.shape) for name, each in vars(law).items()}
        return rows, type(law)(**parameters)


def _number(cell: Any) -> float:
    try:
        return float(cell)
    except (ValueError, TypeError):
        return np.nan


def read_pipes(folder: Folder, given: str) -> PipeTable:
    """Read a table of pipes from a CSV file, whose first line has the headings, or from the arrays of an NPZ file."""
    try:
        return _read(folder.find(given), given)
    except InputError as error:
        where = "lines" if error.where == "file" else error.where
        raise SceneError([InputError(where, error.problem, error.expected, error.got)]) from None


def _arrays(path: Path, given: str) -> dict[str, NDArray]:
    """Arrays of an NPZ file, which would unpack to no unreasonable size."""
    try:
        with ZipFile(path) as packed:
            size = sum(each.file_size for each in packed.infolist())
        if size <= LARGEST_UNPACKED:
            with np.load(path, allow_pickle=False) as arrays:
                return {key: arrays[key] for key in arrays.files}
    except (ValueError, BadZipFile, OSError, EOFError, MemoryError, RuntimeError, zlib.error):
        raise InputError("lines", f"{shown(given)} is not a file of arrays", "one that numpy.savez wrote") from None
    raise InputError("lines", f"{shown(given)} is too large", f"at most {LARGEST_UNPACKED:,} bytes unpacked")


def _read(path: Path, given: str) -> PipeTable:
    if path.suffix.lower() == ".npz":
        return PipeTable(given, _arrays(path, given))
    rows = csv.reader(io.StringIO(read_text(path, "lines")))
    try:
        heading, *cells = (row for row in rows if row)
    except (csv.Error, ValueError):
        raise InputError(
            "lines", f"{shown(given)} is not a table", "a line of headings, and a line for each pipe"
        ) from None
    uneven = next((k for k, row in enumerate(cells) if len(row) != len(heading)), None)
    if uneven is not None or not cells:
        got = f"{len(cells[uneven])} in row {uneven + 1}" if uneven is not None else "no rows"
        raise InputError("lines", f"not as many cells as {shown(given)} has headings", f"{len(heading)}", got)
    columns: Sequence[tuple[str, ...]] = [*zip(*cells, strict=True)]
    if len({*heading}) < len(heading):
        raise InputError("lines", f"two columns of {shown(given)} have one name", "one of them")
    return PipeTable(given, dict(zip(heading, columns, strict=True)))
