"""EPANET in a process of its own, within limits of time and memory, on the lines of a file that bear on a steady flow.

Its folder is new and empty, and no line that could name another file is among these.
"""

import json
import re
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from math import isfinite
from pathlib import Path
from platform import machine
from typing import Any

from tline.errors import InputError, MissingExtraError
from tline.interchange import epanet_run
from tline.interchange.positional_valves import as_throttles
from tline.interchange.water_network import Position, Travel
from tline.scene.text_file import read_bytes
from tline.words.wording import shown

SECONDS, EACH = 20.0, 10.0  # of the processor: for any file, and for each megabyte more
MOST_SECONDS, WAITING = 300.0, 3.0  # seconds, and those of the clock for each one of the processor
MEMORY, WRITTEN = 4 << 30, 1 << 30  # bytes; the latter of a file
LONGEST = 1000  # bytes of a line; EPANET's buffer has 1024
TITLE = 200  # characters
END_OF_LINE, SEPARATORS = re.compile(r"\r\n|\r|\n"), re.compile(r"[ \t,]+")
NO_NUMBER = re.compile(r"[+-]?(nan(\(.*\))?|inf|infinity)", re.IGNORECASE)
GIVEN = (
    "JUNCTIONS", "RESERVOIRS", "TANKS", "PIPES", "PUMPS", "VALVES", "EMITTERS", "CURVES", "PATTERNS", "STATUS",
    "DEMANDS", "CONTROLS", "RULES",
)  # fmt: skip
HELD = {"PATTERNS", "CONTROLS", "RULES"}
LEFT = ("ROUGHNESS", "ENERGY", "QUALITY", "REACTIONS", "SOURCES", "MIXING", "REPORT", "LABELS", "BACKDROP",
        "TAGS")  # fmt: skip
OWN = ("TITLE", "COORDINATES", "VERTICES", "OPTIONS", "TIMES", "END")
NEWER = "LEAKAGE"  # section of EPANET 2.3, which writes it whether or not there is any
# options and times by how EPANET tells them, from their first letters
OPTIONS = ("UNIT", "PRES", "HEADL", "VISC", "SPEC", "CHECKF", "MAXCH", "DAMP", "PATT", "DEMA", "EMIT", "MINI", "REQU")
OTHER_OPTIONS = ("HYDR", "QUAL", "MAP", "VERI", "SEGM", "DIFF", "TOLE", "TRIA", "ACCU", "UNBA", "HEADE", "FLOWC",
                 "BACKF")  # fmt: skip
TIMES = ("PATT", "HYDR", "RULE", "START")


