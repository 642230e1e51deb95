"""Order and slab width of a run: as the user fixed them, or fine enough for what the scene holds."""

from fractions import Fraction
from math import ceil, inf, isfinite, lcm
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.load_step import reflection
from tline.solver.nodes import Node

ORDER = 5
SLABS_PER_DELAY, SLABS_PER_RUN = 4, 500  # at least, where they cost little
CHEAP = 1e9  # line-end samples computed without asking whether that fine is needed
LARGEST = 4e8  # samples on the lines at once
WHOLE = 1e-12  # a delay this near to whole slabs, relatively, is whole


class Resolution(NamedTuple):
    """How finely a scene is computed, and what that leaves out."""

    s: int
    h: float
    notes: tuple[str, ...]


def resolution(scene: Scene, nodes: dict[str, Node]) -> Resolution:
    """Choose order and slab width.

    Raises
    ------
    InputError
        A given slab is longer than the shortest delay, or the waves under way would not fit in memory.
    """
    delays = {name: line.parameters.delay or 0.0 for name, line in scene.lines.items()}
    shortest = min(delays, key=lambda name: delays[name])
    scales = time_scales(scene, nodes)
    s = scene.solver.order or ORDER
    if scene.solver.slab is not None:
        h = float(scene.solver.slab)
        if h > delays[shortest] * (1 + WHOLE):
            raise InputError(
                "solver.slab",
                "longer than the shortest delay",
                f"at most that of lines.{shortest}, {delays[shortest]:.6g} s",
                f"{h:.6g} s",
            )
    else:
        wanted = min(delays[shortest] / SLABS_PER_DELAY, scene.t_end / SLABS_PER_RUN, *scales.values(), inf)
        affordable = 2 * len(delays) * s * scene.t_end / CHEAP
        h = _aligned(list(delays.values()), max(min(delays[shortest], affordable), wanted))
    under_way = 2 * s * sum(delays.values()) / h
    if under_way > LARGEST:
        longest = max(delays, key=lambda name: delays[name])
        raise InputError(
            f"lines.{shortest}" if scene.solver.slab is None else "solver.slab",
            f"slabs of {h:.3g} s put {under_way:.2g} samples on the lines at once, "
            f"for lines.{longest} takes {delays[longest]:.3g} s",
            f"at most {LARGEST:.0e}: a longer shortest line, or a lower order",
        )
    notes = [
        f"{where}: its time scale of {scale:.3g} s is shorter than the slab of {h:.3g} s; "
        "what is faster than the slab is damped, not resolved"
        for where, scale in scales.items()
        if scale < h * (1 - 1e-9)
    ]
    return Resolution(s, h, tuple(notes))


def time_scales(scene: Scene, nodes: dict[str, Node]) -> dict[str, float]:
    """The shortest time scale of each load and waveform that has one, s."""
    scales = {}
    for name, source in scene.sources.items():
        gaps = np.diff(source.value.breaks(scene.t_end))
        scales[f"sources.{name}"] = min(source.value.fastest(), gaps.min() if gaps.size else inf)
    for node in nodes.values():
        if node.load is not None and node.held is None:
            poles = np.linalg.eigvals(reflection(node.load, 1 / node.total, node.load_name).A)
            scales[node.load_name] = 1 / np.abs(poles).max()
    return {where: float(scale) for where, scale in scales.items() if isfinite(scale)}


def _aligned(delays: list[float], wanted: float) -> float:
    """A slab near the wanted width that divides every delay, if there is one; else one that divides the shortest."""
    shortest = min(delays)
    ratios = [Fraction(delay / shortest).limit_denominator(200) for delay in delays]
    parts = lcm(*(ratio.denominator for ratio in ratios))
    whole = all(abs(delay / shortest - ratio) <= WHOLE * ratio for delay, ratio in zip(delays, ratios, strict=True))
    if whole and shortest / parts > wanted / 20:
        return shortest / (parts * ceil(shortest / parts / wanted - WHOLE))
    return shortest / ceil(shortest / wanted - WHOLE)
