"""Closure of a valve: the shortest time, in one stage or two, that keeps a highest and a lowest pressure."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tline.design.limits import limits
from tline.design.search import SizeSearch, Trial
from tline.design.sizing import Runs, Size, Sizing
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.scene import Scene
from tline.scene.shape import Shape
from tline.scene.valve import Orifice
from tline.solver.description.excitation import just_before
from tline.units import to_si
from tline.words.wording import nearest, place

TIMES = 0.15, 0.3, 0.5, 0.7  # initial shares of the time at which a second stage begins
LEVELS = 0.1, 0.25, 0.4, 0.6, 0.8  # initial shares of the travel left at that time
FINER, WORTH = (0.1, 0.05, 0.025), 0.99  # how far these move, and how much shorter a closure is worth more
FIRST = 0.1  # of the largest time, the first closure tried


class Motion(NamedTuple):
    """Motion of a valve: the path of its waveform, levels before and after, and its begin, s."""

    path: str
    before: float
    after: float
    begin: float

    def waveform(self, duration: float, bend: tuple[float, float] | None) -> dict[str, Any]:
        """Build one straight stage, or two with a bend at (share of the time, share of the travel left)."""
        if bend is None:
            shape = {"shape": "ramp", "from": self.before, "to": self.after, "at": self.begin}
            return {**shape, "duration": duration}
        share, left = bend
        middle = self.after + left * (self.before - self.after)
        bends = [[self.begin + share * duration, middle], [self.begin + duration, self.after]]
        return {"shape": "piecewise linear", "points": [[self.begin, self.before], *bends]}


def closure(
    scene: Scene | str | Path,
    valve: str,
    *,
    path: Sequence[str] = (),
    lowest: float | str | None = None,
    highest: float | str | None = None,
    stages: int = 1,
    begin: float | str | None = None,
    tol: float | None = None,
    progress: bool = False,
) -> Sizing:
    """Find the shortest closure of a valve, linear in its opening, or in two linear stages.

    Parameters
    ----------
    Scene that starts in the steady state.
        That starts in the steady state.
    valve : str
        An orifice (load or link), or a source of flow. Its waveform determines the levels of the motion and its
        begin; a constant opening is closed to zero.
    path, lowest, highest, tol, progress
        As of `tline.design.vessel`; the highest pressure is the scene's ``rating`` if no limit is given.
    stages : int
        1, or 2: then the begin of the second stage is searched too.
    begin : float or str, optional
        Begin of the closure, s, in place of the scene's.

    Returns
    -------
    Sizing
        The time, its margin, the curve of all times run, and the scene with the closure.

    Raises
    ------
    InputError
        No time up to the end of the run keeps the limits, or there is no such valve.

    Examples
    --------
    >>> import tline as tl
    >>> found = tl.design.closure(tl.examples["valve_closure"], "valve", highest="12 bar")
    >>> round(found.sizes["closure time"].value, 1)  # s
    3.5
    """
    given = as_scene(scene)
    if lowest is None and highest is None and given.rating is not None:
        highest = float(given.rating)
    wanted = limits(given, path, lowest, highest)
    if stages not in (1, 2):
        raise InputError("stages", "out of range", "1 or 2", f"{stages}")
    motion = _motion(given, valve, begin)
    largest = float(given.t_end) - motion.begin
    if largest <= 0:
        raise InputError("begin", "after the end of the run", f"before {given.t_end:g} s", f"{motion.begin:g} s")
    bend: tuple[float, float] | None = None
    runs = Runs(given, lambda size: {motion.path: motion.waveform(size, None)}, wanted, tol, progress)
    found, search, notes = runs.smallest("s", FIRST * largest, largest)
    if stages == 2:
        found, search, notes, bend = _two_stages(given, motion, runs, (found, search, notes))
        if bend is None:
            notes.append("no second stage shortens it")
    sizes = {"closure time": Size(found.size, "s")}
    if bend is not None:
        sizes |= {"first stage": Size(bend[0] * found.size, "s"), "travel left": Size(bend[1], "")}
    done = given.change({motion.path: motion.waveform(found.size, bend)})
    return Sizing("closure", motion.path, sizes, found, search.trials, wanted, done, tuple(notes))


def _two_stages(
    scene: Scene, motion: Motion, one: Runs, best: tuple[Trial, SizeSearch, list[str]]
) -> tuple[Trial, SizeSearch, list[str], tuple[float, float] | None]:
    """Search in turns the bend with the largest margin for a time, and the shortest time for that bend."""
    bend: tuple[float, float] | None = None
    tried = [(share, left) for share in TIMES for left in LEVELS]
    for step in FINER:
        duration, margins = best[0].size, dict[tuple[float, float], float]()
        for each in tried:
            margins[each] = _with_bend(scene, motion, one, each).run(duration).margin
        first = max(margins, key=margins.__getitem__)
        if margins[first] <= best[0].margin:
            break
        found = _with_bend(scene, motion, one, first).smallest("s", duration)
        if found[0].size >= WORTH * duration:
            break
        best, bend = found, first
        moves = [(k, x) for k in (-step, 0.0, step) for x in (-step, 0.0, step) if k or x]
        tried = [(round(bend[0] + k, 3), round(bend[1] + x, 3)) for k, x in moves]
        tried = [each for each in tried if min(each) > 0 and max(each) < 1]
    return *best, bend


def _with_bend(scene: Scene, motion: Motion, one: Runs, bend: tuple[float, float]) -> Runs:
    """Prepare runs of a closure in two stages."""
    runs = Runs(scene, lambda size: {motion.path: motion.waveform(size, bend)}, one.limits, one.tol, False)
    runs.bar = one.bar
    return runs


def _motion(scene: Scene, name: str, begin: float | str | None) -> Motion:
    """Find the motion of a valve, and its levels."""
    movable: Mapping[str, tuple[str, Shape]] = {
        **{
            key: (place("sources", key, "value"), one.value) for key, one in scene.sources.items() if one.kind == "flow"
        },
        **_openings("loads", scene.loads),
        **_openings("links", scene.links),
    }
    if name not in movable:
        expected = nearest(name, list(movable)) if movable else "a scene with a valve of kind 'orifice'"
        raise InputError("valve", "no such valve", expected, f"'{name}'")
    path, waveform = movable[name]
    end = np.array(float(scene.t_end))
    breaks = waveform.breaks(float(end))
    before, after = just_before(waveform), float(waveform.value(end, end))
    starts = float(breaks[0]) if len(breaks) else 0.0
    if before == after:
        after = 0.0
    if before == after:
        raise InputError(path, "is shut already", "a valve that is open before t = 0", f"{before:g}")
    return Motion(path, before, after, starts if begin is None else to_si(begin, "s", "begin"))


def _openings(section: str, elements: Mapping[str, Any]) -> dict[str, tuple[str, Shape]]:
    valves = {name: one for name, one in elements.items() if isinstance(one, Orifice)}
    return {name: (place(section, name, "opening"), valve.opening) for name, valve in valves.items()}
