"""Links of kind "ibis": models of an IBIS file between two pins, of type Series or Series_switch."""

from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from pydantic import PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.characteristic import Curve
from tline.scene.element import Between, Composed, OneMedium, optional, required
from tline.scene.ibis.buffer import CurrentTable, above_zero, current_table, own_sections, read_once
from tline.scene.ibis.keywords import Section, sections_of
from tline.scene.rational import Ratio, RationalImpedance, exact
from tline.scene.text_file import read_text
from tline.words.wording import shown

VALUES = {"r series": "ohm", "l series": "H", "rl series": "ohm", "c series": "F", "lc series": "H", "rc series": "ohm"}
BEHIND = {"rl series": "l series", "lc series": "c series", "rc series": "c series"}  # in series; may be zero
OPEN = 1e12  # ohm, where nothing else is between the pins
Joint = tuple[Ratio, CurrentTable | None, list[str]]  # side by side an impedance and a table; notes


@lru_cache(maxsize=64)
def _read(path: Path, stamp: int, model: str | None, corner: str, on: bool | None) -> Joint:
    """Read a model between two pins; `stamp` is the file's time of modification, as a scene is read several times."""
    own = own_sections(sections_of(read_text(path, "file", legacy=True)), "model", model, "model")
    kind = own[0].first_word("Model_type")
    if kind not in ("series", "series_switch"):
        raise InputError("model", "stands at one pin, a load", "one of type Series or Series_switch", shown(kind))
    if (on is None) == (kind == "series_switch"):
        problem = "is missing" if on is None else "is the state of a Series_switch"
        raise InputError("on", problem, "true or false" if on is None else "none")
    values, notes, table = {}, [], None
    for each in _of_state(own, on):
        if each.keyword in VALUES:
            values[each.keyword] = exact(above_zero(each, corner, VALUES[each.keyword], each.keyword in BEHIND))
        elif each.keyword == "series current":
            table = current_table(each, corner, 0.0, kind, notes)
        elif each.keyword == "series mosfet":
            problem = f"line {each.line}: [Series MOSFET] is a law of the voltages of both pins"
            raise InputError("file", problem, "R, L, C and [Series Current]")
    if on is not None and (state := "on" if on else "off") not in {each.keyword for each in own}:
        notes.append(f"[{state.title()}] is not in the file")
    if not values and table is None:
        if on is not False:
            raise InputError("file", f"line {own[0].line}: nothing is between the pins", "R, L, C or [Series Current]")
        notes.append("nothing is between the pins: open")
    return _ratio(values), table, notes


def _ratio(value: dict[str, Fraction]) -> Ratio:
    """R, beside R and L in series, beside R, L and C in series."""
    found = Ratio.of_fractions([value.get("r series", exact(OPEN))], [1])
    if "l series" in value:
        found = found.parallel(Ratio.of_fractions([value["l series"], value.get("rl series", 0)], [1]))
    if C := value.get("c series"):
        own = [C * value.get("lc series", 0), C * value.get("rc series", 0), 1]
        found = found.parallel(Ratio.of_fractions(own, [C, 0]))
    return found


def _of_state(own: list[Section], on: bool | None) -> list[Section]:
    """Sections of all states and of this one, elements once and beside what they are in series with."""
    state, found = None, []
    for each in own:
        if each.keyword in ("on", "off"):
            state = each.keyword == "on"
        elif state is None or state == on:
            found.append(each)
    lines: dict[str, int] = {}
    for each in found:
        if each.keyword in (*VALUES, "series current") and lines.setdefault(each.keyword, each.line) != each.line:
            raise InputError("file", f"line {each.line}: a second [{each.keyword.title()}]", "one")
    for keyword, needed in BEHIND.items():
        if keyword in lines and needed not in lines:
            problem = f"line {lines[keyword]}: [{keyword.title()}] has nothing to be in series with"
            raise InputError("file", problem, f"[{needed.title()}] beside it")
    return found


class IbisSeries(Composed, OneMedium, RationalImpedance, Between):
    """Element between two pins of a chip as published by its maker, or a switch in one of its states.

    It becomes an impedance of the file's R, L and C, and a table of current over voltage beside it.

    References
    ----------
    ANSI/EIA-656-B, I/O Buffer Information Specification 4.2 and later, model types Series and Series_switch.
    """

    medium, instead = "electrical", "kind = 'impedance'"
    kind: Literal["ibis"] = "ibis"
    stores = True
    file: str = required("IBIS file, looked for beside the scene file")
    model: str | None = optional("name of the model, if the file has several")
    corner: Literal["typ", "min", "max"] = optional("column of the file's values", "typ")
    on: bool | None = optional("whether a Series_switch is on")
    _joint: Joint = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo):
        self._joint = read_once(_read, self.file, info, self.model, self.corner, self.on)
        self._ratio = self._joint[0]
        return self

    @property
    def near(self) -> tuple[str, str]:
        """Nodes named in the scene."""
        return self.nodes

    @property
    def summary(self) -> str:
        """Summary of the file's model, in one line."""
        return "; ".join([f"{self.file}, between pins ({self.corner})", *self._joint[2]])

    def taken_apart(self, own: str) -> tuple[dict[str, dict[str, Any]], "IbisSeries"]:
        """Return the table of currents, named after the element, and the impedance."""
        if (table := self._joint[1]) is None:
            return {}, self
        points = list(zip(table.volts.tolist(), table.amps.tolist(), strict=True))
        name = own.partition(".")[2].strip('"')
        return {"links": {f"{name}, current": Curve(**{"nodes": self.nodes, "points": points})}}, self
