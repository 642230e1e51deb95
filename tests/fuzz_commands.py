"""Hostile input by the million: `python tests/fuzz_commands.py` asks all commands, prints the seed of each bad answer.

Cases (`tests/fuzz`) run in forked processes with a limit of time and of memory: a process that dies names its
case. For any input, a command must answer in time, in bounds, and touch nothing else.
"""

import argparse
import json
import mmap
import os
import resource
import shlex
import signal
import struct
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from shutil import rmtree
from typing import NamedTuple

from fuzz.case import Case
from fuzz.doors import DOORS, case_of
from fuzz.judge import verdict
from fuzz.warm import lower_limits, warm_up

SIZE = 250  # cases of a process
SECONDS, WALL = 5.0, 120.0  # of processor time that a case may take, and until one that waits for ever is given up
MEMORY = 500_000_000  # bytes, in addition to those of the program before
STATE = struct.Struct("qdd")  # of a process: the present case, longest and summed processor time
SAID = {signal.SIGPROF: f"took more than {SECONDS:g} s", signal.SIGALRM: "waits for ever"}


class Block(NamedTuple):
    """Cases of a door that one process takes, from `first` to before `last`."""

    door: str
    first: int
    last: int


class Finding(NamedTuple):
    """Errors in the answer to one case."""

    door: str
    index: int
    reasons: list[str]


def findings(
    blocks: list[Block],
    case_of: Callable[[str, int], Case],
    processes: int,
    told: Callable[[Block, float, float], None],
) -> Iterator[Finding]:
    """Run all blocks; `told` is called after each, with the processor time of its longest case and of all."""
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
    """Take a block in a process of its own; never returns."""
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
    """Folder in memory, if there is one."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def main() -> int:
    """Run all cases, and return 1 if anything was found."""
    asked = _asked()
    if asked.show:
        return _show(asked)
    doors = asked.door or list(DOORS)
    whole = sum(DOORS[door][1] for door in doors)
    counts = {door: asked.count * DOORS[door][1] // whole for door in doors}
    print(f"seed {asked.seed}: " + ", ".join(f"{count:,} {door}" for door, count in counts.items()), flush=True)
    begun = time.perf_counter()
    warm_up()
    lower_limits()
    print(f"warm after {time.perf_counter() - begun:.0f} s", flush=True)
    blocks = [
        (k / counts[door], Block(door, asked.first + k, asked.first + min(k + SIZE, counts[door])))
        for door in doors
        for k in range(0, counts[door], SIZE)
    ]
    done, longest, bad = defaultdict(int), defaultdict(float), 0
    spent = defaultdict(float)

    def told(block: Block, most: float, seconds: float) -> None:
        done[block.door] += block.last - block.first
        longest[block.door] = max(longest[block.door], most)
        spent[block.door] += seconds

    for found in findings([block for _, block in sorted(blocks)], partial(case_of, asked.seed), asked.processes, told):
        bad += 1
        _tell(asked.seed, found)
    minutes = (time.perf_counter() - begun) / 60
    print(f"\n{'door':<12} {'cases':>9} {'longest [s]':>12} {'mean [ms]':>10}")
    for door in doors:
        print(f"{door:<12} {done[door]:>9,} {longest[door]:>12.2f} {1e3 * spent[door] / max(done[door], 1):>10.2f}")
    print(
        f"{sum(done.values()):,} cases, {bad} wrong; limits {SECONDS:g} s, {MEMORY / 1e6:g} MB; {minutes:.1f} minutes"
    )
    return 1 if bad else 0


def _asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python tests/fuzz_commands.py", description=__doc__)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--count", type=int, default=1_000_000, help="cases over all doors that are asked for")
    parser.add_argument("--door", action="append", choices=DOORS, help="may be repeated; all if not given")
    parser.add_argument("--first", type=int, default=0, help="index of the first case of each door")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--show", action="store_true", help="print the case --first of --door instead of running it")
    return parser.parse_args()


def _tell(seed: int, found: Finding) -> None:
    args = shlex.join(case_of(seed, found.door, found.index).args)
    print(
        f"{found.door} --first {found.index}: {'; '.join(found.reasons)}\n    tline {ascii(args)[1:-1]:.300}",
        flush=True,
    )


def _show(asked: argparse.Namespace) -> int:
    for door in asked.door or list(DOORS):
        case = case_of(asked.seed, door, asked.first)
        print(f"tline {ascii(shlex.join(case.args))[1:-1]}")
        for name, content in case.files.items():
            sys.stdout.flush()
            sys.stdout.buffer.write(b"--- " + name.encode() + b"\n" + content + b"\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
