"""Protection of a pipe with the least size that keeps limits: an air vessel, a relief valve, the inertia of a pump."""

from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import Any

from tline.design.limits import limits
from tline.design.sizing import Runs, Size, Sizing
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.pump import Pump
from tline.scene.rating import BAR, HOUR, WATER
from tline.scene.scene import Scene
from tline.scene.valve import ReliefValve
from tline.scene.vessel import AirVessel
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import above_level
from tline.units import to_si
from tline.words.wording import nearest, place

RESERVE = 0.1  # of the shell: liquid left when the gas volume is largest
SWING = 10.0  # initial compliance of the gas over that of the lines
USUAL_SET = 0.9  # of the highest pressure, at which the valve is wide open


def vessel(
    scene: Scene | str | Path,
    at: str,
    *,
    path: Sequence[str] = (),
    lowest: float | str | None = None,
    highest: float | str | None = None,
    reserve: float | str = RESERVE,
    tol: float | None = None,
    progress: bool = False,
    **element: Any,
) -> Sizing:
    """Find the smallest air vessel at a node.

    The variable is the volume of the gas in the steady state. The shell holds the gas when the pressure at the node is
    lowest, and a reserve of liquid; the precharge is the pressure of gas that fills the empty shell at its temperature
    in the steady state.

    Parameters
    ----------
    scene : Scene or path
        Scene of a surge that starts in the steady state. An air vessel already at the node is resized.
    at : str
        Node of the vessel.
    path : sequence of str
        Nodes between which all places keep the limits; all nodes of the scene if not given.
    lowest : float or str, optional
        Lowest gauge pressure, such as "0.5 bar" (numbers are Pa), or head above the zero of heights, such as "35 m".
    highest : float or str, optional
        Highest gauge pressure or head; one of both is needed.
    reserve : float or str, 0 to 0.9
        Share of the shell that is liquid when the gas is largest.
    tol : float, optional
        Largest error of the runs, relative to the amplitude; the scene's, or 1e-3, if not given.
    progress : bool
        Show a bar on stderr if it takes more than two seconds.
    **element
        Keys of the vessel, as in a scene: ``kv``, ``exponent``, ``atmosphere``.

    Returns
    -------
    Sizing
        Gas, shell and precharge, the margin, the curve of all sizes run, and the scene with the vessel.

    Raises
    ------
    InputError
        No size keeps the limits, none is needed, or something does not fit the scene.

    Examples
    --------
    >>> import tline as tl
    >>> scene = tl.examples["air_vessel"].change({"t_end": "15 s"})
    >>> found = tl.design.vessel(scene, "vessel", lowest="2 bar", highest="7 bar", tol=1e-2)
    >>> round(found.sizes["gas volume"].value, 2), round(found.sizes["vessel volume"].value, 2)  # m³
    (0.79, 1.34)
    """
    given = as_scene(scene)
    wanted = limits(given, path, lowest, highest)
    share = to_si(reserve, "", "reserve")
    if not 0 <= share <= 0.9:
        raise InputError("reserve", "out of range", "from 0 to 0.9", f"{reserve}")
    description = describe(given)
    if at not in description.nodes:
        raise InputError("at", "no such node", nearest(at, list(description.nodes)), f"'{at}'")
    pressure = above_level(description).effort[at] - description.nodes[at].height.above_level
    name, table = _template(given, at)
    table |= element | {"gas_pressure": float(f"{pressure:.6g}")}
    loads = {**given.table().get("loads", {})}
    loads.pop(name, None)
    bare = given.with_changes(loads=loads)
    Runs(bare, lambda _: {}, wanted, tol, False).refuse_kept("highest" if lowest is None else "lowest", "a vessel")
    fitted = given.with_changes(loads={**loads, name: table | {"gas_volume": 1.0}})
    where = place("loads", name)
    runs = Runs(fitted, lambda size: {f"{where}.gas_volume": size}, wanted, tol, progress)
    gas = fitted.loads[name]
    assert isinstance(gas, AirVessel)
    outside = float(gas.atmosphere)
    compliance = sum((line.parameters.delay or 0.0) / (line.parameters.z0 or 1.0) for line in given.lines.values())
    found, search, notes = runs.smallest("m^3", SWING * compliance * (pressure + outside))
    least = _lowest(runs.results[found.size], at)
    shell = found.size * ((pressure + outside) / (least + outside)) ** (1 / float(gas.exponent)) / (1 - share)
    sizes = {
        "gas volume": Size(found.size, "m^3"),
        "gas pressure": Size(pressure, "bar"),
        "vessel volume": Size(shell, "m^3"),
        "precharge": Size((pressure + outside) * found.size / shell - outside, "bar"),
    }
    done = fitted.change({f"{where}.gas_volume": found.size})
    return Sizing("vessel", where, sizes, found, search.trials, wanted, done, tuple(notes))


