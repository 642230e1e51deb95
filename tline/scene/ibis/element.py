"""Loads of kind "ibis": how the driver of an IBIS file switches, and the elements it is made of.

Into a fixture of resistance R toward V, with the die's capacitance C, a waveform u(t) of the file means

    (V - u)/R - C du/dt - i_clamps(u) = p·i_up(u) + q·i_down(u),

one equation for each waveform. Two of them, into different fixtures, give both shares p and q; of one alone q = 1 - p;
without any p is the ramp. The method is that of two waveforms, as in the IBIS Modeling Cookbook (2005), section 2.
"""

import re
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import PrivateAttr, ValidationInfo, model_validator

from tline.distinct import distinct
from tline.errors import InputError
from tline.scene.characteristic import Curve
from tline.scene.element import AtNode, Composed, OneMedium, optional, required
from tline.scene.ibis import die_of
from tline.scene.ibis.buffer import ALWAYS, DRIVING, Buffer, CurrentTable, EdgeWaveform, read_buffer, read_once
from tline.scene.quantity import ZERO, Duration, Time
from tline.scene.rational import Capacitor, Ratio, RationalImpedance, Series, exact
from tline.scene.shape import Shape
from tline.scene.source import Source
from tline.words.wording import shown

SWITCHED = "pullup", "pulldown"  # tables that are weighted over time; all others are always connected
SAME = 1e-6  # of the shortest step of an edge: instants of two edges nearer to each other are one
STRAIGHT = 1e-2  # of a share: largest error of straight lines between fewer instants; that of cubics is a tenth


class Edge(NamedTuple):
    """Shares of pull-up and pull-down after an edge, piecewise linear in time, from 0 to 1 or back."""

    t: NDArray
    up: NDArray
    down: NDArray
    misfit: float  # largest distance of the shares at both ends from 0 and 1, before they were drawn there


def edge_of(buffer: Buffer, rises: bool) -> Edge:
    """Edge from the waveforms of a model, or else from its ramp.

    Examples
    --------
    >>> table = CurrentTable(0.0, False, np.array([0.0, 1.0]), np.array([0.0, 0.02]))
    >>> buffer = Buffer("x", "output", 1e-12, 1.0, {"pulldown": table}, {True: 1e-9}, [], (0, 0, 0), (0, 0), [])
    >>> edge = edge_of(buffer, True)
    >>> edge.t.tolist(), edge.up.tolist(), edge.down.tolist()
    ([0.0, 1e-09], [0.0, 1.0], [1.0, 0.0])
    """
    waveforms = [each for each in buffer.waveforms if each.rises == rises]
    if not waveforms:
        up = np.array([0.0, 1.0])
        return Edge(np.array([0.0, buffer.ramps[rises]]), up if rises else 1 - up, 1 - up if rises else up, 0.0)
    t = distinct(np.concatenate([each.t for each in waveforms]))
    up, down = _shares(buffer, waveforms, t)
    wanted = (0.0, 1.0) if rises else (1.0, 0.0)
    misfit = max(abs(up[0] - wanted[0]), abs(up[-1] - wanted[1]), abs(down[0] - wanted[1]), abs(down[-1] - wanted[0]))
    up, down = _drawn(up, *wanted), _drawn(down, *wanted[::-1])
    kept = np.union1d(_kept(t, up), _kept(t, down))
    return Edge(t[kept] - min(t[0], 0.0), up[kept], down[kept], float(misfit))


