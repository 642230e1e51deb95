"""Operate a network by words, run it, and find the worst of it."""

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import count
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tline.errors import import_extra
from tline.interchange.water_controls import WaterControl
from tline.presentation import Presentation
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.result.result import Result
from tline.solver.simulate import UnresolvedWarning, as_seconds, asked, simulated
from tline.solver.tolerance.ladder import Budget, Search
from tline.surge.band import Band, band_of
from tline.surge.columns import ROUGHLY, Columns, separated, surely
from tline.surge.control import acting, read_control, triggered
from tline.surge.event import OPERATIONS, Event, Texts, as_texts, each_of, probed_nodes, read_event, to_open
from tline.surge.operate import Network, operated, read_network
from tline.surge.report import as_dict, as_text
from tline.surge.tables import as_dataset, save_tables
from tline.surge.unsteady import with_unsteady
from tline.surge.worst import ALONE, Extreme, Worst, behind_outlets, extremes, is_decided, worst

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

SHOWN = 5  # nodes in tables
SECONDS = 20.0  # computing time for all runs
KEPT, WAITING_SHARE = 0.5, 0.2  # of the time left: for further runs where some follow, and for one that finds instants
LONGEST = 3600.0  # s, to which a run is made longer until no extreme lies at its end
MOST_RECORDED = 300  # lines of a network all of which are recorded
Planned = tuple[Scene, tuple[str, ...]]  # a scene, and notes on guesses for it


