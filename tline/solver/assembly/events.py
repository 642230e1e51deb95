"""What happens at a group of nodes at an instant."""

from typing import NamedTuple

from tline.solver.kernel.fronts.structures import SAME_MAP


class Event(NamedTuple):
    """Something that happens at a group: a switch moves, or a piece of a slab begins.

    Events are put in order by their instants. None takes the place of another, be it at the same instant.
    """

    at: float  # slabs
    group: int
    row: int = SAME_MAP  # of the group's map from then on

    @property
    def moves(self) -> bool:
        """Whether it changes the group's map."""
        return self.row != SAME_MAP