def _shares(buffer: Buffer, waveforms: list[EdgeWaveform], t: NDArray) -> tuple[NDArray, NDArray]:
    """Shares of both tables by least squares over all waveforms."""
    u = np.array([np.interp(t, each.t, each.u) for each in waveforms])
    toward, R, C = np.array([(each.toward, each.resistance, each.capacitance) for each in waveforms]).T[:, :, None]
    flow = (toward - u) / R - (buffer.capacitance + C) * np.gradient(u, t, axis=1)
    flow -= sum(_current(table, u) for name, table in buffer.tables.items() if name not in SWITCHED)
    up, down = (_current(buffer.tables.get(name), u) for name in SWITCHED)
    if len(waveforms) == 1 or not (up.any() and down.any()):  # q = 1 - p
        p = _quotient(((flow - down) * (up - down)).sum(axis=0), ((up - down) ** 2).sum(axis=0))
        return p, 1 - p
    a, b, c = (up * up).sum(axis=0), (up * down).sum(axis=0), (down * down).sum(axis=0)
    x, y, determinant = (flow * up).sum(axis=0), (flow * down).sum(axis=0), a * c - b * b
    return _quotient(c * x - b * y, determinant), _quotient(a * y - b * x, determinant)


def _current(table: CurrentTable | None, u: NDArray) -> NDArray:
    return np.zeros_like(u) if table is None else table.current(u)


def _quotient(a: NDArray, b: NDArray) -> NDArray:
    """Quotient a/b, interpolated between neighbours where the waveforms do not determine it."""
    sure = b > 1e-9 * b.max(initial=0.0)
    k = np.arange(len(b))
    return np.interp(k, k[sure], a[sure] / b[sure]) if sure.any() else np.zeros_like(a)


def _drawn(share: NDArray, first: float, last: float) -> NDArray:
    """Shift and scale a share to its values at both ends; never below zero."""
    span = share[-1] - share[0]
    moved = first + (last - first) * (share - share[0]) / span if span else np.linspace(first, last, len(share))
    return np.maximum(moved, 0.0)


def _kept(t: NDArray, y: NDArray) -> NDArray:
    """Instants between which straight lines are accurate enough (Ramer 1972, Douglas and Peucker 1973)."""
    kept, parts = {0, len(t) - 1}, [(0, len(t) - 1)]
    while parts:
        low, high = parts.pop()
        line = y[low] + (y[high] - y[low]) * (t[low : high + 1] - t[low]) / (t[high] - t[low])
        off = np.abs(y[low : high + 1] - line)[1:-1]  # each part is shorter than the whole, whatever rounding does
        if off.size and off.max() > STRAIGHT:
            k = low + 1 + int(off.argmax())
            kept.add(k)
            parts += [(low, k), (k, high)]
    return np.array(sorted(kept))


def over_time(
    first: bool, edges: dict[bool, Edge], instants: list[tuple[float, bool]]
) -> dict[str, tuple[NDArray, NDArray]]:
    """Shares over time of a driver that begins high or low and has edges at instants, each a rise or a fall.

    The changes of the edges add up, so that an edge before the end of the last one continues from there.
    """
    found = {}
    for name, begin in (("up", float(first)), ("down", float(not first))):
        t, bend = [np.zeros(0)], [np.zeros(0)]
        for at, rises in instants:
            edge = edges[rises]
            t.append(at + edge.t)
            bend.append(np.diff(np.diff(getattr(edge, name)) / np.diff(edge.t), prepend=0.0, append=0.0))
        unit = SAME * min((float(np.diff(edges[rises].t).min()) for _, rises in instants), default=1.0)
        marks, where = np.unique(np.round(np.concatenate(t) / unit), return_inverse=True)
        times = marks * unit
        slope = np.cumsum(np.bincount(where, np.concatenate(bend), len(times)))
        level = begin + np.concatenate([[0.0], np.cumsum(slope[:-1] * np.diff(times))])[: len(times)]
        found[name] = times, np.maximum(level, 0.0)
    return found


LONGEST = 8192  # bits
Parts = dict[str, dict[str, Any]]  # elements by section and name


