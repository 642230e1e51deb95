"""How well a run keeps what it told, by a far finer one that is looked at where all runs are best: at its slab ends."""

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline import Result, Scene
from tline.cli.report import summary
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.result.dense_output import extremes
from tline.solver.run import run
from tline.solver.simulate import UnresolvedWarning, simulate

CLOSE = 1e-7  # slabs of the finer run; what is nearer to a jump is on either side of it
CELLS = (4, 1024)  # times as narrow as the finest run's slabs, beside cells, and at most as the first ones
NEAR, FOLLOWED = 12, 1e-9  # slabs of each width behind a front, and what of the largest wave is followed there


class Kept(NamedTuple):
    """Errors over what was told, by the worst quantity of the worst probe; 0 where the reference cannot tell."""

    met: bool
    inside: float  # largest error at any instant over the error told
    over: float  # the same over the tolerance
    extreme: float  # error of a printed extreme over its own ±
    told: float  # largest error told, of the amplitude
    where: str
    at: float


def kept(scene: Scene, tol: float, finer: int = 16, order: int = 4) -> Kept:
    """Run a scene to a tolerance and compare all that was told with a run on far narrower slabs.

    Cells converge slowly: there the reference goes by the finest run, and tells nothing where that is too
    fine.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        result = simulate(scene, tol=tol)
        report = summary(result, result.accuracy)
        told, slabs = report["probes"], [a.slab for a in result.accuracy.attempts]
        first = max(slabs)
        if any("cells" in parts for parts in report["losses"].values()):
            finer = max(finer, round(CELLS[0] * first / min(slabs)))
            if finer > CELLS[1]:
                return Kept(result.accuracy.met, 0.0, 0.0, 0.0, 0.0, "", 0.0)
        runs = [_finer(scene, result.resolution, order, first / n) for n in (finer // 2, finer)]
    worst = Kept(result.accuracy.met, 0.0, 0.0, 0.0, 0.0, "", 0.0)
    for name, probe in result.probes.items():
        rough, fine = (each.probes[name] for each in runs)
        t, near = _instants(fine.t, probe, result)
        found = probe.at(t)
        for letter, seen in zip("uy", told[name].values(), strict=True):
            true, other, ours = (getattr(x, letter) for x in (fine.at(t), rough.at(t), found))
            amplitude = float(np.abs(getattr(fine, letter)).max())
            if amplitude < 1e-8 * max(np.abs(fine.u).max(), probe.record.z0 * np.abs(fine.y).max()) / (
                1.0 if letter == "u" else probe.record.z0
            ):
                continue
            doubt = np.abs(true - other)
            error = np.maximum(np.abs(ours - true) - 2 * doubt, 0.0)
            error[near | _at_fronts(t, doubt)] = 0.0
            k = int(error.argmax())
            margin = seen["error_inside_slabs"] + 1e-12 * amplitude
            outside = 0.0
            for which, low_or_high in ((0, "minimum"), (1, "maximum")):
                best, rougher = (extremes(each, letter)[which][0] for each in (fine, rough))
                if abs(best - rougher) < 0.3 * margin:
                    outside = max(outside, abs(seen[low_or_high] - best) - abs(best - rougher))
            told_here = seen["error_inside_slabs"] / amplitude if amplitude else 0.0
            here = (error[k] / margin, error[k] / amplitude / tol, outside / margin, told_here)
            if here[0] > worst.inside:
                worst = worst._replace(where=f"{name}.{letter}", at=float(t[k]))
            worst = worst._replace(
                inside=max(worst.inside, float(here[0])),
                over=max(worst.over, float(here[1])),
                extreme=max(worst.extreme, float(here[2])),
                told=max(worst.told, float(here[3])),
            )
    return worst


def _finer(scene: Scene, found: Resolution, order: int, h: float) -> Result:
    """A run on narrower slabs: convolutions where laws of lines are, for circuits that are fitted to these are not."""
    if found.convolved and found.near:
        return Convolved(describe(scene), []).run(found._replace(h=h, near=NEAR, layers=FOLLOWED))
    return run(describe(scene), Resolution(order, h))


def _instants(t: NDArray, probe, result: Result) -> tuple[NDArray, NDArray]:
    """Ends of the finer run's slabs in the run, and whether a front of the run is just there."""
    t = t[(t > 0) & (t <= result.t[-1] * (1 - 1e-12))]
    record, h = probe.record, t[0]
    fronts = [wave.breakpoints() for wave in (record.a1, record.b1, record.a2, record.b2)]
    if 0 < probe.share < 1:
        fronts = [fronts[0] + probe.share * record.delay, fronts[3] + (1 - probe.share) * record.delay]
    known = np.sort(np.concatenate([*fronts, [-np.inf, np.inf]]))
    k = np.searchsorted(known, t)
    return t, np.minimum(t - known[k - 1], known[k] - t) < CLOSE * h


def _at_fronts(t: NDArray, doubt: NDArray) -> NDArray:
    """Instants where the references differ by far more than around: a front that they did not follow."""
    return doubt > 1e3 * (np.median(doubt) + 1e-14)
