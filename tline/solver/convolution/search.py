"""Convolutions on ever narrower slabs until a tolerance is met."""

from dataclasses import replace
from math import ceil, inf, log2, log10

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, NoFlowError
from tline.solver.assembly.lossy_segments import fits
from tline.solver.convolution.envelope import envelope_of
from tline.solver.convolution.jumps import arrivals
from tline.solver.convolution.quadrature import padding, rounding
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import Description
from tline.solver.description.families import MOST as MOST_FAMILIES
from tline.solver.description.families import leads
from tline.solver.description.given import Scene
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import ProbeResult, Result
from tline.solver.run import Again
from tline.solver.tolerance.compare import BETWEEN, relative
from tline.solver.tolerance.difference import Difference, on_slabs, ways
from tline.solver.tolerance.search import Search
from tline.words.wording import place

ORDER = 5
CLOSEST = 1e-8  # tolerance; transforms are as good as some 1e-10
ROUNDED = 1e-12  # slabs, by which the end of one lies in it
LEAST_SHARE = 0.1  # of a difference, that a step is taken to leave
FIRST = 8  # slabs, at least, in the shortest delay
SETTLED, FINER = 0.02, 0.1  # of the tolerance: what narrower slabs beside fronts change no more; and later
ALIKE = 2  # times that two runs are off at most by more than they differ, so near to a jump that neither follows it
BLURRED = 0.01  # of the shortest delay of a lossy line: so near to a jump nothing is asked
MOST_BLURRED = 0.25  # of a run
DEAR = 10  # samples of line ends that one of a lossy line takes as long as
MOST_BESIDE_LAWS = 2e7  # weights of convolutions, numbers
MOST, FEW = 4e6, 8  # points at which the scene answers in one run, times its line ends; of more than these a cube


def convolved(search: Search) -> Result | None:
    """Run a scene by convolution quadrature to a tolerance; None if it is not one for that.

    Slabs are halved. The error of a run is told by its difference to the one before: where each step leaves the share
    r of the difference, the next ones leave r + r² + …. Beside a jump, nearer than a hundredth of the delay,
    polynomials cannot follow it; there no tolerance is asked, but what is off is told.
    """
    if not _suits(search):
        return None
    description = search.whole or search.description
    if search.envelope:
        search.description.refuse_coupled("an envelope")
    record = [*search.description.lines] if search.envelope else search.record
    try:
        scene, s = Convolved(search.description, record, padding(search.tol)), description.scene.solver.order or ORDER
    except InputError:  # there is no answer in s
        return None
    only = any(bundle.skin.any() for bundle in scene.network.bundles.values())  # other runs do not know that
    h = _first_slab(description, s, scene)
    if not _affordable(scene, s, h / 2) and not only:
        return None
    bundles, jumps = scene.network.bundles, arrivals(description)
    lossy = [line.delay for line in description.lines.values() if line.losses is not None]
    jumping = any(len(each) for each in jumps.values())
    settle = BLURRED * min([*lossy, *(bundle.delay for bundle in bundles.values())]) if jumping else 0.0
    layers, near = (SETTLED * search.tol, _near_fronts(search.tol)) if scene.layered else (0.0, 0)
    chosen = Resolution(s, h, settle=settle, convolved=True, layers=layers, near=near)
    try:
        result = before = scene.run(chosen)
    except NoFlowError:
        return None
    attempts, share, last, accuracy, limit = [Attempt.of(result)], SLOWEST, inf, Accuracy(search.tol), ""
    by = inf
    while accuracy.worst > search.tol and not limit:
        chosen = chosen._replace(h=chosen.h / 2, near=chosen.near + 2, layers=FINER * chosen.layers)
        try:
            before, result = result, scene.run(chosen)
        except NoFlowError as error:
            limit = f"{error.where}: {error.problem}"
            break
        found = _errors(before, result, description.scene, jumps, settle, rounding(scene.padded))
        share, last = min(max(found.worst / last, LEAST_SHARE) if last < inf else share, SLOWEST), found.worst
        by = BETWEEN * share / (1 - share)
        blurred = found.times(ALIKE * BETWEEN / (1 - SLOWEST)).blurred
        accuracy = replace(found.times(by, by), tol=search.tol, blurred=blurred)
        attempts.append(Attempt.of(result, accuracy.worst))
        limit = search.budget.limit(attempts, search.tol)
        if not _affordable(scene, s, chosen.h / 2):
            limit = "narrower slabs would take too long"
    limit = "" if accuracy.worst <= search.tol else limit
    accuracy = replace(accuracy, attempts=tuple(attempts), limit=limit)
    if search.envelope:
        one, other = (envelope_of(search.description, each) for each in (result, before))
        result = replace(result, envelope=one.compared(other, by))
        kept = {*search.record, *search.description.probed}
        result = replace(result, lines={name: line for name, line in result.lines.items() if name in kept})
    notes = tuple(f"{place('lines', name)}: its losses mix the modes: it is computed by matrices" for name in bundles)
    accounts = None if bundles else _accounts(search.description)
    return replace(result, accuracy=accuracy, accounts=accounts, warned=(*notes, *result.warned))


