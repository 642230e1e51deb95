"""Models of Touchstone files compared with scikit-rf's: every file of its wheel, and of folders given.

Both fit a model of S that is passive and within 1e-2 of the samples, or else the nearest passive one.
``python -m benchmarks.channels [FOLDER…]`` writes benchmarks/pages/channels.md.
"""

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


def theirs(network: skrf.Network) -> tuple[int, float, bool]:
    """Order, largest distance, and whether scikit-rf finds its automatic fit passive once it has enforced that."""
    fitted: Any = VectorFitting(network)
    fitted.auto_fit()
    if not fitted.is_passive():
        fitted.passivity_enforce()
    ports = range(network.nports)
    S = np.array([[fitted.get_model_response(i, k, network.f) for k in ports] for i in ports]).transpose(2, 0, 1)
    return int(fitted.get_model_order(fitted.poles)), float(np.abs(S - network.s).max()), bool(fitted.is_passive())


def rows(files: list[Path]) -> Iterator[list[str]]:
    """Measure a row for each file."""
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
        begun = process_time()
        try:
            order, error, passive = theirs(response.network())
            other = [f"{order}", f"{error:.1e}", "passive" if passive else "not passive"]
        except Exception as fault:  # noqa: BLE001  # any error of another program
            other = ["", type(fault).__name__, "none"]
        other.append(f"{process_time() - begun:.1f}")
        print(file.name, *mine, *other, flush=True)
        yield [file.name, f"{len(response.f)} × {response.ports}", f"{beyond:.1e}", *mine, *other]


def main() -> None:
    """Write the page."""
    warnings.simplefilter("ignore")
    folders = [Path(str(skrf.__file__)).parent / "data", *map(Path, sys.argv[1:])]
    files = [file for folder in folders for file in sorted(folder.glob("*.[sS]*[pP]")) if "plot" not in file.suffix]
    found = list(rows(files))
    whole = [row for row in found if row[5] == "proved"]
    near = [row for row in whole if float(row[4]) <= max(TOLERANCE, float(row[2]) * 1.1)]
    others = [float(row[10]) for row in found if len(row) > 10 and row[10]]
    passive = sum(row[9] == "passive" for row in found)
    told = f"""{len(found)} files: {len(whole)} models of ours are proved passive, {len(near)} of them within
{TOLERANCE:g} of the samples, or of how far these are beyond what is passive. {passive} of scikit-rf's
{skrf.__version__} (`auto_fit`, with `passivity_enforce` where it is wanted) pass its own test. CPU times are single
runs, with medians of {median(float(row[6]) for row in whole):.1f} and {median(others):.1f} s."""
    head = "<file|<samples × ports|σ − 1|poles|error|<ours|s|poles|error|<scikit-rf|s"
    title = (
        "# Models of Touchstone files\n\nWritten by `python -m benchmarks.channels`; errors are the largest of entries."
    )
    write("benchmarks/pages/channels.md", f"{title}\n\n{told}\n\n{table(head, found)}\n")


if __name__ == "__main__":
    main()
