"""What pipes and cables have in common: quantities by name, read from what a user gives, and immutable once settled."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple, TypeVar

from tline.errors import InputError
from tline.line.given import Given
from tline.line.relations import listed
from tline.units import to_si

Entry = TypeVar("Entry")


class LineQuantity(NamedTuple):
    """One quantity of a line, as its constructor, the command line and the printed table know it."""

    name: str
    symbol: str
    unit: str
    handy: str  # the unit people print it in, "" for none
    help: str


class LineParameters:
    """Base of the lines: immutable, equal by value, printed as it was given."""

    remarks: tuple[str, ...]  # sentences on what is odd in what was given
    _given: dict[str, object]

    def _settle(
        self,
        quantities: Iterable[LineQuantity],
        values: Mapping[str, float],
        arguments: Mapping[str, object],
        remarks: Iterable[str],
    ) -> None:
        """Set the attributes, once; a quantity that did not follow is None."""
        self.__dict__.update((quantity.name, values.get(quantity.name)) for quantity in quantities)
        given = {name: value for name, value in arguments.items() if value is not None}
        self.__dict__.update(_given=given, remarks=tuple(remarks))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable, {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable, {name} cannot be deleted")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LineParameters):
            return NotImplemented
        return type(self) is type(other) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash((type(self), *self._values()))

    def _values(self) -> list[float | None]:
        """Of all quantities, in their order."""
        return [value for name, value in vars(self).items() if name not in ("_given", "remarks")]

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={value!r}" for name, value in self._given.items())
        return f"{type(self).__name__}({given})"


def read(quantities: Iterable[LineQuantity], arguments: Mapping[str, float | str | None]) -> Given:
    """The quantities given among `arguments` (None is not given), each positive and finite."""
    values, typed, units = {}, {}, {}
    for name, _, unit, _, _ in quantities:
        given, units[name] = arguments[name], unit
        if given is not None:
            values[name], typed[name] = to_si(given, unit, name), given
            if values[name] <= 0:
                raise InputError(name, "not positive", "more than 0", repr(given))
    return Given(values, typed=typed, units=units)


def choose(table: Mapping[str, Entry], name: object, where: str) -> Entry:
    """The entry of that name; the error lists the names there are."""
    key = name.strip().lower() if isinstance(name, str) else ""
    if key in table:
        return table[key]
    from difflib import get_close_matches

    near = get_close_matches(key, table, n=1)
    known = listed([repr(entry) for entry in table], "or")
    meant = f"{near[0]!r} (known are {known})" if near else known
    raise InputError(where, f"unknown {where}", meant, repr(name))