def _first_slab(description: Description, s: int, scene: Convolved) -> float:
    """A slab to begin with, s; where fronts have narrower ones beside them, only what rings asks for more.

    Beside laws it divides what is between two fronts, if that is enough for all of them to be at edges of slabs.
    """
    shortest = min(min(line.delay for line in description.lines.values()), description.t_end)
    if not scene.layered:
        h = resolution(description, s).h
        h /= 2 ** max(ceil(log2(h * FIRST / shortest)), 0)
        if scene.laws and len(leads(scene.instants / h)) > 1:
            apart = float(np.diff(scene.instants).min())
            apart /= ceil(apart / h)
            return apart if apart > h / 2 and len(leads(scene.instants / apart)) == 1 else h
        return h
    h, ringing = shortest / FIRST, min((period for _, period in description.time_scales.values()), default=inf)
    return h if ringing / 2 >= h else min(h, max(ringing / 2, resolution(description, s).h))


def _near_fronts(tol: float) -> int:
    """Slabs of each width that follow a front in the first run; each more makes it two or three times as exact."""
    return max(round(-1.5 * log10(tol)) - 2, 4)


def _accounts(description: Description) -> Again:
    """A run in segments, or with loss elements, that accounts for energies."""
    chosen = resolution(description)
    slabs = ceil(description.t_end / chosen.h - 1e-9)
    passed = sum(line.delay / chosen.h for line in description.lines.values() if line.losses is not None)
    return Again(description.scene, chosen, slabs, {}, DEAR * chosen.s * slabs * passed, False)


def _suits(search: Search) -> bool:
    """Whether a scene is linear and the same at all times, and one of its lines remembers, or fits no segments."""
    description = search.description
    losses = [line.losses for line in description.lines.values() if line.losses is not None]
    moving = any(e.governor is not None or e.kind.breaks for e in description.elements)
    lifted = description.heights and not description.steady
    mixing = description.mixing
    if not (losses or mixing) or not all(each.linear for each in losses) or moving or lifted:
        return False
    if search.tol < CLOSEST or description.active or (mixing and description.steady):
        return False
    remember = mixing or any(each.constant is None for each in losses)
    alone = not (description.elements or description.switched)
    return remember or (alone and not fits(description.lines, resolution(description).h))


def _affordable(scene: Convolved, s: int, h: float) -> bool:
    leads = np.zeros(1) if scene.layered else scene.leads(h)
    several = len(leads) > 1 and any(changes.curved and len(changes.at) > 1 for changes in scene.changes)
    points, ends = scene.description.t_end / h * s * len(leads), scene.network.size
    weights = scene.description.t_end / h * (len(scene.network.laws) * s) ** 2
    if weights > MOST_BESIDE_LAWS:
        return False
    return not several and len(leads) <= MOST_FAMILIES and points * ends * max(ends / FEW, 1) ** 2 <= MOST


