"""Decks with words and lines torn out, doubled and moved.

Each of tests/decks is changed in one to five places, imported, and what the solver has to know of the scene is
found, in this process. A deck is read, or refused in a sentence, within some seconds; anything else is a fault of the
program.
"""

import signal
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

from tline.errors import InputError
from tline.interchange.spice import read_spice
from tline.solver.description.description import describe

FOLDER = Path(__file__).parent / "decks"
DECKS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.cir"))}
DIALECTS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("dialects/*.cir"))}
SECONDS = 5
EXTREME = (
    "0", "-1", "1e300", "1e-300", "1e999", "-1e308", "nan", "inf", "1meg", "{", "}", "(", ")", "=", "'", "{1/0}", "{a}",
    "{2**9999}", "*", "+", ";", "$", "W", "X1", ".subckt", ".ends", ".model", ".include ../x", "\0", "é", "9" * 400,
)  # fmt: skip


def mutated(seed: int) -> tuple[str, str]:
    """A deck's name, and its text with changes that follow from a seed: of a dialect where it is negative."""
    chance, decks = Random(seed), DECKS if seed >= 0 else DIALECTS
    name = chance.choice(list(decks))
    lines = decks[name].splitlines()
    for _ in range(chance.randint(1, 5)):
        _change(lines, chance)
    return name, "\n".join(lines) + "\n"


def _change(lines: list[str], chance: Random) -> None:
    """Change lines, or words of one."""
    if not lines:
        lines.append(chance.choice(EXTREME))
    k, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    if chance.random() < 0.3:
        cut = lines[k][: chance.randrange(len(lines[k]) + 1)] + lines[j][chance.randrange(len(lines[j]) + 1) :]
        _move(lines, k, j, chance.randrange(4), cut)
        return
    words = lines[k].split() or [""]
    a, b, what = chance.randrange(len(words)), chance.randrange(len(words)), chance.randrange(5)
    new = chance.choice(EXTREME)
    _move(words, a, b, what, new if what == 3 else words[a].partition("=")[0] + "=" * ("=" in words[a]) + new)
    lines[k] = " ".join(words)


def _move(parts: list[str], one: int, other: int, what: int, new: str) -> None:
    """Leave out a part, swap it with another, double it, or put a new one in its place."""
    if what == 0:
        del parts[one]
    elif what == 1:
        parts[one], parts[other] = parts[other], parts[one]
    elif what == 2:
        parts.insert(other, parts[one])
    else:
        parts[one] = new


class LateError(Exception):
    """A deck that takes too long."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Interrupt what takes longer."""

    def late(*_: object) -> None:
        raise LateError(f"not done within {seconds:g} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def outcome(text: str, folder: Path) -> str:
    """Whether a deck is read or refused; or where the program has a fault, as "fault: …"."""
    file = folder / "deck.cir"
    file.write_text(text, encoding="utf-8")
    try:
        with limited(SECONDS):
            scene, _ = read_spice(file)
            described = describe(scene)
            _ = described.nodes, described.elements, described.branches
    except InputError as error:
        return "refused" if str(error).strip() else "fault: nothing said"
    except Exception as error:  # noqa: BLE001 - whatever it is, it is counted
        at = traceback.extract_tb(error.__traceback__)[-1]
        return f"fault: {type(error).__name__} in line {at.lineno} of {Path(at.filename).name}: {error!s:.100}"
    return "read"
