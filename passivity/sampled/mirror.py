"""Networks that look alike from two sides: models of their sums and differences in place of one with common poles.

Where an exchange of ports in pairs leaves S as it is, as the ends of a uniform line or the conductors of a symmetric
pair do, waves alike and waves opposite at the two ports of each pair are decoupled: with (1, +-1)/sqrt(2) for
each pair S is two smaller matrices, and passive if these are. Each has poles of its own, half of those of the whole,
and its proof is one of fewer ports. Their sum has residues r/2 with signs, exact in binary numbers; constants are
rounded so that they are, too.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from passivity.sampled.enforce import ROOM
from passivity.sampled.extremes import verdict_of
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.response import SampledResponse

MOST_PORTS = 8  # whose exchanges are all tried
ALIKE = 1e-2  # of the tolerance: largest change of S by an exchange of its ports
GRID = 2.0**46  # constants are multiples of its inverse, so that their sums and halves are exact


def mirrored(response: SampledResponse, tolerance: float) -> tuple[NDArray, list[SampledResponse]] | None:
    """An exchange of ports that leaves S nearly as it is, as the port that each becomes, and S of the two halves."""
    S, p = response.values, response.ports
    if p > MOST_PORTS:
        return None
    for pairs in _pairings(tuple(range(p))):
        swap = np.empty(p, int)
        for a, b in pairs:
            swap[[a, b]] = b, a
        if np.abs(S - S[:, swap][:, :, swap]).max() <= ALIKE * tolerance:
            one, other = np.array(pairs).T
            along = (S[:, one][:, :, one] + S[:, other][:, :, other]) / 2
            across = (S[:, one][:, :, other] + S[:, other][:, :, one]) / 2
            halves = (along + across, along - across)
            return swap, [replace(response, values=half, z0=response.z0[one], rounding=None) for half in halves]
    return None


def _pairings(ports: tuple[int, ...]) -> Iterator[list[tuple[int, int]]]:
    """All ways to put ports into pairs, none for an odd number."""
    if not ports:
        yield []
    for k in range(1, len(ports)):
        for rest in _pairings(ports[1:k] + ports[k + 1 :]):
            yield [(ports[0], ports[k]), *rest]


def on_grid(model: PoleResidueModel) -> PoleResidueModel:
    """Round the constant so that its sums are exact; return the model itself if they are."""
    constant = np.round(np.asarray(model.constant) * GRID) / GRID
    return model if np.array_equal(constant, model.constant) else replace(model, constant=constant)


def proved_on_grid(model: PoleResidueModel) -> PoleResidueModel:
    """Round the constant of a passive model, moved inside the bound as far as its proof needs, if ROOM suffices."""
    tried = (on_grid(model if not room else model.moved_inside(room)) for room in ROOM if verdict_of(model).proved)
    return next((moved for moved in tried if verdict_of(moved).proved), on_grid(model))


def joined(swap: NDArray, halves: Sequence[PoleResidueModel]) -> PoleResidueModel:
    """The whole of the models of waves alike and of waves opposite."""
    p = len(swap)
    one = np.flatnonzero(np.arange(p) < swap)
    sides = np.zeros((2, p // 2, p))  # what each port has to do with a pair
    sides[:, np.arange(p // 2), one] = 1
    sides[0, np.arange(p // 2), swap[one]], sides[1, np.arange(p // 2), swap[one]] = 1, -1
    spread = [side.T @ half.coefficients.reshape(-1, p // 2, p // 2) @ side / 2
              for side, half in zip(sides, halves, strict=True)]  # fmt: skip
    poles = np.concatenate([half.poles for half in halves])
    whole = PoleResidueModel(poles, np.zeros((len(poles), p, p)), np.zeros((p, p)))
    constant = spread[0][-2:] + spread[1][-2:]
    return whole.with_coefficients(np.concatenate([spread[0][:-2], spread[1][:-2], constant]))
