"""Studies: many scenarios of a network, run on any executor, kept on disk as they end, and compared."""

import json
import os
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.atomic import replacing, suffix_of, write_table
from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.file import scene_text
from tline.scene.medium import readable
from tline.scene.rating import BAR
from tline.surge.scenarios import AS_READ, Plan, Scenario, read_plan
from tline.surge.worst import extremes
from tline.sweeps.design import whole
from tline.sweeps.executors import Batch, NoWorkers, Queue, on_executor, on_processes, workers_of
from tline.sweeps.runs import MOST_WORKERS
from tline.words.progress import Progress
from tline.words.wording import aligned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WRITTEN = ".html", ".pdf", ".csv"
SHOWN = 4  # decimals of pressures in tables
# of the extremes of a node, Pa: largest where a surge hit hardest
MEASURES: dict[str, Callable[[Mapping[str, Any]], float]] = {
    "rise": lambda node: node["highest"] - node["before"],
    "fall": lambda node: node["before"] - node["lowest"],
    "highest": lambda node: node["highest"],
    "lowest": lambda node: -node["lowest"],
}


class Outcome(NamedTuple):
    """Results of a scenario."""

    scenario: Scenario
    # those of `Operation.to_dict`, with `nodes`: extremes of all nodes, `estimate`: the estimated error, `seconds` of
    # processor time and `scene`: the text that `tline.simulate` runs just so; or `mistake`: the reason for having none
    told: Mapping[str, Any]

    @property
    def worst(self) -> dict[str, Mapping[str, Any]]:
        """Extremes of the nodes with the largest rise, fall, highest and lowest pressure; empty if failed."""
        nodes = self.told.get("nodes")
        return {word: max(nodes, key=measure) for word, measure in MEASURES.items()} if nodes else {}

    @property
    def verdict(self) -> str:
        """Class of pressure, or the reason for naming none."""
        told = self.told
        if "mistake" in told:
            return told["mistake"]
        if told["no_pressure_class"]:
            return f"none: {told['no_pressure_class']}"
        return f"PN {told['pressure_class'] / BAR:g}" if told["pressure_class"] else "above PN 100"

    @property
    def signed(self) -> bool:
        """Whether a class of pressure is named."""
        return bool(self.told.get("pressure_class"))


