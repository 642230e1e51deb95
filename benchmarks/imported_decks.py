"""Decks of other programs, imported, against ngspice: python -m benchmarks.imported_decks [NAME...].

Prints a table and writes it into docs/netlists.md. The decks (tests/decks) have the structure of the examples for
transmission lines of ngspice, Xyce and gnucap that have no transistors. The largest step of ngspice is halved until
its result moves no more, moves more again, or a run takes too long. Its TXL lines, whose error no step lessens, are
LTRA lines there; of its CPL lines, which are made alike, there is no other kind. Takes some minutes.
"""

import re
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.interchange.spice import read_spice
from tline.solver.result.result import Result
from tline.solver.simulate import simulate
from tline.study.programs import ngspice

ROOT = Path(__file__).parent.parent
DECKS, PAGE = ROOT / "tests" / "decks", ROOT / "docs" / "netlists.md"
TOL, STEPS, STILL, LONG, INSTANTS = 1e-3, 1000, 3e-5, 4.0, 2000  # steps in a run; change; s
DIALECT = ((r"(?m)^#.*$", ""), (r"(?is)\n\.modify.*", ""), (r"\bz=", "z0="), (r"(?is)\.control.*?\.endc", ""),
           (r"(?im)^y(.*)$", r"oy\1"), (r"(?im)^(\.model\s+\w+\s+)txl(.*?)length", r"\1ltra rel=1 \2len"),
           (r"(?im)^\.(tran|print|list|width|step|end)\b.*$", ""))  # fmt: skip


def in_ngspice(name: str, ours: Result, steps: int) -> dict[str, NDArray]:
    """Waves of a deck by name, with so many steps at least."""
    title, *lines = (DECKS / f"{name}.cir").read_text(encoding="utf-8").splitlines()
    text = "\n" + "\n".join(lines) + "\n"
    for pattern, new in DIALECT:
        text = re.sub(pattern, new, text)
    end = float(ours.scene.t_end)
    saved = ".save " + " ".join(f"v({probe})" for probe in ours.probes)
    options = ".options acct reltol=1e-5 abstol=1e-14 vntol=1e-8 gmin=1e-15"
    run = f".tran {end / steps!r} {end!r} 0 {end / steps!r}"
    return ngspice.transient("\n".join(["* " + title, text, options, saved, run, ".end", ""]))[0]


def distance(ours: Result, theirs: dict[str, NDArray]) -> float:
    """Largest difference of a probe, relative to the largest voltage."""
    t = theirs["time"]
    chosen = np.unique(np.linspace(1, len(t) - 2, INSTANTS).astype(int))
    amplitude = max(float(np.abs(probe.u).max()) for probe in ours.probes.values())
    return max(
        float(np.abs(theirs[f"v({key.lower()})"][chosen] - probe.at(t[chosen]).u).max()) / amplitude
        for key, probe in ours.probes.items()
    )


def change(finer: dict[str, NDArray], coarser: dict[str, NDArray]) -> float:
    """Largest difference of two runs, relative to the largest voltage."""
    waves = [key for key in finer if key.startswith("v(")]
    amplitude = max(float(np.abs(finer[key]).max()) for key in waves)
    at = coarser["time"]
    moved = [np.abs(np.interp(at, finer["time"], finer[key]) - coarser[key]).max() for key in waves]
    return float(max(moved)) / amplitude


def row(name: str) -> str:
    """Figures of a deck."""
    scene, notes = read_spice(DECKS / f"{name}.cir")
    begun = time.perf_counter()
    ours = simulate(scene.with_changes(solver={"tol": TOL}), active=True)
    seconds = time.perf_counter() - begun
    steps, theirs, moved, taken = STEPS, in_ngspice(name, ours, STEPS), np.inf, 0.0
    while moved > STILL and taken < LONG:
        begun = time.perf_counter()
        try:
            finer = in_ngspice(name, ours, 2 * steps)
        except InputError:
            break
        steps *= 2
        taken = time.perf_counter() - begun
        now = change(finer, theirs)
        if now > moved:
            break
        moved, theirs = now, finer
    figures = f"{distance(ours, theirs):.0e} | {moved:.0e} | {steps} | {seconds:.1f} | {taken:.1f}"
    like = scene.title.partition(":")[0].partition("of ")[2]
    return f"| [`{name}`](../tests/decks/{name}.cir) | {like} | {len(notes)} | {figures} |"


HEAD = f"""| deck | like | notes | from ngspice, ours at {TOL:.0e} | its last halving moves it by | its steps \
| our run, s | its run, s |
|---|---|---:|---:|---:|---:|---:|---:|"""


if __name__ == "__main__":
    rows = [HEAD]
    for each in sys.argv[1:] or sorted(path.stem for path in DECKS.glob("*.cir")):
        rows.append(row(each))
        print(rows[-1], flush=True)
    if not sys.argv[1:]:
        page = PAGE.read_text(encoding="utf-8")
        table = "\n".join(rows)
        page = re.sub(r"(<!-- decks -->\n).*?(\n<!-- end -->)", rf"\g<1>{table}\g<2>", page, flags=re.DOTALL)
        PAGE.write_text(page, encoding="utf-8")
