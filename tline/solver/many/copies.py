"""A scene in many copies: topology and waveforms are shared, numbers vary; all of them as arrays over the copies.

Before t = 0 they are at rest, or in the steady state that constant sources imply. Lossless lines join nodes to parts
with one effort each. One that is held is known; else a part is a Thévenin source to the one element at it, whose law
answers at once. Flows are those of a slow rise from rest, as in `tline.solver.steady.steady_state`.

A period, the common measure of a copy's delays, is cut in slabs so that all fronts pass at their edges. Fronts of a
source leave at breaks of its waveform and meet nodes whole periods later. So if the breaks' places in the period are
edges of slabs, every wave is smooth in every slab of every copy, for any delays.
"""

from collections.abc import Mapping, Sequence
from math import ceil, inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.distinct import distinct
from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.law import NonLinear
from tline.scene.load import Matched, NoFlow, Reservoir, Short
from tline.scene.rational import Parallel, Resistor, Series
from tline.scene.refuse import refuse_cavities
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import Scene, Shape
from tline.solver.description.groups import parts
from tline.solver.description.slab import WHOLE, common_parts
from tline.solver.kernel.network import Crossing
from tline.solver.kernel.units import law_addresses
from tline.solver.many.nodes import (
    ELEMENTS,
    WHAT,
    LawOfCopies,
    NodeOfCopies,
    Varying,
    junction_of,
    laws_by_node,
    scenes_of,
    value,
    value_before,
)
from tline.solver.radau import Basis
from tline.solver.steady.steady_state import SAME_EFFORT
from tline.words.wording import place

Floats = NDArray[np.float64]
MOST_UNITS = 1000  # in the shortest delay
DROWNING = 1e6  # largest ratio of a wave to the efforts
MOST_BREAKS = 12


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


def before(description: Description, junctions: Sequence[NodeOfCopies], z0: Floats, delays: Floats) -> Floats:
    """Efforts at line ends, counted from the level, and waves that arrive there, shape (2, 2 L, N)."""
    lines, count = z0.shape
    start = np.zeros((2, 2 * lines, count))
    if not description.steady:
        return start
    at = np.empty(2 * lines, int)
    for k, junction in enumerate(junctions):
        at[junction.ends] = k
    first, second = at[::2], at[1::2]
    part = parts(first, second, len(junctions))
    effort, flow_in = np.zeros((2, len(junctions), count))
    fixed: list[int] = []
    for number in range(part.max() + 1):
        here = np.flatnonzero(part == number).tolist()
        held = [k for k in here if junctions[k].conductance is None]
        effort[here], flow_in[here] = _at_part([junctions[k] for k in here], count)
        fixed += held or [here[0]]
    arriving = z0 * _along(first, second, 1 / (z0 * delays), flow_in, fixed)
    for side, node, sign in ((0, first, -1.0), (1, second, 1.0)):
        start[0, side::2] = effort[node]
        start[1, side::2] = effort[node] + sign * arriving
    return start


def _at_part(junctions: list[NodeOfCopies], count: int) -> tuple[Floats, Floats]:
    """Effort of nodes joined by lossless lines, (copies,), and the flow from each into its lines."""
    zero = np.zeros(count)
    waves = [sum((share * value_before(shape) for shape, share in each.drives), zero) for each in junctions]
    held = [wave for each, wave in zip(junctions, waves, strict=True) if each.conductance is None]
    conducted = [zero if each.conductance is None else each.conductance for each in junctions]
    pairs = zip(junctions, waves, strict=True)
    driven = [zero if each.conductance is None else wave / each.impedance for each, wave in pairs]
    if held:
        u, z = held[0], zero
        if any((np.abs(other - u) > SAME_EFFORT * np.maximum(np.abs(other), np.abs(u))).any() for other in held):
            raise InputError("start", "its lines join different efforts", WHAT)
    else:
        total = np.sum(conducted, axis=0)
        if sum(each.law is not None for each in junctions) > 1 or not (total > 0).all():
            raise InputError("start", "its steady state is that of several elements, or of none that conducts", WHAT)
        u, z = np.sum(driven, axis=0) / total, 1 / total
    flows = [zero if each.law is None else _through(each.law, u, z) for each in junctions]
    u = u - z * np.sum(flows, axis=0)
    return u, np.array(driven) - np.array(conducted) * u - np.array(flows)


def _through(law: LawOfCopies, v: Floats, z: Floats) -> Floats:
    """Flow out of a node through an element, behind an effort and an impedance."""
    from tline.solver.kernel.laws.crossing import Through, through

    across = law.sign * (v - (0.0 if law.beyond is None else value_before(law.beyond)))
    control, flow, slope = np.empty((3, len(v)))
    control[:] = value_before(law.control)
    at = law.constants.shape[1] * np.arange(len(v))
    crossing = Crossing(law.constants.ravel(), *np.empty((4, 1)))
    unit = np.full(len(v), law_addresses([law.unit])[0])
    through(pack(Through(unit, at, control, across, z, flow, slope, crossing)))
    return law.sign * flow


def _along(first: NDArray, second: NDArray, stiffness: Floats, flow_in: Floats, fixed: list[int]) -> Floats:
    """Flows along lines (L, copies) that balance the inflow: differences of a potential, zero at fixed nodes."""
    n, count = flow_in.shape
    matrix, lines = np.zeros((n, n, count)), zip(first, second, stiffness, strict=True)
    for a, b, k in lines:
        matrix[a, a] += k
        matrix[b, b] += k
        matrix[a, b] -= k
        matrix[b, a] -= k
    free, potential = np.setdiff1d(np.arange(n), fixed), np.zeros((n, count))
    own = matrix[np.ix_(free, free)].transpose(2, 0, 1)
    potential[free] = np.linalg.solve(own, flow_in[free].T[..., None])[..., 0].T
    return stiffness * (potential[first] - potential[second])


