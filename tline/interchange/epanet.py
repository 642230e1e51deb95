"""Water networks from EPANET files, read by wntr and solved by EPANET itself for their operating point."""

import logging
import tempfile
import warnings
from collections import defaultdict
from collections.abc import Iterator
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.head_loss import GRAVITY, LAWS
from tline.interchange.pump_curve import Polyline, PowerLaw, pump_curve
from tline.interchange.water_network import STILL, Basin, Junction, Pipe, Pump, Valve, WaterNetwork

WATER, VISCOSITY = 1000.0, 1.1e-5 * 0.3048**2  # kg/m³ and m²/s, EPANET's
MULTIPLIER = 1e-3  # a viscosity above it is a multiple of that of water
PSI_PER_METRE = 0.4333 / 0.3048
ACCURACY, TRIALS = 1e-5, 1000  # of EPANET's solution: flow changes, relative, in its last step
HIGHEST = 1e5  # m, of a head that is no accident of an unsolved network
SLOWEST = 0.01  # m/s; friction at slower flow is taken at this speed
CLOSED = 0  # status of a link in results
LISTED = 6
TRADITIONAL = {"CFS", "GPM", "MGD", "IMGD", "AFD"}


def read_epanet(path: str | Path) -> WaterNetwork:
    """Read an EPANET file and its operating point: the steady flow at the file's start of time.

    Demand patterns, controls and rules count as they stand at that instant. What is closed then is left out, but for
    check valves, and the notes name it.

    Parameters
    ----------
    path : str or Path
        An ``.inp`` file of EPANET 2.0 or 2.2.

    Raises
    ------
    InputError
        wntr is not installed, cannot read the file, or finds no steady flow; or the file holds what cannot be
        represented.
    """
    wntr = _wntr()
    logging.getLogger("wntr").addHandler(logging.NullHandler())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            model = wntr.network.WaterNetworkModel(str(path))
        except OSError as error:
            raise InputError(str(path), "cannot be read", got=error.strerror or str(error)) from None
        except Exception as error:  # noqa: BLE001 (a broken file makes wntr raise whatever comes)
            raise InputError(str(path), "cannot be read as an EPANET file", got=_said(error)) from None
        curves = {name: _curve(f"{path}: pump '{name}'", link) for name, link in model.head_pumps()}
        return _network(model, curves, _solved(wntr, model, str(path)), str(path))


def _wntr() -> Any:
    try:
        import wntr  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise InputError("EPANET files", f"are read by wntr, which is not installed ({error.name} is missing)",
                         "pip install 'tline[epanet]'") from None  # fmt: skip
    return wntr


def _said(error: BaseException) -> str:
    """The first reason given, for that names the line of the file."""
    while error.__cause__ is not None:
        error = error.__cause__
    if isinstance(error, KeyError):
        return f"the name {error}, which nothing has"
    return " ".join(str(error).replace("%s", "").split())[:300] or type(error).__name__


def _solved(wntr: Any, model: Any, path: str) -> Any:
    """EPANET's solution at the start of time."""
    model.options.time.duration = 0
    model.options.hydraulic.accuracy, model.options.hydraulic.trials = ACCURACY, TRIALS
    with tempfile.TemporaryDirectory() as folder:
        try:
            return wntr.sim.EpanetSimulator(model).run_sim(str(Path(folder) / "network"), convergence_error=True)
        except Exception as error:  # noqa: BLE001
            raise InputError(path, "EPANET finds no steady flow", got=_said(error)) from None


def _network(model: Any, curves: dict[str, PowerLaw | Polyline], solution: Any, path: str) -> WaterNetwork:
    hydraulic = model.options.hydraulic
    viscosity = float(hydraulic.viscosity) * (VISCOSITY if hydraulic.viscosity > MULTIPLIER else 1.0)
    heads, drawn = (solution.node[key].iloc[0] for key in ("head", "demand"))
    flows, status, settings = (solution.link[key].iloc[0] for key in ("flowrate", "status", "setting"))
    stopped = {name for name in (*model.pump_name_list, *model.valve_name_list) if abs(flows[name]) < STILL}
    stopped |= {name for name in model.pump_name_list if settings[name] <= 0}
    closed = {name for name in model.link_name_list if status[name] == CLOSED or name in stopped}
    one_way = {name for name, link in model.pipes() if link.check_valve}
    reached = _reached(model, closed)
    _check_heads(heads[sorted(reached)], path)
    in_use = {name for name, link in model.links() if {*_ends(link)} <= reached and name not in closed - one_way}
    law = hydraulic.headloss, (viscosity,) if hydraulic.headloss == "D-W" else ()
    pipes = {name: _pipe(link, float(flows[name]), *law) for name, link in model.pipes() if name in in_use}
    pumps = {
        name: Pump(
            _ends(link), curves.get(name), getattr(link, "power", None), float(settings[name]), float(flows[name])
        )
        for name, link in model.pumps()
        if name in in_use
    }
    valves = {
        name: Valve(_ends(link), link.valve_type, float(flows[name]), float(np.subtract(*heads[[*_ends(link)]])))
        for name, link in model.valves()
        if name in in_use
    }
    junctions = {
        name: _junction(hydraulic, node, float(heads[name]), float(drawn[name]))
        for name, node in model.junctions()
        if name in reached
    }
    basins = {
        name: _basin(node, float(heads[name]))
        for name, node in (*model.reservoirs(), *model.tanks())
        if name in reached
    }
    return WaterNetwork(
        title=model.title[0] if model.title else Path(path).stem,
        density=WATER * float(hydraulic.specific_gravity),
        viscosity=viscosity,
        exponent=float(hydraulic.emitter_exponent),
        junctions=junctions,
        basins=basins,
        pipes=pipes,
        pumps=pumps,
        valves=valves,
        notes=tuple(_notes(model, [name for name in closed if name not in in_use], reached)),
    )


