"""Where probes are: on which line, at which share of its delay, at which of several conductors or at which node."""

from collections.abc import Mapping
from typing import NamedTuple

from tline.errors import InputError
from tline.solver.description.given import End, Height, Probe, Scene
from tline.words.wording import place


class Conductor(NamedTuple):
    """One of several coupled conductors, or a mode of two: what its current is of theirs, and at which end."""

    weights: tuple[float, ...]
    end: int
    ends: tuple[End, End]


class ProbePlace(NamedTuple):
    """Where a probe is."""

    line: str  # '' at a node where none ends
    share: float  # of the delay
    height: Height
    conductor: Conductor | None = None
    node: str | None = None  # where no line ends

    @property
    def lines(self) -> list[str]:
        """The lines that it sees: those of all modes at a conductor."""
        at = self.conductor
        if self.node is not None:
            return []
        return [self.line] if at is None else [node.removesuffix(", end 1") for node in at.ends[0].modal]


def probes_of(scene: Scene, coupled: Mapping[str, tuple[End, End]]) -> dict[str, ProbePlace]:
    """Probes of a scene by name."""
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
        if line.losses is not None and 0.0 < share < 1.0:
            problem = f"inside {place('lines', where)}, which has losses"
            raise InputError(place("probes", name, "position"), problem, "that scene in stretches")
        found[name] = ProbePlace(where, share, scene.height(name))
    return found


def _weights(probe: Probe, conductors: tuple[str, ...]) -> tuple[float, ...]:
    """Currents of conductors in what a probe sees: i, (i1 - i2)/2 of the differential mode, i1 + i2 of the common."""
    first, second = {"differential": (0.5, -0.5), "common": (1.0, 1.0), None: (1.0, 0.0)}[probe.mode]
    return tuple(first if node == probe.at else second if node == probe.beside else 0.0 for node in conductors)
