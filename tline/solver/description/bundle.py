"""Coupled conductors whose losses mix their modes, exactly: matrix functions of Z(s) Y(s), in the waves of their modes.

With v = T u and i = T^-T y of the modes without losses, u' = -Z y and y' = -Y u with Z, Y no longer diagonal. Then
Γ = sqrt(Y Z) of y, and flows into both ends are those of Γ coth(Γl) and Γ/sinh(Γl), by eigenvectors at each s: no mode
is followed over s, and none is taken for another.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.coupled import Coupled
from tline.solver.description.description import Description


class Bundle(NamedTuple):
    """Coupled conductors with losses: numbers of their modes' lines, and parameters per metre: R, K of K √s, and G."""

    lines: NDArray
    length: float
    z0: NDArray
    inductance: NDArray
    capacitance: NDArray
    resistance: NDArray
    skin: NDArray
    added: bool
    conductance: NDArray

    def series(self, s: NDArray) -> NDArray:
        """Z (n, k, k): sL + sqrt(R² + K² s), in units in which L is 1, or sL + R + K √s."""
        s, root = s[:, None, None], np.sqrt(self.inductance)
        unit = root[:, None] * root
        R, K = self.resistance / unit, self.skin / unit
        if self.added or not K.any():
            lost = R + K * np.sqrt(s)
        else:
            squares, vectors = np.linalg.eig(R @ R + K @ K * s)
            lost = (vectors * np.sqrt(squares)[:, None, :]) @ np.linalg.inv(vectors)
        return s * np.diag(self.inductance) + unit * lost

    def admittances(self, s: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
        """Return Y11 and Y12 (n, k, k) for s (n,) in 1/s; `late` (n, k) is the part of each mode's delay beyond sT.

        The delay of each mode by itself, as R, K and G on the diagonal make it, is its own; that of their mixing is the
        shortest, for a part of it arrives with the fastest mode.
        """
        Z, Y = self.series(s), self.conductance + s[:, None, None] * np.diag(self.capacitance)
        squares, vectors = np.linalg.eig(Z @ Y)
        gamma, inverse, first = np.sqrt(squares), np.linalg.inv(vectors), late[:, [np.abs(late).sum(axis=0).argmin()]]
        alone = np.sqrt(np.einsum("nkk,nkk->nk", Z, Y)) * self.length
        passed = (vectors * np.exp(-gamma * self.length - first)[:, None, :]) @ inverse
        np.einsum("nkk->nk", passed)[:] += np.exp(-alone - late) - np.exp(-alone - first)
        admittance = np.linalg.solve(Z, (vectors * gamma[:, None, :]) @ inverse)
        twice = 2 * admittance @ np.linalg.inv(np.eye(len(self.z0)) - passed @ passed)
        return twice - admittance, -twice @ passed


def bundles_of(description: Description) -> dict[str, Bundle]:
    """Coupled lines of a scene whose losses mix the modes, by name."""
    numbers = {name: k for k, name in enumerate(description.lines)}
    return {
        name: _bundle(line, [numbers[node.removesuffix(", end 1")] for node in description.coupled[name][0].modal])
        for name, line in description.scene.lines.items()
        if isinstance(line, Coupled) and line.mixing
    }


def _bundle(line: Coupled, lines: list[int]) -> Bundle:
    modes, length = line.modes, float(line.length or 0.0)
    k = len(modes.z0)
    R, G, high = (
        np.array(given or np.zeros((k, k)), float)
        for given in (line.resistance, line.conductance, line.skin and line.skin.resistance)
    )
    back = np.linalg.inv(modes.T)
    inductance, capacitance = modes.z0 * modes.delay / length, modes.delay / modes.z0 / length
    skin = high / np.sqrt(np.pi * float(line.skin.frequency)) if line.skin else high
    added = bool(line.skin and line.skin.added)
    R, skin = (back @ each @ back.T for each in (R, skin))
    return Bundle(
        np.array(lines), length, modes.z0, inductance, capacitance, R, skin, added,
        modes.T.T @ G @ modes.T,
    )  # fmt: skip
