"""Scenes: lines, sources, loads and probes, an end time, and the accuracy."""

from collections.abc import Mapping
from functools import cached_property
from math import nan
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from tline.errors import InputError, SceneError
from tline.gc_paused import gc_paused
from tline.scene.check import conflicts, misplaced
from tline.scene.coupled import Lines, single_lines
from tline.scene.display import as_html, as_text, drawn
from tline.scene.element import Composed, Element, Measured, Name, optional, required
from tline.scene.heights import GRAVITY, Height, Site, heights_of
from tline.scene.law import ElementLaw, NonLinear
from tline.scene.line import Cable, Pipe, SceneLine
from tline.scene.load import Link, Load
from tline.scene.measure import Measure, Probe
from tline.scene.medium import MEDIA, check_units
from tline.scene.mistakes import MOST_MISTAKES, limited, mistakes, validator
from tline.scene.pipe_table import PipeTable, read_pipes
from tline.scene.quantity import Duration, Effort
from tline.scene.refuse import refuse_cavities
from tline.scene.shape import Shape
from tline.scene.solver import Solver
from tline.scene.source import Source
from tline.scene.text_file import Folder
from tline.scene.user_defined import user_elements
from tline.words.progress import Progress
from tline.words.wording import one_line, place, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHORT = 1e-30  # s, replaces an invalid end time; so short that no waveform has too many breaks


