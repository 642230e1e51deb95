"""Links of kind "ibis": models of an IBIS file between two pins, of type Series or Series_switch."""

from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.characteristic import Curve
from tline.scene.element import Between, OneMedium
from tline.scene.ibis.buffer import CurrentTable, above_zero, current_table, own_sections
from tline.scene.ibis.keywords import Section, sections_of
from tline.scene.rational import Ratio, RationalImpedance, exact
from tline.scene.text_file import beside, read_text
from tline.words.wording import shown

VALUES = {"r series": "ohm", "l series": "H", "rl series": "ohm", "c series": "F", "lc series": "H", "rc series": "ohm"}
OPEN = 1e12  # ohm, where nothing else is between the pins


class Joint(NamedTuple):
    """Impedance and table of current over voltage between two pins at one corner, side by side."""

    kind: str
    values: dict[str, float]  # of VALUES that are given
    table: CurrentTable | None
    notes: list[str]

    def ratio(self) -> Ratio:
        """R, beside R and L in series, beside R, L and C in series."""
        value = {name: exact(number) for name, number in self.values.items()}
        found = Ratio.of_fractions([value.get("r series", exact(OPEN))], [1])
        if "l series" in value:
            found = found.parallel(Ratio.of_fractions([value["l series"], value.get("rl series", 0)], [1]))
        if "c series" in value:
            C = value["c series"]
            own = [C * value.get("lc series", 0), C * value.get("rc series", 0), 1]
            found = found.parallel(Ratio.of_fractions(own, [C, 0]))
        return found


@lru_cache(maxsize=64)
def read_joint(path: Path, stamp: int, model: str | None, corner: str, on: bool | None) -> Joint:
    """Read a model between two pins; `stamp` is the file's time of modification, as a scene is read several times."""
    own = own_sections(sections_of(read_text(path, "file", legacy=True)), "model", model, "model")
    found = own[0].find("Model_type")
    kind = found[1][0].lower() if found and found[1] else ""
    if kind not in ("series", "series_switch"):
        raise InputError("model", "stands at one pin, a load", "one of type Series or Series_switch", shown(kind))
    if (on is None) == (kind == "series_switch"):
        problem = "is missing" if on is None else "is the state of a Series_switch"
        raise InputError("on", problem, "true or false" if on is None else "none")
    values, notes, table = {}, [], None
    for each in _of_state(own, on):
        if each.keyword in VALUES:
            values[each.keyword] = above_zero(each, corner, VALUES[each.keyword])
        elif each.keyword == "series current":
            table = current_table(each, corner, 0.0, kind, notes)
        elif each.keyword == "series mosfet":
            problem = f"line {each.line}: [Series MOSFET] is a law of the voltages of both pins"
            raise InputError("file", problem, "R, L, C and [Series Current]")
    return Joint(kind, values, table, notes)


def _of_state(own: list[Section], on: bool | None) -> list[Section]:
    """Sections of all states and of this one."""
    state, found = None, []
    for each in own:
        if each.keyword in ("on", "off"):
            state = each.keyword == "on"
        elif state is None or state == on:
            found.append(each)
    return found


class IbisSeries(OneMedium, RationalImpedance, Between):
    """Element between two pins of a chip as published by its maker, or a switch in one of its states.

    It becomes an impedance of the file's R, L and C, and a table of current over voltage beside it.

    References
    ----------
    ANSI/EIA-656-B, I/O Buffer Information Specification 4.2 and later, model types Series and Series_switch.
    """

    medium, instead = "electrical", "kind = 'impedance'"
    kind: Literal["ibis"] = "ibis"
    stores = True
    file: str = Field(description="IBIS file, looked for beside the scene file")
    model: str | None = Field(default=None, description="name of the model, if the file has several")
    corner: Literal["typ", "min", "max"] = Field(default="typ", description="column of the file's values")
    on: bool | None = Field(default=None, description="whether a Series_switch is on")
    _joint: Joint = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo):
        path = beside(self.file, info)
        try:
            stamp = path.stat().st_mtime_ns if path.is_file() else 0
            self._joint = read_joint(path, stamp, self.model, self.corner, self.on)
        except InputError as error:
            told = f"'{self.file}': {error.problem}" if error.where == "file" else error.problem
            raise InputError(error.where, told, error.expected, error.got) from None
        self._ratio = self._joint.ratio()
        return self

    @property
    def near(self) -> tuple[str, str]:
        """Nodes named in the scene."""
        return self.nodes

    @property
    def summary(self) -> str:
        """Summary of the file's model, in one line."""
        state = "" if self.on is None else f", {'on' if self.on else 'off'}"
        return "; ".join([f"{self.file}, model of type {self._joint.kind}, {self.corner}{state}", *self._joint.notes])

    def taken_apart(self, own: str) -> tuple[dict[str, dict[str, Any]], "IbisSeries"]:
        """Return the table of currents, named after the element, and the impedance."""
        table = self._joint.table
        if table is None:
            return {}, self
        points = list(zip(table.volts.tolist(), table.amps.tolist(), strict=True))
        name = own.partition(".")[2].strip('"')
        return {"links": {f"{name}, current": Curve(**{"nodes": self.nodes, "points": points})}}, self
