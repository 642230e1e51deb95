"""Numbers that vary from copy to copy, drawn from distributions that are given as text."""

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.quantity import LARGEST, SMALLEST, Whole
from tline.solver.description.given import MEDIA, Scene
from tline.solver.many.copies import MOST_COPIES, variable
from tline.units import to_si
from tline.wording import listed, nearest, shown

Floats = NDArray[np.float64]
CALL = re.compile(r"\s*(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)\s*")  # units may have parentheses of their own
DISTRIBUTIONS = ("uniform(low, high)", "normal(mean, deviation)")
LARGEST_SEED = 2**63 - 1


def draw(scene: Scene, wanted: Mapping[str, str], runs: int | str, seed: int | str = 0) -> dict[str, Floats]:
    """Draw numbers for `tline.solver.many.many`, independently of each other.

    Parameters
    ----------
    scene : Scene
        What the numbers belong to.
    wanted : mapping of str to str
        ``uniform(low, high)`` or ``normal(mean, deviation)`` by place in the scene, with units (plain numbers are SI).
    runs : int or str
        How many of each, 1 to 10,000,000.
    seed : int or str
        From 0; the same seed draws the same numbers.

    Returns
    -------
    dict of str to ndarray, shape (runs,)
        In SI.

    Raises
    ------
    InputError
        Of a place that may not vary, another distribution, a unit that does not fit, limits in the wrong order, or a
        number drawn that is not above zero.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "n"}},
    ...     lines={"a": {"nodes": ["n", "f"], "z0": 50, "delay": 1}},
    ... )
    >>> draw(scene, {"lines.a.z0": "uniform(45 ohm, 0.055 kohm)"}, 3)["lines.a.z0"].round(2).tolist()
    [51.37, 47.7, 45.41]
    """
    count, known = _whole("runs", runs, 1, MOST_COPIES), list(variable(scene))
    rng = np.random.default_rng(_whole("seed", seed, 0, LARGEST_SEED))
    found = {}
    for where, text in wanted.items():
        if where not in known:
            raise InputError(where, "no number of the scene that may vary", nearest(where, known))
        key = where.rpartition(".")[2]
        unit = "s" if key == "delay" else MEDIA[scene.medium].units["resistance" if key == "z0" else key]
        found[where] = _drawn(where, text, unit, rng, count)
    return found


def _drawn(where: str, text: str, unit: str, rng: np.random.Generator, count: int) -> Floats:
    call = CALL.fullmatch(text)
    given = call[2].split(",") if call else []
    if not call or call[1] not in ("uniform", "normal") or len(given) != 2:
        raise InputError(where, "not a distribution", listed([*DISTRIBUTIONS]), shown(text))
    first, second = (to_si(float(part) if _plain(part) else part, unit, where) for part in given)
    expected = f"numbers from {SMALLEST:g} to {LARGEST:g} {unit}"
    if call[1] == "uniform":
        if first > second:
            raise InputError(where, "the lower limit is above the upper one", DISTRIBUTIONS[0], shown(text))
        if first < SMALLEST or second > LARGEST:
            raise InputError(where, "limits out of range", expected, shown(text))
        return rng.uniform(first, second, count)
    if second < 0:
        raise InputError(where, "a negative deviation", DISTRIBUTIONS[1], shown(text))
    values = rng.normal(first, second, count)
    bad = values[~((values >= SMALLEST) & (values <= LARGEST))]
    if len(bad):
        problem = f"{shown(text)} drew {len(bad):,} of {count:,} numbers out of range"
        raise InputError(where, problem, expected, f"{bad[0]:g}")
    return values


def _plain(text: str) -> bool:
    """Whether a text is a number without a unit: that one is SI."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _whole(where: str, typed: int | str, least: int, most: int) -> int:
    try:
        return Whole(least, most).read(typed)
    except InputError as error:
        raise InputError(where, error.problem, error.expected, error.got) from None
