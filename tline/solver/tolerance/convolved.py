"""Convolutions on ever narrower slabs, to a tolerance."""

from dataclasses import replace
from math import ceil, inf, log2, log10

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.convolution.families import SAME_FAMILY, leads
from tline.solver.convolution.quadrature import padding, rounding
from tline.solver.convolution.rays import arrivals
from tline.solver.convolution.run import Convolved, is_affordable
from tline.solver.convolution.suited import CLOSEST, is_slow, suits
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import Scene
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.wave import Wave
from tline.solver.run import accounts_of
from tline.solver.tolerance.compare import BETWEEN, Difference, added, on_slabs, relative
from tline.solver.tolerance.kinks import kinking
from tline.solver.tolerance.ladder import Grids, Ladder, Search, Step, refined
from tline.words.wording import place

ORDER = 5
ROUNDED = 1e-12  # slabs; the end of a slab is taken this far inside it
LEAST_SHARE = 0.1  # smallest share of a difference that a step is assumed to leave
MIXED_SHARE = 0.25  # the same of mixing conductors: wide slabs do not show the fronts that these smooth
FIRST = 8  # fewest slabs in the shortest delay
SETTLED, FINER = 0.02, 0.1  # of the tolerance: least change for which slabs beside fronts are halved; factor per run
LEAST_LAYERS, MOST_NEAR = 1e-6, 20  # of the tolerance: least such change; most slabs of a width behind a front
ALIKE = 2  # largest ratio of errors to differences of two runs so near to a jump that neither follows it
BLURRED = 0.01  # of the shortest delay of a lossy line: nearer to a jump the tolerance does not apply
MOST_BLURRED = 0.25  # largest share of a run that may be blurred
WIDE, MOST_WIDE = 64, 1e4  # slabs of a run without fast changes: of the first, and of the last
STEP, BENT = 1e-6, 1e-3  # of efforts, to see slopes of a law; and change of a slope, of the slope, at a corner
MOST_CLOCKED = 2.5e5  # samples with fronts at edges of slabs; beyond these, narrower slabs beside fronts take over


def convolved(search: Search) -> Result | None:
    """Run a scene by convolution quadrature to a tolerance; None if it is not one for that."""
    description = search.description
    slow, usual = is_slow(description), suits(description)
    if search.tol < CLOSEST or not (slow or usual):
        return None
    if search.envelope:
        description.refuse_coupled("an envelope")
    grids, result = None, None
    for how in [{"slow": True}] * slow + [{}, {"clocked": False}] * usual:
        try:
            grids = Convolutions(search, **how)
            if is_affordable(grids.scene, grids.order, grids.h / 2) or grids.alone:
                result = refined(grids)
            elif not grids.scene.slow:
                return None
        except InputError:  # there is no answer in s, or no flow through laws
            return None
        if (result and result.accuracy and result.accuracy.met) or not (grids.scene.slow or grids.scene.clock):
            break
    if grids is None or result is None or not (usual or (result.accuracy and result.accuracy.met)):
        return None
    bundles = grids.scene.network.bundles
    notes = tuple(f"{place('lines', name)}: its losses mix the modes: it is computed by matrices" for name in bundles)
    return replace(result, accounts=accounts_of(description), warned=(*notes, *result.warned))


