"""Loss elements of lines: their places, and the effort that each takes away.

A loss element of series impedance Z sees 2 z0 y + Z y = a - b and takes e = Z y; one of shunt admittance Y sees
2 u + z0 Y u = a + b and takes e = z0 Y u. Both read 2 q + ζ q = w, e = w - 2 q, with ζ = Z/z0 or z0 Y.

Where they are not too many, loss elements stand half a slab apart, so that every slab of one wave meets every slab of
the other: what a jump leaves behind then changes from slab to slab alike, and errors at slab ends are smooth. None
stands at an end, so the outermost take what lies before them, too: as an open trapezoidal rule of second order.
"""

from collections.abc import Collection, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss import Foster
from tline.loss.losses import Losses
from tline.solver.assembly.flow_tables import flow_table
from tline.solver.description.circuits import Circuits, one_step
from tline.solver.description.lines import Line
from tline.solver.description.slab import WHOLE
from tline.solver.kernel.network import CONSTANT, NO_LOSSES, REMEMBERED, SQUARED, TABLED, LossElements
from tline.solver.radau import Basis

EMPTY = np.empty(0)


class _Law(NamedTuple):
    """Law of equal loss elements of one line: kind, sign, strength, entries and modes as in `LossElements`."""

    kind: int
    sign: float
    strength: NDArray | float = 0.0
    entries: NDArray = EMPTY
    modes: int = 0
    passed: float = 0.0


class _Row(NamedTuple):
    """Equal loss elements of one line."""

    line: int
    place: NDArray
    law: _Law


def loss_elements_in(lines: Mapping[str, Line], h: float, most: int) -> dict[str, int]:
    """Places of loss elements in each lossy line: where any two slabs meet inside, if these are not too many."""
    delays = {name: line.delay for name, line in lines.items() if line.losses is not None}
    longest = max(delays.values(), default=0.0)
    return {
        name: min(2 * int(delay / h * (1 + WHOLE)) - 1, max(round(most * delay / longest), 1))
        for name, delay in delays.items()
    }


def loss_elements_of(
    lines: Mapping[str, Line],
    circuits: Mapping[str, Circuits],
    delay: NDArray,
    order: Basis,
    h: float,
    most: int,
    without: Collection[int],
) -> tuple[LossElements, int]:
    """All loss elements of a scene, and the number of their states.

    Parameters
    ----------
    lines : mapping of str to Line
    circuits : mapping of str to Circuits
        Of all lines that lose something.
    delay : ndarray, shape (lines,)
        Whole slabs of each delay.
    most : int
        Loss elements of one law in the longest line.
    without : collection of int
        Numbers of lines whose losses have no loss elements.
    """
    rows: list[_Row] = []
    count = loss_elements_in(lines, h, most)
    for k, (name, line) in enumerate(lines.items()):
        if line.losses is not None and k not in without:
            rows += _rows(k, line, circuits[name], int(delay[k]), count[name], order, h)
    if not rows:
        return NO_LOSSES, 0
    laws, size = [row.law for row in rows], [len(row.place) for row in rows]
    states = np.cumsum([0, *(law.modes * n for law, n in zip(laws, size, strict=True))])
    entries, at = _pooled([law.entries for law in laws])
    losses = LossElements(
        gap=_gaps(rows, delay),
        line=np.array([row.line for row in rows]),
        kind=np.array([law.kind for law in laws]),
        sign=np.array([law.sign for law in laws]),
        first=np.cumsum([0, *size]),
        place=np.concatenate([row.place for row in rows]),
        passed=np.array([law.passed for law in laws]),
        strength=np.concatenate([np.broadcast_to(row.law.strength, len(row.place)) for row in rows]),
        at=at,
        modes=np.array([law.modes for law in laws]),
        entries=entries,
        memory=states[:-1],
    )
    return losses, int(states[-1])


def _pooled(entries: list[NDArray]) -> tuple[NDArray, NDArray]:
    """Entries of all rows, those that rows share once, and the place of each row's."""
    first, kept, n = {}, [], 0
    for each in entries:
        if id(each) not in first:
            first[id(each)], n = n, n + len(each)
            kept.append(each)
    return np.concatenate(kept), np.array([first[id(each)] for each in entries])


def _gaps(rows: list[_Row], delay: NDArray) -> NDArray:
    """Slabs in which nothing passes from one loss element, or end, of a line to another; its delay if it has none."""
    places: dict[int, set[bytes]] = {}
    for row in rows:
        places.setdefault(row.line, set()).add(row.place.tobytes())
    known, gaps = {}, delay.copy()
    for line, here in places.items():
        alike = int(delay[line]), frozenset(here)
        if alike not in known:
            apart = np.diff(np.unique([0, 2 * delay[line], *np.frombuffer(b"".join(here), int)]))
            known[alike] = max(int(apart.min()) // 2, 1)
        gaps[line] = known[alike]
    return gaps


def _rows(k: int, line: Line, circuits: Circuits, delay: int, count: int, order: Basis, h: float) -> list[_Row]:
    """Loss elements at whole slabs, then those between in reverse order, for laws that do not commute."""
    losses, z0 = line.losses, line.z0
    assert losses is not None
    if losses.distortionless:
        share, each = -float(np.expm1(-losses.attenuation)) / 2, float(np.exp(-losses.attenuation / 2))
        return [_Row(k, np.array([delay]), _Law(CONSTANT, sign, share, passed=each)) for sign in (-1.0, 1.0)]
    place = _places(delay, count)
    even = bool(circuits.series.rates.size or circuits.shunt.rates.size or not (losses.linear or losses.quadratic))
    share = shares(count, even)
    rows: list[_Row] = []
    for turn, here in ((1, place % 2 == 0), (-1, place % 2 == 1)):
        part = share[0] if even else share[here]
        laws = [
            *_linear(-1.0, circuits.series, part * losses.exact.length / z0, order, h),
            *_friction(losses, z0, part),
            *_linear(1.0, circuits.shunt, part * losses.exact.length * z0, order, h),
        ]
        rows += [_Row(k, place[here], law) for law in laws[::turn]] if here.any() else []
    return rows


@lru_cache(1024)
def shares(count: int, even: bool) -> NDArray:
    """Share of each loss element in the losses of its line; equal if one table or circuit does for all."""
    if even or count == 1:
        return np.full(count, 1 / count)
    share = np.full(count, 1 / (count + 1))
    share[[0, -1]] *= 1.5
    return share


@lru_cache(1024)
def _places(delay: int, count: int) -> NDArray:
    """Half slabs from end 1."""
    return np.round(2 * delay * np.arange(1, count + 1) / (count + 1)).astype(int)


def _linear(sign: float, law: Foster, scale: Any, order: Basis, h: float) -> list[_Law]:
    """A circuit, times a scale."""
    if law.strengths.size:
        return [_Law(REMEMBERED, sign, 0.0, one_step(law, scale, order, h), law.rates.size)]
    loss = scale * law.loss
    return [_Law(CONSTANT, sign, loss / (2 + loss))] if law.loss else []


def _friction(losses: Losses, z0: float, share: Any) -> list[_Law]:
    """A share of the friction that depends on the size of the flow."""
    if losses.linear:
        return []
    length = losses.exact.length * share
    if losses.quadratic:
        return [_Law(SQUARED, -1.0, losses.quadratic * length / z0**2)]
    assert losses.flow_law is not None
    entries, scale = flow_table(losses.flow_law, z0, length)
    return [_Law(TABLED, -1.0, scale, entries)]
