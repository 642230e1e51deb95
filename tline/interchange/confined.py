"""EPANET in a process of its own: in a new empty folder, within limits of time and memory."""

import json
import subprocess
import sys
import tempfile
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from platform import machine
from typing import Any

from tline.errors import InputError, MissingExtraError
from tline.interchange import epanet_run

SECONDS, EACH = 20.0, 10.0  # of the processor: for any file, and for each megabyte more
MOST, WAITING = 300.0, 3.0  # seconds, and those of the clock for each one of the processor
MEMORY, WRITTEN = 4 << 30, 1 << 30  # bytes; the latter of a file


def solved(path: str, text: str, instant: int = 0) -> dict[str, Any]:
    """What EPANET answers to a text, as `epanet_run` writes it.

    Parameters
    ----------
    path : str
        The file that messages name.
    text : str
        The network; it is to name no files.
    instant : int
        After the start of time, s.
    """
    library = _library()
    seconds = min(SECONDS + EACH * len(text) / 1e6, MOST)
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
