"""Messages on a terminal during compilation, which only the first use waits for."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from time import process_time

PATIENCE = 1.0  # s of compiling without a message
FOR = {  # part of the kernel -> its purpose, and seconds for compiling all of it
    "blocks": ("lines", 2),
    "delay": ("delays that are no whole number of slabs", 2),
    "friction": ("friction models", 5),
    "fronts": ("fronts", 5),
    "laws": ("non-linear elements", 3),
    "diamonds": ("losses", 3),
    "many": ("sweeps", 4),
    "stores": ("vessels, tanks and pumps", 3),
}
OTHERWISE = "this", 10
_spent: dict[str, float] = {}
_said: set[str] = set()
_compiling = {"depth": 0, "seconds": 0.0}


def compiling_seconds() -> float:
    """Processor time that this process has spent on compiling, s."""
    return _compiling["seconds"]


@contextmanager
def counted() -> Iterator[None]:
    """Count the compiling time of a unit, including the units that it calls."""
    begun = process_time()
    _compiling["depth"] += 1
    try:
        yield
    finally:
        _compiling["depth"] -= 1
        _compiling["seconds"] += 0.0 if _compiling["depth"] else process_time() - begun


@contextmanager
def announced(module: str) -> Iterator[None]:
    """Announce the compilation of a unit once its part of the kernel has taken a second.

    Parameters
    ----------
    module : str
        Module of the unit.
    """
    part = next((part for part in module.split(".") if part in FOR), "")
    if part in _said or not sys.stderr.isatty():
        yield
        return
    begun = time.perf_counter()
    timer = Timer(max(PATIENCE - _spent.get(part, 0.0), 0.0), _say, [part])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        _spent[part] = _spent.get(part, 0.0) + time.perf_counter() - begun


def _say(part: str) -> None:
    _said.add(part)
    purpose, seconds = FOR.get(part, OTHERWISE)
    print(f"compiling for {purpose}, once, some {seconds} s", file=sys.stderr, flush=True)  # noqa: T201
