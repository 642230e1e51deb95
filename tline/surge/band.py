"""Effect of guesses on a verdict: the run again with each of them varied, and which one governs."""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.scene.pump import Pump
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.scene.valve import ADDED, Orifice
from tline.solver.description.excitation import varies
from tline.solver.result.result import Result
from tline.solver.tolerance.ladder import Budget
from tline.surge.columns import ROUGHLY
from tline.surge.worst import extremes

FASTER = 0.85, 1.15  # times the wave speed: walls and air are not known
ROUGHER = 0.9, 1.1  # times the coefficient of Hazen and Williams; of roughness their fifth power
HEAVIER = 0.5, 2.0  # times the inertia of rotors, as good as regressions over machines are

Tables = dict[str, Any]


class Varied(NamedTuple):
    """A run with one guess changed, Pa at all nodes."""

    guess: str  # such as "wave speed × 1.15"
    highest: float
    lowest: float


class Band(NamedTuple):
    """Effect of guesses: pressures of the run with all guesses as they are, and of runs with one of them changed."""

    base: Varied
    varied: tuple[Varied, ...]
    left: tuple[str, ...] = ()  # guesses for which there was no time

    def of(self, key: str) -> tuple[float, float, Varied]:
        """Return the spans below and above the base of `highest` or `lowest`, Pa, and the run that moves it most."""
        moves = [getattr(one, key) - getattr(self.base, key) for one in self.varied]
        governs = max(self.varied, key=lambda one: abs(getattr(one, key) - getattr(self.base, key)))
        return max(-min(moves), 0.0), max(*moves, 0.0), governs

    def to_dict(self) -> dict[str, Any]:
        """All runs as plain data in SI."""
        varied = [one._asdict() for one in self.varied]
        return {"base": self.base._asdict(), "varied": varied, "not_varied": list(self.left)}


def band_of(result: Result, run: Callable[[Scene], Result], budget: Budget, known: Collection[str] = ()) -> Band | None:
    """The band that guesses leave, by runs with rounded delays; None if there is nothing to vary.

    Quantities in `known` are no guesses: "wave speed", "friction", "travel", "inertia".
    """
    scene, chosen = result.scene, result.resolution
    changed = {guess: tables for kind, guess, tables in _variations(scene) if kind not in known}
    if not changed:
        return None
    if not chosen.rounded:
        chosen = run(scene.with_changes(solver=ROUGHLY)).resolution
    solver, before = {"solver": {"rounded": True, "slab": chosen.h}}, budget.left
    base, takes = _seen("", run(scene.with_changes(**solver))), before - budget.left
    found, left = list[Varied](), list[str]()
    for guess, tables in changed.items():
        if budget.left < takes:
            left.append(guess)
            continue
        try:
            found.append(_seen(guess, run(scene.with_changes(**tables, **solver))))
        except InputError:  # such as a steady state that would be below a vacuum: no guess
            continue
    return Band(base, tuple(found), tuple(left)) if found or left else None


def _seen(guess: str, result: Result) -> Varied:
    nodes = extremes(result)
    return Varied(guess, max(one.highest for one in nodes), min(one.lowest for one in nodes))


def _variations(scene: Scene) -> Iterator[tuple[str, str, Tables]]:
    """Kind, words and changed sections of each variation."""
    for times in FASTER:
        lines = _lines(scene, lambda line, times=times: {"wave_speed": times * Quantity(line["wave_speed"], "m/s")})
        if lines:
            yield "wave speed", f"wave speed × {times:g}", {"lines": lines}
    for times in ROUGHER:
        lines = _lines(scene, lambda line, times=times: _rougher(line, times))
        if lines:
            yield "friction", f"friction: coefficient × {times:g}", {"lines": lines}
    links: Tables = scene.table().get("links", {})
    for name, link in scene.links.items():
        if isinstance(link, Orifice) and isinstance(link.characteristic, str) and varies(link.opening):
            for other in ADDED:
                if other != link.characteristic:
                    table = links | {name: links[name] | {"characteristic": other}}
                    yield "travel", f"'{name}' as a {other} valve", {"links": table}
    rotors = [name for name, link in scene.links.items() if isinstance(link, Pump) and link.inertia is not None]
    for times in HEAVIER if rotors else ():
        heavier = {
            name: links[name] | {"inertia": times * Quantity(links[name]["inertia"], "kg m^2")} for name in rotors
        }
        yield "inertia", f"inertia of rotors × {times:g}", {"links": links | heavier}


def _lines(scene: Scene, change: Callable[[Tables], Mapping[str, Any]]) -> Tables:
    """All lines, with changes in those that have the changed keys; empty if no line has."""
    lines: Tables = scene.table()["lines"]
    found = {}
    for name, line in lines.items():
        try:
            found[name] = {key: float(x) if isinstance(x, float) else x for key, x in change(line).items()}
        except KeyError:
            continue
    return lines | {name: lines[name] | more for name, more in found.items()} if found else {}


def _rougher(line: Tables, times: float) -> Tables:
    friction = line["friction"]
    key, power = {"hazen-williams": ("coefficient", 1), "manning": ("coefficient", -1)}.get(
        friction["kind"], ("roughness", -5)
    )
    return {"friction": friction | {key: float(times**power * Quantity(friction[key], None))}}
