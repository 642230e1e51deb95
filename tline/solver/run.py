"""One run of a scene at a stated resolution: assemble it, step the kernel, and return the records of the probes."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from math import inf
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.errors import InputError, NoFlowError
from tline.gc_paused import gc_paused
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.assembly.node_maps import Event
from tline.solver.convolution.suited import CLOSEST, suits
from tline.solver.description.description import Description, describe
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import Scene
from tline.solver.description.resolution import LARGEST, Resolution, resolution
from tline.solver.ledger.ledger import Ledger, Recorder
from tline.solver.loop.march import March, march
from tline.solver.loop.slabs import Slabs
from tline.solver.result.accuracy import Accuracy
from tline.solver.result.envelope import Extremes
from tline.solver.result.merged import probed
from tline.solver.result.notes import VISIBLE, smeared
from tline.solver.result.result import Result
from tline.solver.result.states import watched
from tline.solver.result.wave import ElementRecord, LineRecord, Recorded
from tline.words.wording import place

LARGEST_LEDGER = 1e7  # samples at line ends, of a ledger that is not asked for: half a second
Kinks = Mapping[str, NDArray]
NO_KINKS: Kinks = MappingProxyType({})
PARTS, MOST_CUTS = 4, 1e6  # of each slab at a group in which no flow is found, and of each of these; cuts in all
MOST_ALONE = 100  # cuts, beyond which all slabs are in parts and not a piece alone
EACH_NODE = 4000  # cost of a node in a ledger, in samples
DEAR = 10  # cost of a sample of a lossy line, in the same samples
FOLLOWED = 1e-6  # of the largest wave: least change followed by narrower slabs beside fronts, in a convolution by hand


def run(
    description: Description,
    chosen: Resolution,
    record: Iterable[str] = (),
    *,
    envelope: bool = False,
    ledger: bool = False,
    progress: bool = False,
    slabs: int | None = None,
    kinks: Kinks = NO_KINKS,
    laws: Collection[str] = (),
) -> Result:
    """Run a scene with slabs of a given width and order, to its end time or for a number of slabs.

    `record` names lines to keep beside those of the probes. Without `ledger` energies are accounted for once they are
    read. Slabs are cut in pieces at the instants of `kinks`, s, at the elements named by its keys. `laws` are places of
    elements whose waves are kept. Where no flow is found through elements coupled without delay, the run is made again
    with that piece of a slab in 4 parts, and if that does not help soon, with all slabs in 4, then 16.
    Scenes whose lines lose linearly are convolutions, but with a ledger or waves of elements.
    """
    if envelope:
        description.refuse_coupled("an envelope")
    if not (ledger or laws or chosen.plain) and (found := _convolved(description, chosen, record, envelope)):
        return found
    refuse_mixing(description)
    extent = Slabs.until(description.t_end, chosen.h, slabs)
    given = {"envelope": envelope, "ledger": ledger, "progress": progress, "laws": laws}
    while True:
        try:
            return _run(description, chosen, {*record, *description.probed}, extent, kinks, **given)
        except NoFlowError as error:
            kinks = _divided(kinks, error, extent.number, chosen.h)


def refuse_mixing(description: Description) -> None:
    """Refuse losses that mix modes, where a run is no convolution."""
    for name in description.mixed:
        problem = "its losses mix the modes, which are computed at once, by convolution"
        expected = f"a tolerance of {CLOSEST:g} or more, no ledger, rounded delays or active elements"
        raise InputError(place("lines", name), problem, expected)


def _convolved(description: Description, chosen: Resolution, record: Iterable[str], envelope: bool) -> Result | None:
    """The run as a convolution; None if the scene is not one for that, on these slabs."""
    if not chosen.exact or not suits(description):
        return None
    from tline.solver.convolution.run import Convolved, is_affordable

    try:
        scene = Convolved(description, record, envelope=envelope)
        if is_affordable(scene, chosen.s, chosen.h):
            result = scene.run(chosen._replace(layers=FOLLOWED))
            return replace(result, resolution=chosen, accounts=accounts_of(description))  # as it was asked for
    except InputError:  # there is no answer in s, or no flow was found through laws
        pass
    return None


def accounts_of(description: Description) -> "Again | None":
    """A run in slabs in place of a convolution, to account for energies."""
    if description.mixed:
        return None
    chosen = resolution(description)
    slabs = Slabs.until(description.t_end, chosen.h).number
    passed = float(description.columns.delay[description.columns.lossy].sum()) / chosen.h
    work = inf if description.coupled else DEAR * chosen.s * slabs * passed
    return Again(description.scene, chosen, slabs, {}, work)


def _run(
    description: Description,
    chosen: Resolution,
    kept: set[str],
    slabs: Slabs,
    kinks: Kinks,
    *,
    envelope: bool,
    ledger: bool,
    progress: bool,
    laws: Collection[str],
) -> Result:
    n = slabs.number
    laws = {*laws, *watched(description, n * chosen.s)}
    with gc_paused():
        assembly = assemble(description, kept, chosen, laws=laws, progress=progress)
    assembly.events = sorted([*assembly.events, *_cuts(assembly, kinks)])
    if (samples := 4 * len(kept) * n * chosen.s) > LARGEST:
        problem = f"recording {len(kept)} lines over {n} slabs of order {chosen.s} needs {samples:.2g} samples"
        raise InputError("probes", problem, f"at most {LARGEST:.0e}: fewer probes or a shorter run")
    extremes = Extremes(assembly, slabs) if envelope else None
    recorder = Recorder(assembly, slabs) if ledger else None
    watching = [each for each in (extremes, recorder) if each]
    waves, done = march(assembly, n, observers=watching, progress=progress)
    result = given_out(description, assembly, slabs, waves, done, kinks)
    if extremes:
        result = replace(result, envelope=extremes.envelope(description.heights))
    if recorder:
        return replace(result, accounts=recorder.ledger(done.final_fronts))
    if not extremes:  # an envelope writes rows of its own
        assembly.leave()
    return result


def given_out(
    description: Description,
    assembly: Assembly,
    slabs: Slabs,
    waves: NDArray,
    done: March,
    kinks: Kinks = NO_KINKS,
    accuracy: Accuracy | None = None,
) -> Result:
    """Make the result of a run from an assembled scene and the record of its march.

    `kinks` are those at which slabs were cut in pieces.
    """
    smears = done.fronts.lost > VISIBLE or description.blurred
    chosen, kept = assembly.resolution, records_of(assembly, waves, done, smears)
    lines, alone = line_records(assembly, kept), dict[str, LineRecord]()
    for node in description.probed_nodes:
        level = assembly.nodes[node].height.level
        alone[node] = kept.node(assembly.recorded_nodes[node], float(assembly.efforts[node]) + level, level)
    samples = len(assembly.network.ends) * slabs.number * chosen.s
    work = inf if description.coupled else samples + EACH_NODE * len(assembly.nodes)
    return Result(
        description.scene,
        slabs,
        probed(description, lines, alone, slabs),
        lines,
        chosen,
        (*chosen.notes, *smeared(done.fronts)),
        assembly.start,
        samples,
        done.seconds,
        done.fronts,
        accuracy=accuracy,
        accounts=Again(description.scene, chosen, slabs.number, dict(kinks), work),
        circuits=assembly.grid.circuits,
        elements={where: _into(assembly, where, kept) for where in assembly.recorded_laws},
        slams=_slams(assembly),
    )


class Again(NamedTuple):
    """Repetition of a run, to account for energies or for a result of its own."""

    scene: Scene
    chosen: Resolution
    slabs: int
    kinks: dict[str, NDArray]
    work: float  # samples; infinite with coupled conductors, which ledgers refuse

    def __call__(self) -> Ledger | None:
        """Energies that every line and element gave, took and stored."""
        return run(describe(self.scene), self.chosen, ledger=True, slabs=self.slabs, kinks=self.kinks).ledger

    def result(self, description: Description, record: Iterable[str], progress: bool) -> Result:
        """The result of the same description, with arrays of its own."""
        return run(description, self.chosen, record, progress=progress, slabs=self.slabs, kinks=self.kinks)


def with_ledger(result: Result, ledger: bool | None) -> Result:
    """A result whose energies are accounted for: now, never, or (None) once they are read, if that is cheap."""
    again = result.accounts
    if isinstance(again, Again) and (ledger is False or (ledger is None and again.work > LARGEST_LEDGER)):
        again = None
    accounts = result.ledger if ledger else again
    return result if accounts is result.accounts else replace(result, accounts=accounts)


def _divided(kinks: Kinks, error: NoFlowError, n: int, h: float) -> Kinks:
    """Divide the piece of a slab in which no flow was found, or all slabs if it is not known.

    Slabs come in parts, then in smaller ones; the error is raised if they do already.
    """
    where = error.where.split(" and ")[0]
    known = kinks.get(where, ())
    begin, end = error.span or (0.0, 0.0)
    if end - begin > PARTS * EDGE and len(known) < MOST_ALONE:
        return {**kinks, where: distinct(np.append(known, (begin + (end - begin) * np.arange(1, PARTS) / PARTS) * h))}
    parts = PARTS if len(known) < (PARTS - 1) * n else PARTS**2
    if len(known) >= (PARTS**2 - 1) * n or parts * n > MOST_CUTS:
        raise error
    return {**kinks, where: distinct(np.append(known, np.arange(1, parts * n) * (h / parts)))}


def _cuts(assembly: Assembly, kinks: Kinks) -> Iterator[Event]:
    """Events that begin a piece at a group and move nothing: at kinks, and at elements at t = 0 from rest."""
    begin = [0.0] if assembly.follows_edges and not assembly.description.steady else []
    for g, group in enumerate(assembly.groups if begin or kinks else ()):
        elements = [element.where for element in group.elements]
        yield from (Event(t, g) for t in begin * len(elements))
        for where in (*elements, *(at_node(node.name) for node in group.nodes)):
            yield from (Event(float(t), g) for t in np.asarray(kinks.get(where, ())) / assembly.resolution.h)


def at_node(name: str) -> str:
    """The key of kinks at a node."""
    return f"nodes.{name}"


def _slams(assembly: Assembly) -> dict[str, float]:
    """Largest velocity with which liquid has flowed back through check valves whose discs have inertia, m/s."""
    found = {}
    for element, at in zip(assembly.elements, assembly.network.laws.governor_state, strict=True):
        if element.governor is not None and element.governor.area and assembly.state.load[at + 2] < 0:
            found[element.where] = float(-assembly.state.load[at + 2] / element.governor.area)
    return found


def records_of(assembly: Assembly, waves: NDArray, done: March, smears: bool = False) -> Recorded:
    """Record of a march; `smears` says whether fronts are missing."""
    chosen = assembly.resolution
    return Recorded(waves, done.pieces, assembly.basis, chosen.h, smears, done.raw or bool(chosen.sections))


def line_records(assembly: Assembly, kept: Recorded) -> dict[str, LineRecord]:
    """Records of lines by name."""
    found = {}
    for name, row in assembly.recorded.items():
        line = assembly.grid.lines[name]
        level = assembly.nodes[line.nodes[0]].height.level
        found[name] = kept.line(row, line, assembly.start[name] + level, level)
    return found


def _into(assembly: Assembly, where: str, kept: Recorded) -> ElementRecord:
    row, rows, waves = assembly.recorded_laws[where], assembly.recorded_nodes, kept.waves
    e, placed = next((e, one) for e, one in enumerate(assembly.elements) if one.where == where)
    here, there = (
        kept.wave(rows[node], 0, float(assembly.efforts[node])) if node else None
        for node in (placed.from_node, placed.to_node)
    )
    laws, states = assembly.network.laws, np.empty((0, 0))
    at = max(laws.state_at[e], laws.governor_state[e])
    if at >= 0:
        before = assembly.loads_before[[at, at + max(laws.states[e], 1) - 1]]
        states = np.hstack([before[:, None], waves[row : row + 2, 1, kept.order.s - 1 :: kept.order.s]])
    wave = kept.wave(row, 0, float(waves[row, 0, 0]))
    return ElementRecord(wave, float(laws.source_impedance[e]), states, (here, there))
