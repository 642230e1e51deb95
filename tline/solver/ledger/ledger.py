"""What a ledger says: of every element and line the energy it gave and took, and what does not add up."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError

COLUMNS = ("supplied", "dissipated", "stored", "taken", "unaccounted")
UNACCOUNTED = 4  # the other columns have the numbers that the inventory gives them
GRAVITY = "gravity"  # account of what flows out to the open air below the highest node
TOLERANCE = 1e-3  # of the turnover; what is lost or made beyond it is told


class Entry(NamedTuple):
    """One account, J."""

    # place in the scene of an element or a line; of several whose shares the waves do not tell apart, or a node
    where: str
    supplied: float  # what came from a source, a reservoir or a pump; negative if it took
    dissipated: float  # in resistances, valves and diodes
    stored: float  # change of what it stores
    taken: float  # dissipated and stored together, where these are not told apart
    # what was lost on the way: by a line where fronts or fractional delays are projected on slabs (numerical
    # dissipation, never negative but for rounding), at a node where flows do not balance
    unaccounted: float
    # the most that it had given beyond what it had taken and held, at any slab's end, if it must not; else 0
    created: float


class Ledger(NamedTuple):
    """Energy of a whole run, by element: supplied = dissipated + stored + taken + unaccounted.

    With elevations, energies of lines, sources and reservoirs count from the highest node, those of what leads to the
    open air from the gauge pressure; "gravity" supplies the difference, density·g·height for what flows out below.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"r": {"at": "far", "kind": "resistor", "resistance": 50}},
    ... )
    >>> ledger = simulate(scene, ledger=True).ledger
    >>> print(f"{ledger.of('sources.s').supplied:.3g} J, {ledger.of('loads.r').dissipated:.3g} J")
    4e-10 J, 1.75e-10 J
    """

    entries: tuple[Entry, ...]  # lines first, then elements, then nodes
    turnover: float  # what lossless lines held before t = 0, and the most that each account had given at any time, J

    def of(self, where: str) -> Entry:
        """The account at a place in the scene, such as ``"lines.pipe"``."""
        for entry in self.entries:
            if entry.where == where:
                return entry
        raise InputError("ledger", "no such account", "a line or an element such as 'lines.NAME'", repr(where))

    @property
    def total(self) -> Entry:
        """Sums of all columns."""
        return Entry("sum", *(float(part) for part in self._numbers().sum(axis=0)))

    @property
    def residual(self) -> float:
        """Sum of the sizes of all that is not accounted for, relative to the turnover; 0 if nothing moved."""
        off = float(np.abs(self._numbers()[:, UNACCOUNTED]).sum())
        return off / self.turnover if self.turnover else 0.0

    @property
    def notes(self) -> tuple[str, ...]:
        """Of a residual or energy made beyond a thousandth of the turnover a sentence each, naming who did most."""
        told, bound = [], TOLERANCE * self.turnover
        if self.residual > TOLERANCE:
            worst = max(self.entries, key=lambda entry: abs(entry.unaccounted))
            did = f"{worst.where} lost" if worst.unaccounted > 0 else f"{worst.where} made"
            told.append(
                f"ledger: {self.residual:.2g} of the energy turned over is not accounted for; {did} most of it, "
                f"{abs(worst.unaccounted):.3g} J; narrower slabs or a higher order are off by less"
            )
        makers = [entry for entry in self.entries if entry.created > bound]
        told += [f"ledger: {e.where} gave {e.created:.3g} J more than it had taken" for e in makers]
        return tuple(told)

    def _numbers(self) -> NDArray:
        return np.array([entry[1:] for entry in self.entries], float).reshape(-1, len(COLUMNS) + 1)
