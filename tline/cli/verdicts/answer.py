"""What is printed, returned as JSON and drawn of a verdict, whatever it is about."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tline.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NO_VIOLATION = "no violation seen"
EXIT = {"proved": 0, "refuted": 1, "undecided": 3, NO_VIOLATION: 3}


@dataclass(frozen=True)
class Asked:
    """The options of the command, as they were typed; None or empty where they were not."""

    kind: str | None
    parameters: tuple[str, ...]
    z0: str | None
    delay: str | None
    within: str | None
    error: str | None
    nearest: str | None
    certificate: str | None = None
    confined: bool = False

    def refuse(self, about: str, *options: str) -> None:
        """Raise InputError for the first of these options that was given."""
        for option in options:
            if getattr(self, option) not in (None, (), False):
                name = {"parameters": "param"}.get(option, option)
                raise InputError(f"--{name}", f"says nothing about {about}", "another option, or none")


@dataclass(frozen=True)
class Answer:
    """The answer to one question."""

    status: str
    lines: list[str]
    told: dict[str, Any]
    draw: "Callable[[], Figure] | None" = None

    @property
    def exit_code(self) -> int:
        """0 proved, 1 refuted, 3 undecided."""
        return EXIT[self.status]


def values(given: tuple[str, ...]) -> dict[str, str]:
    """Names and their values out of NAME=VALUE."""
    found: dict[str, str] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError("--param", "not a name with a value", "NAME=VALUE such as R='50 ohm'", f"'{text:.60}'")
        if name in found:
            raise InputError(f"--param {name}", "given twice", "one value", f"'{found[name]:.30}' and '{value:.30}'")
        found[name] = value
    return found
