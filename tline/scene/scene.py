"""A scene: lines, sources, loads and probes, an end time, and how finely to compute."""

from typing import Annotated, Any, Literal, get_args

from pydantic import Field, PlainValidator, SerializeAsAny, ValidationError, ValidationInfo

from tline.errors import InputError, SceneError
from tline.scene.check import conflicts, misplaced
from tline.scene.element import Element
from tline.scene.line import Cable, Pipe, SceneLine
from tline.scene.load import Load
from tline.scene.medium import MEDIA
from tline.scene.mistakes import mistakes
from tline.scene.quantity import Duration, Position
from tline.scene.source import Source
from tline.scene.waveform import Waveform
from tline.units import to_si


class Probe(Element):
    """Where effort, flow and waves are recorded: at a node, or at a position along a line.

    Where several lines meet, `line` says whose flow and waves are meant. A position is a distance from the
    line's end 1, or a share of its delay such as "25 %".
    """

    at: str | None = None
    line: str | None = None
    position: Position | None = None

    def fraction(self, line: SceneLine) -> float:
        """Place on the line as a share of its delay, from 0 at end 1 to 1 at end 2."""
        if self.position is None:
            return float(line.nodes[1] == self.at and line.nodes[0] != self.at)
        typed, length = self.position.typed, line.parameters.length
        if isinstance(typed, str) and "%" in typed:
            share = to_si(typed, "")
        elif length is None:
            raise InputError("position", "the line's length is not known", "a share such as '25 %'", repr(typed))
        else:
            share = to_si(typed, "m") / length
        if not 0 <= share <= 1 + 1e-12:
            raise InputError(
                "position", "not on the line", f"0 to {length:g} m" if length else "0 to 100 %", repr(typed)
            )
        return min(share, 1.0)


class Solver(Element):
    """Order and slab width, where they are to be fixed by hand."""

    order: int | None = Field(default=None, ge=1, le=16)
    slab: Duration | None = None


def _line_of_medium(value: Any, info: ValidationInfo) -> Any:
    kind = Pipe if (info.context or {}).get("medium") == "hydraulic" else Cable
    return kind.model_validate(value.table() if isinstance(value, Element) else value, context=info.context)


Line = Annotated[SerializeAsAny[SceneLine], PlainValidator(_line_of_medium, json_schema_input_type=Pipe | Cable)]


class Scene(Element):
    """What a user describes; immutable, and valid once it exists.

    Parameters
    ----------
    medium : str
        "hydraulic" or "electrical".
    t_end : number or text
        End time, s.
    lines, sources, loads, probes : dict
        Elements by name. Lines meet at the nodes they name, in any topology; a node with nothing else is closed.
    start : str
        "rest", or "steady": the state that the sources imply by what they are just before t = 0.
    solver : Solver
        Order and slab width, where they are to be fixed by hand.
    title : str
        Said in plots and files.

    Raises
    ------
    SceneError
        With every mistake of the scene, each naming its element.

    Examples
    --------
    >>> from tline.scene.source import Source
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns",
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": "50 ohm", "delay": "5 ns"}},
    ...     sources={"pulse": {"at": "near", "kind": "voltage", "value": "1 V", "resistance": "50 ohm"}},
    ...     probes={"far": {"at": "far"}},
    ... )
    >>> scene.lines["cable"].parameters.delay
    5e-09
    """

    title: str = ""
    medium: Literal["hydraulic", "electrical"]
    t_end: Duration
    start: Literal["rest", "steady"] = "rest"
    solver: Solver = Solver()
    lines: dict[str, Line]
    sources: dict[str, Source] = Field(default_factory=dict)
    loads: dict[str, Load] = Field(default_factory=dict)
    probes: dict[str, Probe]

    def __init__(self, *, folder: str = ".", **data: Any) -> None:
        """Validate everything and collect all mistakes; `folder` is where CSV tables are looked for."""
        context = {"medium": data.get("medium") if data.get("medium") in MEDIA else "", "folder": folder}
        found = []
        try:
            self.__pydantic_validator__.validate_python(data, self_instance=self, context=context)
        except ValidationError as error:
            found = mistakes(error, _models(context["medium"]))
        reported = {mistake.where for mistake in found}
        found += [mistake for mistake in misplaced(data) if mistake.where not in reported]
        if not found:
            found = list(conflicts(self))
        if found:
            raise SceneError(found)


def _models(medium: str) -> dict[str, type[Element]]:
    """The model behind each section of a scene, and behind each kind and shape."""
    models: dict[str, type[Element]] = {
        "": Scene,
        "solver": Solver,
        "lines": Pipe if medium == "hydraulic" else Cable,
        "sources": Source,
        "probes": Probe,
    }
    for union, word in ((Load, "kind"), (Waveform, "shape")):
        for model in get_args(get_args(union)[0]):
            for tag in get_args(model.model_fields[word].annotation):
                models[tag] = model
    return models
