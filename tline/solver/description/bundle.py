"""Coupled conductors whose losses mix their modes, exactly: matrix functions of Z(s) Y(s), in the waves of their modes.

With v = T u and i = T^-T y of the modes without losses, u' = -Z y and y' = -Y u with Z, Y no longer diagonal. Then
Γ = sqrt(Y Z) of y, and flows into both ends are those of Γ coth(Γl) and Γ/sinh(Γl), by eigenvectors at each s: no mode
is followed over s, and none is taken for another.
"""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.description.description import Description

SAME_DELAY = 1e-9  # of the longest; modes of delays so alike are not told apart
ALIKE = 0.7  # least share of a mode without losses in one with losses that is followed by itself


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

    @property
    def delays(self) -> NDArray:
        """Delays of fronts in the modes, (k,) s."""
        return self.length * np.sqrt(self.inductance * self.capacitance)

    def modes(self, s: NDArray, of: NDArray) -> "Eigenmodes":
        """Eigenmodes at s (n,) in 1/s, in the order of those without losses that they resemble.

        Modes with the same number in `of` (k,) are not told apart.
        """
        Z, Y = self.series(s), self.conductance + s[:, None, None] * np.diag(self.capacitance)
        squares, vectors = np.linalg.eig(Z @ Y)
        inverse, kind = np.linalg.inv(vectors), np.unique(of, return_inverse=True)[1]
        share = (kind == np.arange(len(kind))[:, None]) @ (vectors * np.swapaxes(inverse, 1, 2)).real
        order = np.argsort(share.argmax(axis=1), axis=1, kind="stable")
        order = order[:, np.argsort(np.argsort(kind, kind="stable"))]
        alike = np.take_along_axis(share, order[:, None], axis=2)[:, kind, np.arange(len(kind))].min()
        gamma = np.take_along_axis(np.sqrt(squares), order, axis=1)
        vectors = np.take_along_axis(vectors, order[:, None], axis=2)
        inverse = np.take_along_axis(inverse, order[:, :, None], axis=1)
        return Eigenmodes(gamma, vectors, inverse, np.linalg.solve(Z, vectors * gamma[:, None]), float(alike))

    def fronts(self, s: NDArray) -> NDArray:
        """Delays of fronts in the modes, (k,) s: of those that are not told apart at s (n,), the shortest.

        Modes that meet where Re s > 0 are none by themselves: their responses would grow, and only the sum does not.
        Such places are near real s, where one that is slower is then passed by the other.
        """
        found, real = self.delays, np.imag(s) == 0
        while len(apart := distinct(found)) > 1:
            modes = self.modes(s, found)
            passes = np.real(modes.gamma[real])
            met = [
                bool((passes[:, found == sooner].max(axis=1) >= passes[:, found == later].min(axis=1)).any())
                for sooner, later in pairwise(apart)
            ]
            near = np.diff(apart)
            if near.min() > SAME_DELAY * apart[-1] and modes.alike > ALIKE and not any(met):
                break
            k = np.where(met, near, near + apart[-1] * any(met)).argmin()
            found = np.where(found == apart[k + 1], apart[k], found)
        return found

    def admittances(self, s: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
        """Return Y11 and Y12 (n, k, k) for s (n,) in 1/s; `late` (n, k) is the part of each mode's delay beyond sT."""
        modes = self.modes(s, np.abs(late).max(axis=0))
        total = modes.gamma * self.length + late
        twice = -np.expm1(-2 * total)
        each = (2 - twice) / twice, -2 * np.exp(-total) / twice
        own, other = ((modes.flow * part[:, None]) @ modes.inverse for part in each)
        return own, other


class Eigenmodes(NamedTuple):
    """Eigenvectors of Z Y at n places: efforts `vectors` and flows `flow` (n, k, k) of k waves, exp(-gamma x) each."""

    gamma: NDArray  # (n, k) per metre
    vectors: NDArray
    inverse: NDArray  # of `vectors`
    flow: NDArray
    alike: float  # least share that one has of the mode that it resembles, or of those not told from it


def bundles_of(description: Description) -> dict[str, Bundle]:
    """Coupled lines of a scene whose losses mix the modes, by name."""
    numbers = {name: k for k, name in enumerate(description.lines)} if description.mixed else {}
    return {
        name: _bundle(description.scene.lines[name], [numbers[each] for each in lines])
        for name, lines in description.mixed.items()
    }


def _bundle(line: Any, lines: list[int]) -> Bundle:
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
