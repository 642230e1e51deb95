"""Cases in forked processes with a limit of time and of memory: one that dies names the case it died of."""

import json
import mmap
import os
import resource
import signal
import struct
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from shutil import rmtree
from typing import NamedTuple

from benchmarks.fuzz.case import Case
from benchmarks.fuzz.judge import verdict

SECONDS, WALL = 5.0, 120.0  # of processor time that a case may take, and until one that waits for ever is given up
MEMORY = 500_000_000  # bytes, beyond what the program has before
STATE = struct.Struct("qdd")  # of a process: the case under way, longest and summed processor time so far
SAID = {signal.SIGPROF: f"took more than {SECONDS:g} s", signal.SIGALRM: "waits for ever"}


class Block(NamedTuple):
    """Cases of a door that one process takes, from `first` to before `last`."""

    door: str
    first: int
    last: int


class Finding(NamedTuple):
    """What is wrong with the answer to one case."""

    door: str
    index: int
    reasons: list[str]


def findings(
    blocks: list[Block],
    case_of: Callable[[str, int], Case],
    processes: int,
    told: Callable[[Block, float, float], None],
) -> Iterator[Finding]:
    """Run all blocks; `told` hears of each that is done, with the processor time of its longest case and of all."""
    with tempfile.TemporaryDirectory(prefix="fuzz-", dir=_memory()) as scratch:
        yield from _supervised(blocks, case_of, processes, told, Path(scratch))


def _supervised(
    blocks: list[Block],
    case_of: Callable[[str, int], Case],
    processes: int,
    told: Callable[[Block, float, float], None],
    scratch: Path,
) -> Iterator[Finding]:
    waiting, running = blocks[::-1], {}
    while waiting or running:
        while waiting and len(running) < processes:
            block, folder = waiting.pop(), Path(tempfile.mkdtemp(dir=scratch))
            shared, (reading, writing) = mmap.mmap(-1, STATE.size), os.pipe()
            shared[:] = STATE.pack(block.first, 0.0, 0.0)
            pid = os.fork()
            if not pid:
                os.close(reading)
                _work(block, case_of, folder, shared, writing)
            os.close(writing)
            running[pid] = block, folder, shared, reading
        pid, status = os.wait()
        block, folder, shared, reading = running.pop(pid)
        rmtree(folder)
        with open(reading, encoding="utf-8") as lines:
            for line in lines:
                index, reasons = json.loads(line)
                yield Finding(block.door, index, reasons)
        index, longest, spent = STATE.unpack(shared[:])
        if status:
            died = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
            said = SAID.get(died) or (f"died of {signal.Signals(died).name}" if died else "ended the process")
            yield Finding(block.door, index, [said])
            if index + 1 < block.last:
                waiting.append(block._replace(first=index + 1))
        told(block._replace(last=index + 1), longest, spent)


def _work(block: Block, case_of: Callable[[str, int], Case], folder: Path, shared: mmap.mmap, writing: int) -> None:
    """Take a block in a process of its own; never comes back."""
    code = 1
    try:
        size = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, size + MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for which in (signal.SIGPROF, signal.SIGALRM):
            signal.signal(which, signal.SIG_DFL)
        os.chdir(folder)
        with open(writing, "w", encoding="utf-8") as out:
            longest = spent = 0.0
            for index in range(block.first, block.last):
                shared[:] = STATE.pack(index, longest, spent)
                signal.setitimer(signal.ITIMER_PROF, SECONDS)
                signal.setitimer(signal.ITIMER_REAL, WALL)
                case = case_of(block.door, index)
                begun = os.times()
                reasons = verdict(case, folder)
                done = os.times()
                took = done.user + done.system - begun.user - begun.system
                longest, spent = max(longest, took), spent + took
                if reasons:
                    print(json.dumps([index, reasons]), file=out, flush=True)
            shared[:] = STATE.pack(block.last - 1, longest, spent)
            signal.setitimer(signal.ITIMER_PROF, 0)
            signal.setitimer(signal.ITIMER_REAL, 0)
        code = 0
    finally:
        if code:
            import traceback

            traceback.print_exc(file=sys.stderr)
        os._exit(code)


def _memory() -> str | None:
    """A folder in memory, if there is one."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
