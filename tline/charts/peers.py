"""Other programs on the scenes of the charts, measured in the same run; those that are absent are named.

| peer | how | its clock |
|---|---|---|
| ngspice | T and O elements, its largest step refined | its own figure of the transient analysis, in milliseconds |
| scikit-rf | two-ports in a row, inverse FFT over a damped window twice the run | all but the grid of frequencies |
| rthym-moc | its friction, which cannot be switched off, as small as it allows | its run(), setting up included |

TSNet, also for water, has no exact counterpart here: its demands are openings, and the flow of the scene is given.
"""

import warnings
from collections.abc import Callable
from functools import partial

from tline.charts import inverse_fft, ngspice, rthym
from tline.charts.clock import FULL, QUICK, Run
from tline.charts.table import Table
from tline.charts.work_precision import add, begun, production
from tline.scene.scene import Scene

PATIENT = FULL._replace(longest=2.0)  # s; peers need it

Peer = tuple[Callable[[Scene], str | None], Callable[[Scene, int], Run]]
PEERS: dict[str, Peer] = {
    "ngspice": (ngspice.misfit, ngspice.run),
    "scikit-rf, inverse FFT": (inverse_fft.misfit, inverse_fft.run),
    "rthym-moc, its friction on": (rthym.misfit, rthym.run),
}


UNLIKE = {"TSNet": "its demands are openings, and the scenes give flows or voltages"}


def peers(name: str, quick: bool = False, progress: bool = False) -> Table:
    """Measure other programs, and the production method beside them, on one scene of the charts.

    Parameters
    ----------
    name : str
        One of `tline.charts.scenes.NAMES`.
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

    effort = QUICK if quick else PATIENT
    scene, judge, table = begun(name, effort, quick)
    with tqdm(total=2 + len(PEERS), disable=not progress, unit="program") as bar, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        table.rows += production(scene, judge, effort)
        bar.update(2)
        for label, (misfit, run) in PEERS.items():
            why = misfit(scene)
            if why:
                table.notes.append(f"absent: {label} ({why})")
            else:
                add(table, label, "peer", partial(run, scene), judge, effort)
            bar.update()
    table.notes += [f"absent: {label} ({why})" for label, why in UNLIKE.items()]
    return table
