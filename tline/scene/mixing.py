"""Coupled conductors whose losses mix the modes: stretches without losses, with all they lose at places between."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.line import SceneLine

FINENESS, FEWEST, MOST = 40, 8, 64  # places: per loss over impedance, and bounds, where no more are asked


class Mixing(NamedTuple):
    """Places with losses between the stretches of coupled conductors."""

    name: str  # of the line
    line: Coupled
    places: int  # as many; the first and the last stretch are half as long as those between

    @classmethod
    def of(cls, name: str, line: Coupled, doublings: int) -> Mixing:
        """With so many places that little is lost at each."""
        R, G = _lost(line)
        z0 = np.linalg.inv(line.modes.admittance)
        lost = max(np.linalg.norm(R @ line.modes.admittance, 2), np.linalg.norm(G @ z0, 2))
        return cls(name, line, min(max(ceil(FINENESS * lost), FEWEST), MOST) * 2**doublings)

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes at all places."""
        return tuple(node for k in range(1, self.places + 1) for end in (1, 2) for node in self._at(k, end))

    def lines(self) -> dict[str, dict[str, Any]]:
        """Tables of the stretches."""
        table = self.line.table()
        alike = {key: table[key] for key in ("inductance", "capacitance")}
        near = [self.line.nodes1, *(self._at(k, 2) for k in range(1, self.places + 1))]
        far = [*(self._at(k, 1) for k in range(1, self.places + 1)), self.line.nodes2]
        lengths = [
            float(self.line.length or 0.0) / self.places / (2 if k in (0, self.places) else 1) for k in range(len(near))
        ]
        return {
            f"{self.name}, stretch {k + 1}": alike | {"length": length, "nodes1": list(one), "nodes2": list(other)}
            for k, (one, other, length) in enumerate(zip(near, far, lengths, strict=True))
        }

    def links(self) -> dict[str, dict[str, Any]]:
        """Tables of what is lost at the places: half of R, all of G, half of R."""
        if self.line.skin:
            where, expected = (
                f"{place('lines', self.name)}.skin",
                "a run from rest to a tolerance of 1e-8 or more, without a ledger",
            )
            raise InputError(where, "it makes modes see each other, which other runs do not know", expected)
        R, G = (lost / self.places for lost in _lost(self.line))
        one, none = np.eye(len(R)), np.zeros_like(R)
        # u1 - R i1/2 = u2 - R i2/2 = v, i1 + i2 = G v
        M = np.block([[one, -one], [G, none]])
        N = np.block([[-R / 2, R / 2], [-one - G @ R / 2, -one]])
        z0 = float(np.median(self.line.modes.z0))
        scattering = np.linalg.solve(N / z0 - M, N / z0 + M)
        table = {"kind": "junction", "z0": z0, "scattering": scattering.tolist()}
        return {
            f"{self.name}, place {k}": table | {"nodes": [*self._at(k, 1), *self._at(k, 2)]}
            for k in range(1, self.places + 1)
        }

    def _at(self, k: int, end: int) -> tuple[str, ...]:
        return tuple(f"{self.name}, place {k}, conductor {j + 1}, end {end}" for j in range(len(self.line.nodes1)))


def mixing_lines(lines: Mapping[str, SceneLine | Coupled]) -> dict[str, Coupled]:
    """Those of the lines whose losses mix the modes."""
    return {name: line for name, line in lines.items() if isinstance(line, Coupled) and line.mixing}


def _lost(line: Coupled) -> tuple[NDArray, NDArray]:
    """R and G of the whole line, in ohm and S."""
    k, length = len(line.nodes1), float(line.length or 0.0)
    R, G = (length * np.array(given or np.zeros((k, k)), float) for given in (line.resistance, line.conductance))
    return R, G
