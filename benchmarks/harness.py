"""Common parts of all benchmarks: one clock, processes of their own, tables, and pages that they write.

A time is a median of runs after a first one that compiles; a claim of speed is a ratio of times taken in turn.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
RUNS = 5


def timed(call: Callable[[], Any], runs: int = RUNS, clock: Callable[[], float] = time.process_time) -> tuple:
    """Return a call's last result, and the median of its seconds by a clock."""
    found, seconds = None, []
    for _ in range(runs):
        begun = clock()
        found = call()
        seconds.append(clock() - begun)
    return found, median(seconds)


def in_turn(calls: Mapping[str, Callable[[], float]], runs: int = RUNS) -> dict[str, tuple[float, float]]:
    """Measure calls that return seconds, in turn in each round: median, and median ratio to the first, by name."""
    rounds = [{name: call() for name, call in calls.items()} for _ in range(runs + 1)][1:]
    first = next(iter(calls))
    return {
        name: (median(each[name] for each in rounds), median(each[name] / each[first] for each in rounds))
        for name in calls
    }


class Spent(NamedTuple):
    """Wall and processor time of a process, s, and its output."""

    wall: float
    cpu: float
    said: str


def spent(call: list, environment: Mapping[str, Any] | None = None, limit: float = 600.0) -> Spent:
    """Run a program to its end.

    Raises subprocess.CalledProcessError: it failed; an exit status of 1 is an answer. Raises subprocess.TimeoutExpired:
    it takes longer than the limit, s.
    """
    own = os.environ | {key: str(value) for key, value in (environment or {}).items()}
    own.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryFile() as out:
        before, begun = os.times(), time.perf_counter()
        done = subprocess.run(call, env=own, cwd=ROOT, stdout=out, stderr=subprocess.DEVNULL, timeout=limit)
        wall, after = time.perf_counter() - begun, os.times()
        out.seek(0)
        said = out.read().decode()
    if done.returncode not in (0, 1):
        raise subprocess.CalledProcessError(done.returncode, call, said)
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Spent(wall, cpu, said)


def apart(module: str, *arguments: object, limit: float = 600.0) -> Any:
    """Run ``python -m module ARGUMENT…`` as a process; return the JSON in its last line."""
    call = [sys.executable, "-W", "ignore", "-m", module, *map(str, arguments)]
    return json.loads(spent(call, limit=limit).said.splitlines()[-1])


def table(head: str, rows: Iterable[Iterable[object]]) -> str:
    """Format a table in Markdown; the head has its columns between bars, those with < aligned to the left."""
    titles = head.split("|")
    bar = "|" + "|".join("---" if title.startswith("<") else "---:" for title in titles) + "|"
    first, *rest = ([str(cell).strip() for cell in row] for row in ([title.lstrip("<") for title in titles], *rows))
    written = ("|" + "".join(f" {cell} |" if cell else " |" for cell in row) for row in (first, *rest))
    return "\n".join([next(written), bar, *written])


def write(page: str, text: str, mark: str = "") -> None:
    """Print a text and write it to a page, or between the page's mark and the end of that."""
    print(text, flush=True)
    path = ROOT / page
    if mark:
        pattern = rf"(<!-- {mark} -->\n).*?\n?(<!-- end -->)"
        text, found = re.subn(
            pattern, lambda match: f"{match[1]}{text}\n{match[2]}", path.read_text(encoding="utf-8"), flags=re.DOTALL
        )
        assert found == 1, f"{page} has no mark {mark}"
    path.write_text(text, encoding="utf-8")
