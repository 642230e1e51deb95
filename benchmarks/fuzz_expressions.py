"""Random questions about passivity with little memory and time: `python -m benchmarks.fuzz_expressions --number 1000`.

Each is asked in a child process. None may end the process, take over 5 s of CPU or 500 MB, or end as a fault of the
program (exit status 70).
"""

import argparse
import contextlib
import io
import multiprocessing
import os
import resource
import shlex
import signal
import sys
import time
from collections import Counter
from random import Random

from tests.random_expressions import question, state_space

SECONDS, MEGABYTES = 5, 500
_STATUS = {"proved": 0, "refuted": 1, "undecided": 3}


def ask(seed: int) -> tuple[object, str]:
    """Exit status of a question, and the question."""
    random = Random(seed)
    if random.random() < 0.05:
        return _ask_state_space(state_space(random))
    from tline.cli.main import main

    arguments = question(random)
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main.main(["passivity", *arguments], standalone_mode=True)
            status = 0
        except SystemExit as end:
            status = end.code
    return (err.getvalue().strip() if status == 70 else status), shlex.join(arguments)


def _ask_state_space(entries: list) -> tuple[object, str]:
    from passivity import ExpressionError, StateSpace, check_bounded_real_matrix, check_positive_real_matrix

    try:
        system = StateSpace.from_entries(*entries)
        found = [check(system) for check in (check_positive_real_matrix, check_bounded_real_matrix)]
        assert all(verdict.why for verdict in found)
    except ExpressionError:
        return 2, ""
    except Exception as error:  # noqa: BLE001 (any fault is a find)
        return repr(error)[:200], repr(entries)
    return _STATUS[found[0].status.value], ""


def _work(seeds: range, pipe) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEGABYTES * 2**20, MEGABYTES * 2**20))
    for seed in seeds:
        pipe.send((seed, None, "", 0.0))
        before = time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, 4 * SECONDS)  # ends what has no end
        status, text = ask(seed)
        pipe.send((seed, status, text, time.process_time() - before))
    pipe.send((None, None, "", 0.0))


def run(seeds: range) -> tuple[Counter, list[str], list[tuple[float, int]]]:
    """What came out, faults and the slowest questions."""
    import passivity  # noqa: F401 (before the children are forked)
    from tline.cli.verdicts import expression, matrix  # noqa: F401

    found, faults, slow = Counter(), [], []
    rest = seeds
    while rest:
        ours, theirs = multiprocessing.Pipe(duplex=False)
        child = multiprocessing.get_context("fork").Process(target=_work, args=(rest, theirs))
        child.start()
        theirs.close()
        now = rest[0]
        try:
            while True:
                seed, status, text, seconds = ours.recv()
                if seed is None:
                    child.join()
                    return found, faults, sorted(slow, reverse=True)[:20]
                now = seed
                if status is None:
                    continue
                found[status if isinstance(status, int) else "fault"] += 1
                slow.append((round(seconds, 2), seed))
                if len(slow) % 500 == 0:
                    print(f"{len(slow)} asked, {sum(x for x, _ in slow):.0f} s: {dict(found)}, {max(slow)}", flush=True)
                if seconds > SECONDS or not isinstance(status, int):
                    faults.append(f"seed {seed}: {status} after {seconds:.1f} s: {text[:300]}")
                    print(faults[-1], flush=True)
        except EOFError:
            child.join()
            found["died"] += 1
            faults.append(f"seed {now}: the process ended with {child.exitcode}")
            print(faults[-1], flush=True)
            rest = range(now + 1, seeds.stop)
    return found, faults, sorted(slow, reverse=True)[:20]


def main() -> None:
    """Ask as many questions as are wanted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--number", type=int, default=1000)
    given = parser.parse_args()
    started = time.time()
    found, faults, slow = run(range(given.first, given.first + given.number))
    print(f"seeds {given.first} to {given.first + given.number - 1}, {time.time() - started:.0f} s: {dict(found)}")
    print("slowest:", ", ".join(f"{seconds} s (seed {seed})" for seconds, seed in slow[:8]))
    sys.exit(bool(faults))


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