class Shares(Shape):
    """Levels at instants, with monotone smooth cubics in between; not read from files.

    The slopes at instants are those of F. N. Fritsch and J. Butland (1984).
    """

    t: tuple[float, ...]
    level: tuple[float, ...]

    _curve: Callable[[NDArray], NDArray] | None = PrivateAttr(default=None)

    def breaks(self, t_end):  # noqa: D102
        return np.empty(0)

    def value(self, t, inside):  # noqa: D102
        if self._curve is None:
            from scipy.interpolate import PchipInterpolator

            made: Callable[[NDArray], NDArray] = PchipInterpolator(self.t, self.level)
            self._curve = made
        return self._curve(np.clip(t + 0.0 * inside, self.t[0], self.t[-1]))

    def fastest(self):  # noqa: D102
        return min(np.diff(self.t))


class Ibis(Composed, OneMedium, RationalImpedance, AtNode):
    """Driver or receiver as published by its maker: a model of an IBIS file at one of its corners.

    It becomes the capacitance of the die with tables of current over voltage, to ideal supplies, behind the package.
    With `bits` the pull-up and pull-down tables are weighted over time, so that the waveforms of the file come out at
    its fixtures; or in proportion to the ramp where it has no waveforms.

    References
    ----------
    ANSI/EIA-656-B, I/O Buffer Information Specification 4.2 and later; IBIS Modeling Cookbook (2005).
    """

    medium, instead = "electrical", "kind = 'table'"
    kind: Literal["ibis"] = "ibis"
    file: str = required("IBIS file, looked for beside the scene file")
    model: str | None = optional("name of the model, if the file has several")
    pin: str | None = optional("pin of the component: its model and its package")
    component: str | None = optional("name of the component, if the file has several")
    corner: Literal["typ", "min", "max"] = optional("column of the file's values", "typ")
    package: bool = optional("whether R, L and C of the package stand in front of the die", True)
    bits: str | None = optional("what a driver sends, zeros and ones; without it, it receives")
    bit: Duration | None = optional("time of a bit")
    begin: Time = optional("begin of the first bit, which also stands before it", ZERO)
    _buffer: Buffer = PrivateAttr()
    _edges: dict[bool, Edge] = PrivateAttr()
    _near: str | None = PrivateAttr(default=None)  # node of the pin

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo):
        asked = self.model, self.pin, self.component, self.corner, self.bits is not None
        self._buffer = read_once(_read, self.file, info, *asked)
        self._edges = self._checked()
        self._ratio = Ratio.of_fractions([1], [exact(self._buffer.capacitance), 0])
        return self

    def _checked(self) -> dict[bool, Edge]:
        """Edges of a driver; none of a receiver."""
        kind, buffer = self._buffer.kind, self._buffer
        if self.bits is None:
            if kind in ALWAYS:
                raise InputError("bits", f"is missing, for the model is of type '{kind}' and drives", "zeros and ones")
            if self.bit is not None:
                raise InputError("bit", "is the time of bits", "bits beside it")
            return {}
        if kind not in DRIVING:
            raise InputError("bits", f"the model is of type '{kind}' and cannot drive", "none")
        if not re.fullmatch(f"[01]{{1,{LONGEST}}}", self.bits):
            raise InputError("bits", "not a bit pattern", f"zeros and ones, at most {LONGEST:,}", shown(self.bits))
        if self.bit is None:
            raise InputError("bit", "is missing", "the time of a bit, such as '1 ns'")
        if not {*SWITCHED} & buffer.tables.keys():
            raise InputError("file", f"model '{buffer.name}' has no table to drive with", "[Pullup] or [Pulldown]")
        edges = {}
        for rises in sorted(
            {after == "1" for before, after in zip(self.bits, self.bits[1:], strict=False) if before != after}
        ):
            if not buffer.ramps.get(rises) and not any(each.rises == rises for each in buffer.waveforms):
                word = "rising" if rises else "falling"
                raise InputError(
                    "file", f"model '{buffer.name}' has no {word} edge", f"[Ramp], or a [{word.title()} Waveform]"
                )
            edges[rises] = edge_of(buffer, rises)
        return edges

    @property
    def near(self) -> str:
        """Node named in the scene, also with a package."""
        return self._near or self.at

    @property
    def summary(self) -> str:
        """Summary of the file's model and of the parts left out of it, in one line."""
        buffer = self._buffer
        told = [f"{self.file}, model {buffer.name} ({buffer.kind}, {self.corner})"]
        if self._edges:
            longest = max(float(edge.t[-1]) for edge in self._edges.values())
            told.append(
                f"edges end within {longest:.3g} s, " + ("with" if buffer.waveforms else "ramps without") + " waveforms"
            )
            worst = max(edge.misfit for edge in self._edges.values())
            if worst > 0.02:
                told.append(f"waveforms and tables differ at their ends by {worst:.0%} of a table")
        return "; ".join([*told, *buffer.notes])

    def taken_apart(self, own: str) -> tuple[Parts, "Ibis"]:
        """Return the other elements of the model, named after its own place, and the capacitance of its die."""
        name = own.partition(".")[2].strip('"')
        R, L, C = self._buffer.package if self.package else (0.0, 0.0, 0.0)
        die = die_of(name) if R or L else self.at
        parts: Parts = {"sources": {}, "loads": {}, "links": {}}
        if R or L:
            values = {key: value for key, value in (("resistance", R), ("inductance", L)) if value}
            parts["links"][f"{name}, package"] = Series(**{"nodes": (self.at, die), **values})
        if C:
            parts["loads"][f"{name}, package"] = Capacitor(**{"at": self.at, "capacitance": C})
        if self._buffer.damper[1]:
            values = {
                key: value
                for key, value in zip(("resistance", "capacitance"), self._buffer.damper, strict=True)
                if value
            }
            parts["loads"][f"{name}, damper"] = Series(**{"at": die, **values})
        scales = self._scales()
        for key, table in self._buffer.tables.items():
            if key in SWITCHED and key not in scales:
                continue
            _place(parts, f"{name}, {key}", table, die, scales.get(key))
        moved = self.model_copy(update={"at": die})
        moved._near = self.at
        return parts, moved

    def _scales(self) -> dict[str, Shares]:
        """Shares of the driving tables over time; none of a receiver."""
        if self.bits is None or self.bit is None:
            return {}
        bits = [bit == "1" for bit in self.bits]
        begin = float(self.begin)
        instants = [(begin + k * float(self.bit), bits[k]) for k in range(1, len(bits)) if bits[k] != bits[k - 1]]
        shares = over_time(bits[0], self._edges, instants)
        return {
            key: _corners(*shares[short], bits[0] == (short == "up"))
            for key, short in (("pullup", "up"), ("pulldown", "down"))
        }