def breaks_of(description: Description, copies: Copies) -> Floats:
    """Instants after t = 0 at which waveforms jump or bend, s, shape (breaks, copies), or (breaks, 1) if all alike.

    Copies with fewer of them have zeros in their place.
    """
    t_end, drives = description.t_end, [pair for junction in copies.junctions for pair in junction.drives]
    laws = [junction.law for junction in copies.junctions if junction.law is not None]
    waveforms = [shape for shape, _ in drives] + [law.control for law in laws]
    waveforms += [law.beyond for law in laws if law.beyond is not None]
    found: list[NDArray] = [np.zeros((0, 1))]
    for waveform in waveforms:
        alone = isinstance(waveform, Shape)
        each = [shape.breaks(t_end) for shape in ([waveform] if alone else waveform)]
        each = [distinct(instants[(instants > 0) & (instants < t_end)]) for instants in each]
        most = max(map(len, each))
        found.append(np.transpose([np.pad(instants, (most - len(instants), 0)) for instants in each]))
    if len({part.shape[1] for part in found}) > 1:
        found = [np.broadcast_to(part, (len(part), len(copies.unit))) for part in found]
    instants = np.vstack(found)
    if instants.shape[1] == 1:
        instants = distinct(instants)[:, None]
    if len(instants) > MOST_BREAKS:
        problem = "their waveforms have too many jumps and corners for many runs"
        raise InputError("sources", problem, f"at most {MOST_BREAKS}", f"{len(instants)}")
    return instants


def front_places(breaks: Floats, unit: Floats) -> Floats:
    """Places at which fronts pass nodes, from the begin of a period to its end, as shares, shape (fronts, copies).

    Breaks leave at instants, s, shape (breaks,) or (breaks, copies); `unit` is the period of each copy, s.

    Examples
    --------
    >>> front_places(np.array([1.0, 4.5]), np.array([2.0, 3.0])).T.round(3).tolist()
    [[0.0, 0.25, 0.5, 1.0], [0.0, 0.333, 0.5, 1.0]]
    """
    places = np.reshape(breaks, (len(breaks), -1 if len(breaks) else 1)) / unit % 1.0
    places = np.sort(np.where((places < EDGE) | (places > 1 - EDGE), 0.0, places), axis=0)
    return np.vstack([np.zeros(len(unit)), places, np.ones(len(unit))])


def slab_edges(fronts: Floats, parts: int, growth: float) -> Floats:
    """Edges of the slabs in a period, as shares of it, shape (slabs + 1, copies); some may be of no width.

    The first slab after any front is no wider than it would be were there no fronts.

    Fronts have the shape (fronts, copies), as shares of the period; without fronts it would have `parts` slabs. Behind
    a front each slab is wider than the one before by the factor `growth`.

    Examples
    --------
    >>> slab_edges(np.array([[0.0], [0.4], [1.0]]), 3, 2.0).T.round(3).tolist()
    [[0.0, 0.133, 0.4, 0.486, 0.657, 1.0]]
    """
    width = np.diff(fronts, axis=0)
    widest = width.max(axis=1)
    count = widest * parts if growth == 1 else np.log1p(widest * (growth**parts - 1)) / np.log(growth)
    count = np.maximum(np.ceil(count - EDGE).astype(int), 1)
    parted = [np.cumsum(growth ** np.arange(n)) for n in count]
    return cut(fronts, [np.concatenate([[0.0], ends / ends[-1]]) for ends in parted])


def cut(fronts: Floats, shares: Sequence[Floats]) -> Floats:
    """Edges of slabs from front to front at shares, 0 to 1, of the way to the next one; shape (slabs + 1, copies)."""
    each = zip(fronts[:-1], np.diff(fronts, axis=0), shares, strict=True)
    return np.vstack([*(begin + width * share[:-1, None] for begin, width, share in each), fronts[-1:]])


def driven_waves(
    drives: list[list[tuple[Varying, Floats]]], order: Basis, unit: Floats, edges: Floats, n: int, t_end: float
) -> Floats:
    """Sources' parts of Thévenin waves at all points of n periods, or of fewer, of which the last one repeats.

    Drives of each node with sources are waveforms and their shares (batches, B); edges have the shape (batches, slabs +
    1, B), waves (batches, nodes, periods, slabs, s, B).
    """
    shapes = [waveform for each in drives for waveform, _ in each]
    alike = [shape for shape in shapes if isinstance(shape, Shape)]
    last = max((float(shape.breaks(t_end).max(initial=0.0)) for shape in alike), default=0.0)
    if len(alike) == len(shapes) and all(_settled(shape, last, t_end) for shape in alike):
        n = min(n, ceil(last / unit.min()) + 1)
    start, width = edges[:, None, :-1, None], np.diff(edges, axis=1)[:, None, :, None]
    unit, period = unit[:, None, None, None], np.arange(n)[:, None, None, None]
    inside = (period + start + width / 2) * unit
    t = inside + width * unit * (order.c[:, None] - 0.5)
    waves = np.zeros((len(t), len(drives), *t.shape[1:]))
    for k, each in enumerate(drives):
        for shape, share in each:
            waves[:, k] += share[:, None, None, None] * value(shape, t, inside)
    return waves


def _settled(waveform: Shape, last: float, t_end: float) -> bool:
    """Whether a waveform is constant after the last break."""
    t = np.array([last, max(t_end, last)])
    return waveform.fastest() == inf and np.ptp(waveform.value(t, np.array(last + t_end))) == 0.0