@dataclass(frozen=True, eq=False, repr=False)
class Operation(Presentation):
    """An operated network and its results; printed, it is the report of ``tline surge``.

    Attributes
    ----------
    result : Result
        With an envelope; its probes are at the nodes that were operated, or those asked for.
    guesses : tuple of str
        Omissions from the file, and values assumed where none were given.
    columns : Columns or None
        Results for columns that separated, where cavities were laid; None if nothing boiled.
    """

    result: Result
    guesses: tuple[str, ...]
    columns: Columns | None = None

    def text_lines(self) -> list[str]:
        """The report, and notes."""
        text = as_text(self.result, self.result.accuracy, self.worst, self.columns)
        return [*text.splitlines(), *(f"note: {n}" for n in self.notes)]

    def __str__(self) -> str:
        return "\n".join(self.text_lines())  # all lines, for those at the end matter

    @property
    def scene(self) -> Scene:
        """The network with all operations in it: `tline.simulate` runs it just so, and ``to_toml()`` writes it."""
        return self.result.scene

    @cached_property
    def worst(self) -> Worst:
        """The nodes with the largest rise and fall, where water boils, and the pressure class that is needed."""
        columns = self.columns
        alone = ALONE if columns and len(columns.places) == 1 else ""
        return worst(self.result, SHOWN, columns.spread if columns else 0.0, alone)

    def band(self, known: Iterable[str] = (), progress: bool = False, seconds: float | str = SECONDS) -> Band | None:
        """Effect of guesses on the highest and lowest pressure: runs with each of them varied.

        Parameters
        ----------
        known : iterable of str
            Quantities that are no guesses: "wave speed", "friction", "travel", "inertia".
        progress : bool
            Show a progress bar on stderr if a run takes more than two seconds.
        seconds : float or str
            Computing time for all runs, above 0; guesses for which none is left are named.

        Returns
        -------
        Band or None
            None if there is nothing to vary.
        """
        budget = Budget(as_seconds(seconds))
        return band_of(self.result, lambda scene: run(scene, (), progress, budget), budget, tuple(known))

    @property
    def notes(self) -> tuple[str, ...]:
        """Guesses, and all notes on the run."""
        return (*self.guesses, *self.result.notes)

    def to_dict(self) -> dict[str, Any]:
        """The worst nodes as plain data in SI, as ``tline surge --json`` prints them."""
        return as_dict(self.result, self.worst, self.columns)

    def to_dataframe(self) -> "DataFrame":
        """Gauge pressures before the run and at their extremes, Pa, with instants, s, and errors, by node.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        pandas = import_extra("pandas", "pandas", "data", "to_dataframe")
        return pandas.DataFrame(extremes(self.result), columns=Extreme._fields).set_index("node")

    def to_xarray(self) -> "Dataset":
        """Tables of nodes and pipes as a dataset of xarray, over `node` and `pipe`, in the units of the scene.

        Raises
        ------
        MissingExtraError
            xarray is not installed.
        """
        return as_dataset(self.result)

    def save_tables(self, path: str | Path) -> None:
        """Write tables of nodes, pipes and states: ``.csv`` (three files), ``.xlsx`` or ``.geojson``.

        Raises
        ------
        InputError
            Another suffix, or a file cannot be written.
        """
        save_tables(self.result, path)

    def plot(self, ax: "Axes | None" = None) -> "Figure | Axes":
        """Draw pressure and flow over time at the probes; on `ax` the pressure."""
        return self.result.plot() if ax is None else self.result.plot(ax)

    def plot_map(self) -> "Figure":
        """Draw maps of the network, coloured by how far the head rose and fell."""
        return self.result.plot_map()

    def plot_profile(self, *nodes: str) -> "Figure":
        """Draw the lowest and the highest head along the path of least delay through some nodes."""
        return self.result.plot_profile(*nodes)


def operate(
    network: Network | Scene | str | Path | Mapping[str, Any],
    *,
    trip: Texts = (),
    start: Texts = (),
    stop: Texts = (),
    speed: Texts = (),
    close: Texts = (),
    open: Texts = (),
    burst: Texts = (),
    demand: Texts = (),
    when: Texts = (),
    t_end: float | str = "60 s",
    tol: float | None = None,
    order: int | None = None,
    inertia: float | str | None = None,
    rated_speed: float | str | None = None,
    rating: float | str | None = None,
    units: str | None = None,
    unsteady: str | None = None,
    at: Texts = (),
    record: Iterable[str] | None = None,
    cavities: bool = True,
    until_settled: bool = False,
    wave_speed: float | str | None = None,
    material: str | None = None,
    hour: float | None = None,
    moving_tanks: bool = False,
    seconds: float | str = SECONDS,
    progress: bool = False,
) -> Operation:
    """Operate a network of pipes in its steady state, and find the worst of it.

    Each operation is a text, or several for different elements.

    Parameters
    ----------
    network : Scene, path or dict
        A hydraulic scene that starts in the steady state, or the path of one (.toml) or of a network of EPANET (.inp).
    trip : str, "PUMP@TIME"
        Pumps whose motors fail, and that run down; "*@TIME" all that run, "P1,P2@TIME" or "north*@TIME" a group.
    start : str, "PUMP@TIME"
        Pumps at rest that their motors start; +DURATION does so evenly. After a trip the power returns.
    stop : str, "PUMP@TIME+DURATION"
        Pumps whose speed falls to nothing, linearly.
    speed : str, "PUMP:SHARE@TIME+DURATION"
        Pumps that go to a share of the rated speed, linearly; PUMP@TIME:FILE.csv follows a file of speeds.
    close : str, "LINK@TIME+DURATION"
        Valves to shut, or pipes that get a gate valve; with :20%+8s a second stage from there, with :FILE.csv along a
        file of openings.
    open : str, "LINK@TIME+DURATION"
        Valves to open.
    burst : str, "NODE:FLOW@TIME"
        Holes, or drains that open, with their flow at the pressure before.
    demand : str, "NODE:±FLOW@TIME"
        Nodes that draw more, or less; twice for a pulse.
    when : str, "NODE>PRESSURE:close LINK+DURATION"
        Operations once a gauge pressure is reached, above or below (<).
    t_end : number or text
        How long to run, s.
    tol : float, 1e-13 to 0.1
        Largest error at the probes at any instant, relative to their amplitudes. If neither it nor `order` is given,
        delays are rounded to whole slabs, which are halved until the highest and lowest pressures at all nodes are
        known within 0.01 of the largest, or well enough that nothing boils and one class is left.
    order : int, 1 to 16
        One run of this order instead, in the slabs that suit it.
    inertia : number or text, optional
        Of pumps that trip or start, such as "2 kg m^2"; a usual one for their power if not given.
    rated_speed : number or text, optional
        Of pumps that trip or start, such as "1450 rpm"; a usual one if not given.
    rating : number or text, optional
        Pressure that the pipes bear, such as "16 bar".
    units : str, optional
        In which results are read: "SI", "US", or units such as "US, MGD"; those of the file if not given.
    unsteady : "vardy-brown", "zielke" or "none", optional
        Friction added in all pipes while flows change: in turbulent flow, about the flow of the start, or in laminar
        flow; that of the scene if not given, which an .inp file does not have.
    at : str
        Nodes to probe, instead of those that are operated.
    record : iterable of str, optional
        Lines of whose inside maps and profiles are drawn; all of a network of at most 300 lines if not given.
    cavities : bool
        Where water boils, run again with cavities of vapour there and along the pipes beside, at two numbers of places.
    until_settled : bool
        Run longer, up to an hour, until neither the highest nor the lowest pressure comes at the end of the run.
    wave_speed, material, hour, moving_tanks
        Of an .inp file, as of `tline.interchange.read_inp`.
    seconds : float or str
        Computing time for all runs, above 0. When a further run is expected to end later, the best so far is the
        result, with its estimated error; a class is named if that is enough for one.
    progress : bool
        Show a progress bar on stderr if a run takes more than two seconds.

    Returns
    -------
    Operation
        Its worst nodes, its scene, its result and its pictures.

    Raises
    ------
    InputError
        The network cannot be read, or not be operated so.

    Examples
    --------
    >>> import tline as tl
    >>> pipes = {"length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    >>> network = {
    ...     "medium": "hydraulic", "t_end": "1 s", "start": "steady",
    ...     "lines": {"main": {"nodes": ["lake", "b"], **pipes}, "branch": {"nodes": ["b", "c"], **pipes}},
    ...     "loads": {
    ...         "lake": {"at": "lake", "kind": "reservoir", "pressure": "6 bar"},
    ...         "tap": {"at": "c", "kind": "orifice", "flow": "20 L/s", "pressure_drop": "6 bar"},
    ...     },
    ...     "probes": {"tap": {"at": "c"}},
    ... }
    >>> surge = operate(network, close="tap@0s+2s", t_end="10 s")
    >>> rise = surge.worst.risen[0]
    >>> rise.node, round(rise.highest / 1e5, 1), surge.worst.needed / 1e5, surge.worst.boiling
    ('c', 8.8, 10.0, [])
    """
    budget = Budget(as_seconds(seconds))
    given = dict(zip(OPERATIONS, (trip, start, stop, speed, close, open, burst, demand), strict=True))
    scene, read, controls = read_network(
        network,
        wave_speed=wave_speed,
        material=material,
        hour=hour,
        moving_tanks=moving_tanks,
        opened=to_open(as_texts("open", open)),
    )
    rotor = {"inertia": inertia, "rated_speed": rated_speed}
    planned, guesses = plan(
        scene,
        given,
        when=when,
        t_end=t_end,
        tol=tol,
        order=order,
        rating=rating,
        units=units,
        unsteady=unsteady,
        at=at,
        controls=controls,
        budget=budget,
        progress=progress,
        **rotor,
    )
    lines = record if record is not None else planned.lines if len(planned.lines) <= MOST_RECORDED else ()
    more = {"cavities": cavities, "until_settled": until_settled, "progress": progress}
    return carried_out(planned, (*read, *guesses), lines, budget, **more)


def plan(
    scene: Scene,
    operations: Mapping[str, Texts],
    *,
    when: Texts = (),
    t_end: float | str,
    tol: float | str | None = None,
    order: int | str | None = None,
    rating: float | str | None = None,
    units: str | None = None,
    unsteady: str | None = None,
    at: Texts = (),
    controls: Iterable[WaterControl] = (),
    budget: Budget | None = None,
    progress: bool = False,
    **rotor: float | str | None,
) -> Planned:
    """Return the scene with operations by kind and controls of a file, with notes on guesses and instants."""
    scene, told = with_unsteady(scene, unsteady) if unsteady is not None else (scene, [])
    solver = {"order": order} if order else {"tol": tol} if tol else ROUGHLY
    more = {"t_end": t_end, "solver": solver} | {
        key: value for key, value in (("rating", rating), ("units", units)) if value
    }
    events = [read_event(kind, text) for kind in OPERATIONS for text in as_texts(kind, operations.get(kind, ()))]
    wanted = as_texts("at", at)
    waiting = [read_control(text) for text in as_texts("when", when)]
    tripped = {one.name for event in events if event.kind == "trip" for one in each_of(scene, event)}
    events = [one for event in events for one in each_of(scene, event, tripped)]
    taken = {event.name for event in (*events, *(one.event for one in waiting))}
    begun, waits, notes = acting(scene, controls, taken, Quantity(t_end, "s", "t_end"))
    events, waiting = [*events, *begun], [*waiting, *waits]

    @lru_cache(1)
    def build(done: tuple[Event, ...], watched: tuple[str, ...]) -> Planned:
        probes = {node: {"at": node} for node in (*probed_nodes(scene, done, wanted), *watched)}
        seen = {"probes": probes, "measures": {}} if probes else {}
        changed, notes = operated(scene, done, **rotor, more=more | seen)
        shut_in = set() if wanted else behind_outlets(changed) - {*watched}
        known = {node: probe for node, probe in probes.items() if node not in shut_in}
        return changed if known in ({}, probes) else changed.with_changes(probes=known), tuple(notes)

    if waiting:
        left = budget or Budget(SECONDS)
        found = {"run": lambda each: run(each, (), progress, Budget(WAITING_SHARE * max(left.left, 0.0)))}
        events, waiting, instants = triggered(waiting, events, lambda *each: build(*each)[0], **found)
        notes += instants
    watched = () if wanted else tuple(one.node for one in waiting)  # as in the run that found no instants
    planned, guesses = build(tuple(events), watched)
    return planned, (*told, *notes, *guesses)


def run(scene: Scene, record: Iterable[str], progress: bool, budget: Budget) -> Result:
    """Simulate with an envelope; unresolved features are among the notes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        each = describe(scene), asked(scene, None) or 0.0, [*record], progress, budget
        return simulated(Search(*each, envelope=True, ledger=False))


