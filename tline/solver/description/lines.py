"""Lines in numbers: single ones, and one for each mode of coupled conductors."""

from math import exp
from typing import NamedTuple

from tline.loss import ConstantLoss
from tline.loss.line import Losses
from tline.solver.description.given import Scene


class Line(NamedTuple):
    """A line from its end 1, at the first node, to its end 2."""

    nodes: tuple[str, str]
    z0: float  # as a front meets it, Pa s/m³ or ohm
    delay: float  # s
    losses: Losses | None

    @property
    def dispersive(self) -> bool:
        """Whether it does more to waves than to delay and attenuate them."""
        return self.losses is not None and not self.losses.distortionless

    @property
    def passed(self) -> float:
        """Share of a wave that arrives if all it does is to attenuate; else 1."""
        return exp(-self.losses.attenuation) if self.losses and self.losses.distortionless else 1.0

    @property
    def in_diamonds(self) -> bool:
        """Whether it loses effort by its flow alone, at once, and otherwise only delays."""
        if self.losses is None:
            return False
        series, shunt = self.losses.exact.series, self.losses.exact.shunt
        return isinstance(series, ConstantLoss) and isinstance(shunt, ConstantLoss) and not shunt.loss


def lines_of(scene: Scene) -> dict[str, Line]:
    """All lines of a scene that carry waves, by name."""
    return {
        name: Line(line.nodes, line.parameters.z0, line.parameters.delay or 0.0, line.losses)
        for name, line in scene.single_lines.items()
    }