def _template(scene: Scene, at: str) -> tuple[str, dict[str, Any]]:
    """Name and table of the air vessel at a node, or of a new one."""
    for name, load in scene.loads.items():
        if isinstance(load, AirVessel) and load.at == at:
            return name, load.table()
    return f"{at}:vessel", {"at": at, "kind": "air vessel"}


def _lowest(result: Any, at: str) -> float:
    """Lowest gauge pressure of a node."""
    seen = result.envelope
    k = seen.nodes.index(at)
    weight = float(seen.weight[k])
    return float(seen.lowest[k]) - (weight if weight == weight else 0.0)


def relief(
    scene: Scene | str | Path,
    at: str,
    *,
    highest: float | str,
    path: Sequence[str] = (),
    set_pressure: float | str | None = None,
    band: float | str | None = None,
    kv: float | str | None = None,
    tol: float | None = None,
    progress: bool = False,
) -> Sizing:
    """Find the smallest relief valve at a node; with a capacity, its highest set pressure.

    Parameters
    ----------
    scene : Scene or path
        Scene of a surge that starts in the steady state.
    at : str
        Node of the valve.
    highest : float or str
        Largest gauge pressure, Pa, or a text with a unit.
    path, tol, progress
        As of `tline.design.vessel`.
    set_pressure : float or str, optional
        Pressure at which the valve begins to open, Pa; 0.9 of the highest if neither it nor a capacity is given.
    band : float or str, optional
        Further pressure over which it opens, Pa; the rest up to the highest pressure if not given, or a tenth of that
        pressure with a given capacity.
    kv : float or str, optional
        Capacity, m³/h of water at 1 bar: then the set pressure is searched.

    Returns
    -------
    Sizing
        Capacity and set pressure, the margin, the curve of all sizes run, and the scene with the valve.

    Raises
    ------
    InputError
        Nothing keeps the limit, no valve is needed, or something does not fit the scene.

    Examples
    --------
    >>> import tline as tl
    >>> found = tl.design.relief(tl.examples["valve_closure"], "valve", highest="10 bar")
    >>> round(found.sizes["kv"].value), str(found.sizes["set pressure"])  # m³/h at 1 bar
    (95, '9 bar')
    """
    given = as_scene(scene)
    wanted = limits(given, path, None, highest)
    if wanted.per_metre is not None:
        raise InputError("highest", "is a head", "a gauge pressure, such as '10 bar'", str(highest))
    if kv is not None and set_pressure is not None:
        raise InputError("set_pressure", "nothing is left to search", "one of set_pressure and kv", "both")
    steady, density, z0 = _at_node(given, at)
    Runs(given, lambda _: {}, wanted, tol, False).refuse_kept("highest", "a relief valve")
    opens = USUAL_SET * wanted.highest if set_pressure is None else to_si(set_pressure, "Pa", "set_pressure")
    if kv is None and not steady < opens < wanted.highest:
        expected = f"above the steady {steady / BAR:.4g} bar and below the highest {wanted.highest / BAR:.4g} bar"
        raise InputError("set_pressure", "out of range", expected, f"{opens / BAR:.4g} bar")
    usual = wanted.highest - opens if kv is None else (1 - USUAL_SET) * wanted.highest
    over = usual if band is None else to_si(band, "Pa", "band")

    name = f"{at}:relief"
    table: dict[str, Any] = {"at": at, "kind": "relief valve", "density": density, "kv": kv or 1.0}
    table |= {"set_pressure": opens, "band": over}
    fitted = given.with_changes(loads={**given.table().get("loads", {}), name: table})
    where = place("loads", name)

    def values(size: float) -> dict[str, float]:
        if kv is None:
            return {f"{where}.kv": size}
        return {f"{where}.set_pressure": wanted.highest - size}

    runs = Runs(fitted, values, wanted, tol, progress)
    if kv is None:
        found, search, notes = runs.smallest("", sqrt(wanted.highest) / z0 * HOUR * sqrt(BAR * density / WATER))
    else:
        found, search, notes = runs.smallest("bar", (wanted.highest - steady) / 4, wanted.highest - steady)
    done = fitted.change(values(found.size))
    valve = done.loads[name]
    assert isinstance(valve, ReliefValve)
    sizes = {"kv": Size(float(valve.kv or 0.0), ""), "set pressure": Size(float(valve.set_pressure), "bar")}
    if kv is not None:
        sizes = {"set below highest": Size(found.size, "bar"), **sizes}
    sizes["band"] = Size(float(valve.band), "bar")
    return Sizing("relief", where, sizes, found, search.trials, wanted, done, tuple(notes))