def carried_out(
    scene: Scene,
    guesses: Iterable[str],
    record: Iterable[str],
    budget: Budget,
    *,
    cavities: bool = True,
    until_settled: bool = False,
    progress: bool = False,
) -> Operation:
    """Run an operated scene, with cavities where columns separate, and until no extreme lies at its end, if wanted."""
    half, compared, rough = KEPT * budget.left, count(1), scene.solver.rounded

    def kept(best: Result) -> float:
        if cavities and surely(best):
            return inf
        if next(compared) > 1 and rough and is_decided(best):
            return inf
        found = worst(best)
        return half if (cavities and found.boiling) or (until_settled and found.unfinished) else 0.0

    result, columns, notes = run(scene, record, progress, budget.keeping(kept)), None, ()
    if result.accuracy and rough and is_decided(result):  # a tolerance that nobody asked
        result = replace(result, accuracy=replace(result.accuracy, tol=None, limit=""))
    if cavities:
        result, columns, notes = separated(result, lambda laid: run(laid, record, progress, budget), budget)
    found = Operation(result, (*guesses, *notes), columns)
    now, longer = float(scene.t_end), 2 * float(scene.t_end)
    if not until_settled or not found.worst.unfinished or longer > LONGEST or budget.left < 0.5 * budget.seconds:
        return found
    told = f"an extreme lay at the end of a run of {now:g} s: it was made again, up to {longer:g} s"
    again = {"cavities": cavities, "until_settled": True, "progress": progress}
    return carried_out(scene.with_changes(t_end=longer), (*guesses, told), record, budget, **again)
