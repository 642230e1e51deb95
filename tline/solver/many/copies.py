"""A scene in many copies: topology and waveforms are shared, numbers vary; all of them as arrays over the copies."""

from collections.abc import Mapping
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.law import NonLinear
from tline.scene.load import Matched, NoFlow, Reservoir, Resistor, Short
from tline.scene.rational import Parallel, Series
from tline.scene.refuse import refuse_cavities
from tline.solver.description.description import Description
from tline.solver.description.given import Scene
from tline.solver.description.slab import WHOLE, common_parts
from tline.solver.many.nodes import ELEMENTS, WHAT, NodeOfCopies, junction_of, laws_by_node, scenes_of
from tline.solver.many.steady import before
from tline.words.wording import place

Floats = NDArray[np.float64]
MOST_UNITS = 1000  # in the shortest delay
DROWNING = 1e6  # largest ratio of a wave to the efforts


class Copies(NamedTuple):
    """A scene in N copies; L lines."""

    unit: Floats  # (N,) the common measure of a copy's delays, s
    delay: NDArray[np.int64]  # (L,) delays in units, the same in all copies
    z0: Floats  # (L, N)
    junctions: list[NodeOfCopies]
    start: Floats  # (2, 2 L, N) efforts at line ends, and waves that arrive there, before t = 0
    alike: bool  # whether no number varies within elements or waveforms
    valid: NDArray  # (N,) whether those numbers fit there, and flows before t = 0 do not drown efforts in rounding

    @property
    def judged(self) -> bool:
        """Whether errors are estimated copy by copy: with laws, or numbers that vary within elements or waveforms."""
        return not self.alike or any(junction.law is not None for junction in self.junctions)


def copies_of(description: Description, vary: Mapping[str, Floats]) -> Copies:
    """Return all copies of a scene; for arguments and errors see `tline.solver.many.runs`."""
    scene, count = description.scene, len(next(iter(vary.values())))
    numbers = {where: vary.get(where, np.full(count, value)) for where, value in variable(scene).items()}
    scenes, valid = scenes_of(scene, vary, count)
    z0, delays = (
        np.array([numbers[place("lines", name, key)] for name in description.lines]) for key in ("z0", "delay")
    )
    shortest = int(delays[:, 0].argmin())
    ratios = delays / delays[shortest]
    ratio = ratios[:, :1]
    apart = np.flatnonzero((np.abs(ratios - ratio) > WHOLE * ratio).any(axis=0))
    if len(apart):
        problem = f"the delays of copy {apart[0]} are not in the proportion of those of copy 0"
        raise InputError("lines", problem, "all delays multiplied by the same number, copy by copy")
    parts = common_parts(tuple(ratio[:, 0].tolist()), 1.0, MOST_UNITS)
    if not parts:
        expected = f"whole multiples of a part of the shortest, at most a {MOST_UNITS}th"
        raise InputError("lines", "their delays have no common measure", expected)
    delay = np.round(ratio[:, 0] * parts).astype(np.int64)
    laws = laws_by_node(description, scenes, count)
    junctions = [
        junction_of(node, z0, numbers, scenes)._replace(law=laws.get(name))
        for name, node in description.nodes.items()
        if node.ends
    ]
    for name in laws:
        if description.nodes[name].load is not None:
            raise InputError(description.nodes[name].load_name, "keeps a state beside elements with a law", WHAT)
    start = before(description, junctions, z0, delays)
    effort, wave = np.abs(start).max(axis=1)
    valid &= wave <= DROWNING * effort
    return Copies(delays[shortest] / parts, delay, z0, junctions, start, len(scenes) == 1, valid)


def _refuse(scene: Scene) -> None:
    for key in ("order", "slab"):
        if getattr(scene.solver, key) is not None:
            raise InputError(place("solver", key), "many runs choose order and slabs themselves", "a tolerance")
    refuse_cavities(scene.lines, "many runs")
    laws = {place("links", name) for name, link in scene.links.items() if isinstance(link, NonLinear)}
    for where, _ in scene.between:
        if where not in laws:
            raise InputError(where, "stands between two nodes", WHAT)
    for name, line in scene.lines.items():
        if isinstance(line, Coupled) or line.losses is not None:
            problem = "has coupled conductors" if isinstance(line, Coupled) else "has losses"
            raise InputError(place("lines", name), problem, WHAT)
    states: set[str] = set()
    for name, load in scene.loads.items():
        if not isinstance(load, NoFlow | Short | Reservoir | Matched | Resistor | Series | Parallel | NonLinear):
            raise InputError(place("loads", name), f"a load of kind '{load.kind}'", WHAT)
        if isinstance(load, Series | Parallel) and load.ratio.degree:
            if load.at in states:
                raise InputError(place("loads", name), f"a second L or C at node '{load.at}'", "one load with a state")
            states.add(load.at)
            if load.inductance is not None and scene.start == "steady":
                raise InputError(
                    place("loads", name), "an inductance in a steady state", "start = 'rest', for many runs"
                )
            height, path = scene.heights.get(load.at), load.ratio.at_zero()
            if height and height.above_level and load.inductance is not None and path != inf:
                problem = f"lets a steady flow out through an inductance below the highest node, at '{load.at}'"
                raise InputError(place("loads", name), problem, WHAT)


def variable(scene: Scene) -> dict[str, float]:
    """All numbers of a scene that may vary, by place; raise an error for scenes that cannot be run in copies."""
    _refuse(scene)
    found: dict[str, float] = {}
    for name, line in scene.lines.items():
        found[place("lines", name, "z0")] = line.parameters.z0
        found[place("lines", name, "delay")] = line.parameters.delay or 0.0
    for section, elements in (("loads", scene.loads), ("sources", scene.sources)):
        for name, element in elements.items():
            given = {key: getattr(element, key, None) for key in ELEMENTS}
            found |= {place(section, name, key): float(value) for key, value in given.items() if value}
    return found
