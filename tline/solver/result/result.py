"""Result of a run: the waves at the ends of recorded lines, and the quantities derived from them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError, as_numbers
from tline.solver.assembly.workspace import Tally
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import NO_HEIGHT, Height, Medium, Scene, readable
from tline.solver.description.lines import Circuits
from tline.solver.description.resolution import Resolution
from tline.solver.ledger.ledger import Ledger
from tline.solver.loop.slabs import Slabs
from tline.solver.result.accuracy import Accuracy
from tline.solver.result.display import Display, shortly
from tline.solver.result.envelope import Envelope
from tline.solver.result.export import Export
from tline.solver.result.wave import ElementRecord, LineRecord, Wave
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.solver.result.states import Measured, StateTrace


class AtHeight:
    """Efforts `u` somewhere, at a `height`."""

    u: Any
    height: Height

    @property
    def gauge_pressure(self) -> NDArray:
        """Pressure above the air's at the same height, Pa: u - density·g·elevation; u itself without elevations."""
        return self.u - self.height.weight

    @property
    def head(self) -> NDArray:
        """Piezometric head above the zero of elevations, m: u/(density·g).

        Raises
        ------
        InputError
            The density of the liquid is not known.
        """
        if np.isnan(self.height.per_metre):
            raise InputError("head", "the density of the liquid is not known", "the density of the pipe")
        return self.u / self.height.per_metre


@dataclass(frozen=True, eq=False, repr=False)
class Samples(AtHeight):
    """Effort, flow and waves at instants t, in SI; flow counts positive from end 1 to end 2 of the line."""

    t: NDArray
    u: NDArray
    y: NDArray
    a: NDArray
    b: NDArray
    height: Height = NO_HEIGHT

    def __repr__(self) -> str:
        return shortly("Samples", instants=self.t.size, of="t, u, y, a, b")


@dataclass(frozen=True, eq=False, repr=False)
class ProbeResult(AtHeight):
    """Signals at one probe."""

    name: str
    line: str  # '' at a node without line ends
    share: float  # place on the line, 0 at end 1 and 1 at end 2
    record: LineRecord
    slabs: Slabs
    height: Height = NO_HEIGHT

    def __repr__(self) -> str:
        return shortly(f"Probe {self.name!r}", instants=f"{len(self.t):,}", to=f"{self.t[-1]:.6g} s")

    @property
    def has_flow(self) -> bool:
        """Whether the probe is on a line; at a node without line ends flow is 0 and both waves are the effort."""
        return bool(self.line)

    def at(self, t: ArrayLike) -> Samples:
        """Effort, flow and waves at any instants of the run, and before t = 0; at a jump the values before it.

        Errors are estimated by `Accuracy.inside`; slab ends (`t`, `u`, `y`) are more accurate.

        Raises
        ------
        InputError
            An instant is no number, or lies behind the end of the run.
        """
        t, end = as_numbers("t", t), self.slabs.end
        if not (t <= end * (1 + EDGE)).all():
            raise InputError(
                place("probes", self.name), "instant not in the run", f"at most {end:.9g} s", f"{t.max():.9g} s"
            )
        return self.of_waves(t, *self.record.waves(t, self.share))

    @cached_property
    def samples(self) -> Samples:
        """Signals at slab ends, t = 0 included, and at the end of the run."""
        seen = self.at_slab_ends
        if not self.slabs.rest:
            return seen
        last = self.at(self.slabs.ends[-1:])
        return replace(seen, **{key: np.append(getattr(seen, key), getattr(last, key)) for key in ("t", *"uyab")})

    @cached_property
    def at_slab_ends(self) -> Samples:
        """Signals at slab ends within the run, t = 0 included, where values are most accurate."""
        record, n = self.record, self.slabs.whole + 1
        a, b = (record.a1, record.b1) if self.share == 0.0 else (record.a2, record.b2)
        t = self.slabs.ends[:n] if self.slabs.rest else self.slabs.ends  # one array for all probes
        if self.share not in (0.0, 1.0) or self.slabs.number != len(a.values):
            return self.at(t)
        return self.of_waves(t, a.at_slab_ends()[:n], b.at_slab_ends()[:n])

    @property
    def passing(self) -> tuple[tuple[Wave, float], tuple[Wave, float]]:
        """Waves a and b that pass the probe, as they are at an end of its line, and how much later."""
        return self.record.passing(self.share)

    @property
    def waves(self) -> tuple[Wave, Wave]:
        """Waves (a, b) that pass the probe, as they are at an end of its line."""
        (a, _), (b, _) = self.passing
        return a, b

    def of_waves(self, t: NDArray, a: NDArray, b: NDArray) -> Samples:
        """Samples at instants, of the waves there."""
        return Samples(t, (a + b) / 2, (a - b) / (2 * self.record.z0), a, b, self.height)

    @property
    def t(self) -> NDArray:
        """Instants, s."""
        return self.samples.t

    @property
    def u(self) -> NDArray:
        """Effort: pressure in Pa, piezometric if nodes have elevations, or voltage in V."""
        return self.samples.u

    @property
    def y(self) -> NDArray:
        """Flow: m³/s, or A."""
        return self.samples.y

    @property
    def a(self) -> NDArray:
        """Wave u + z0·y, toward end 2."""
        return self.samples.a

    @property
    def b(self) -> NDArray:
        """Wave u - z0·y, toward end 1."""
        return self.samples.b