def _corners(t: np.ndarray, level: np.ndarray, high: bool) -> Shares:
    if not len(t):
        t, level = np.arange(2.0), np.full(2, float(high))
    return Shares(t=tuple(t.tolist()), level=tuple(level.tolist()))


def _place(parts: Parts, name: str, table: CurrentTable, die: str, scale: Shares | None) -> None:
    """Place a table between the die and its reference: a load if that is earth, else a link from a new source."""
    scaled = {} if scale is None else {"scale": scale}
    if not table.downwards and table.reference == 0:
        points = list(zip(table.volts.tolist(), table.amps.tolist(), strict=True))
        parts["loads"][name] = Curve(**{"at": die, "points": points}).model_copy(update=scaled)
        return
    parts["sources"][name] = Source(**{"at": name, "kind": "voltage", "value": table.reference})
    ends, sign = ((name, die), -1.0) if table.downwards else ((die, name), 1.0)
    points = list(zip(table.volts.tolist(), (sign * table.amps).tolist(), strict=True))
    parts["links"][name] = Curve(**{"nodes": ends, "points": points}).model_copy(update=scaled)


@lru_cache(maxsize=64)
def _read(path: Path, stamp: int, *asked: Any) -> Buffer:
    """Read a model; `stamp` is the file's time of modification, as a scene is read several times."""
    return read_buffer(path, *asked)