def solved(path: str, text: str, instant: int = 0) -> dict[str, Any]:
    """Solution of EPANET for a text, `instant` seconds after the start of time; messages name the file at `path`."""
    library = _library()
    seconds = min(SECONDS + EACH * len(text) / 1e6, MOST_SECONDS)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        (Path(folder) / epanet_run.NETWORK).write_text(text, encoding="utf-8", newline="\n")
        command = [sys.executable, "-I", "-S", epanet_run.__file__, str(library)]
        limits = [str(seconds), str(MEMORY), str(WRITTEN), str(instant)]
        try:
            ended = subprocess.run(
                [*command, *limits],
                cwd=folder,
                timeout=WAITING * seconds,
                check=False,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except subprocess.TimeoutExpired:
            ended = None
        answer = None
        with suppress(OSError, ValueError):
            answer = json.loads((Path(folder) / epanet_run.ANSWER).read_text(encoding="utf-8"))
    if ended is None or -ended.returncode in _slow():
        raise InputError(path, "EPANET takes too long over it", f"at most {seconds:.0f} s")
    if not isinstance(answer, dict):
        raise InputError(path, "EPANET breaks down over it", "a network that it can solve")
    if "mistake" in answer:
        raise InputError(path, "cannot be read as an EPANET file", got=" ".join(answer["mistake"].split())[:300])
    if "unsolved" in answer:
        raise InputError(path, "EPANET finds no steady flow", got=answer["unsolved"])
    return answer


def _slow() -> set[int]:
    """Signals that say that the time is over."""
    import signal

    return {int(getattr(signal, name)) for name in ("SIGXCPU", "SIGKILL") if hasattr(signal, name)}


def _library() -> Path:
    """EPANET's library, as wntr brings it; wntr itself is not imported."""
    found = find_spec("wntr")
    if found is None or found.origin is None:
        raise MissingExtraError("EPANET files", "are read by EPANET as wntr brings it, and wntr is missing", "epanet")
    folder = Path(found.origin).parent / "epanet" / "libepanet"
    if sys.platform == "win32":
        return folder / "windows-x64" / "epanet22.dll"
    if sys.platform == "darwin":
        arm = "arm" in machine().lower()
        return folder / ("darwin-arm/libepanet2.dylib" if arm else "darwin-x64/libepanet22.dylib")
    return folder / "linux-x64" / "libepanet22.so"


SECTIONS = {name.rstrip("S"): name for name in (*GIVEN, *LEFT, *OWN, NEWER)}


@dataclass
class EpanetText:
    """Content of a file of EPANET."""

    network: str = ""  # for EPANET to solve: sections and options that bear on a steady flow at the start of time
    title: str = ""
    held: bool = False  # whether there are patterns, controls or rules
    controls: list[list[str]] = field(default_factory=list)  # words of the lines of controls
    positions: dict[str, Position] = field(default_factory=dict)  # of nodes
    vertices: dict[str, list[Position]] = field(default_factory=dict)  # of links
    travels: dict[str, Travel] = field(default_factory=dict)  # of positional valves


def read_text(path: str) -> str:
    """Text of a file in UTF-8 or UTF-16 with a byte order mark, or else in the alphabet of western Windows.

    A line ends at a null character, as EPANET reads it.
    """
    data = read_bytes(Path(path))
    for encoding in ("utf-16",) if data[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252", "latin-1"):
        try:
            text = re.sub(r"\0[^\r\n]*", "", data.decode(encoding))
        except UnicodeDecodeError:
            continue
        if not any(ord(c) < 32 and c not in "\t\n\r\f\x1a" for c in set(text)):
            return text
        break
    raise InputError(path, "cannot be read as an EPANET file", "text", "control characters")


def parse(text: str, path: str) -> EpanetText:
    """Sort the lines of a file by section."""
    found, section, kept = EpanetText(title=Path(path).stem), None, []
    titles: list[str] = []
    for number, line in enumerate(END_OF_LINE.split(text), 1):
        where, said = f"{path}, line {number}", line.partition(";")[0].strip(" \t,\f\x1a")
        if said.startswith(("[", '"[')):
            section = _section(said, where)
            if section == "END":
                break
            kept += [f"[{section}]"] if section != NEWER else []
        elif section == "TITLE":
            titles += [line.strip()] if line.strip() else []
        elif said:
            _sort(said, section, where, found, kept)
    if titles:
        found.title = "".join(c for c in titles[0] if c.isprintable())[:TITLE] or found.title
    kept, found.travels = as_throttles(kept, path)
    found.network = "\n".join([*kept, "[TIMES]", "DURATION 0", "[OPTIONS]", "QUALITY NONE", "[REPORT]", "STATUS NO",
                               "[END]", ""])  # fmt: skip
    return found


def _sort(line: str, section: str | None, where: str, found: EpanetText, kept: list[str]) -> None:
    """Keep a line that bears on the flow, or take its position on the map."""
    if section is None:
        raise InputError(where, "cannot be read as an EPANET file", "a section such as [JUNCTIONS]", shown(line))
    found.held = found.held or section in HELD
    if section in LEFT:
        return
    words = _words(line, where)
    if section == NEWER:
        raise InputError(where, "leakage along a pipe is not computed", "emitters in place of it", shown(line))
    if section == "COORDINATES":
        found.positions[words[0]] = _position(words, where)
    elif section == "VERTICES":
        found.vertices.setdefault(words[0], []).append(_position(words, where))
    elif _bears(section, words, where) and not (section == "CONTROLS" and words[-1].upper().startswith("DISABLED")):
        kept.append(_joined(words, where))
        if section == "CONTROLS":
            found.controls.append(words)


def _words(line: str, where: str) -> list[str]:
    """Words of a line, without quotes around them."""
    words = SEPARATORS.split(line)
    if '"' in line:
        if any(word.count('"') % 2 or '"' in word.strip('"') or not word.strip('"') for word in words):
            raise InputError(where, "a name with quotes or spaces in it", "names without them", shown(line))
        words = [word.strip('"') for word in words]
    return words


def _section(line: str, where: str) -> str:
    name = line.partition("]")[0].lstrip("[").strip().upper()
    section = SECTIONS.get(name.rstrip("S"))
    if section is None:
        raise InputError(where, "unknown section", "such as [JUNCTIONS]", shown(line))
    return section


def _bears(section: str, words: list[str], where: str) -> bool:
    """Whether a line bears on a steady flow."""
    key = words[0].upper()
    if section == "OPTIONS":
        if not key.startswith(OPTIONS + OTHER_OPTIONS):
            raise InputError(where, "unknown option", "one of EPANET 2.2", shown(" ".join(words)))
        return key.startswith(OPTIONS)
    return section in GIVEN or (section == "TIMES" and key.startswith(TIMES))


def _joined(words: list[str], where: str) -> str:
    line = " ".join(words)
    if words[0].startswith(("[", '"')) or ";" in line:
        raise InputError(where, "a name that is none", "one that begins with a letter or a digit", shown(line))
    if any(NO_NUMBER.fullmatch(word) for word in words[1:]):
        raise InputError(where, "a number that is none", "finite numbers", shown(line))
    if len(line.encode("utf-8", "replace")) > LONGEST:
        raise InputError(where, "the line is too long", f"at most {LONGEST} bytes")
    return line


def _position(words: list[str], where: str) -> Position:
    try:
        x, y = map(float, words[1:3])
    except ValueError:
        x = y = float("nan")
    if not (isfinite(x) and isfinite(y)):
        raise InputError(where, "not a place on a map", "a name and two numbers", shown(" ".join(words)))
    return x, y