def _check_heads(heads: Any, path: str) -> None:
    unsolved = heads[~(heads.abs() < HIGHEST)]
    if len(unsolved) or not len(heads):
        got = f"a head of {unsolved.iloc[0]:.3g} m at '{unsolved.index[0]}'" if len(heads) else "none that a link joins"
        raise InputError(path, "EPANET finds no steady flow", "a network fed by reservoirs or tanks", got)


def _reached(model: Any, closed: set[str]) -> set[str]:
    """Nodes that open links join with a reservoir or a tank."""
    beside = defaultdict(list)
    for name, link in model.links():
        if name not in closed:
            one, two = _ends(link)
            beside[one].append(two)
            beside[two].append(one)
    found = {name for name in (*model.reservoir_name_list, *model.tank_name_list) if name in beside}
    new = list(found)
    while new:
        grown = {other for node in new for other in beside[node]} - found
        found |= grown
        new = list(grown)
    return found


def _ends(link: Any) -> tuple[str, str]:
    return link.start_node_name, link.end_node_name


def _pipe(link: Any, flow: float, law: str, given: tuple[float, ...]) -> Pipe:
    """A pipe with the friction factor that gives EPANET's loss at its flow."""
    length, diameter = float(link.length), float(link.diameter)
    area = pi / 4 * diameter**2
    at = max(abs(flow), SLOWEST * area)
    loss = LAWS[law](at, length, diameter, float(link.roughness), *given)
    factor = loss * diameter / length * 2 * GRAVITY / (at / area) ** 2 + float(link.minor_loss) * diameter / length
    vertices = tuple((float(x), float(y)) for x, y in link.vertices)
    return Pipe(_ends(link), length, diameter, flow, factor, bool(link.check_valve), vertices)


def _curve(where: str, link: Any) -> PowerLaw | Polyline:
    curve = link.get_pump_curve()
    try:
        return pump_curve(curve.points if curve else [])
    except InputError as error:
        raise InputError(where, error.problem, error.expected, error.got) from None


def _junction(hydraulic: Any, node: Any, head: float, drawn: float) -> Junction:
    elevation = float(node.elevation)
    emitter = float(node.emitter_coefficient or 0.0)
    if hydraulic.inpfile_units in TRADITIONAL:  # wntr turns pounds per square inch into metres for a square root
        emitter *= PSI_PER_METRE ** (hydraulic.emitter_exponent - 0.5)
    leaking = emitter * max(head - elevation, 0.0) ** hydraulic.emitter_exponent if emitter else 0.0
    return Junction(elevation, head, _position(node), drawn - leaking, emitter)


def _basin(node: Any, head: float) -> Basin:
    tank = node.node_type == "Tank"
    return Basin("tank" if tank else "reservoir", float(node.elevation) if tank else head, head, _position(node))


def _position(node: Any) -> tuple[float, float]:
    x, y = node.coordinates
    return float(x), float(y)


def _notes(model: Any, closed: list[str], reached: set[str]) -> Iterator[str]:
    cut_off = [name for name in model.node_name_list if name not in reached]
    for names, why in (
        (closed, "closed or without flow"),
        (cut_off, "no open link leads there from a reservoir or tank"),
    ):
        if names:
            listed = ", ".join(map(repr, sorted(names)[:LISTED]))
            yield f"left out, {why}: {listed}" + f" and {len(names) - LISTED} more" * (len(names) > LISTED)
    if model.num_controls or model.num_patterns:
        yield "patterns, controls and rules: held as they stand at the start of time"
