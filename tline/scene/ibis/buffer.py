"""Model of an IBIS file at one corner, as numbers: tables of voltage and current, capacitance, edges, package."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo

from tline.errors import InputError
from tline.scene.ibis.keywords import (
    CORNERS,
    MOST,
    Section,
    at_corner,
    number_of,
    sections_of,
    table_of,
    without_far_ends,
)
from tline.scene.text_file import beside, read_text
from tline.words.wording import nearest, shown

TABLES = ("pullup", "pulldown", "power clamp", "gnd clamp")
RLC = ("ohm", "H", "F")
FIXTURE = {
    "r_fixture": "ohm", "v_fixture": "V", "c_fixture": "F", "l_fixture": "H", "r_dut": "ohm", "l_dut": "H",
    "c_dut": "F",
}  # fmt: skip
LEFT_OUT_OF_WAVEFORMS = ("l_fixture", "r_dut", "l_dut", "c_dut")
PLAUSIBLE_RANGE = 10  # times the larger of supply and fixture: largest plausible voltage of a waveform
WORDS = frozenset((*FIXTURE, "v_fixture_min", "v_fixture_max"))
OPEN = {"open_drain", "open_sink", "open_source"}
ALWAYS = {"output", "output_ecl", *OPEN}  # types that cannot be switched off
DRIVING = {"output", "3-state", "i/o", *OPEN, *(f"i/o_{word}" for word in OPEN)}
DRIVING |= {f"{word}_ecl" for word in ("output", "3-state", "i/o")}
KINDS = DRIVING | {"input", "input_ecl", "terminator"}
LEFT_OUT = "driver schedule", "algorithmic model", "initial delay", "ttgnd", "ttpower"
SMALLEST_CAPACITANCE = 1e-15  # F, smallest capacitance of a die, as its voltage is a state
MODES = "driving", "non-driving", "all"  # of submodels
MATRICES = "resistance matrix", "inductance matrix", "capacitance matrix"
TERMINATING = {"rgnd": "gnd clamp", "rpower": "power clamp"}  # resistors, by the clamp that has the same reference


class CurrentTable(NamedTuple):
    """Current into the component over a voltage that counts from a reference, upwards or downwards."""

    reference: float  # V
    downwards: bool  # whether the voltage is the reference's less the die's, as for tables that lead to a supply
    volts: NDArray
    amps: NDArray

    def current(self, u: NDArray) -> NDArray:
        """Current at a voltage of the die, with the end segments extrapolated."""
        v = self.reference - u if self.downwards else u - self.reference
        k = np.clip(np.searchsorted(self.volts, v) - 1, 0, len(self.volts) - 2)
        slope = (self.amps[k + 1] - self.amps[k]) / (self.volts[k + 1] - self.volts[k])
        return self.amps[k] + slope * (v - self.volts[k])


class EdgeWaveform(NamedTuple):
    """Voltage of the die over time after an edge, with a load resistance to a fixed voltage."""

    rises: bool
    resistance: float
    toward: float
    capacitance: float
    t: NDArray
    u: NDArray


class Buffer(NamedTuple):
    """One model at one corner."""

    name: str
    kind: str  # type, in small letters
    capacitance: float  # of the die
    supply: float
    tables: dict[str, CurrentTable]
    ramps: dict[bool, float]  # time of a whole swing, of rises and falls
    waveforms: list[EdgeWaveform]
    package: tuple[float, float, float]  # R, L, C
    damper: tuple[float, float]  # R and C in series from the die to earth, C = 0 for none
    notes: list[str]


def read_once(read: Callable[..., Any], file: str, info: ValidationInfo, *asked: Any) -> Any:
    """Read a model of a file beside the scene's, once for each time of modification; errors name the file."""
    path = beside(file, info)
    try:
        return read(path, path.stat().st_mtime_ns if path.is_file() else 0, *asked)
    except InputError as error:
        told = f"'{file}': {error.problem}" if error.where == "file" else error.problem
        raise InputError(error.where, told, error.expected, error.got) from None


def read_buffer(
    path: Path, model: str | None, pin: str | None, component: str | None, corner: str, drives: bool = False
) -> Buffer:
    """Read a model by its name, or by that of a pin, at a corner; submodels are there as it drives or not."""
    sections = sections_of(read_text(path, "file", legacy=True))
    package = _package(_component(sections, component), sections, corner, pin)
    name = model or _model_of(sections, component, pin)
    own = own_sections(sections, "model", name, "model")
    added, notes = _submodels(sections, own, "driving" if drives else "non-driving")
    return _buffer(own, added, corner, package, notes)


