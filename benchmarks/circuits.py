"""Scenes with circuits against SciPy and ngspice, imported decks against ngspice: ``python -m benchmarks.circuits``.

Writes the tables of docs/circuits.md and docs/netlists.md. The inputs of SciPy and ngspice are written by
hand (tests/electrical_by_hand.py, hydraulic_by_hand.py, circuit_decks.py, decks). The largest step of ngspice is halved
until its result converges, diverges again, or a run takes too long. Takes some minutes.
"""

import re
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from itertools import starmap
from pathlib import Path
from typing import Any

from circuit_decks import DECKS, in_ngspice
from electrical_by_hand import ELECTRICAL
from hydraulic_by_hand import HYDRAULIC
from imported_decks import DECKS as FILES, change, distance, in_ngspice as deck_in_ngspice
from numpy.typing import NDArray

from benchmarks.harness import ROOT, table, timed, write
from tline.errors import InputError
from tline.interchange.spice import read_spice
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.result.result import Result
from tline.solver.simulate import simulate
from tline.study.programs import ngspice

FINE, USUAL, LONG = 1e-9, 1e-6, 4.0  # s
DECK_TOL, DECK_STEPS, DECK_STILL = 1e-3, 1000, 3e-5
STEPS, STILL = 40, 1e-7  # in the shortest delay; change


def refined(
    run: Callable[[int], Any], moved: Callable[[Any, Any], float], steps: int, still: float
) -> tuple[Any, float, int, float]:
    """Refine a run from a least number of steps; return it, its last change, number of steps, and seconds."""
    found, change, seconds = run(steps), float("inf"), 0.0
    while change > still and seconds < LONG:
        begun = time.perf_counter()
        try:
            finer = run(2 * steps)
        except InputError:
            break
        seconds, now = time.perf_counter() - begun, moved(finer, found)
        if now > change:
            break
        steps, found, change = 2 * steps, finer, now
    return found, change, steps, seconds


def circuit(name: str) -> list[str]:
    """Measure a scene."""
    scene, by_hand = read_scene(ROOT / "scenes" / f"{name}.toml"), (ELECTRICAL | HYDRAULIC)[name]
    fine = simulate(scene, tol=FINE)
    usual, seconds = timed(lambda: simulate(scene, tol=USUAL), clock=time.perf_counter)
    off = [f"{max(by_hand.differences(run.probes).values()):.0e}" for run in (usual, fine)]
    figures = [f"`{name}`", *off, f"{1e3 * seconds:.0f}", f"{1e3 * fine.seconds:.1f}"]
    if name not in DECKS:
        return [*figures, "", "", ""]
    run, moved, *_ = refined(lambda n: in_ngspice(name, fine, n), lambda a, b: a.change(b), STEPS, STILL)
    return [*figures, f"{run.distance:.0e}", f"{moved:.0e}", f"{1e3 * run.seconds:.0f}"]


def ngspice_of(path: Path, ours: Result, steps: int) -> tuple[dict[str, NDArray], str]:
    """Run a deck in ngspice, or what `tline export` makes of it where that does not know its dialect."""
    found, how = {}, ""
    with suppress(InputError):
        found = deck_in_ngspice(path, ours, steps)
    if len(found.get("time", ())) < STEPS:
        scene = ours.scene.with_changes(measures={})
        text = ngspice.netlist(scene, float(scene.t_end) / steps)
        found, how = ngspice.transient(text)[0], " (exported)"
        for word, name in re.findall(r"(?m)^\* node (\w+) is '(.*)'$", text):
            if f"v({word})" in found:  # it is probed
                found[f"v({name.lower()})"] = found.pop(f"v({word})")
    return found, how


def unlike(paths: Iterable[Path]) -> Iterator[tuple[Path, Scene, tuple[str, ...]]]:
    """Yield decks of transients with their scenes and notes, each scene once; print why others are refused."""
    seen = set()
    for path in paths:
        try:
            scene, notes = read_spice(path)
        except InputError as error:
            print(path.name, str(error).replace("\n", " | "), flush=True)
            continue
        content = repr(scene.with_changes(title="").table())
        if content not in seen and not any("there is no .tran" in note for note in notes):
            seen.add(content)
            yield path, scene, notes


def deck(path: Path, scene: Scene, notes: tuple[str, ...]) -> list[str]:
    """Measure an imported deck."""
    own = path.parent == FILES
    name = f"[`{path.stem}`](../tests/decks/{path.name})" if own else f"`{path.name}`"
    like = scene.title.partition(":")[0].partition("of ")[2] if own else path.parent.name
    ours, seconds = timed(lambda: simulate(scene.with_changes(solver={"tol": DECK_TOL}), active=True), 1)
    run, moved, steps, taken = refined(
        lambda n: ngspice_of(path, ours, n), lambda a, b: change(a[0], b[0]), DECK_STEPS, DECK_STILL
    )
    figures = f"{distance(ours, run[0]):.0e}{run[1]}", f"{moved:.0e}", f"{steps}", f"{seconds:.1f}", f"{taken:.1f}"
    print(path.name, *figures, flush=True)
    return [name, like, f"{len(notes)}", *figures]


if __name__ == "__main__":
    if shutil.which("ngspice") is None:
        sys.exit("ngspice is not installed")
    head = f"<scene|from SciPy, at {USUAL:.0e}|at {FINE:.0e}|all of a run at {USUAL:.0e}, ms|steps at {FINE:.0e}, ms"
    rows = map(circuit, [*ELECTRICAL, *HYDRAULIC])
    write(
        "docs/circuits.md", table(f"{head}|from ngspice|its last halving moves it by|its steps, ms", rows), "measured"
    )
    head = f"<deck|<like|notes|from ngspice, ours at {DECK_TOL:.0e}|its last halving moves it by|its steps"
    foreign = [path for folder in sys.argv[1:] for path in sorted(Path(folder).rglob("*.*"))]
    rows = starmap(deck, unlike([*sorted(FILES.glob("*.cir")), *foreign]))
    write("docs/netlists.md", table(f"{head}|our run, s|its run, s", rows), "decks")