@dataclass(frozen=True, eq=False, repr=False)
class Result(Display, Export):
    """A finished run.

    Attributes
    ----------
    scene : Scene
        As it was run.
    slabs : Slabs
        Their number and width, and the end of the run.
    probes : mapping
        ProbeResult by name.
    lines : mapping
        LineRecord of each recorded line by name.
    resolution : Resolution
        Order s and slab width h.
    unresolved : tuple of str
        Parts of the run that were not resolved; empty if all were.
    start : mapping of str to ndarray
        By line the waves (a1, b1, a2, b2) before t = 0, counted from the level.
    samples : int
        Line-end samples computed.
    seconds : float
        Processor time spent stepping [s].
    fronts : Tally
        Count and size of the fronts that did not fit the slabs.
    accuracy : Accuracy or None
        Estimated errors; None for a run whose order or slab is fixed by hand, without a tolerance.
    envelope : Envelope or None
        Lowest and highest effort at every node; None if not asked for.
    accounts : Ledger, callable or None
        Energy by element, or a function that returns it; `ledger` reads it.
    circuits : mapping of str to Circuits
        Circuits that approximate the laws of lossy lines, by line.
    elements : mapping of str to ElementRecord
        Records of elements with states, by place; in runs on the way to a tolerance also of laws with kinks.
    slams : mapping of str to float
        Largest velocity of reverse flow through check valves with a disc, by place, m/s.
    parts : Result or None
        Result of the expanded scene, with stretches in place of lines with cavities; None if there are none.
    warned : tuple of str
        Remarks made before the run.
    """

    scene: Scene
    slabs: Slabs
    probes: Mapping[str, ProbeResult]
    lines: Mapping[str, LineRecord]
    resolution: Resolution
    unresolved: tuple[str, ...]
    start: Mapping[str, NDArray]
    samples: int
    seconds: float
    fronts: Tally
    accuracy: Accuracy | None = None
    envelope: Envelope | None = None
    accounts: Ledger | Callable[[], Ledger | None] | None = None
    circuits: Mapping[str, Circuits] = field(default_factory=dict)
    elements: Mapping[str, ElementRecord] = field(default_factory=dict)
    slams: Mapping[str, float] = field(default_factory=dict)
    parts: "Result | None" = None
    warned: tuple[str, ...] = ()

    @cached_property
    def t(self) -> NDArray:
        """Slab ends, s, beginning with 0, and the end of the run."""
        return self.slabs.ends

    @cached_property
    def ledger(self) -> Ledger | None:
        """Energy by element, computed when first read; None if not asked for or too expensive."""
        return self.accounts() if callable(self.accounts) else self.accounts

    @cached_property
    def states(self) -> "list[StateTrace]":
        """States, openings and speeds of elements at slab ends.

        Speed, torque and power of pumps, volume and pressure of gas, levels, openings, volumes of air and cavities.
        """
        from tline.solver.result.states import states_of

        return states_of(self)

    @cached_property
    def measures(self) -> "Mapping[str, Measured]":
        """Value and unit of each measure of the scene by name; NaN where its event does not happen."""
        from tline.solver.result.states import measures_of

        return measures_of(self)

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on the scene and the run; empty if there are none."""
        from tline.solver.result.notes import remarks_of

        return (*self.warned, *(self.parts.remarks if self.parts else remarks_of(self)))

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks, notes of the ledger, and unresolved parts."""
        return (*self.remarks, *(self.ledger.notes if self.ledger else ()), *self.unresolved)

    @property
    def medium(self) -> Medium:
        """Words and units of the scene's medium."""
        return readable(self.scene)
