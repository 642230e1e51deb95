"""Ledger of a run: energy supplied, dissipated and stored by every element and line, and the residual."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError

COLUMNS = ("supplied", "dissipated", "stored", "taken", "unaccounted")
UNACCOUNTED = 4  # the other columns have the numbers that the inventory gives them
GRAVITY = "gravity"  # account of outflow to the open air below the highest node
TOLERANCE = 1e-3  # relative to the turnover; a larger loss or gain is reported


class Entry(NamedTuple):
    """Energies of one account, J."""

    # place of an element, a line or a node in the scene; of several elements if waves do not separate their shares
    where: str
    supplied: float  # by a source, a reservoir or a pump; negative if it absorbed energy
    dissipated: float  # in resistances, valves and diodes
    stored: float  # change of the stored energy
    taken: float  # dissipated and stored together, where these are not separable
    # lost by a line where fronts or fractional delays are projected on slabs (numerical
    # dissipation, negative by rounding only), or at a node whose flows do not balance
    unaccounted: float
    # largest energy that a passive account had given beyond that taken and stored, at any slab end; else 0
    created: float


class Ledger(NamedTuple):
    """Energy balance of a whole run, by element: supplied = dissipated + stored + taken + unaccounted.

    With elevations, energies of lines, sources and reservoirs count from the highest node, those of outlets to the
    open air from the gauge pressure; "gravity" supplies the difference, density·g·height for outflow below.

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
    turnover: float  # energy of lossless lines before t = 0, and the most that each account gave at any time, J

    def of(self, where: str) -> Entry:
        """Return the account at a place in the scene, such as ``"lines.pipe"``."""
        for entry in self.entries:
            if entry.where == where:
                return entry
        raise InputError("ledger", "no such account", "a line or an element such as 'lines.NAME'", repr(where))

    @property
    def total(self) -> Entry:
        """Sum of all accounts, column by column."""
        return Entry("sum", *(float(part) for part in self._numbers().sum(axis=0)))

    @property
    def residual(self) -> float:
        """Sum of the absolute unaccounted energies over the turnover; 0 if nothing moved."""
        off = float(np.abs(self._numbers()[:, UNACCOUNTED]).sum())
        return off / self.turnover if self.turnover else 0.0

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on a residual, or energy created, beyond a thousandth of the turnover, with the largest cause."""
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
