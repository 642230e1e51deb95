"""Decks, IBIS and Touchstone files with words and lines torn out, doubled and moved.

Each is changed in one to five places and read, decks and models of IBIS as far as what the solver has to know of their
scene, one Touchstone file in twenty to its nearest passive model. It is read, or refused in a sentence, within some
seconds of the processor; anything else is a fault of the program.
"""

import signal
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from random import Random

from passivity import check_samples, fit_scattering, read_touchstone
from tline import InputError, Scene
from tline.interchange.spice import read_spice
from tline.solver.description.description import describe

FOLDER = Path(__file__).parent / "decks"
SCENES = FOLDER.parents[1] / "scenes"
DECKS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.cir"))}
DIALECTS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("dialects/*.cir"))}
IBIS = {"memory.ibs": (SCENES / "memory.ibs").read_text(encoding="utf-8")}
TOUCHSTONE = {
    name: "\n".join((SCENES / name).read_text(encoding="utf-8").splitlines()[::step])
    for name, step in (("antenna.s1p", 4), ("filter.s2p", 3))
}
DRIVEN = {
    "medium": "electrical",
    "t_end": "20 ns",
    "probes": {"far": {"at": "b"}},
    "lines": {"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    "loads": {"driver": {"at": "a", "kind": "ibis", "bits": "0110", "bit": "4 ns"}},
}
FITTED = 20  # of so many Touchstone files one is fitted
SECONDS = 10
EXTREME = (
    "0", "-1", "1e300", "1e-300", "1e999", "-1e308", "nan", "inf", "1meg", "{", "}", "(", ")", "=", "'", "{1/0}", "{a}",
    "{2**9999}", "*", "+", ";", "$", "W", "X1", ".subckt", ".ends", ".model", ".include ../x", "\0", "é", "9" * 400,
)  # fmt: skip


def mutated(seed: int, files: Mapping[str, str] = DECKS) -> tuple[str, str]:
    """A file's name, and its text with changes that follow from a seed: of a dialect where it is negative."""
    chance, files = Random(seed), files if seed >= 0 else DIALECTS
    name = chance.choice(list(files))
    lines = files[name].splitlines()
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
    """A file that takes too long."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Interrupt what takes longer."""

    def late(*_: object) -> None:
        raise LateError(f"not done within {seconds:g} s")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def read_deck(file: Path) -> None:
    described = describe(read_spice(file)[0])
    _ = described.nodes, described.elements, described.branches


def read_ibis(file: Path) -> None:
    """Its first model, as a driver before a line."""
    buffers = [line.split()[1] for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("[Model] ")]
    load = DRIVEN["loads"]["driver"] | {"file": str(file), "model": buffers[0] if buffers else "DQ"}
    described = describe(Scene(**DRIVEN | {"loads": {"driver": load}}))
    _ = described.nodes, described.elements, described.branches


def read_samples(file: Path) -> None:
    response = read_touchstone(file)
    check_samples(response)
    if file.stat().st_size % FITTED == 0:
        fit_scattering(response, 1e-2, nearest=True)


READERS = {".ibs": read_ibis, ".s1p": read_samples, ".s2p": read_samples}


def outcome(text: str, folder: Path, name: str = "deck.cir") -> str:
    """Whether a file is read or refused; or where the program has a fault, as "fault: …"."""
    file = folder / name
    file.write_text(text, encoding="utf-8")
    try:
        with limited(SECONDS):
            READERS.get(file.suffix, read_deck)(file)
    except InputError as error:
        return "refused" if str(error).strip() else "fault: nothing said"
    except Exception as error:  # noqa: BLE001 - whatever it is, it is counted
        at = traceback.extract_tb(error.__traceback__)[-1]
        return f"fault: {type(error).__name__} in line {at.lineno} of {Path(at.filename).name}: {error!s:.100}"
    return "read"
