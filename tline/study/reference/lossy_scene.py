"""The exact solution of a scene with one lossy line between a source behind a resistance and a resistor."""

from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.cavities import refuse_cavities
from tline.scene.heights import refuse_heights
from tline.scene.load import NoFlow, Resistor
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.study.reference.exact import Exact
from tline.study.reference.lattice import instant
from tline.study.reference.lossy import Drive, lossy_response
from tline.study.reference.network import decimal
from tline.study.reference.waveforms import straight
from tline.words.wording import place


class LossySolution:
    """What a probe at an end sees, from rest, to as many digits as asked.

    Parameters
    ----------
    scene : Scene
        One line with linear losses; a voltage or pressure source behind a resistance at one end, of straight pieces; a
        resistor, or nothing, at the other.
    probe : str
        Name of a probe, at one of the ends.

    Raises
    ------
    InputError
        Naming what is not so.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="20 ns", probes={"far": {"at": "far"}},
    ...     lines={"l": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns", "length": "0.2 m", "resistance": 20}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"end": {"at": "far", "kind": "resistor", "resistance": 50}},
    ... )
    >>> print(LossySolution(scene, "far").at(["1.5e-9"], digits=12).u[0])
    0.4805612853383
    """

    def __init__(self, scene: Scene, probe: str):
        if len(scene.lines) != 1 or len(scene.sources) != 1 or len(scene.loads) > 1 or scene.links:
            raise InputError("lines", "not one line with one source and one load at most", "such a scene")
        if scene.start != "rest":
            raise InputError("start", "exact solutions start at rest", "'rest'", f"'{scene.start}'")
        refuse_cavities(scene.lines, "exact solutions")
        refuse_heights(scene, "exact solutions")
        ((name, line),) = scene.single_lines.items()
        ((given, source),) = scene.sources.items()
        if line.losses is None or not line.losses.linear:
            raise InputError(place("lines", name), "its losses are not linear", "such as a resistance")
        if not source.is_effort or source.at not in line.nodes:
            raise InputError(place("sources", given), "no effort at an end", "a voltage or pressure source")
        far = line.nodes[1 - line.nodes.index(source.at)]
        for key, load in scene.loads.items():
            if not isinstance(load, Resistor | NoFlow) or load.at != far:
                raise InputError(place("loads", key), "no resistor at the end without the source", "a resistor")
        at = scene.probes[probe].at
        if at is None:
            raise InputError(place("probes", probe), "stands within the line", "at = …")
        self._line, self._delay = line.losses.exact, decimal(line.parameters.delay or 0.0)
        self._source = float(source.resistance or 0.0)
        self._load = next((float(load.resistance) for load in scene.loads.values() if isinstance(load, Resistor)), inf)
        self._position = 0.0 if at == source.at else self._line.length
        self._end = decimal(scene.t_end)
        self._parts = _parts(source.value, self._end, place("sources", given))

    @property
    def fronts(self) -> NDArray:
        """Instants at which jumps or corners of the source pass the probe, in order, s."""
        first = self._delay if self._position else Fraction(0)
        starts = {start + first for start, _, _ in self._parts}
        hops = int((self._end - min(starts)) / (2 * self._delay)) + 1
        return np.array(sorted({t + 2 * k * self._delay for t in starts for k in range(hops)}), float)

    def at(self, times: Iterable[Any], digits: int = 20) -> Exact:
        """What the probe sees; for arguments see `lossy_response`."""
        instants = [instant(t) for t in times]
        u, y = ([Decimal(0)] * len(instants) for _ in range(2))
        for start, drive, factor in self._parts:
            late = [k for k, t in enumerate(instants) if t > start]
            if not late:
                continue
            since = [instants[k] - start for k in late]
            ends = {"source": self._source, "load": self._load, "drive": drive, "digits": digits}
            found = lossy_response(self._line, since, self._position, **ends)
            size = Decimal(factor.numerator) / Decimal(factor.denominator)
            for k, effort, flow in zip(late, found.u, found.y, strict=True):
                u[k], y[k] = u[k] + size * effort, y[k] + size * flow
        return Exact(tuple(u), tuple(y))


def _parts(shape: Shape, end: Fraction, where: str) -> list[tuple[Fraction, Drive, Fraction]]:
    """Steps and ramps that add up to a waveform: when each begins, which it is, and how large."""
    pieces = straight(shape, end)
    if pieces is None:
        raise InputError(where, "its waveform is curved", "straight pieces")
    parts = [(Fraction(0), Drive.STEP, pieces[0][1])]
    for (start, first, slope), (then, level, steep) in pairwise(pieces):
        assert then is not None
        before = first + slope * (then - start) if start is not None else first
        parts += [(then, Drive.STEP, level - before), (then, Drive.RAMP, steep - slope)]
    return [part for part in parts if part[2] and part[0] < end]
