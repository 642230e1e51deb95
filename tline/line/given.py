"""What a user gives of a line."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tline.units import half_digit

AGREE = 1e-6  # relative; quantities given twice over may differ by the digits that tables drop


@dataclass
class Given:
    """What is given of a line, and what is to be said of it."""

    values: dict[str, float]  # positive, SI
    sources: dict[str, tuple[str, ...]] = field(default_factory=dict)  # other names by which the user knows a quantity
    typed: Mapping[str, object] = field(default_factory=dict)  # as the user gave them
    units: Mapping[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    def rounding(self, name: str) -> float:
        """Half a unit in the last digit typed of a quantity, relative to it; 0 where it is no text."""
        text = self.typed.get(name)
        return half_digit(text) if isinstance(text, str) else 0.0

    def shown(self, name: str, value: float, digits: int = 6) -> str:
        """A value of that quantity, with its unit."""
        return f"{value:.{digits}g} {self.units.get(name, '')}".rstrip()

    def include(self, what: str, values: Mapping[str, float]) -> None:
        """Add the quantities that a named fluid or wall stands for; one that is given as well counts instead."""
        for name, value in values.items():
            there = self.values.setdefault(name, value)
            if abs(there / value - 1) <= AGREE:
                self.sources[name] = (what,)
            else:
                instead = f"instead of {self.shown(name, value)} of the {what}"
                self.remarks.append(f"{name}: {self.shown(name, there)} as given, {instead}")
