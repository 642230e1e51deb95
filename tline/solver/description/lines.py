"""Where probes are: on which line, at which share of its delay, at which of several conductors or at which node.

Lines in numbers: single ones, and one for each mode of coupled conductors.
"""

from collections.abc import Iterable, Mapping
from math import exp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import ConstantLoss
from tline.loss.line import Losses
from tline.solver.description.given import End, Height, Probe, Scene
from tline.words.wording import place


class Conductor(NamedTuple):
    """One of several coupled conductors, or a mode of two: weights of their currents in its own, and the end."""

    weights: tuple[float, ...]
    end: int
    ends: tuple[End, End]

    @property
    def parts(self) -> tuple[NDArray, NDArray, float]:
        """Voltage and current per u and y of modes; and z0 with the other conductors at zero, or of the mode."""
        modes, weights = self.ends[0].modes, np.array(self.weights)
        z0 = 1 / float(weights @ modes.admittance @ weights)
        return weights @ modes.T / (weights @ weights), np.linalg.inv(modes.T) @ weights, z0


class ProbePlace(NamedTuple):
    """Where a probe is."""

    line: str  # '' at a node where none ends
    share: float  # of the delay
    height: Height
    conductor: Conductor | None = None
    node: str | None = None  # where no line ends

    @property
    def lines(self) -> list[str]:
        """Lines recorded by the probe: those of all modes at a conductor."""
        at = self.conductor
        if self.node is not None:
            return []
        return [self.line] if at is None else [node.removesuffix(", end 1") for node in at.ends[0].modal]


def probes_of(scene: Scene, coupled: Mapping[str, tuple[End, End]], inside: bool = False) -> dict[str, ProbePlace]:
    """Probes of a scene by name; those inside lossy lines are refused if not allowed."""
    found = {}
    for name, probe in scene.probes.items():
        where = scene.probed_line(name)
        if where is None:
            found[name] = ProbePlace("", 0.0, scene.height(name), node=probe.at)
            continue
        if where in coupled:
            end = next(k for k, end in enumerate(coupled[where]) if probe.at in end.conductors)
            conductor = Conductor(_weights(probe, coupled[where][end].conductors), end, coupled[where])
            found[name] = ProbePlace(where, float(end), scene.height(name), conductor)
            continue
        line = scene.lines[where]
        share = probe.fraction(line)
        if line.losses is not None and 0.0 < share < 1.0 and not inside:
            problem = f"inside {place('lines', where)}, which has losses"
            raise InputError(place("probes", name, "position"), problem, "that scene in stretches")
        found[name] = ProbePlace(where, share, scene.height(name))
    return found


def _weights(probe: Probe, conductors: tuple[str, ...]) -> tuple[float, ...]:
    """Weights of currents at a probe: i of a conductor, (i1 - i2)/2 differential mode, i1 + i2 common mode."""
    first, second = {"differential": (0.5, -0.5), "common": (1.0, 1.0), None: (1.0, 0.0)}[probe.mode]
    return tuple(first if node == probe.at else second if node == probe.beside else 0.0 for node in conductors)


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
    found = {}
    for name, line in scene.single_lines.items():
        parameters = line.parameters
        found[name] = Line(line.nodes, parameters.z0, parameters.delay or 0.0, line.losses)
    return found


def distinct(lines: Iterable[Line]) -> tuple[list[Line], NDArray]:
    """The first of those that differ in more than their nodes, and which of them each line is like.

    Examples
    --------
    >>> one, two = Line(("a", "b"), 50.0, 1e-9, None), Line(("b", "c"), 50.0, 1e-9, None)
    >>> distinct([one, two])[1].tolist()
    [0, 0]
    """
    known: dict[tuple[float, float, int], int] = {}
    first, like = [], []
    for line in lines:
        k = known.setdefault((line.z0, line.delay, id(line.losses)), len(first))
        if k == len(first):
            first.append(line)
        like.append(k)
    return first, np.array(like, int)