def _at_node(scene: Scene, at: str) -> tuple[float, float, float]:
    """Steady gauge pressure of a node, density of the liquid there, and the least impedance of its lines."""
    lines = [line for line in scene.lines.values() if at in line.nodes]
    if not lines:
        known = sorted({node for line in scene.lines.values() for node in line.nodes})
        raise InputError("at", "no such node", nearest(at, known), f"'{at}'")
    description = describe(scene)
    steady = above_level(description).effort[at] - description.nodes[at].height.above_level
    density = getattr(lines[0].parameters, "density", None) or WATER
    return float(steady), float(density), min(float(line.parameters.z0 or 1.0) for line in lines)


def flywheel(
    scene: Scene | str | Path,
    pump: str,
    *,
    path: Sequence[str] = (),
    lowest: float | str | None = None,
    highest: float | str | None = None,
    tol: float | None = None,
    progress: bool = False,
) -> Sizing:
    """Find the smallest inertia of a pump that trips.

    Parameters
    ----------
    scene : Scene or path
        Scene in which the pump trips, and that starts in the steady state.
    pump : str
        Name of the pump; its inertia is the start of the search.
    path, lowest, highest, tol, progress
        As of `tline.design.vessel`.

    Returns
    -------
    Sizing
        The inertia, its margin, the curve of all sizes run, and the scene with that inertia.

    Raises
    ------
    InputError
        No inertia keeps the limits, or there is no such pump.

    Examples
    --------
    >>> import tline as tl
    >>> found = tl.design.flywheel(tl.examples["pump_trip"], "pump", lowest="1 bar", tol=1e-2)
    >>> round(found.sizes["inertia"].value, 1), round(found.sizes["flywheel"].value, 1)  # kg m²
    (8.1, 6.6)
    """
    given = as_scene(scene)
    wanted = limits(given, path, lowest, highest)
    pumps = {name: link for name, link in given.links.items() if isinstance(link, Pump)}
    if pump not in pumps:
        expected = nearest(pump, list(pumps)) if pumps else "a scene with a pump"
        raise InputError("pump", "no such pump", expected, f"'{pump}'")
    has = pumps[pump].inertia
    if has is None:
        raise InputError(place("links", pump), "does not trip", "trip, inertia and rated_speed, as by tline surge")
    where = place("links", pump, "inertia")
    runs = Runs(given, lambda size: {where: size}, wanted, tol, progress)
    found, search, notes = runs.smallest("kg m^2", float(has))
    sizes = {"inertia": Size(found.size, "kg m^2"), "flywheel": Size(max(found.size - float(has), 0.0), "kg m^2")}
    done = given.change({where: found.size})
    return Sizing("flywheel", place("links", pump), sizes, found, search.trials, wanted, done, tuple(notes))
