"""`python -m benchmarks.fuzz`: a million hostile inputs over all doors; prints the seed and what is found wrong."""

import argparse
import os
import shlex
import sys
import time
from collections import defaultdict
from functools import partial

from benchmarks.fuzz.doors import DOORS, case_of
from benchmarks.fuzz.warm import lower_limits, warm_up
from benchmarks.fuzz.workers import MEMORY, SECONDS, Block, Finding, findings

SIZE = 250  # cases of a process


def main() -> int:
    """Run, and answer 1 if anything was found."""
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
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
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