def _submodels(sections: Sequence[Section], own: Sequence[Section], mode: str) -> tuple[list[Section], list[str]]:
    """Clamps that submodels add in a mode, and notes on submodels that change with the signal."""
    added, notes = [], []
    for line, row in (row for each in own if each.keyword == "add submodel" for row in each.rows):
        if len(row) > 1 and row[1].lower() not in MODES:
            problem = f"line {line}: not a mode of a submodel"
            raise InputError("file", problem, "Driving, Non-Driving or All", shown(row[1]))
        if len(row) > 1 and row[1].lower() not in ("all", mode):
            continue
        parts = own_sections(sections, "submodel", row[0], "file")
        if parts[0].first_word("Submodel_type") != "dynamic_clamp" or any("pulse" in each.keyword for each in parts):
            notes.append(f"submodel {row[0]} changes with the signal and is left out")
            continue
        added += [each for each in parts if each.keyword in TERMINATING.values()]
        notes += [f"[{each.keyword.title()}] of a submodel is left out" for each in parts if each.keyword in TABLES[:2]]
    return added, notes


def own_sections(sections: Sequence[Section], keyword: str, name: str | None, key: str) -> list[Section]:
    """Sections of a keyword with that name, and those up to the next of its kind."""
    ends = ("component", "model", "model selector", "submodel", "define package model", "external circuit", "end")
    begins = [k for k, each in enumerate(sections) if each.keyword == keyword]
    names = [" ".join(sections[k].words[:1]) for k in begins]
    if name is None and len(begins) > 1:
        raise InputError(key, "is missing", " or ".join(map(repr, names[:6])))
    if not begins or (name is not None and name not in names):
        raise InputError(key, f"no such [{keyword.title()}] in the file", nearest(name or "", names), shown(name))
    first = begins[0 if name is None else names.index(name)]
    last = next((k for k in range(first + 1, len(sections)) if sections[k].keyword in ends), len(sections))
    return list(sections[first:last])


def _component(sections: Sequence[Section], component: str | None) -> list[Section]:
    if component is None and not any(each.keyword == "component" for each in sections):
        return []
    several = sum(each.keyword == "component" for each in sections) > 1
    return [] if component is None and several else own_sections(sections, "component", component, "component")


def _rows_of_pins(own: Sequence[Section]) -> dict[str, tuple[int, list[str], list[str]]]:
    """Line number, words and columns of each pin."""
    for each in own:
        if each.keyword == "pin":
            return {row[0]: (line, row, [word.lower() for word in each.words]) for line, row in each.rows}
    return {}


def _model_of(sections: Sequence[Section], component: str | None, pin: str | None) -> str | None:
    """Name of the model at a pin; None if no pin is named."""
    if pin is None:
        return None
    pins = _rows_of_pins(own_sections(sections, "component", component, "component"))
    if pin not in pins:
        raise InputError("pin", "no such pin in the file", nearest(pin, list(pins)), shown(pin))
    _, row, _ = pins[pin]
    name = row[2] if len(row) > 2 else ""
    for each in sections:
        if each.keyword == "model selector" and each.words[:1] == [name]:
            names = [words[0] for _, words in each.rows]
            raise InputError("model", f"pin {shown(pin)} has several", " or ".join(map(repr, names[:6])), "none chosen")
    return name


def _package(
    own: Sequence[Section], sections: Sequence[Section], corner: str, pin: str | None
) -> tuple[float, float, float]:
    """R, L and C of a pin, by its package model or its row, or of the package where the pin has none."""
    found = [0.0, 0.0, 0.0]
    for each in own:
        if each.keyword == "package":
            for k, name in enumerate(("R_pkg", "L_pkg", "C_pkg")):
                if row := each.find(name):
                    found[k] = at_corner(row[1], corner, row[0], RLC[k])
    if pin is not None and pin in (pins := _rows_of_pins(own)):
        line, row, columns = pins[pin]
        for k, name in enumerate(("r_pin", "l_pin", "c_pin")):
            at = columns.index(name) + 1 if name in columns else len(row)
            if at < len(row) and row[at].upper() != "NA":
                found[k] = number_of(row[at], line, RLC[k])
        for name in (each.words[0] for each in own if each.keyword == "package model" and each.words):
            found = _of_package_model(own_sections(sections, "define package model", name, "file"), pin, found)
    if min(found) < 0:
        raise InputError("file", "R, L or C of the package is negative", "zero or more", f"{min(found):g}")
    return found[0], found[1], found[2]


