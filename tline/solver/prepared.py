"""A scene for repeated runs with other values: parts that these do not touch are read and found once."""

from collections.abc import Iterable, Mapping
from itertools import pairwise
from math import inf, log2
from pathlib import Path
from threading import Lock
from typing import Any

from tline.scene.file import as_scene
from tline.solver.description.description import Description, describe
from tline.solver.description.given import Scene
from tline.solver.plan import Pair, planned
from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import Result
from tline.solver.simulate import asked, simulated
from tline.solver.tolerance.ladder import Budget, Search, Start

WORSE = (
    4  # times that a step may leave more of a difference with other values; and a grid, unless unknown kinks make it so
)
ROOM = 0.2  # of the tolerance: where the order below should leave less, it is tried


class Prepared:
    """A scene made ready for runs with other values, also from several threads; made by `prepare`.

    Parameters
    ----------
    scene : Scene
        As it was given.
    starts : mapping of float to Start, optional
        Where searches for order and slab begin, by tolerance.
    fixed : bool
        Whether they begin there always.

    Attributes
    ----------
    description : Description
        Of the scene.
    """

    def __init__(self, scene: Scene, starts: Mapping[float, Start] | None = None, fixed: bool = False):
        self.scene, self.description = scene, describe(scene)
        self.starts, self._fixed = dict(starts or {}), fixed
        self._plans: dict[float, Pair | None] = {}
        self._repeated: set[float] = set()  # tolerances of several searches
        self._lock = Lock()  # of plans, which write in place

    def fix(self, starts: Mapping[float, Start] | None = None) -> "Prepared":
        """Begin all further searches where they begin now, or at `starts`, so that no run depends on those before."""
        self.starts, self._fixed = dict(self.starts if starts is None else starts), True
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return Prepared, (self.scene, self.starts, self._fixed)

    def run(
        self,
        values: Mapping[str, Any] | None = None,
        *,
        tol: float | None = None,
        record: Iterable[str] = (),
        envelope: bool = False,
        ledger: bool | None = None,
        active: bool = False,
        progress: bool = False,
    ) -> Result:
        """Simulate the scene with other values.

        Parameters
        ----------
        values : mapping of str to number, text or table, optional
            By dotted path, as of `Scene.change`: ``"loads.receiver.capacitance"``, ``"t_end"``, or whole elements. All
            other values are those of the scene as it was given, independent of earlier runs.
        tol, record, envelope, ledger, active, progress
            As of `tline.solver.simulate.simulate`.

        Returns
        -------
        Result
            That of `simulate` for the changed scene. The search for order and slab begins where the last one to the
            same tolerance ended, so it may be the result of another order, within the tolerance as well.

        Raises
        ------
        InputError
            There is nothing at a path, or a value does not fit there; or any error that `simulate` raises.
        """
        description = self.description.changed(values) if values else self.description
        wanted = asked(description.scene, tol)
        how = bool(envelope or ledger or active or progress or [*record])
        if values and wanted and not how and (result := self._planned(description, wanted)):
            return result
        start = None if wanted is None else self.starts.get(wanted)
        each = description, wanted or 0.0, [*record], progress, Budget(shown=progress)
        result = simulated(Search(*each, envelope=envelope, ledger=ledger, active=active, start=start))
        if wanted is not None and result.accuracy is not None and not self._fixed:
            self._learn(wanted, result.accuracy)
        return result

    def _planned(self, description: Description, tol: float) -> Result | None:
        """Result by a plan or a pair, for the same lines and times; None without one, or if it is not for these values.

        A plan is made once a search has begun where another had ended.
        """
        if not (tol in self._repeated or self._fixed) or not description.fits(self.description):
            return None
        with self._lock:
            if tol not in self._plans:
                self._plans[tol] = planned(self.description, tol)
            plan = self._plans[tol]
            return plan and plan.run(description)

    def _learn(self, tol: float, accuracy: Accuracy) -> None:
        """Remember the grid that a search ended with, and how fast it converged, if that was by the order alone."""
        attempts, is_ladder = [*accuracy.attempts], len(accuracy.attempts) > 1
        for a, b in pairwise(attempts):  # each has a higher order than the one before, or a half or quarter of its slab
            same = (b.order, b.slab) == (a.order, a.slab)
            is_ladder &= not same and b.order >= a.order and a.slab / b.slab in (1.0, 2.0, 4.0)
        if not accuracy.met or any(attempt.sections for attempt in attempts) or not is_ladder:
            self.starts.pop(tol, None)
            return
        known, told = self.starts.get(tol), [a.estimate for a in attempts if a.estimate]
        if known and told and told[0] > WORSE * known.told:
            return  # a run that knows no kinks from one before is worse than its grid, and so would finer ones be
        halved = round(log2(attempts[0].slab / attempts[-2].slab)) + (known.halved if known else 0)
        self._repeated.update([tol] if known else [])
        left, order = known.left if known else SLOWEST, attempts[-2].order
        if halved:
            left = SLOWEST
        elif len(told) > 1:
            left = min(WORSE * (told[-1] / told[-2]) ** (1 / max(order - attempts[-3].order, 1)), SLOWEST)
        spare = known is not None and told and told[-1] <= ROOM * tol * left and not halved
        self.starts[tol] = Start(order - 1 if spare else order, left, halved, told[-1] if told and not spare else inf)


def prepare(scene: Scene | str | Path | Mapping[str, Any]) -> Prepared:
    """Make a scene ready to be run again and again with other values.

    Parameters
    ----------
    scene : Scene, path or dict
        A scene, the path of a file that `read` reads, or its tables.

    Returns
    -------
    Prepared
        Its method ``run`` simulates the scene with values at dotted paths in place of its own.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"c": {"at": "far", "kind": "parallel", "resistance": 100, "capacitance": "10 pF"}},
    ... )
    >>> prepared = prepare(scene)
    >>> for capacitance in ("1 pF", 50e-12):
    ...     result = prepared.run({"loads.c.capacitance": capacitance}, tol=1e-6)
    ...     print(f"{float(result.probes['far'].at(5.5e-9).u):.4f}")
    0.6667
    0.1728
    """
    return Prepared(as_scene(scene))
