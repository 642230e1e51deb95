"""Coupled conductors: one line with a node per conductor at either end; and the choice of a line model by medium."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from pydantic import (
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapSerializer,
    WrapValidator,
    model_validator,
)

from tline.errors import InputError
from tline.line.electrical import LIGHT, LIGHT_ROUNDING
from tline.line.modes import MixedModesError, Modes, even_and_odd, modes
from tline.scene.cable_loss import Skin
from tline.scene.element import Element, Name, nodes_of, optional, required
from tline.scene.line import Cable, Pipe, SceneLine, read_pipe
from tline.scene.mistakes import Read, mistakes, validator
from tline.scene.pipe_table import PipeTable
from tline.scene.quantity import (
    LARGEST,
    SMALLEST,
    ConductancePerMetre,
    Frequency,
    Length,
    Quantity,
    ResistancePerMetre,
    Role,
)
from tline.words.wording import shown

MOST_CONDUCTORS = 16  # conductors
Row = list[Annotated[Quantity, Role("inductance per length", "H/m")]]
RowOfC = list[Annotated[Quantity, Role("capacitance per length", "F/m")]]
RowOfR = list[Annotated[Quantity, Role("resistance per metre", "ohm/m")]]
RowOfG = list[Annotated[Quantity, Role("conductance per metre", "S/m")]]


Nodes = Annotated[tuple[Name, ...], nodes_of(MOST_CONDUCTORS, "one for each conductor")]


class OneMode(Element):
    """One mode of a pair of conductors: impedance of each conductor, delay, and losses."""

    z0: Annotated[Quantity, Role("z0", "ohm", above=0)] = required("of each conductor against the reference")
    delay: Annotated[Quantity, Role("delay", "s", above=0)] = required("time from end to end")
    resistance: ResistancePerMetre | None = optional("of each conductor to steady current, per metre")
    conductance: ConductancePerMetre | None = optional("of the insulation of each conductor, per metre")
    skin: Skin | None = optional("skin effect, by the resistance at a high frequency")


class SkinMatrix(Element):
    """Skin effect from the resistances at one high frequency."""

    resistance: list[RowOfR] = required("matrix, its rows, at that frequency")
    frequency: Frequency = required("far above the corner")
    added: bool = optional("whether it adds to the resistance to steady current, as in W elements of SPICE", False)


class Coupled(Element):
    """Coupled conductors over a common reference: matrices and a length, or two modes of a symmetric pair.

    Examples
    --------
    >>> pair = Coupled(
    ...     nodes1=["a1", "a2"], nodes2=["b1", "b2"],
    ...     even={"z0": "60 ohm", "delay": "1.1 ns"}, odd={"z0": "40 ohm", "delay": "0.9 ns"},
    ... )
    >>> pair.modes.z0.tolist(), pair.nodes
    ([60.0, 40.0], ('a1', 'a2', 'b1', 'b2'))
    """

    nodes1: Nodes = required("nodes at end 1, one for each conductor")
    nodes2: Nodes = required("nodes at end 2, in the same order")
    inductance: list[Row] | None = optional("matrix L, its rows")
    capacitance: list[RowOfC] | None = optional(
        "matrix C (Maxwell's: what is between two conductors counts negative), its rows"
    )
    length: Length | None = optional("length; with even and odd where these lose something")
    resistance: list[RowOfR] | None = optional(
        "matrix R to steady currents, its rows; what conductors share is beside the diagonal"
    )
    conductance: list[RowOfG] | None = optional("matrix G (Maxwell's), its rows")
    skin: SkinMatrix | None = optional("skin effect, by the resistances at a high frequency")
    even: OneMode | None = optional("of two alike: z0 and delay where both voltages are the same")
    odd: OneMode | None = optional("of two alike: z0 and delay where the voltages are opposite")
    _modes: Modes = PrivateAttr()
    _lines: list[dict[str, Any]] = PrivateAttr()
    _mixing: bool = PrivateAttr(default=False)

    @property
    def modes(self) -> Modes:
        """Modes of the line."""
        return self._modes

    @property
    def lines(self) -> list[dict[str, Any]]:
        """Tables of the modes as single lines, without nodes."""
        return self._lines

    @property
    def mixing(self) -> bool:
        """Whether losses couple the modes; the modes are then those of the lossless line."""
        return self._mixing

    @property
    def nodes(self) -> tuple[str, ...]:
        """All nodes, those of end 1 first."""
        return (*self.nodes1, *self.nodes2)

    @property
    def shortest(self) -> float:
        """Delay of the fastest mode, s."""
        return float(self._modes.delay.min())

    @property
    def faster_than_light(self) -> bool:
        """Whether the length is known and too long for the fastest mode."""
        return self.length is not None and self.length > self.shortest * LIGHT * (1 + LIGHT_ROUNDING)

    @property
    def losses(self) -> None:
        """No losses of the line as a whole: its modes have them."""

    @property
    def parameters(self):
        """Parameters of a single line, which coupled conductors do not have.

        Raises
        ------
        InputError
            Always: each mode has its own.
        """
        raise InputError(
            "lines", "coupled conductors have parameters of each mode, and none as a whole", "single lines"
        )

    @model_validator(mode="after")
    def _settle(self):
        k = len(self.nodes1)
        if len(self.nodes2) != k:
            raise InputError("nodes2", "another number of conductors", f"{k}", f"{len(self.nodes2)}")
        given = {key for key, value in self if value is not None and not key.startswith("nodes")}
        matrices = given - {"resistance", "conductance", "skin"} == {"inductance", "capacitance", "length"}
        if given - {"length"} == {"even", "odd"} and self.even and self.odd:
            self._modes, self._lines = self._of_pair(self.even, self.odd)
        elif matrices and self.inductance and self.capacitance and self.length:
            self._modes, self._lines = self._of_matrices(self.inductance, self.capacitance, float(self.length))
        else:
            expected = "inductance, capacitance and length, or even and odd"
            raise InputError("", "is not given once", expected, ", ".join(sorted(given)) or "none")
        if len(self._modes.z0) != k:
            raise InputError("nodes1", "another number of conductors", f"{len(self._modes.z0)}", f"{k}")
        for value in (*self._modes.z0, *self._modes.delay):
            if not SMALLEST <= value <= LARGEST:
                raise InputError(
                    "", "a mode's z0 or delay is out of range", f"{SMALLEST:g} to {LARGEST:g}", f"{value:g}"
                )
        self._check_modes()
        return self

    def _check_modes(self) -> None:
        """Validate each mode as a line of its own, so that its mistakes are reported on input."""
        for k, table in enumerate(self._lines, 1):
            try:
                Cable.model_validate({"nodes": ("end 1", "end 2")} | table)
            except ValidationError as error:
                found = mistakes(error, Cable)[0]
                raise InputError(found.where, f"of mode {k}: {found.problem}", found.expected, found.got) from None

    def _of_pair(self, even: OneMode, odd: OneMode) -> tuple[Modes, list[dict[str, Any]]]:
        tables = [even.table(), odd.table()]
        lossy = sorted({key for table in tables for key in table} - {"z0", "delay"})
        if bool(lossy) != (self.length is not None):
            problem = f"{lossy[0]} needs its length" if lossy else "is given, and no loss needs it"
            raise InputError("length", problem, got="none" if lossy else f"{self.length:g}")
        found = even_and_odd(*((float(mode.z0), float(mode.delay)) for mode in (even, odd)))
        return found, [table | ({"length": self.length} if len(table) > 2 else {}) for table in tables]

    def _of_matrices(self, L: list[Row], C: list[RowOfC], length: float) -> tuple[Modes, list[dict[str, Any]]]:
        resistances = {"resistance": self.resistance, "skin.resistance": self.skin and self.skin.resistance}
        resistances = {name: matrix for name, matrix in resistances.items() if matrix is not None}
        conductances = {"conductance": self.conductance} if self.conductance else {}
        try:
            found = modes(L, C, length, resistances, conductances)
        except MixedModesError:
            found, self._mixing = modes(L, C, length), True
        tables = []
        for k, (z0, delay) in enumerate(zip(found.z0.tolist(), found.delay.tolist(), strict=True)):
            losses: dict[str, Any] = {name: float(loss[k]) for name, loss in found.losses.items() if loss[k]}
            if self.skin and (high := losses.pop("skin.resistance", 0.0)):
                losses["skin"] = self.skin.table() | {"resistance": high}
            tables.append({"z0": z0, "delay": delay} | ({"length": length} if losses or self._mixing else {}) | losses)
        return found, tables


class End(NamedTuple):
    """One end of coupled conductors: the nodes of its conductors, and those of its modes."""

    conductors: tuple[str, ...]
    modal: tuple[str, ...]
    modes: Modes
    lines: list[dict[str, Any]]


def ends_of(lines: Mapping[str, SceneLine | Coupled]) -> list[End]:
    """Ends of all coupled lines, end 1 and end 2 of each in turn; tables of pipes have none."""
    if isinstance(lines, PipeTable):
        return []
    return [
        End(nodes, tuple(f"{name}, mode {m + 1}, end {end}" for m in range(len(nodes))), line.modes, line.lines)
        for name, line in lines.items()
        if isinstance(line, Coupled)
        for end, nodes in ((1, line.nodes1), (2, line.nodes2))
    ]


def single_lines(lines: Mapping[str, SceneLine]) -> Mapping[str, SceneLine]:
    """Lines, with one for each mode, between nodes of its own, in place of coupled ones."""
    ends = ends_of(lines)
    if not ends:
        return lines
    found = {name: line for name, line in lines.items() if not isinstance(line, Coupled)}
    for one, other in zip(ends[::2], ends[1::2], strict=True):
        for first, second, table in zip(one.modal, other.modal, one.lines, strict=True):
            found[first.removesuffix(", end 1")] = Cable.model_validate({"nodes": (first, second)} | table)
    return found


def _line_of_medium(value: Any, info: ValidationInfo) -> Any:
    context = info.context or {}
    medium = context.get("medium")
    if "bar" in context:
        context["bar"].update()
    if medium is None:
        return value  # a mistake in itself; lines cannot be judged before the medium is known
    kind = Pipe if medium == "hydraulic" else Cable
    if medium == "electrical" and (isinstance(value, Coupled) or (isinstance(value, dict) and "nodes1" in value)):
        kind = Coupled
    if isinstance(value, Element) and not isinstance(value, kind):
        known = type(value).__name__
        raise InputError("", f"not a line of {medium} scenes", f"a table or a {kind.__name__}", f"a {known}")
    if type(value) is Pipe:
        return value  # it was read before, and nothing in it depends on where it stands
    return read_pipe(value, context) if kind is Pipe else validator(kind).validate_python(value, context=context)


# Coupled takes the place of a line: it has nodes and a shortest delay, and its parameters refuse
Line = Annotated[SceneLine, Read(_line_of_medium, Pipe | Cable | Coupled)]


def _table_or_each(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """Take a table of pipes as it is."""
    if isinstance(value, str):
        raise InputError("", "a table of pipes is for hydraulic scenes", "tables of lines", shown(value))
    return value if isinstance(value, PipeTable) else handler(value)


def _as_given(value: Any, handler: SerializerFunctionWrapHandler) -> Any:
    return value.given if isinstance(value, PipeTable) else handler(value)


Lines = Annotated[
    dict[Name, Line],
    WrapValidator(_table_or_each),
    WrapSerializer(_as_given),
    Field(json_schema_extra={"type": ["object", "string"]}),
]
