"""A relief valve at a node: the least capacity at a set pressure, or the highest set pressure of a capacity."""

from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import Any

from tline.design.limits import limits
from tline.design.sizing import Runs, Size, Sizing
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.rating import BAR, HOUR, WATER
from tline.scene.scene import Scene
from tline.scene.valve import ReliefValve
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import above_level
from tline.units import to_si
from tline.words.wording import nearest, place

USUAL_SET = 0.9  # of the highest pressure; it is wide open there


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
        Of a surge; it starts in the steady state.
    at : str
        A node.
    highest : float or str
        Largest gauge pressure, Pa, or a text with a unit.
    path, tol, progress
        As of `tline.design.vessel`.
    set_pressure : float or str, optional
        At which the valve begins to open, Pa; 0.9 of the highest pressure if neither it nor a capacity is given.
    band : float or str, optional
        Further pressure over which it opens, Pa; what is left to the highest pressure if not given, or a tenth of that
        pressure where a capacity is.
    kv : float or str, optional
        Capacity, m³/h of water at 1 bar: then the set pressure is searched.

    Returns
    -------
    Sizing
        Capacity and set pressure, the margin, the curve of all sizes that were run, and the scene with the valve.

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
