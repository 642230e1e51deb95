"""Inertia of a pump whose motor fails: the least that keeps a lowest and a highest pressure."""

from collections.abc import Sequence
from pathlib import Path

from tline.design.limits import limits
from tline.design.sizing import Runs, Size, Sizing
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.scene.pump import Pump
from tline.scene.scene import Scene
from tline.words.wording import nearest, place


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
        In which the pump trips; it starts in the steady state.
    pump : str
        Name of the pump; its inertia is where the search begins.
    path, lowest, highest, tol, progress
        As of `tline.design.vessel`.

    Returns
    -------
    Sizing
        The inertia, its margin, the curve of all that were run, and the scene with it.

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
