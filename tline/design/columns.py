"""Highest pressure where liquid columns separate: over several numbers of places with cavities."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.cavities import with_cavities
from tline.scene.file import as_scene
from tline.scene.quantity import Quantity
from tline.scene.rating import BAR
from tline.scene.scene import Scene
from tline.solver.result.result import Result
from tline.solver.simulate import simulate

DOUBLINGS = 2
LATE = 0.98  # share of a run


class Peak(NamedTuple):
    """Highest gauge pressure of a run at nodes and places.

    Attributes
    ----------
    places : tuple of int
        Of each line with cavities, in the order of the scene.
    pressure : float
        Pa
    node : str
        Or the place, such as "pipe, place 3".
    at : float
        s
    """

    places: tuple[int, ...]
    pressure: float
    node: str
    at: float


@dataclass(frozen=True, repr=False)
class Separation(Presentation):
    """Design pressure where columns separate.

    Attributes
    ----------
    peaks : tuple of Peak
        Stretches between places are half as long in each run as in the one before.
    notes : tuple of str
        Of the run with most places, and whether the runs are long enough.
    """

    peaks: tuple[Peak, ...]
    notes: tuple[str, ...]

    @property
    def governing(self) -> Peak:
        """Highest peak of all runs."""
        return max(self.peaks, key=lambda peak: peak.pressure)

    @property
    def spread(self) -> float:
        """Spread of the highest pressure over the numbers of places, Pa."""
        pressures = [peak.pressure for peak in self.peaks]
        return max(pressures) - min(pressures)

    def to_dict(self) -> dict[str, Any]:
        """All numbers in SI, as ``tline design separation --json`` prints them."""
        return plain({"design_pressure": self.governing.pressure, "spread": self.spread} | vars(self))

    def text_lines(self) -> Iterator[str]:
        """Describe the highest pressure of each run, and the one to design for."""
        for places, pressure, node, at in self.peaks:
            yield f"{'/'.join(map(str, places))} places: {pressure / BAR:.4g} bar at {node} after {at:.4g} s"
        top = self.governing
        advice = f"take {top.pressure / BAR:.4g} bar as the design pressure: the highest of these runs, at {top.node}"
        yield f"{advice}; the number of places moves it by {self.spread / BAR:.2g} bar"


def separation(scene: Scene | str | Path) -> Separation:
    """Find the highest gauge pressure at all nodes and places, with cavities at ever more places.

    Later spikes between collapsing cavities do not converge, so the error estimate of a run says little about
    its highest pressure. It is therefore computed with the places of the scene, and with stretches between them
    half and a quarter as long, in the method of textbooks (order 1, slabs that divide all delays). The total free gas
    is kept: that at a place, and in a cavity at the end of such a line, is in proportion to the stretches.
    Four times the places take some 16 times as long.

    Parameters
    ----------
    scene : Scene or path
        Scene with cavities in a line at least.

    Raises
    ------
    InputError
        No line has cavities, or there would be too many places.

    Examples
    --------
    >>> import tline as tl
    >>> found = tl.design.separation(tl.examples["column_separation"].with_changes(t_end="0.2 s"))
    >>> [peak.places for peak in found.peaks], f"{found.governing.pressure / 1e5:.2g} bar at {found.governing.node}"
    ([(31,), (63,), (127,)], '9.6 bar at valve')
    """
    given = as_scene(scene)
    if not with_cavities(given.lines):
        raise InputError("lines", "none has cavities", "[lines.NAME.cavities] with places, as of column separation")
    peaks, notes = list[Peak](), ()
    for doubling in range(DOUBLINGS + 1):
        finer = _with_stretches(given, 2**doubling)
        result = simulate(finer, envelope=True, ledger=False)
        peaks.append(_peak(result))
        notes = result.notes
    found = Separation(tuple(peaks), notes)
    if found.governing.at > LATE * float(given.t_end):
        notes = (*notes, "the highest pressure comes at the end of the run: let it run longer")
    return replace(found, notes=notes)


def _with_stretches(scene: Scene, times: int) -> Scene:
    """Return the scene with a multiple of the stretches, and an equal total of gas."""
    tables, ends = scene.table(), set[str]()
    for name, line in with_cavities(scene.lines).items():
        cavities = tables["lines"][name]["cavities"]
        cavities["places"] = times * line.stretches - 1
        _share(cavities, times)
        ends |= {*line.nodes}
    for load in tables.get("loads", {}).values():
        if load["at"] in ends and load["kind"] == "cavity":
            _share(load, times)
    return Scene(scene.folder, **tables | {"solver": {"order": 1}})


def _share(table: dict[str, Any], times: int) -> None:
    if "gas_volume" in table:
        table["gas_volume"] = float(Quantity(table["gas_volume"], "m^3")) / times


def _peak(result: Result) -> Peak:
    whole = result.parts or result
    seen = whole.envelope
    assert seen is not None
    gauge = seen.highest - np.nan_to_num(seen.weight)
    k = int(np.argmax(gauge))
    places = tuple(line.stretches - 1 for line in with_cavities(result.scene.lines).values())
    return Peak(places, float(gauge[k]), seen.nodes[k], float(seen.highest_at[k]))
