"""Size of an air vessel: the least gas that keeps a lowest and a highest pressure, its precharge and its shell."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tline.design.limits import limits
from tline.design.sizing import Runs, Size, Sizing
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.scene import Scene
from tline.scene.vessel import AirVessel
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import above_level
from tline.units import to_si
from tline.words.wording import nearest, place

RESERVE = 0.1  # of the shell: liquid left in it when the gas is largest
SWING = 10.0  # times the compliance of the lines that of the first gas


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

    Searched is the volume of the gas in the steady state. The shell holds the gas when the pressure at the node is
    lowest, and a reserve of liquid; the precharge is the pressure of gas that fills the empty shell at the temperature
    that it has in the steady state.

    Parameters
    ----------
    scene : Scene or path
        Of a surge; it starts in the steady state. An air vessel that is at the node is sized anew.
    at : str
        A node.
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
        Of the vessel, as in a scene: ``kv``, ``exponent``, ``atmosphere``.

    Returns
    -------
    Sizing
        Gas, shell and precharge, the margin, the curve of all sizes that were run, and the scene with the vessel.

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