@dataclass(frozen=True, eq=False, repr=False)
class SurgeStudy(Presentation):
    """Scenarios of a network and their results; printed, the table of them all.

    Attributes
    ----------
    plan : Plan
        Title, variants of the network, paths and scenarios.
    outcomes : tuple of Outcome
        In the order of the scenarios.
    """

    plan: Plan
    outcomes: tuple[Outcome, ...]

    @property
    def unsigned(self) -> list[Outcome]:
        """Scenarios for which no class of pressure is named."""
        return [outcome for outcome in self.outcomes if not outcome.signed]

    @property
    def unit(self) -> tuple[float, str]:
        """Size, Pa, and name of the unit in which pressures are read."""
        first = self.plan.scenarios[0]
        scene, units = first.network.scene, first.options.get("units")
        return readable(scene.with_changes(units=units) if units else scene).unit("effort")

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Head and rows of the table of scenarios, in the units of the network."""
        size, unit = self.unit
        words = "rise", "at", "after", "fall", "at", "after", "highest", "±", "at", "lowest", "at"
        units = {"at": "", "after": " [s]"}
        head = ["scenario", *(word + units.get(word, f" [{unit}]") for word in words), "class"]
        rows = []
        for outcome in self.outcomes:
            cells = [""] * 11
            if worst := outcome.worst:
                rise, fall, top, low = worst.values()
                error = max(top["highest_error"] or 0.0, (outcome.told["columns"] or {}).get("spread", 0.0))
                cells = [*self.moved(outcome, "rise"), rise["node"], f"{rise['highest_at']:.4g}"]
                cells += [*self.moved(outcome, "fall"), fall["node"], f"{fall['lowest_at']:.4g}"]
                cells += [f"{top['highest'] / size:.4g}", f"{round(error / size, SHOWN):.1g}", top["node"]]
                cells += [f"{low['lowest'] / size:.4g}", low["node"]]
            rows.append([outcome.scenario.name, *cells, outcome.verdict])
        return head, rows

    def moved(self, outcome: Outcome, *words: str) -> list[str]:
        """Largest rise, "rise", or fall, "fall", of pressures, in the unit in which they are read."""
        size, worst = self.unit[0], outcome.worst
        return [f"{round(MEASURES[word](worst[word]) / size, SHOWN):.4g}" for word in words if worst]

    def text_lines(self) -> Iterator[str]:
        """Report lines, scenarios with the largest rise or fall first."""
        head, rows = self.table()
        yield self.plan.title or "a study of surges"
        failed = sum("mistake" in outcome.told for outcome in self.outcomes)
        told = f"{len(rows)} scenarios, {len(self.unsigned) - failed} without a class of pressure, {failed} failed"
        yield f"{told}; gauge pressures"
        order = sorted(range(len(rows)), key=lambda k: -_change(self.outcomes[k]))
        short = [
            [*rows[k][:-1], "failed" if "mistake" in self.outcomes[k].told else rows[k][-1].partition(":")[0]]
            for k in order
        ]
        yield from ["", *(line.rstrip() for line in aligned([head, *short], 1))]

    def to_dict(self) -> dict[str, Any]:
        """Title and all results of all scenarios, in SI."""
        rows = [{"name": each.scenario.name, "file": each.scenario.file, **each.told} for each in self.outcomes]
        return {"title": self.plan.title, "scenarios": rows}

    def plot(self, ax: "Axes | None" = None) -> "Figure | Axes":
        """Draw maps of how far pressures rose and fell in any scenario of the network as it is; on `ax` the first."""
        from tline.surge.study_page import worst_map

        return worst_map(self, AS_READ, ax)

    def save(self, path: str | Path) -> None:
        """Write the report, ``.html`` or ``.pdf``, or the table of scenarios, ``.csv``.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written.
        """
        if suffix_of(path, WRITTEN) == ".csv":
            write_table(path, *self.table())
            return
        from tline.pictures.page import save_page
        from tline.surge.study_page import study_page

        save_page(study_page(self), path)


def surge_study(
    study: str | Path | Mapping[str, Any],
    *,
    folder: str | Path | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: bool = False,
) -> SurgeStudy:
    """Run all scenarios of a study.

    Parameters
    ----------
    study : path or dict
        A TOML file or its tables: ``network``, ``reading`` and ``run`` (arguments of `operate`), ``variants``,
        ``events`` and ``paths``; see docs/networks.md.
    folder : str or Path, optional
        Where each scenario is kept as it ends, as NAME.json and the scene that it ran, NAME.toml. Those that are there
        are not run again.
    executor : concurrent.futures.Executor, optional
        Where scenarios are run, as for `tline.sweep`.
    workers : int, optional
        Processes that are started in place of an executor, 1 for none; as many as there are processors if not given.
    progress : bool
        Show a progress bar on stderr if the study takes more than two seconds.

    Returns
    -------
    SurgeStudy
        Results of all scenarios; one that cannot be run has a sentence in place of numbers.

    Raises
    ------
    InputError
        The study is not as above, or its network cannot be read.

    Examples
    --------
    >>> import tline as tl
    >>> pipe = {"nodes": ["lake", "c"], "length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    >>> network = {
    ...     "medium": "hydraulic", "t_end": "1 s", "start": "steady", "lines": {"main": pipe},
    ...     "loads": {
    ...         "lake": {"at": "lake", "kind": "reservoir", "pressure": "6 bar"},
    ...         "tap": {"at": "c", "kind": "orifice", "flow": "20 L/s", "pressure_drop": "6 bar"},
    ...     },
    ...     "probes": {"tap": {"at": "c"}},
    ... }
    >>> events = {"slow": {"close": "tap@0s+2s"}, "fast": {"close": "tap@0s"}}
    >>> found = surge_study({"network": network, "run": {"t_end": "10 s"}, "events": events}, workers=1)
    >>> [outcome.verdict for outcome in found.outcomes]
    ['PN 10', 'PN 10']
    """
    workers = None if workers is None else whole("workers", workers, 1, MOST_WORKERS)
    plan = read_plan(study)
    kept = [_kept(folder, scenario) for scenario in plan.scenarios]
    left = np.array([k for k, told in enumerate(kept) if told is None], int)
    with Progress(len(kept), "scenario", progress) as bar:
        bar.update(len(kept) - len(left))
        for rows, batch in _batches(plan.scenarios, left, executor, workers):
            for k, row in enumerate(rows.tolist()):
                if k in batch.errors:
                    kept[row] = {"mistake": batch.errors[k]}
                else:
                    kept[row] = json.loads(batch.kept["told"][k])
                    _keep(folder, plan.scenarios[row], kept[row])
            bar.update(len(rows))
    outcomes = [Outcome(scenario, told) for scenario, told in zip(plan.scenarios, kept, strict=True) if told]
    return SurgeStudy(plan, tuple(outcomes))


def run_scenarios(scenarios: Sequence[Scenario]) -> Batch:
    """Run some scenarios, in any process, and return all that is kept of each as JSON."""
    started = time.perf_counter()
    told = [json.dumps(_told(scenario), ensure_ascii=False) for scenario in scenarios]
    return Batch([*range(len(told))], {"told": np.array(told, object)}, {}, time.perf_counter() - started)


def _told(scenario: Scenario) -> dict[str, Any]:
    started = time.process_time()
    try:
        surge = scenario.carried_out()
    except InputError as error:
        return {"mistake": str(error)}
    result = surge.result
    accuracy, scene = result.accuracy, surge.scene
    if result.resolution.rounded:  # in one run, as the last one was
        scene = scene.with_changes(solver={"rounded": True, "slab": result.resolution.h})
    found = surge.to_dict() | {"notes": surge.notes, "nodes": extremes(result), "scene": scene_text(scene)}
    return plain(found | {"estimate": accuracy and accuracy.at_slab_ends, "seconds": time.process_time() - started})


def _batches(
    scenarios: Sequence[Scenario], left: NDArray, executor: Executor | None, workers: int | None
) -> Iterator[tuple[NDArray, Batch]]:
    def submit(executor: Executor, rows: NDArray) -> "Future[Batch]":
        return executor.submit(run_scenarios, [scenarios[k] for k in rows])

    if executor is not None:
        workers = workers_of(executor, workers)
        yield from on_executor(Queue(left, workers), executor, workers, submit)
        return
    workers = min(workers or os.cpu_count() or 1, len(left))
    if workers > 1:
        try:
            yield from on_processes(Queue(left, workers), workers, submit)
        except NoWorkers as error:
            warnings.warn(f"{error}; the study goes on in this process alone", stacklevel=3)
        else:
            return
    for k in left:
        yield np.array([k]), run_scenarios([scenarios[k]])


def _kept(folder: str | Path | None, scenario: Scenario) -> dict[str, Any] | None:
    """Results of a scenario in a folder, if it has them."""
    path = folder and Path(folder) / f"{scenario.file}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path and path.exists() else None


def _keep(folder: str | Path | None, scenario: Scenario, told: Mapping[str, Any]) -> None:
    if folder is None:
        return
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(folder), "cannot be a folder", got=(error.strerror or "").lower()) from None
    path = Path(folder) / scenario.file
    texts = {".toml": told["scene"]} if "scene" in told else {}
    for suffix, text in (texts | {".json": json.dumps(told, ensure_ascii=False)}).items():
        with replacing(f"{path}{suffix}") as temporary:
            temporary.write_text(text, encoding="utf-8")


def _change(outcome: Outcome) -> float:
    """Largest rise or fall of the pressure, Pa; infinite if the scenario failed."""
    return max((MEASURES[word](outcome.worst[word]) for word in ("rise", "fall") if outcome.worst), default=np.inf)
