"""The scenes with circuits against ngspice and SciPy: python -m benchmarks.circuits [NAME...].

Prints a table and writes it into docs/circuits.md. The equations that SciPy integrates are written by hand
(tests/electrical_by_hand.py, tests/hydraulic_by_hand.py), and so are the decks of ngspice
(tests/circuit_decks.py), whose largest step is halved until its result moves no more, or a run takes too long.
Takes some minutes.
"""

import re
import sys
import time
from pathlib import Path
from statistics import median

from tline.scene.file import read_scene
from tline.solver.result.result import Result
from tline.solver.simulate import simulate

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from circuit_decks import DECKS, in_ngspice  # noqa: E402
from electrical_by_hand import ELECTRICAL  # noqa: E402
from hydraulic_by_hand import HYDRAULIC  # noqa: E402

PAGE = ROOT / "docs" / "circuits.md"
FINE, USUAL, REPEATED = 1e-9, 1e-6, 5
STEPS, STILL, LONG = 40, 1e-7, 4.0  # in the shortest delay; change; s


def refined(name: str, ours: Result) -> tuple[float, float, float]:
    """Steps halved: the distance of the last run from ours, what halving them changed, and the run's seconds."""
    steps, run = STEPS, in_ngspice(name, ours, STEPS)
    while True:
        steps *= 2
        coarser, run = run, in_ngspice(name, ours, steps)
        change = run.change(coarser)
        if change < STILL or run.seconds > LONG:
            return run.distance, change, run.seconds


def row(name: str) -> str:
    """Figures of a scene."""
    scene = read_scene(ROOT / "scenes" / f"{name}.toml")
    by_hand = (ELECTRICAL | HYDRAULIC)[name]
    fine, usual, seconds = simulate(scene, tol=FINE), simulate(scene, tol=USUAL), []
    for _ in range(REPEATED):
        begun = time.perf_counter()
        simulate(scene, tol=USUAL)
        seconds.append(time.perf_counter() - begun)
    off = [f"{max(by_hand.differences(run.probes).values()):.0e}" for run in (usual, fine)]
    figures = [*off, f"{1e3 * median(seconds):.0f}", f"{1e3 * fine.seconds:.1f}"]
    if name in DECKS:
        distance, change, seconds = refined(name, fine)
        figures += [f"{distance:.0e}", f"{change:.0e}", f"{1e3 * seconds:.0f}"]
    else:
        figures += [""] * 3
    return f"| `{name}` | " + " | ".join(figures) + " |"


HEAD = f"""| scene | from SciPy, at {USUAL:.0e} | at {FINE:.0e} | all of a run at {USUAL:.0e}, ms \
| steps at {FINE:.0e}, ms | from ngspice | its last halving moves it by | its steps, ms |
|---|---:|---:|---:|---:|---:|---:|---:|"""


if __name__ == "__main__":
    names = sys.argv[1:] or [*ELECTRICAL, *HYDRAULIC]
    rows = [HEAD]
    for each in names:
        rows.append(row(each))
        print(rows[-1], flush=True)
    if not sys.argv[1:]:
        page = PAGE.read_text(encoding="utf-8")
        table = "\n".join(rows)
        page = re.sub(r"(<!-- measured -->\n).*?(\n<!-- end -->)", rf"\g<1>{table}\g<2>", page, flags=re.DOTALL)
        PAGE.write_text(page, encoding="utf-8")