class Convolutions(Grids):
    """Slabs halved, and ever narrower ones beside fronts.

    The error of a run is estimated from its difference to the previous one: where each step leaves the share r of the
    difference, the next ones leave r + r² + …. Where waves bend inside slabs one step says nothing of the next. Nearer
    to a jump than a hundredth of the delay, polynomials cannot follow it; the tolerance does not apply there, but the
    error is reported.
    """

    def __init__(self, search: Search, *, clocked: bool = True, slow: bool = False):
        super().__init__(search)
        description, padded = search.description, padding(search.tol)
        self.jumps = arrivals(description)
        jumping = any(len(each) for each in self.jumps.values())
        how = {"envelope": search.envelope, "clocked": clocked, "slow": slow}
        how["followed"] = jumping or not any(map(_has_corner, kinking(description)))
        self.scene = Convolved(description, search.record, padded, **how)
        self.order = description.scene.solver.order or ORDER
        self.h = self._first_slab()
        network, bundles = self.scene.network, self.scene.network.bundles.values()
        lossy = [*network.lossy, *(k for bundle in bundles for k in bundle.lines)]
        self.settle = BLURRED * network.second * float(network.delays[lossy].min()) if jumping else 0.0
        self.alone = bool(bundles)  # no other method computes these
        self.share, self.off = SLOWEST, inf

    def first(self) -> Result:
        """The run on the widest slabs."""
        tol = self.search.tol
        near = max(round(-1.5 * log10(tol)) - 2, 4) if self.scene.layered else 0
        return self.scene.run(Resolution(self.order, self.h, settle=self.settle, layers=SETTLED * tol, near=near))

    def next(self, ladder: Ladder) -> Result:
        """The run on slabs half as wide; each more that follows a front makes it two or three times as exact."""
        last = ladder.last.resolution
        layers = max(FINER * last.layers, LEAST_LAYERS * self.search.tol)
        return self.scene.run(last._replace(h=last.h / 2, near=min(last.near + 2, MOST_NEAR), layers=layers))

    def step(self, ladder: Ladder, finer: Result) -> Step:
        """Estimate the error of a run, if the next steps leave as large a share of the difference as the last two."""
        scene, least = self.search.description.scene, rounding(self.scene.padded)
        differences = {
            name: _difference(
                ladder.last.probes[name], probe, _near(name, scene, self.jumps, self.settle), self.settle, least
            )
            for name, probe in finer.probes.items()
        }
        found = Accuracy(self.search.tol, *relative(differences))
        left = MIXED_SHARE if self.scene.network.bundles else LEAST_SHARE
        left = SLOWEST if self._bends(finer.resolution.h) else left
        share = max(found.worst / self.off, left) if self.off < inf else self.share
        self.share, self.off = min(share, SLOWEST), found.worst
        by = BETWEEN * self.share / (1 - self.share)
        told = replace(found.times(by, by), blurred=found.times(ALIKE * BETWEEN / (1 - SLOWEST)).blurred)
        if self.scene.slow:  # ringing behind a corner of a waveform shows as a jump there, in both runs
            torn = {name: np.full(2, BETWEEN * sum(map(_torn, probe.waves))) for name, probe in finer.probes.items()}
            rings = relative({name: each._replace(inside=torn[name]) for name, each in differences.items()})[1]
            told = replace(told, inside=added(told.inside, rings), blurred=added(told.blurred, rings))
        return Step(finer, told, by)

    def limit(self, ladder: Ladder) -> str:
        """Reason against a finer run: slow convergence or too long a run; empty if none."""
        if self.scene.slow and ladder.last.slabs.number > MOST_WIDE:
            return "slabs wider than delays converge slowly"
        if self.scene.clock and 2 * ladder.last.samples > MOST_CLOCKED:
            return "slabs of one width converge slowly"
        finer = is_affordable(self.scene, self.order, ladder.last.resolution.h / 2)
        return "" if finer else "narrower slabs would take too long"

    def _bends(self, h: float) -> bool:
        """Whether waves bend inside slabs of width h; differences then depend on places in slabs, small by accident.

        That is where sources or laws do, or where a line that carries corners has no whole number of slabs.
        """
        scene, network = self.scene, self.scene.network
        if scene.layered and not scene.laws:
            return False
        if scene.laws and (len(leads(scene.instants / h)) > 1 or kinking(self.search.description)):
            return True
        smooth = [k for k, line in network.lossy.items() if not line.constant]
        smooth += [k for bundle in network.bundles.values() if bundle.skin.any() for k in bundle.lines]
        slabs = np.delete(network.delays * network.second / h, smooth)
        return bool((np.abs(slabs - np.round(slabs)) > SAME_FAMILY).any())

    def _first_slab(self) -> float:
        """First slab width, s; where fronts have narrower slabs beside them, only oscillations ask for a narrower one.

        The width divides the spacing of many fronts, and beside laws the shortest time between two fronts, or two moves
        of laws, if that puts all of them at edges of slabs.
        """
        description, scene, s = self.search.description, self.scene, self.order
        if scene.slow:
            return min([description.t_end / WIDE, *(each.fastest() for each in description.waveforms.values())])
        shortest = min(min(line.delay for line in description.lines.values()), description.t_end)
        if scene.clock:
            return scene.clock / ceil(scene.clock * FIRST / shortest)
        at_edges = self._aligned(resolution(description, s).h, shortest) if scene.laws or not scene.layered else 0.0
        if scene.aligned(at_edges) or not scene.layered:
            return at_edges
        h, ringing = shortest / FIRST, min((period for _, period in description.time_scales.values()), default=inf)
        h = h if ringing / 2 >= h else min(h, max(ringing / 2, resolution(description, s).h))
        h = min([h, *(each.fastest() for each in description.waveforms.values())])
        h = float(scene.moves[0]) / ceil(scene.moves[0] / h) if len(scene.moves) else h
        return h if scene.follows(h) else at_edges

    def _aligned(self, h: float, shortest: float) -> float:
        """Divide a slab width until the shortest delay has enough slabs, and try to put fronts beside laws at edges."""
        h /= 2 ** max(ceil(log2(h * FIRST / shortest)), 0)
        for instants in (self.scene.instants, self.scene.moves) if self.scene.laws else ():
            if len(leads(instants / h)) < 2:
                return h
            apart = float(np.diff(instants).min())
            apart /= ceil(apart / h)
            if apart > h / 2 and len(leads(instants / apart)) == 1:
                return apart
        return h


def _torn(wave: Wave) -> float:
    """Sum of all jumps of a wave between its slabs, or pieces."""
    values = wave.pieces.values if len(wave.pieces.slab) else wave.values
    return float(np.abs(values @ wave.basis.evaluation([0.0])[0] - np.append(wave.before, values[:-1, -1])).sum()) / 2


def _has_corner(element: PlacedLaw) -> bool:
    """Whether the slope of a law jumps: waves get corners that nothing follows, as sharp as those of waveforms."""
    flow = element.kind.flow(element.constants)
    if flow is None:
        return True
    efforts = np.array([bend.constant for bend in element.kind.bends(element.constants, 0.0)]) - element.constants[0]
    step = STEP * (np.abs(efforts).max() or 1.0)
    before, at, behind = (flow(efforts + k * step) for k in (-1, 0, 1))
    return bool((np.abs(behind - 2 * at + before) > BENT * np.abs(behind - before)).any())


def _near(name: str, scene: Scene, jumps: dict[str, NDArray], settle: float) -> NDArray:
    """Instants at which jumps pass a probe; empty if their blurred intervals would be much of the run."""
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
    """Difference between two runs at a probe, at slab ends of the coarser and at places in slabs of the finer."""
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
    """Instants at places of all pieces of the waves at a probe, s."""
    found = [np.empty((0, x.size))]
    for wave, late in probe.passing:
        start, stop = (wave.pieces.slab[:, None] + wave.pieces.span).T[:, :, None] * wave.h + late
        found.append(start + (stop - start) * x)
    same = probe.share in (0.0, 1.0)  # pieces of both waves
    return np.minimum(np.concatenate(found[: 2 if same else 3]), end)
