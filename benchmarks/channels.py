"""Models of Touchstone files compared with scikit-rf's: every file of its wheel, and of folders given, each once.

Both fit a model of S that is passive and within 1e-2 of the samples, or else the nearest passive one.
``python -m benchmarks.channels [FOLDER…]`` writes benchmarks/pages/channels.md.
"""

import signal
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
import skrf
from skrf.vectorFitting import VectorFitting

from benchmarks.harness import table, write
from passivity import check_samples, fit_scattering, read_touchstone
from tline.errors import InputError

TOLERANCE = 1e-2
LONGEST = 20  # seconds of the processor that scikit-rf has for a file
LARGEST = 60_000  # bytes of a file that it gets: most larger ones take it longer


def theirs(network: skrf.Network) -> tuple[int, float, bool]:
    """Order, largest distance, and whether scikit-rf finds its automatic fit passive once it has enforced that."""
    fitted: Any = VectorFitting(network)
    fitted.auto_fit()
    if not fitted.is_passive():
        fitted.passivity_enforce()
    ports = range(network.nports)
    S = np.array([[fitted.get_model_response(i, k, network.f) for k in ports] for i in ports]).transpose(2, 0, 1)
    return int(fitted.get_model_order(fitted.poles)), float(np.abs(S - network.s).max()), bool(fitted.is_passive())


def _too_long(*_: object) -> None:
    raise TimeoutError


def rows(files: list[Path]) -> Iterator[list[str]]:
    """Measure a row for each file."""
    signal.signal(signal.SIGPROF, _too_long)
    for file in files:
        try:
            response = read_touchstone(file)
        except InputError as error:
            yield [file.name, f"refused: {error.problem}", *[""] * 9]
            continue
        beyond = float(max(check_samples(response).worst.max() - 1, 0.0))
        begun = process_time()
        try:
            found = fit_scattering(response, TOLERANCE, nearest=True)
            mine = [f"{found.order}", f"{found.error:.1e}", found.verdict.status.value]
        except InputError as error:
            mine = ["", error.problem, "none"]
        mine.append(f"{process_time() - begun:.1f}")
        if file.stat().st_size > LARGEST:
            print(file.name, *mine, flush=True)
            yield [file.name, f"{len(response.f)} × {response.ports}", f"{beyond:.1e}", *mine, "", "", "not run", ""]
            continue
        begun = process_time()
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        try:
            order, error, passive = theirs(response.network())
            other = [f"{order}", f"{error:.1e}", "passive" if passive else "not passive"]
        except Exception as fault:  # noqa: BLE001  # any error of another program
            other = ["", type(fault).__name__, "none"]
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        other.append(f"{process_time() - begun:.1f}")
        print(file.name, *mine, *other, flush=True)
        yield [file.name, f"{len(response.f)} × {response.ports}", f"{beyond:.1e}", *mine, *other]


def page(found: list[list[str]]) -> str:
    """Format the page on the files so far."""
    whole = [row for row in found if row[5] == "proved"]
    near = [row for row in whole if float(row[4]) <= max(TOLERANCE, float(row[2]) * 1.1)]
    others = [float(row[10]) for row in found if row[10]]
    passive, fits = (sum(row[k] == word for row in found) for k, word in ((9, "passive"), (5, "proved")))
    near_others = sum(row[9] == "passive" and float(row[8]) <= max(TOLERANCE, float(row[2]) * 1.1) for row in found)
    refused = sum(row[1].startswith("refused") for row in found)
    run = sum(row[9] not in ("", "not run") for row in found)
    seconds = [float(row[6]) for row in found if row[6]]
    told = f"""{len(found)} files, {refused} of them refused. {fits} models of ours are proved passive,
{len(near)} of them within {TOLERANCE:g} of the samples, or of how far these are beyond what is passive.
{passive} of scikit-rf's {skrf.__version__}
(`auto_fit`, with `passivity_enforce` where it is wanted, {LONGEST} s at most) pass its own test, {near_others} of them
as near; it was run on {run}, of up to {LARGEST // 1000} kB.
CPU times are single runs, with medians of {median(seconds or [0]):.1f} and {median(others or [0]):.1f} s,
at most {max(seconds or [0]):.0f} and {max(others or [0]):.0f} s."""
    head = "<file|<samples × ports|σ − 1|poles|error|<ours|s|poles|error|<scikit-rf|s"
    title = (
        "# Models of Touchstone files\n\nWritten by `python -m benchmarks.channels FOLDER…`; errors are the largest "
    )
    return f"{title}of entries.\n\n{told}\n\n{table(head, found)}\n"


def main() -> None:
    """Write the page, again after each file."""
    warnings.simplefilter("ignore")
    folders = [Path(str(skrf.__file__)).parent / "data", *map(Path, sys.argv[1:])]
    files = [file for folder in folders for file in sorted(folder.rglob("*.[sS]*[pP]")) if "plot" not in file.suffix]
    once = {file.read_bytes(): file for file in reversed(files)}
    found = []
    for row in rows([*reversed(once.values())]):
        found.append(row)
        write("benchmarks/pages/channels.md", page(found))


if __name__ == "__main__":
    main()
