"""Any sufficient set of quantities determines the rest.

The quantities of a line are tied by monomial relations, prod(quantity**power) = 1. These are linear in the
powers, so Gauss-Jordan elimination over exact fractions finds each quantity that follows from the given ones
as a product of their powers, each redundant one, and the missing ones. A relation that is not
monomial (the elastic wall) takes part as a `Relation`, in turns with the elimination.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache, partial
from itertools import combinations, islice
from typing import NamedTuple

from tline.errors import InputError
from tline.units import half_digit

AGREE = 1e-6  # relative; redundant quantities may differ by rounding in tables
COARSEST = 0.01  # relative; largest difference explained by the digits typed
LISTED = 6  # suggestions shown when something is missing


@dataclass
class Given:
    """Quantities given of a line, and remarks on them."""

    values: dict[str, float]  # positive, SI
    sources: dict[str, tuple[str, ...]] = field(default_factory=dict)  # arguments that a quantity comes from
    typed: Mapping[str, object] = field(default_factory=dict)  # as typed by the user
    units: Mapping[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    def rounding(self, name: str) -> float:
        """Half a unit in the last digit typed of a quantity, relative to it; 0 if it is not a text."""
        text = self.typed.get(name)
        return half_digit(text) if isinstance(text, str) else 0.0

    def shown(self, name: str, value: float, digits: int = 6) -> str:
        """Format a value of that quantity, with its unit."""
        return f"{value:.{digits}g} {self.units.get(name, '')}".rstrip()

    def include(self, what: str, values: Mapping[str, float]) -> None:
        """Add the quantities of a named fluid or wall; values given explicitly have priority."""
        for name, value in values.items():
            there = self.values.setdefault(name, value)
            if abs(there / value - 1) <= AGREE:
                self.sources[name] = (what,)
            else:
                instead = f"instead of {self.shown(name, value)} of the {what}"
                self.remarks.append(f"{name}: {self.shown(name, there)} as given, {instead}")


class Relation(NamedTuple):
    """Relation that is not monomial: each of `names` follows from the others, by `solve`."""

    names: tuple[str, ...]
    solve: Callable[[str, Mapping[str, float]], float]
    formula: str  # of the first name, for messages
    impossible: str  # problem if the solution is not positive


@dataclass(frozen=True, eq=False)
class Relations:
    """Relations between the quantities of one kind of line."""

    relations: tuple[Mapping[str, int], ...]  # quantity or constant -> power; the product is 1
    constants: Mapping[str, float]
    law: Relation | None = None
    remedies: Mapping[str, str] = field(default_factory=dict)  # quantity -> remedy for a contradiction


class Product(NamedTuple):
    """Root of a product of integer powers, evaluated without logarithms: a few roundings in all."""

    powers: Mapping[str, int]
    root: int

    @classmethod
    def solved(cls, row: Mapping[str, Fraction], pivot: str) -> "Product":
        """Solve this relation for the quantity `pivot`, which has power 1 there."""
        root = math.lcm(*(power.denominator for power in row.values()))
        return cls({name: int(-power * root) for name, power in row.items() if name != pivot}, root)

    def of(self, known: Mapping[str, float]) -> float:
        """Value of the product; 0 or inf if it leaves the range of floats."""
        above = below = 1.0
        try:
            for name, power in self.powers.items():
                if power > 0:
                    above *= known[name] ** power
                else:
                    below *= known[name] ** -power
            return math.sqrt(above / below) if self.root == 2 else (above / below) ** (1 / self.root)
        except (OverflowError, ZeroDivisionError):
            return math.inf

    def text(self) -> str:
        """Formula as text: ``density*wave_speed/area``."""
        raised = {name: Fraction(power, self.root) for name, power in self.powers.items()}
        above = "*".join(_raised(name, power) for name, power in raised.items() if power > 0) or "1"
        below = "*".join(_raised(name, -power) for name, power in raised.items() if power < 0)
        return f"{above}/({below})" if "*" in below else f"{above}/{below}" if below else above


def _raised(name: str, power: Fraction) -> str:
    return name if power == 1 else f"{name}^{power}" if power.denominator == 1 else f"{name}^({power})"


def solve(system: Relations, given: Given) -> dict[str, float]:
    """Compute every quantity that follows from the given ones, including these."""
    solution = _Solution(system, given)
    values, law = solution.values, system.law
    while True:
        known = {**system.constants, **values}
        for name, product, parts in _following(system, tuple(values)):
            solution.take(name, product.of(known), parts, product.text)
        unknown = [name for name in law.names if name not in values] if law else []
        if law is None or len(unknown) > 1:
            return values
        name = (unknown or law.names)[0]
        value, parts = _by_law(law, name, values), {*law.names} - {name}
        if value <= 0:
            raise InputError("", f"{listed(solution.givens(parts))} clash: {law.impossible}")
        solution.take(name, value, parts, partial(str, law.formula))
        if not unknown:
            return values


def determine(
    system: Relations, given: Given, targets: tuple[tuple[str, ...], ...], offered: Iterable[str]
) -> dict[str, float]:
    """Solve as `solve`, with the condition that of each tuple in `targets` at least one quantity follows.

    If not, the InputError names the shortest sets out of `offered` that would do, up to two quantities more.
    """
    values = solve(system, given)
    left_open = [listed(target, "or") for target in targets if values.keys().isdisjoint(target)]
    if not left_open:
        return values
    rest = [name for name in offered if name not in values]
    for size in (1, 2):
        sets = combinations(rest, size)
        enough = [*islice((more for more in sets if _reaches(system, {*values, *more}, targets)), LISTED + 1)]
        if enough:
            shown = listed([" with ".join(more) for more in enough[:LISTED]], "or")
            shown = f"for example {shown}" if len(enough) > LISTED else shown
            break
    else:
        shown = "more than two other quantities"
    raise InputError("", f"{listed(left_open)} cannot be found, add {shown}")


def listed(names: Iterable[str], conjunction: str = "and") -> str:
    """Join names in a sentence: ``a, b and c``."""
    *first, last = names
    return f"{', '.join(first)} {conjunction} {last}" if first else last


@lru_cache(1024)
def _reduced(system: Relations, known: tuple[str, ...]) -> dict[str, Product]:
    """Solve the relations for one quantity each.

    The reduced row echelon form, unknown quantities first, then the known ones, the earliest of them last. A
    row solved for an unknown with only known ones otherwise determines it; a row solved for a known
    quantity means that it also follows from earlier ones.
    """
    rank = {name: position for position, name in enumerate(known)}
    rows: dict[str, dict[str, Fraction]] = {}
    for relation in system.relations:
        row = {name: Fraction(power) for name, power in relation.items()}
        for pivot in [name for name in row if name in rows]:
            _subtract(row, row[pivot], rows[pivot])
        columns = [name for name in row if name not in system.constants]
        if not columns:
            continue
        pivot = max(columns, key=lambda name: (rank.get(name, len(rank)), name))
        scale = row[pivot]
        row = {name: power / scale for name, power in row.items()}
        for other in rows.values():
            if pivot in other:
                _subtract(other, other[pivot], row)
        rows[pivot] = row
    return {pivot: Product.solved(row, pivot) for pivot, row in rows.items()}


@lru_cache(1024)
def _following(system: Relations, known: tuple[str, ...]) -> list[tuple[str, Product, Set[str]]]:
    """Quantities that follow from the known ones alone, with their products and the known ones used."""
    there = {*system.constants, *known}
    products = _reduced(system, known).items()
    return [(name, each, each.powers.keys() & {*known}) for name, each in products if each.powers.keys() <= there]


def _subtract(row: dict[str, Fraction], factor: Fraction, other: Mapping[str, Fraction]) -> None:
    for name, power in other.items():
        row[name] = row.get(name, Fraction(0)) - factor * power
        if not row[name]:
            del row[name]


def _reaches(system: Relations, names: set[str], targets: Iterable[tuple[str, ...]]) -> bool:
    """Whether these quantities would determine one of each target, for any values."""
    while True:
        for name, product in _reduced(system, tuple(sorted(names))).items():
            if product.powers.keys() <= names | system.constants.keys():
                names.add(name)
        unknown = [name for name in system.law.names if name not in names] if system.law else []
        if len(unknown) != 1:
            return not any(names.isdisjoint(target) for target in targets)
        names.add(unknown[0])


def _by_law(law: Relation, name: str, values: Mapping[str, float]) -> float:
    try:
        return law.solve(name, values)
    except ZeroDivisionError:
        return 0.0


class _Solution:
    """Values known at this point and the given quantities that each depends on."""

    def __init__(self, system: Relations, given: Given):
        self.system, self.given, self.values = system, given, dict(given.values)
        self.parts: dict[str, Set[str]] = {}  # for each derived value, those that it followed from

    def givens(self, parts: Set[str]) -> tuple[str, ...]:
        """Arguments that these depend on, in the order given."""
        named = {source for part in parts for source in self._sources(part)}
        order = dict.fromkeys(source for name in self.given.values for source in self._sources(name))
        return tuple(name for name in order if name in named)

    def _sources(self, name: str) -> tuple[str, ...]:
        """Arguments that a value depends on."""
        if name in self.parts:
            return self.givens(self.parts[name])
        return self.given.sources.get(name, (name,))

    def take(self, name: str, value: float, parts: Set[str], formula: Callable[[], str]) -> None:
        """Add a value computed from `parts`, or compare it with the one that is there."""
        if not 0 < value < math.inf:
            problem = f"{name} follows from {listed(self.givens(parts))} and leaves the range of numbers"
            raise InputError("", problem, got=f"{value:g}")
        if name not in self.values:
            self.values[name], self.parts[name] = value, parts
            return
        there = self.values[name]
        apart = abs(value / there - 1)
        if apart <= AGREE:
            return
        names, digits = self.givens({name, *parts}), 4 if apart > 1e-3 else 9
        two = f"{formula()} gives {self.given.shown(name, value, digits)}"
        two += f" but {name} is {self.given.shown(name, there, digits)}, {100 * apart:.3g} % apart"
        if apart <= min(max(map(self.given.rounding, names)), COARSEST):
            remark = f"{listed(names)} agree to the digits typed: {two}"
            self.given.remarks += [remark] * (remark not in self.given.remarks)
            return
        remedies = [self.system.remedies[part] for part in (name, *parts) if part in self.system.remedies]
        raise InputError("", "; ".join([f"{listed(names)} clash: {two}", *remedies[:1]]))