def _errors(
    coarse: Result, fine: Result, scene: Scene, jumps: dict[str, NDArray], settle: float, least: float
) -> Accuracy:
    """Differences of all probes at slab ends, and at places in all slabs of the finer run."""
    found = {}
    for name, probe in fine.probes.items():
        near = _near(name, scene, jumps, settle)
        found[name] = _difference(coarse.probes[name], probe, near, settle, least)
    return Accuracy(None, *relative(found))


def _near(name: str, scene: Scene, jumps: dict[str, NDArray], settle: float) -> NDArray:
    """Instants at which jumps pass a probe; none if what is blurred would be much of the run."""
    probe, line = scene.probes[name], scene.single_lines.get(scene.probed_line(name) or "")
    if line is None:
        near = jumps[probe.at or ""]
    else:
        share, delay = probe.fraction(line), line.parameters.delay or 0.0
        ways = zip(line.nodes, (share * delay, (1 - share) * delay), strict=True)
        near = np.sort(np.concatenate([jumps[node] + way for node, way in ways]))
    return near if 2 * settle * len(near) <= MOST_BLURRED * float(scene.t_end) else np.empty(0)


def _seen(probe: ProbeResult, t: NDArray) -> NDArray:
    """Gauge effort and z0 times flow at instants, shape (2, *t.shape)."""
    seen = probe.at(t)
    return np.stack([seen.gauge_pressure, probe.record.z0 * seen.y])


def _difference(coarse: ProbeResult, fine: ProbeResult, near: NDArray, settle: float, least: float) -> Difference:
    """Of two runs at a probe, at slab ends of the coarser and at places in slabs of the finer."""
    edges = np.concatenate([[-np.inf], near, [np.inf]])

    def far(t: NDArray) -> NDArray:
        k = np.searchsorted(near, t)
        return np.minimum(t - edges[k], edges[k + 1] - t) > settle

    end, every = fine.slabs.end, round(coarse.slabs.width / fine.slabs.width)
    x = np.minimum(fine.waves[0].basis.c, 1 - ROUNDED)
    t = np.minimum((np.arange(fine.slabs.number)[:, None] + x) * fine.slabs.width, end)
    n = 0 if any(len(wave.pieces.slab) for wave in fine.waves) else coarse.slabs.whole * every
    in_coarse = (np.arange(every)[:, None] + x).ravel() / every
    theirs, ours = (
        np.concatenate([values.reshape(2, n, x.size), _seen(probe, t[n:])], axis=1)
        for probe, values in (
            (coarse, on_slabs(coarse, in_coarse, 0, n // every)),
            (fine, on_slabs(fine, x, 0, n)),
        )
    )
    beside = _in_pieces(fine, x, end)
    theirs, ours, t = (
        np.concatenate([one, other], axis=-2)
        for one, other in ((theirs, _seen(coarse, beside)), (ours, _seen(fine, beside)), (t, beside))
    )
    off = np.abs(theirs - ours) + least * np.abs(ours).max(axis=(1, 2), keepdims=True)
    inside = np.where(far(t), off, 0.0)
    at_ends = inside[:, every - 1 : fine.slabs.number : every, -1].max(axis=1, initial=0.0)
    return Difference(at_ends, *(each.max(axis=(1, 2)) for each in (inside, off, np.abs(ours))))


def _in_pieces(probe: ProbeResult, x: NDArray, end: float) -> NDArray:
    """Instants at places of all pieces that a probe sees, s."""
    found = [np.empty((0, x.size))]
    for wave, late in zip(probe.waves, ways(probe), strict=True):
        start, stop = (wave.pieces.slab[:, None] + wave.pieces.span).T[:, :, None] * wave.h + late
        found.append(start + (stop - start) * x)
    same = probe.share in (0.0, 1.0)  # pieces of both waves
    return np.minimum(np.concatenate(found[: 2 if same else 3]), end)