class Scene(Element):
    """Description of a network and its run; immutable, and valid once it exists.

    Parameters
    ----------
    folder : str or Folder, by position
        Where CSV tables and Touchstone files are looked for; without it the working folder.
    progress : bool, by position
        Show a progress bar on stderr if reading the lines takes more than two seconds.
    medium : str
        "hydraulic" or "electrical".
    t_end : number or text
        End time, s; a run goes on to the end of its last slab.
    lines, sources, loads, links, probes, measures : dict
        Elements by name. Lines meet at the nodes they name, in any topology; a node with nothing else is closed. Nodes
        that only links, loads and sources name are part of the circuits between lines.
    nodes : dict
        Elevation and position of nodes by name, where they are known.
    rating : number or text
        Largest pressure or voltage that all lines are made for; runs note where it is exceeded.
    start : str
        "rest": the liquid stands still, filled up to the highest node; or "steady": the state that the sources imply by
        their values just before t = 0.
    solver : Solver
        The tolerance (1e-6 without it), or order and slab width, where they are to be fixed by hand.
    units : str
        In which results are read: "SI", "US" (psi, gpm, ft), units of single quantities such as "m^3/h", or "US, MGD".
    title : str
        Shown in plots and files, in one line: control characters and line breaks become spaces.

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

    title: Annotated[str, AfterValidator(one_line)] = optional("said in plots and files", "")
    medium: Literal["hydraulic", "electrical"] = required("what the lines carry")
    t_end: Duration = required("end time; a run goes on to the end of its last slab")
    start: Literal["rest", "steady"] = optional(
        "state before t = 0: nothing moves, the liquid filled up to the highest node; or the steady state "
        "that the sources imply",
        "rest",
    )
    solver: Solver = optional("tolerance; or order and slab width, if fixed by hand", Solver())
    lines: Lines = required("lines by name; or a CSV or NPZ file with a table of pipes")
    sources: dict[Name, Source] = Field(default_factory=dict, description="sources by name")
    loads: dict[Name, Load] = Field(default_factory=dict, description="loads by name")
    links: dict[Name, Link] = Field(default_factory=dict, description="what stands between nodes, by name")
    probes: dict[Name, Probe] = required("probes by name")
    measures: dict[Name, Measure] = Field(default_factory=dict, description="numbers read off probes, by name")
    nodes: dict[Name, Site] = Field(default_factory=dict, description="height and place of nodes, by name")
    rating: Effort | None = optional("largest pressure or voltage that all lines are made for")
    units: Annotated[str, AfterValidator(check_units)] = optional(
        "in which results are read: 'SI', 'US', or units such as 'US, MGD' or 'm^3/h'", "SI"
    )

    _folder: Folder = PrivateAttr(default=Folder())
    _parts: set[tuple[str, str]] = PrivateAttr(default_factory=set)  # of elements from files, by section and name

    def __init__(self, folder: str | Folder = ".", progress: bool = False, /, **data: Any) -> None:
        """Validate everything and collect all mistakes."""
        if not isinstance(folder, str | Path | Folder):
            raise InputError("", "not a folder", "keywords, such as Scene(**tables)", shown(folder))
        folder = folder if isinstance(folder, Folder) else Folder(Path(folder))
        medium = data.get("medium")
        known = MEDIA.get(medium) if isinstance(medium, str) else None
        lines = data.get("lines")
        if isinstance(lines, str) and medium == "hydraulic":
            data["lines"] = read_pipes(folder, lines)
        count = len(lines) if isinstance(lines, dict) else 0
        bar = Progress(count, "line", progress, "reading")
        context = {"folder": folder, "bar": bar} | ({"medium": medium, "units": known.units} if known else {})
        models = {
            "lines": Pipe if medium == "hydraulic" else Cable,
            "sources": Source,
            "probes": Probe,
            "nodes": Site,
            "solver": Solver,
        }
        with gc_paused(), bar:
            try:
                validator(Scene).validate_python(data, self_instance=self, context=context)
                found, sound, untold = [], self, 0
            except ValidationError as error:
                found, untold = mistakes(error, Scene, models), error.error_count() - MOST_MISTAKES
                sound = _sound_part(data, error, context)
            reported = {mistake.where for mistake in found}
            found += [mistake for mistake in misplaced(data) if mistake.where not in reported]
            found += conflicts(sound) if sound is not None else []
        if found:
            raise SceneError(limited(found, untold))
        self._folder = folder

    @model_validator(mode="after")
    def _take_apart(self):
        """Add the parts of elements from files: lines of delays, tables and packages of drivers."""
        for (part, name), element in self.composed.items():
            own = place(part, name)
            elements: dict[str, Any] = self.loads if part == "loads" else self.links
            taken = {node for line in self.lines.values() for node in line.nodes}
            parts, elements[name] = element.taken_apart(own)
            for section, made in parts.items():
                there: dict[str, Any] = getattr(self, section)
                for other in made.keys() & (there.keys() | taken):
                    raise InputError(section, f"a name that a part of {own} takes", "another name", f"'{other}'")
                there.update(made)
                self._parts.update((section, other) for other in made)
        return self

    @model_serializer(mode="wrap")
    def _as_given(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Serialise without the parts of elements from files."""
        table = handler(self)
        for section, name in self._parts:
            table.get(section, {}).pop(name, None)
        for section in {section for section, _ in self._parts}:
            if not table.get(section, True):
                del table[section]
        for (part, name), element in self.composed.items():
            table.get(part, {}).get(name, {})["at" if part == "loads" else "nodes"] = element.near
        return table

    def table(self) -> dict[str, Any]:
        """Table of the scene as in a file, except that user-defined elements remain objects."""
        return self._as_file({})

    def with_lines(self) -> dict[str, Any]:
        """Table of the scene with pipes as objects, which `Scene` takes without reading them again."""
        return self._as_file({"lines": dict(self.lines)} if self.medium == "hydraulic" and not self._parts else {})

    def _as_file(self, known: dict[str, Any]) -> dict[str, Any]:
        """Table with some sections given, and user-defined elements as objects."""
        table = self.model_dump(by_alias=True, exclude_unset=True, exclude={*known}) | known
        for (part, name), element in user_elements(self).items():
            table[part][name] = element
        return table

    def change(self, values: Mapping[str, Any]) -> "Scene":
        """Return the scene with other values.

        Parameters
        ----------
        values : mapping of str to anything that a scene file may hold
            By dotted path, as TOML has it: ``"loads.receiver.capacitance"``, ``"t_end"``, ``"solver.tol"``. Numbers are
            in SI; a text has its unit. The path of a whole element, ``"loads.receiver"``, takes a table or an
            element, new or in place of the one there, or None, which removes it.

        Returns
        -------
        Scene
            A new one; this one stays as it is.

        Raises
        ------
        InputError
            There is nothing at a path, or a value does not fit there; names the path.

        Examples
        --------
        >>> import tline as tl
        >>> scene = tl.examples["cable_rc"].change({"lines.cable.z0": 60, "loads.receiver.capacitance": "5 pF"})
        >>> scene.lines["cable"].parameters.z0, scene.loads["receiver"].capacitance
        (60.0, 5e-12)
        >>> scene.change({"loads.receiver": {"at": "far", "kind": "open"}}).loads["receiver"]
        NoFlow(at='far', kind='open')
        >>> scene.change({"loads.reciever.capacitance": "5 pF"})
        Traceback (most recent call last):
        tline.errors.InputError: loads.reciever.capacitance: no such element, expected 'receiver', got 'reciever'
        """
        from tline.scene.changed import changed

        return changed(self, values)

    def to_toml(self) -> str:
        """Format the scene as the text of a TOML file, with every value as it was typed.

        Reading the text in the folder of the files that it names gives an equal scene. User-defined elements appear
        under the names of their classes, which cannot be read back.
        """
        from tline.scene.file import scene_text

        return scene_text(self)

    def plot(self) -> "Figure":
        """Draw the network; see `tline.pictures.plot_network`."""
        return drawn(self)

    def passivity_model(self, kind: str) -> object:
        """Power taken up, a sum over the parts, for `passivity.is_positive_real` and `is_bounded_real`."""
        import tline as tl

        return tl.frequency.taken_power(self)

    def __repr__(self) -> str:
        return as_text(self)

    def _repr_html_(self) -> str:
        return as_html(self)

    def with_changes(self, **tables: Any) -> "Scene":
        """Return the scene with other tables in place of some, and the same folder of files."""
        kept = self._as_file({"lines": self.lines}) if isinstance(self.lines, PipeTable) else self.with_lines()
        return Scene(self._folder, **kept | tables)

    @property
    def folder(self) -> Folder:
        """Folder in which the files named in the scene are looked for."""
        return self._folder

    @cached_property
    def single_lines(self) -> Mapping[str, SceneLine]:
        """Lines that carry waves: single ones, and one for each mode of coupled conductors."""
        return single_lines(self.lines)

    @cached_property
    def lines_at(self) -> Mapping[str, list[str]]:
        """Lines that end at each node, twice if with both ends."""
        if isinstance(self.lines, PipeTable):
            return self.lines.at
        found: dict[str, list[str]] = {}
        for name, line in self.lines.items():
            for node in line.nodes:
                found.setdefault(node, []).append(name)
        return found

    @cached_property
    def heights(self) -> Mapping[str, Height]:
        """Height of each node by name; empty in a scene without elevations."""
        return heights_of(self)

    def height(self, probe: str) -> Height:
        """Height of a probe; inside a line interpolated linearly between its ends."""
        if self.medium == "electrical":
            return Height()
        name = self.probed_line(probe)
        if name is None:
            return self.heights.get(self.probes[probe].at or "", Height(per_metre=nan))
        line = self.lines[name]
        own = Height(per_metre=GRAVITY * (getattr(line.parameters, "density", None) or nan))
        (near, far), share = (self.heights.get(node, own) for node in line.nodes), self.probes[probe].fraction(line)
        return near._replace(elevation=(1 - share) * near.elevation + share * far.elevation)

    @property
    def placed(self) -> list[tuple[tuple[str, str], Any]]:
        """All loads and links, by section and name."""
        loads = [(("loads", name), load) for name, load in self.loads.items()]
        return [*loads, *((("links", name), link) for name, link in self.links.items())]

    @property
    def between(self) -> list[tuple[str, tuple[str, ...]]]:
        """Place and nodes of each link, and of each source between two nodes."""
        links = [(place("links", name), link.nodes) for name, link in self.links.items()]
        return links + [(place("sources", name), s.nodes) for name, s in self.sources.items() if s.nodes is not None]

    @property
    def measured(self) -> dict[tuple[str, str], Any]:
        """Each load and multiport from a Touchstone file, by section and name."""
        return {at: x for at, x in self.placed if isinstance(x, Measured)}

    @property
    def composed(self) -> dict[tuple[str, str], Any]:
        """Each element that a file composes of several others, by section and name."""
        return {at: x for at, x in self.placed if isinstance(x, Composed)}

    @property
    def parts(self) -> set[tuple[str, str]]:
        """Elements made by the composed ones, by section and name."""
        return self._parts

    @property
    def delay_lines(self) -> set[str]:
        """Names of the delay lines of measured elements."""
        return {line for element in self.measured.values() for line in element.delay_lines}

    @property
    def laws(self) -> dict[tuple[str, str], ElementLaw]:
        """Law of each non-linear element by section and name."""
        return {at: element.law() for at, element in self.placed if isinstance(element, NonLinear)}

    def check_linear(self, what: str, besides: type | UnionType | tuple[()] = ()) -> None:
        """Raise an error if the scene has non-linear elements, cavities, or links other than an allowed kind.

        Raises
        ------
        InputError
            With the name of the first, and of the caller that does not support it.
        """
        for part, name in self.laws:
            raise InputError(place(part, name), "is non-linear", f"a linear scene for {what}")
        refuse_cavities(self.lines, what)
        for name, link in self.links.items():
            if not isinstance(link, besides):
                raise InputError(place("links", name), f"a {link.kind}", f"a scene without links for {what}")

    @property
    def waveforms(self) -> dict[tuple[str, str, str], Shape]:
        """Prescribed waveforms by section, name and key."""
        return self.prescribed(self.laws)

    def prescribed(self, laws: Mapping[tuple[str, str], ElementLaw]) -> dict[tuple[str, str, str], Shape]:
        """Prescribed waveforms by section, name and key, with these laws."""
        given = {("sources", name, "value"): source.value for name, source in self.sources.items()}
        for (part, name), law in laws.items():
            if law.factor is not None:
                given[part, name, law.of_kind.control] = law.factor
        return given

    def probed_line(self, probe: str) -> str | None:
        """Name of the line of a probe, or of the only one that ends at its node; None if several do, or none."""
        place = self.probes[probe]
        ends = [] if place.line else list(dict.fromkeys(self.lines_at.get(place.at or "", ())))
        here = [*{*ends} - self.delay_lines] if len(ends) > 1 else ends
        return place.line or (here[0] if len(here) == 1 else None)


def _sound_part(data: dict[str, Any], error: ValidationError, context: dict[str, Any]) -> Scene | None:
    """Scene without its invalid elements, for checks of the others; None if a line is invalid."""
    bad = {finding["loc"][:2] for finding in error.errors(include_url=False)}
    keys = {str(place[0]) for place in bad if place}
    if "units" not in context or keys & {"lines", "medium"}:
        return None
    part = {"t_end": SHORT, "probes": {}} | {key: value for key, value in data.items() if key not in keys}
    for section in keys & {"sources", "loads", "links", "probes", "measures", "nodes"}:
        tables = data.get(section)
        if isinstance(tables, dict):
            part[section] = {name: table for name, table in tables.items() if (section, name) not in bad}
    sound = Scene.__new__(Scene)
    try:
        validator(Scene).validate_python(part, self_instance=sound, context=context)
    except ValidationError:
        return None
    return sound
