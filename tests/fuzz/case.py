"""One input: what is typed, and the files that lie there."""

from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"


@dataclass(frozen=True)
class Case:
    """A command with the files it may read, and those it is asked to write.

    Parameters
    ----------
    args : list of str
        What follows `tline`.
    files : dict of str to bytes
        Content by name, in the folder where the command runs.
    asked : frozenset of str
        Names of files that the command may write there.
    """

    args: list[str]
    files: dict[str, bytes] = field(default_factory=dict)
    asked: frozenset[str] = frozenset()


def shipped(*names: str) -> dict[str, str]:
    """Text of example files by name."""
    return {name: (SCENES / name).read_text(encoding="utf-8") for name in names}
