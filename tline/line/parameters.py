"""Base of pipes and cables: quantities by name, read from a user's input, and immutable once determined."""

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any, ClassVar, NamedTuple, TypeVar

from tline.errors import InputError
from tline.line.relations import Given, listed
from tline.presentation import Presentation
from tline.units import engineering, to_si

Entry = TypeVar("Entry")


class LineQuantity(NamedTuple):
    """Quantity of a line, as in its constructor, the command line and the printed table."""

    name: str
    symbol: str
    unit: str
    handy: str  # the usual unit for display, "" for none
    help: str


class LineParameters(Presentation):
    """Base of the lines: immutable, equal by value, printed as a table; its repr shows the arguments."""

    quantities: ClassVar[tuple[LineQuantity, ...]]
    shown: ClassVar[tuple[str, ...]]  # names of quantities, in the repr
    remarks: tuple[str, ...]  # remarks on implausible arguments
    _given: dict[str, object]

    def _settle(
        self,
        values: Mapping[str, float],
        arguments: Mapping[str, object],
        remarks: Iterable[str],
    ) -> None:
        """Set the attributes, once, to None for a quantity that did not follow."""
        self.__dict__.update((quantity.name, values.get(quantity.name)) for quantity in self.quantities)
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
        """Values of all quantities, in their order."""
        return [value for name, value in vars(self).items() if name not in ("_given", "remarks")]

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={value!r}" for name, value in self._given.items())
        told = [item for item in self.quantities if item.name in self.shown and item.name not in self._given]
        known = [(item, getattr(self, item.name)) for item in told if getattr(self, item.name) is not None]
        follows = ", ".join(f"{item.symbol} = {engineering(value, item.handy or item.unit)}" for item, value in known)
        return f"{type(self).__name__}({given})  # {follows}"

    def text_lines(self) -> Iterator[str]:
        """Format all known quantities: name, symbol, value in SI, and in a handy unit."""
        rows = [("quantity", "symbol", "SI", "handy")]
        for item in self.quantities:
            value = getattr(self, item.name)
            if value is not None:
                exact = f"{value:.6g} {item.unit}".rstrip()
                handy = engineering(value, item.handy) if item.handy else ""
                rows.append((item.name, item.symbol, exact, "" if handy == exact else handy))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        for row in rows:
            yield "  ".join(map(str.ljust, row, widths)).rstrip()

    def to_dict(self) -> dict[str, Any]:
        """All quantities in SI, None where one does not follow, and ``notes`` on implausible ones."""
        return {item.name: getattr(self, item.name) for item in self.quantities} | {"notes": list(self.remarks)}

    def passivity_model(self, kind: str) -> object:
        """Verdict on both ends for `passivity.is_positive_real`, transfer of a wave for `is_bounded_real`."""
        from passivity import check_line_two_port

        z0, delay = (vars(self).get(name) for name in ("z0", "delay"))
        if z0 is None or delay is None:
            raise InputError("line", "no delay follows from what was given", "a length")
        if kind == "positive real":
            return check_line_two_port(z0, delay)
        return f"exp(-{Fraction(delay)}*s)"


def read(quantities: Iterable[LineQuantity], arguments: Mapping[str, float | str | None]) -> Given:
    """Read the quantities given among `arguments` (None is not given), each positive and finite."""
    values, typed, units = {}, {}, {}
    for name, _, unit, _, _ in quantities:
        given, units[name] = arguments[name], unit
        if given is not None:
            values[name], typed[name] = to_si(given, unit, name), given
            if values[name] <= 0:
                raise InputError(name, "not positive", "more than 0", repr(given))
    return Given(values, typed=typed, units=units)


def choose(table: Mapping[str, Entry], name: object, where: str) -> Entry:
    """Look up an entry by name; the error lists the known names."""
    key = name.strip().lower() if isinstance(name, str) else ""
    if key in table:
        return table[key]
    from difflib import get_close_matches

    near = get_close_matches(key, table, n=1)
    known = listed([repr(entry) for entry in table], "or")
    meant = f"{near[0]!r} (known are {known})" if near else known
    raise InputError(where, f"unknown {where}", meant, repr(name))
