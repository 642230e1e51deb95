"""Touchstone files fitted and proved passive, beside scikit-rf: python -m benchmarks.touchstone [FOLDER].

All files that come with scikit-rf's wheel, or those of a folder, to 1e-2 and 1e-3 with the nearest passive model where
a fit is not passive; beside them `VectorFitting.auto_fit` of scikit-rf with its own defaults. Writes
docs/benchmarks-touchstone.md where no folder is given. Some minutes.
"""

import re
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import skrf
from skrf.vectorFitting import VectorFitting

from passivity import ExpressionError, SampledResponse, Status, fit_behind_delay, fit_scattering, read_touchstone

PAGE = Path(__file__).parent.parent / "docs" / "benchmarks-touchstone.md"
WHEEL = Path(skrf.__file__).parent / "data"
ASKED = 1e-2, 1e-3
TEXT = """# Models of Touchstone files

`tline fit` turns S-parameters into a rational model that is proved passive, or says why there is none. Written by
`python -m benchmarks.touchstone` from the files that come with scikit-rf {version}. *tline*: `--nearest`, with the
tolerance that is asked: the largest distance of any entry of S from the file at any frequency. *auto_fit*: scikit-rf's
`VectorFitting.auto_fit()` with its own defaults, the same distance, and its own test of passivity in floating point.
Seconds are those of processors for one fit with its proof or test.

| file | ports, samples | tline, 1e-2 | | | tline, 1e-3 | | | auto_fit | | |
|---|---|---|---|---|---|---|---|---|---|---|
| | | poles | error | s | poles | error | s | poles | error, passive | s |
{rows}

Of {number} files {within} are fitted to 1e-2 and proved passive, {closer} to 1e-3, none in more than {longest:.1f} s;
auto_fit is within 1e-2 of {theirs}, and calls {passive} of these passive. Where tline has no model (–), the error is
the least that it reached.
"""


def ours(response: SampledResponse, tolerance: float) -> tuple[int, float, bool, float]:
    """Poles, error, whether it is proved passive, and seconds."""
    begun = time.process_time()
    try:
        if response.ports == 1:
            found = fit_behind_delay(response, tolerance, nearest=True)
            order = found.order
        else:
            found = fit_scattering(response, tolerance, nearest=True)
            order = found.model.order
    except ExpressionError as error:
        reached = re.search(r"at least (\S+), which (\d+) poles", error.expected or "")
        order, least = (int(reached[2]), float(reached[1])) if reached else (0, np.inf)
        return order, least, False, time.process_time() - begun
    proved = found.verdict.status is Status.PROVED
    return order, found.error, proved, time.process_time() - begun


def theirs(path: Path) -> tuple[int, float, bool, float]:
    """The same of scikit-rf."""
    begun = time.process_time()
    with warnings.catch_warnings(action="ignore"):
        network = skrf.Network(str(path))
        fit = VectorFitting(network)
        try:
            fit.auto_fit()
            p = network.nports
            model = np.stack([[fit.get_model_response(i, k, network.f) for k in range(p)] for i in range(p)], -1)
            error, passive = np.abs(model.transpose(1, 2, 0) - network.s).max(), bool(fit.is_passive())
            order = int((1 + (fit.poles.imag != 0)).sum())
        except (ValueError, ArithmeticError, np.linalg.LinAlgError, UserWarning):
            order, error, passive = 0, np.inf, False
    return order, float(error), passive, time.process_time() - begun


def _cells(order: int, error: float, good: bool, seconds: float, mark: str = "") -> str:
    told = f"{error:.1e}{mark}" if np.isfinite(error) else "fails"
    return f"{order if good else '–'} | {told} | {seconds:.1f}"


def main(folder: Path) -> None:
    """Fit all files and print, or write, the page."""
    rows, results = [], []
    for path in sorted(x for x in folder.rglob("*") if re.fullmatch(r"\.s\d+p", x.suffix.lower())):
        try:
            response = read_touchstone(path)
        except ExpressionError as error:
            print(f"{path.name}: {error}")
            continue
        found, other = [ours(response, tolerance) for tolerance in ASKED], theirs(path)
        results.append((found, other))
        told = "" if not other[2] else ", passive"
        cells = [_cells(*x) for x in found] + [_cells(other[0], other[1], True, other[3], told)]
        rows.append(f"| {path.name} | {response.ports}, {len(response.f)} | {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    good = [[found[k][2] and found[k][1] <= ASKED[k] for found, _ in results] for k in (0, 1)]
    near = [other for _, other in results if other[1] <= ASKED[0]]
    page = TEXT.format(
        version=skrf.__version__,
        rows="\n".join(rows),
        number=len(results),
        within=sum(good[0]),
        longest=max(x[3] for found, _ in results for x in found),
        closer=sum(good[1]),
        theirs=len(near),
        passive=sum(other[2] for other in near),
    )
    if folder == WHEEL:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page.rsplit("\n\n", 1)[1])


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else WHEEL)
