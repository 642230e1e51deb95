"""Probes: where a run is recorded."""

from typing import Literal

from pydantic import Field

from tline.errors import InputError
from tline.scene.element import Element, Name
from tline.scene.line import SceneLine
from tline.scene.quantity import Position
from tline.units import to_si
from tline.words.wording import shown


class Probe(Element):
    """Where effort, flow and waves are recorded: at a node, or at a position along a line.

    At a node where no line ends, or several meet and no `line` says whose flow and waves are meant, that is the effort
    alone; of a line with both its ends there they are those of end 1. A position is a distance from the line's end 1,
    or a share of its delay such as "25 %"; the line may have losses. Of a pair of coupled conductors a probe sees the
    differential mode, u1 - u2 and (i1 - i2)/2, or the common one, (u1 + u2)/2 and i1 + i2.
    """

    at: Name | None = Field(default=None, description="node; without `line`, where not one line ends, its effort alone")
    line: Name | None = Field(default=None, description="line: whose flow at the node, or on which the position is")
    position: Position | None = Field(default=None, description="distance from end 1 in m, or a share such as '25 %'")

    beside: Name | None = Field(default=None, description="node of a second of several conductors at the same end")
    mode: Literal["differential", "common"] | None = Field(default=None, description="of both: what is recorded")

    def fraction(self, line: SceneLine) -> float:
        """Place on the line as a share of its delay, from 0 at end 1 to 1 at end 2.

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