def _of_package_model(own: Sequence[Section], pin: str, found: list[float]) -> list[float]:
    """R, L and C of a pin by the sections of its lead, or by the diagonals of matrices, in which rows begin."""
    found, k, sparse = list(found), 0, False
    for each in own:
        if each.keyword == "pin numbers":
            for line, row in each.rows:
                if row[0] != pin:
                    continue
                found, length = [0.0, 0.0, 0.0], 0.0
                for name, value in zip(map(str.lower, row[1:]), row[2:], strict=False):
                    if name == "len":
                        length = number_of(value, line, "") or 1.0
                    elif name in ("r", "l", "c"):
                        found["rlc".index(name)] += length * number_of(value, line, RLC["rlc".index(name)])
        elif each.keyword in MATRICES:
            k, sparse = MATRICES.index(each.keyword), "sparse" in " ".join(each.words).lower()
        elif each.keyword == "row" and each.words[:1] == [pin] and each.rows:
            line, row = each.rows[0]
            found[k] = number_of(row[min(int(sparse), len(row) - 1)], line, RLC[k])
    return found


def _buffer(
    own: Sequence[Section],
    added: Sequence[Section],
    corner: str,
    package: tuple[float, float, float],
    notes: list[str],
) -> Buffer:
    """Build a model from its keywords, and tables that are added."""
    head = own[0]
    notes = [*notes, *(f"[{each.keyword.title()}] is left out" for each in own if each.keyword in LEFT_OUT)]
    kind = head.first_word("Model_type")
    if kind in ("series", "series_switch"):
        raise InputError("model", f"of type '{kind}', it joins two pins", "a link of kind = 'ibis'")
    if kind not in KINDS:
        raise InputError("model", "a type that is not known here", ", ".join(sorted(KINDS)), shown(kind))
    for each in own:
        if each.keyword == "external model":
            problem = f"line {each.line}: the model is a program of its own, an [External Model]"
            raise InputError("file", problem, "tables of voltage and current")
    capacitance = _capacitance(own, corner, notes)
    supply, references = _references(own, corner, kind)
    tables = _tables(own, added, corner, kind, references, notes)
    single = {each.keyword: each for each in own if each.keyword in ("rac", "cac")}
    damper = (0.0, 0.0)
    if "cac" in single:
        R = above_zero(single["rac"], corner, "ohm") if "rac" in single else 0.0
        damper = R, above_zero(single["cac"], corner, "F")
    ramps = next((_ramps(each, corner) for each in own if each.keyword == "ramp"), {})
    edges = ("rising waveform", "falling waveform")
    waveforms = [_waveform(each, corner, supply, notes) for each in own if each.keyword in edges]
    name = head.words[0] if head.words else ""
    return Buffer(
        name, kind, capacitance, supply, tables, ramps, waveforms, package, damper, list(dict.fromkeys(notes))
    )


def _capacitance(own: Sequence[Section], corner: str, notes: list[str]) -> float:
    """Capacitance of the die, F, above zero."""
    capacitances = next((each for each in own if each.keyword == "c comp corner"), own[0])
    row = capacitances.find("C_comp") or own[0].find("C_comp")
    if row is None:
        raise InputError("file", f"line {own[0].line}: the model has no C_comp", "C_comp and its capacitance")
    capacitance = at_corner(row[1], corner, row[0], "F")
    if capacitance < 0:
        raise InputError("file", f"line {row[0]}: C_comp is below zero", "a capacitance", " ".join(row[1]))
    if not capacitance:
        notes.append(f"C_comp is 0, taken as {SMALLEST_CAPACITANCE:g} F")
    return capacitance or SMALLEST_CAPACITANCE


def _references(own: Sequence[Section], corner: str, kind: str) -> tuple[float, dict[str, float]]:
    """Supply, and the voltage from which each table counts."""
    volts = {each.keyword: at_corner(each.words, corner, each.line, "V") for each in own if _is_voltage(each)}
    supply = volts.get("voltage range", volts.get("pullup reference"))
    if supply is None:
        raise InputError("file", f"line {own[0].line}: the model has no supply", "[Voltage Range]")
    references = {
        "pullup": volts.get("pullup reference", supply),
        "pulldown": volts.get("pulldown reference", 0.0),
        "power clamp": volts.get("power clamp reference", supply),
        "gnd clamp": volts.get("gnd clamp reference", 0.0),
    }
    if kind.endswith("_ecl"):  # its pull-down, too, counts from the upper supply, downwards
        references["pulldown"] = references["pullup"]
    return supply, references


def _tables(
    own: Sequence[Section],
    added: Sequence[Section],
    corner: str,
    kind: str,
    references: dict[str, float],
    notes: list[str],
) -> dict[str, CurrentTable]:
    """Tables of the model, those that are added, and its resistors to the references of clamps."""
    tables = {
        each.keyword: current_table(each, corner, references[each.keyword], kind, notes)
        for each in own
        if each.keyword in TABLES
    }
    for each in added:
        tables[f"{each.keyword} {each.line}"] = current_table(each, corner, references[each.keyword], kind, notes)
    single = {each.keyword: each for each in own if each.keyword in TERMINATING}
    for name, clamp in TERMINATING.items():
        if name in single:
            amps = np.array([0.0, 1 / above_zero(single[name], corner, "ohm")])
            down = name == "rpower"
            tables[name] = CurrentTable(references[clamp], down, np.array([0.0, 1.0]), -amps if down else amps)
    return tables


