"""Where a run exceeds what a liquid or a wall can bear: sentences for its notes."""

from collections.abc import Mapping
from math import inf

from tline.solver.description.description import Description
from tline.units import engineering

VACUUM = -101_325.0  # Pa, gauge


def beyond_limits(description: Description, extremes: Mapping[str, tuple[float, float]]) -> list[str]:
    """Whether pressures fall below those that a liquid can have, or an effort exceeds the scene's rating.

    Extremes are the lowest and highest effort by place; a gauge pressure, Pa; else V.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.description.description import describe
    >>> scene = Scene(
    ...     medium="hydraulic", t_end=1, probes={"valve": {"at": "b"}}, rating="16 bar",
    ...     lines={"pipe": {"nodes": ["a", "b"], "z0": 1e8, "delay": 1}},
    ... )
    >>> for note in beyond_limits(describe(scene), {"probes.valve": (-2e5, 2e6)}):
    ...     print(note)
    probes.valve: the pressure falls to -2 bar; a liquid cavitates below -1.013 bar gauge (0 absolute): not modelled
    probes.valve: the pressure rises to 20 bar, above the rating of 16 bar
    """
    medium = description.medium
    unit, found = medium.shown["effort"], []
    deep = {where: low for where, (low, _) in extremes.items() if low < VACUUM}
    if medium.hydraulic and deep:
        modelled = (
            "modelled at cavities only, and a jump within a slab shoots past it"
            if description.collapses
            else "not modelled"
        )
        limit = f"a liquid cavitates below {engineering(VACUUM, unit)} gauge (0 absolute): {modelled}"
        falls = f"the pressure falls to {engineering(min(deep.values()), unit)}"
        found.append(f"{first_of(worst_first(deep, -1))}: {falls}; {limit}")
    rating = float(description.scene.rating or inf)
    sizes = {where: high if medium.hydraulic else max(high, -low) for where, (low, high) in extremes.items()}
    high = {where: size for where, size in sizes.items() if size > rating}
    if high:
        rises = f"the {medium.effort} rises to {engineering(max(high.values()), unit)}"
        above = f"above the rating of {engineering(rating, unit)}"
        found.append(f"{first_of(worst_first(high, 1))}: {rises}, {above}")
    return found


def worst_first(sizes: Mapping[str, float], sign: int) -> list[str]:
    """Places by falling size (sign 1) or rising (sign -1); those that only rounding tells apart as they are given."""
    return sorted(sizes, key=lambda where: -sign * float(f"{sizes[where]:.9g}"))


def first_of(places: list[str]) -> str:
    """The first, and how many more there are."""
    return places[0] + f" and {len(places) - 1} more" * (len(places) > 1)
