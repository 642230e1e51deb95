"""Probes, where a run is recorded, and measures, numbers derived from their records."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import Element, Name, optional, required
from tline.scene.line import SceneLine
from tline.scene.mistakes import OneOf
from tline.scene.quantity import AnyEffort, Delay, Duration, Position, Quantity, Whole
from tline.units import to_si
from tline.words.wording import shown


class Probe(Element):
    """Place where effort, flow and waves are recorded: at a node, or at a position along a line.

    At a node where no line ends, or where several meet and no `line` selects the flow and waves, only the effort is
    recorded; of a line with both its ends there flow and waves are those of end 1. A position is a distance from the
    line's end 1, or a share of its delay such as "25 %"; the line may have losses. Of a pair of coupled conductors a
    probe records the differential mode, u1 - u2 and (i1 - i2)/2, or the common one, (u1 + u2)/2 and i1 + i2.
    """

    at: Name | None = optional("node; without `line`, where not one line ends, its effort alone")
    line: Name | None = optional("line: whose flow at the node, or on which the position is")
    position: Position | None = optional("distance from end 1 in m, or a share such as '25 %'")

    beside: Name | None = optional("node of a second of several conductors at the same end")
    mode: Literal["differential", "common"] | None = optional("of both: what is recorded")

    def fraction(self, line: SceneLine) -> float:
        """Position on the line as a share of its delay, from 0 at end 1 to 1 at end 2.

        Raises
        ------
        InputError
            The position is not on the line, or is a distance on a line whose length is not known.
        """
        if self.position is None:
            return float(line.nodes[1] == self.at and line.nodes[0] != self.at)
        typed, length = self.position.typed, line.parameters.length
        if isinstance(typed, str) and "%" in typed:
            share = to_si(typed, "", "position")
        else:
            distance = to_si(typed, "m", "position")
            if length is None:
                problem, expected = "the line's length is not known", "a share such as '25 %'"
                raise InputError("position", problem, expected, shown(typed))
            share = distance / length
        if not 0 <= share <= 1 + 1e-12:
            expected = f"0 to {length:g} m" if length else "0 to 100 %"
            raise InputError("position", "not on the line", expected, shown(typed))
        return min(share, 1.0)


START = Quantity(0, "s")


class Signal(Element):
    """Effort at a probe, or its difference from that at another one."""

    section: ClassVar[str] = "measures"
    probe: Name = required("probe whose effort counts: voltage, or gauge pressure")
    minus: Name | None = optional("another probe, whose effort is subtracted")

    @property
    def probes(self) -> Iterator[tuple[str, str]]:
        """Keys and names of the probes used."""
        return ((key, name) for key, name in (("probe", self.probe), ("minus", self.minus)) if name is not None)


class LevelCrossing(Signal):
    """Instant at which a signal crosses a level."""

    level: AnyEffort = required("that is crossed")
    edge: Literal["rise", "fall", "any"] = optional("crossings that count", "any")
    count: Annotated[int, Whole(0)] = optional("which of them, from 1 on; 0 is the last", 1)
    after: Delay = optional("crossings before this instant do not count", START)


class Extent(Signal):
    """Number derived from a signal over the run or a part of it."""

    kind: Literal["maximum", "minimum", "peak to peak", "mean", "rms", "integral"]
    start: Delay = optional("begin of the part", START)
    stop: Duration | None = optional("end of the part; that of the run if not given")

    @model_validator(mode="after")
    def _ascends(self):
        if self.stop is not None and self.stop <= self.start:
            raise InputError("stop", "not after the start", f"more than {self.start:g} s", f"{self.stop:g} s")
        return self


class Instant(LevelCrossing):
    """Instant at which a signal crosses a level."""

    kind: Literal["crossing"] = "crossing"


class Interval(Element):
    """Time from one crossing to another."""

    section: ClassVar[str] = "measures"
    kind: Literal["delay"] = "delay"
    start: LevelCrossing = required("the first crossing: keys of a crossing, without kind")
    stop: LevelCrossing = required("the second one")

    @property
    def probes(self) -> Iterator[tuple[str, str]]:
        """Keys and names of the probes used."""
        for end in ("start", "stop"):
            yield from ((f"{end}.{key}", name) for key, name in getattr(self, end).probes)


class Value(Signal):
    """Value of a signal at an instant, or when one crosses a level."""

    kind: Literal["value"] = "value"
    at: Delay | None = optional("instant")
    when: LevelCrossing | None = optional("instead of it: keys of a crossing, without kind")

    @model_validator(mode="after")
    def _once(self):
        if (self.at is None) == (self.when is None):
            raise InputError("at", "the instant is not given once", "at or when")
        return self

    @property
    def probes(self) -> Iterator[tuple[str, str]]:
        """Keys and names of the probes used."""
        yield from super().probes
        yield from ((f"when.{key}", name) for key, name in (self.when.probes if self.when else ()))


_Any = Extent | Instant | Interval | Value
Measure = Annotated[_Any, OneOf(_Any, "kind")]