def above_zero(section: Section, corner: str, unit: str, or_zero: bool = False) -> float:
    """Read the value of a keyword, above zero or zero."""
    value = at_corner(section.words, corner, section.line, unit)
    if value < 0 or (value == 0 and not or_zero):
        problem = "is below zero" if or_zero else "is not above zero"
        raise InputError("file", f"line {section.line}: [{section.keyword}] {problem}", f"a number of {unit}")
    return value


def _is_voltage(section: Section) -> bool:
    return section.keyword == "voltage range" or section.keyword in {f"{name} reference" for name in TABLES}


def current_table(section: Section, corner: str, reference: float, kind: str, notes: list[str]) -> CurrentTable:
    """Read a current table, replaced by the nearest one whose current rises with the voltage toward its reference."""
    if far := len(section.rows) - len((section := without_far_ends(section)).rows):
        notes.append(f"[{section.keyword.title()}] has {far} rows beyond {MOST['A']:g} A, which are left out")
    rows = sorted(dict(table_of(section, corner, ("V", "A"))).items())
    if len(rows) < 2:
        raise InputError("file", f"line {section.line}: [{section.keyword}] has one voltage only", "two or more")
    volts, amps = np.array(rows).T
    downwards = section.keyword in ("pullup", "power clamp") or (
        kind.endswith("_ecl") and section.keyword == "pulldown"
    )
    sign = -1.0 if downwards else 1.0
    rising = sign * _monotone(sign * amps)
    off = float(np.abs(rising - amps).max())
    if off > 0:
        notes.append(
            f"[{section.keyword.title()}] does not rise throughout: taken as the nearest that does, within {off:.2g} A"
        )
    return CurrentTable(reference, downwards, volts, rising)


def _monotone(y: NDArray) -> NDArray:
    """The nearest values that do not fall, by pooling neighbours that do (least squares).

    Examples
    --------
    >>> _monotone(np.array([0.0, 2.0, 1.0, 3.0])).tolist()
    [0.0, 1.5, 1.5, 3.0]
    """
    pools: list[tuple[float, int]] = []
    for value in y.tolist():
        pools.append((value, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (a, m), (b, n) = pools[-2:]
            pools[-2:] = [((a * m + b * n) / (m + n), m + n)]
    return np.repeat([value for value, _ in pools], [count for _, count in pools])


def _ramps(section: Section, corner: str) -> dict[bool, float]:
    """Times of whole swings from those between 20 and 80 percent."""
    found = {}
    for name, rises in (("dV/dt_r", True), ("dV/dt_f", False)):
        if row := section.find(name):
            line, words = row
            k = CORNERS.index(corner)
            word = words[k] if k < len(words) and words[k].upper() != "NA" else words[0] if words else ""
            _, _, duration = word.partition("/")
            time = number_of(duration, line, "s")
            if time <= 0:
                raise InputError("file", f"line {line}: an edge takes no time", "volts over seconds", shown(word))
            found[rises] = time / 0.6
    return found


def _waveform(section: Section, corner: str, supply: float, notes: list[str]) -> EdgeWaveform:
    """A table of voltage over time with its fixture."""
    known = {name: section.find(name) for name in FIXTURE}
    value = {
        name: number_of(row[1][0], row[0], FIXTURE[name]) if row and row[1] else 0.0 for name, row in known.items()
    }
    if (row := section.find(f"v_fixture_{corner}")) and row[1] and row[1][0].upper() != "NA":
        value["v_fixture"] = number_of(row[1][0], row[0], "V")
    if value["r_fixture"] <= 0:
        raise InputError("file", f"line {section.line}: a waveform without R_fixture", "R_fixture = and a resistance")
    notes += [f"{name} of a waveform is left out" for name in LEFT_OUT_OF_WAVEFORMS if value[name]]
    t, u = np.array(table_of(section, corner, ("s", "V"), WORDS)).T
    if (np.diff(t) <= 0).any():
        raise InputError("file", f"line {section.line}: times of the waveform do not rise", "instants in order")
    largest = PLAUSIBLE_RANGE * max(abs(supply), abs(value["v_fixture"]))
    if np.abs(u).max() > largest:
        problem = f"line {section.line}: the waveform is not plausible"
        raise InputError("file", problem, f"at most {largest:g} V in size", f"{u[np.abs(u).argmax()]:g}")
    rises = section.keyword == "rising waveform"
    return EdgeWaveform(rises, value["r_fixture"], value["v_fixture"], value["c_fixture"], t, u)
