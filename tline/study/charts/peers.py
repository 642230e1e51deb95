"""Other programs on the scenes of the charts, measured in the same run; those that are absent are named.

| peer | how | its clock of stepping | of all |
|---|---|---|---|
| ngspice | T and O elements, its largest step refined | its own figure, in milliseconds | the process |
| scikit-rf | two-ports in a row, inverse FFT over a damped window | all but the grid of frequencies | the same |
| rthym-moc | its factor of friction that of the scene, where it can be | its run(), setting up included | the same |
| TSNet | in an environment of its own, one pipe as two | its MOCSimulator() | the process |

Where friction depends on the flow, the textbook's grid of characteristics stands beside them.
"""

import warnings
from collections.abc import Callable
from functools import partial

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.charts import inverse_fft
from tline.study.charts.clock import FULL, QUICK, TimedRun
from tline.study.charts.table import ChartTable
from tline.study.charts.work_precision import add, baseline_run, begin
from tline.study.programs import ngspice, rthym, tsnet

PATIENT = FULL._replace(longest=1.0)  # s; peers need it

Peer = tuple[Callable[[Scene], str | None], Callable[[Scene, int], TimedRun]]
PEERS: dict[str, Peer] = {
    "ngspice": (ngspice.incompatibility, ngspice.run),
    "scikit-rf, inverse FFT": (inverse_fft.incompatibility, inverse_fft.run),
    "rthym-moc": (rthym.incompatibility, rthym.run),
    "TSNet": (tsnet.incompatibility, tsnet.run),
}
TEXTBOOK = "moc_grid"


def peers(name: str, quick: bool = False, progress: bool = False) -> ChartTable:
    """Measure other programs, and the production method beside them, on one scene of the charts.

    Parameters
    ----------
    name : str
        One of `tline.study.charts.scenes.NAMES`.
    quick : bool
        Few refinements, each run once: a look, not a measurement.
    progress : bool
        Show a progress bar on stderr.

    Raises
    ------
    InputError
        There is no such scene.

    Examples
    --------
    >>> table = peers("rc", quick=True)
    >>> len(list(table.curves())) > 3
    True
    """
    from tqdm import tqdm

    from tline.study.baseline import BASELINES

    effort = QUICK if quick else PATIENT
    with tqdm(total=2 + len(PEERS), disable=not progress, unit="program") as bar, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begun = begin(name, quick)
        (scene, judge), table = begun[:2], begun.table()
        bar.update(2)
        textbook = BASELINES[TEXTBOOK]
        if textbook.incompatibility(scene) is None:
            add(table, textbook.label, "baseline", partial(baseline_run, textbook, scene), judge, effort)
        for label, (incompatibility, run) in PEERS.items():
            why = incompatibility(scene)
            if why:
                table.notes.append(f"absent: {label} ({why})")
            else:
                add(table, label, "peer", partial(run, scene), judge, effort)
            bar.update()
    if scene.medium == "hydraulic" and not describe(scene).lossy:
        table.notes.append("rthym-moc has friction here, which cannot be switched off.")
    return table
