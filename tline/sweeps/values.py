"""What a number of a scene shall be in the runs of a sweep: values, a range, or a distribution."""

import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import changed, parts_of
from tline.scene.quantity import Quantity, Whole
from tline.solver.description.given import Scene
from tline.units import DEGREES, to_si
from tline.words.wording import shown

Floats = NDArray[np.float64]
CALL = re.compile(r"\s*(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)\s*")  # units may have parentheses of their own
DISTRIBUTIONS = {
    "uniform": "uniform(low, high)",
    "loguniform": "loguniform(low, high)",
    "normal": "normal(mean, deviation)",
}
EXPECTED = f"values, FROM:TO:COUNT, FROM:TO:COUNT:log, or {', '.join(DISTRIBUTIONS.values())}"
MOST_VALUES = 1_000_000  # of one path


class Distribution(NamedTuple):
    """What numbers are drawn from: its quantiles by shares from 0 to 1, both of shape (runs,), and how it was given."""

    quantiles: Callable[[Floats], Floats]
    text: str


def values_or_distribution(scene: Scene, path: str, given: Any) -> list[Any] | Distribution:
    """Values that a path of a scene takes, in SI where they are numbers, or what they are drawn from.

    Parameters
    ----------
    scene : Scene
    path : str
        Dotted, as in a scene file.
    given : sequence, text, or object with a method ``ppf``
        Values, each a number in SI, a text with its unit, or whatever a scene file may hold there; a text of values
        with commas between, of a range ``"40 ohm:60 ohm:5"`` (five values, both ends included; ``:log`` after it for
        equal ratios), or of a distribution; or a frozen distribution of `scipy.stats`.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "n"}},
    ...     lines={"a": {"nodes": ["n", "f"], "z0": 50, "delay": 1}},
    ... )
    >>> values_or_distribution(scene, "lines.a.z0", "40 ohm:0.06 kohm:3")
    [40.0, 50.0, 60.0]
    >>> values_or_distribution(scene, "lines.a.z0", "normal(50 ohm, 2 ohm)").quantiles(np.array([0.5])).tolist()
    [50.0]
    """
    if isinstance(given, str):
        if call := CALL.fullmatch(given):
            return _distribution(scene, path, call[1], [part.strip() for part in call[2].split(",")])
        if given.count(":") > 1:
            return _range(scene, path, given)
        given = [_number(part.strip()) for part in given.split(",")]
    if hasattr(given, "ppf"):
        return Distribution(given.ppf, repr(given))
    if not isinstance(given, Sequence | np.ndarray) or (isinstance(given, np.ndarray) and given.ndim != 1):
        raise InputError(path, "not a sequence of values", EXPECTED, shown(given))
    if not 1 <= len(given) <= MOST_VALUES:
        raise InputError(path, "no values, or too many", f"1 to {MOST_VALUES:,}", f"{len(given):,}")
    if isinstance(given, np.ndarray) and given.dtype.kind == "f":
        return given.tolist()
    return [_in_si(scene, path, value) for value in given]


def unit_of(scene: Scene, path: str) -> str:
    """SI unit of what a scene has at a path; empty if that is no quantity, or nothing is given there."""
    leaf = _leaf(scene, path)
    return (leaf.unit or "") if isinstance(leaf, Quantity) else ""


def _range(scene: Scene, path: str, text: str) -> list[Any]:
    first, last, count, *log = (part.strip() for part in text.split(":"))
    if log not in ([], ["log"]):
        raise InputError(path, "not a range", "FROM:TO:COUNT or FROM:TO:COUNT:log", shown(text))
    try:
        number = Whole(2, MOST_VALUES).read(count)
    except InputError as error:
        raise InputError(path, f"the count of {shown(text)}: {error.problem}", error.expected, error.got) from None
    a, b = _limits(scene, path, [first, last])
    if log and a * b <= 0:
        raise InputError(path, "equal ratios through zero", "limits above zero", shown(text))
    return (np.geomspace if log else np.linspace)(a, b, number).tolist()


def _distribution(scene: Scene, path: str, kind: str, given: list[str]) -> Distribution:
    text = f"{kind}({', '.join(given)})"
    if kind not in DISTRIBUTIONS or len(given) != 2:
        raise InputError(path, "not a distribution", f"one of {', '.join(DISTRIBUTIONS.values())}", shown(text))
    if kind == "normal" and any(given[1].endswith(unit) for unit in DEGREES):
        raise InputError(path, "a deviation is no temperature", "K in place of degC", shown(given[1]))
    a, b = _limits(scene, path, given)
    if kind == "normal":
        if b < 0:
            raise InputError(path, "a negative deviation", DISTRIBUTIONS[kind], shown(text))
        return Distribution(_Normal(a, b), text)
    if a > b:
        raise InputError(path, "the lower limit is above the upper one", DISTRIBUTIONS[kind], shown(text))
    if kind == "loguniform" and a <= 0:
        raise InputError(path, "equal ratios through zero", "limits above zero", shown(text))
    return Distribution(_LogUniform(a, b) if kind == "loguniform" else _Uniform(a, b), text)


class _Uniform(NamedTuple):
    low: float
    high: float

    def __call__(self, share: Floats) -> Floats:
        return self.low + (self.high - self.low) * share


class _LogUniform(NamedTuple):
    low: float
    high: float

    def __call__(self, share: Floats) -> Floats:
        return self.low * (self.high / self.low) ** share


class _Normal(NamedTuple):
    mean: float
    deviation: float

    def __call__(self, share: Floats) -> Floats:
        from scipy.special import ndtri

        return self.mean + self.deviation * ndtri(share)


def _limits(scene: Scene, path: str, given: list[str]) -> list[float]:
    """Numbers in SI; those with a unit have that of the path."""
    typed = [_number(part) for part in given]
    texts = [part for part in typed if isinstance(part, str)]
    unit = ""
    if texts:
        leaf = _leaf(scene, path) or _leaf(changed(scene, {path: texts[0]}), path)
        unit = leaf.unit if isinstance(leaf, Quantity) else ""
    return [to_si(part, unit, path) for part in typed]


def _number(text: str) -> float | str:
    """The number that a text is, or the text: one without a unit is SI."""
    try:
        return float(text)
    except ValueError:
        return text


def _in_si(scene: Scene, path: str, value: Any) -> Any:
    """A value as a plain number, where it is one at that path."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str):
        try:
            leaf = _leaf(changed(scene, {path: value}), path)
        except InputError:
            return value  # does not fit, at least not alone: the run tells
        return float(leaf) if isinstance(leaf, Quantity) else value
    return value


def _leaf(scene: Scene, path: str) -> Any:
    """What a scene has at a path, None if nothing is given there."""
    found: Any = scene
    for key in parts_of(path):
        found = found.get(key) if isinstance(found, dict) else getattr(found, key, getattr(found, f"{key}_", None))
    return found
