"""Command `tline warm-up`: compile all units for runs ahead, in as many processes as there are processors."""

import os
import sys
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command

if TYPE_CHECKING:
    from tline.compiled.unit import Unit

WITH_UNITS = (  # packages and modules
    "tline.solver.kernel",
    "tline.solver.many.kernel",
    "friction.kernel",
    "tline.study.baseline.loops",
    "tline.study.reference.grid",
)
EXAMPLES = """\b
Examples:
  tline warm-up
  NUMBA_CACHE_DIR=~/compiled tline warm-up --json
"""


@command(epilog=EXAMPLES)
def warm_up() -> Output:
    """Compile all code for runs ahead.

    Code is otherwise compiled when a scene first needs it. It is kept in the folder NUMBA_CACHE_DIR, else
    next to the program, else in your own cache, until the program changes. A second call finds nothing to do.

    Code is read only from folders and files that are yours, or root's, and that nobody else can write to. For all
    users of a computer, let root warm up a folder that they can read.

    Parameters
    ----------
    as_json
        Print the work done as JSON.
    """
    from tline.compiled.object_code import is_kept, path_of

    begun, units = time.perf_counter(), dict(found())
    missing = {where: unit for where, unit in units.items() if not is_kept(unit)}
    if missing:
        _compile_all(missing)
    unkept = [f"{module}.{name}" for (module, name), unit in missing.items() if not is_kept(unit)]
    folders = sorted({str(path.parent) for unit in units.values() if (path := path_of(unit))})
    told = {"units": len(units), "compiled": len(missing), "not_kept": unkept, "folders": folders}
    told["seconds"] = time.perf_counter() - begun
    return Output([_in_words(told)], lambda: told, exit_code=int(bool(unkept)))


def found() -> Iterator[tuple[tuple[str, str], "Unit"]]:
    """Units by module and name, those with most source code first."""
    from importlib import import_module
    from pkgutil import walk_packages

    from tline.compiled.stamp import sources_of
    from tline.compiled.unit import Unit

    units: dict[tuple[str, str], Unit] = {}
    for outer in WITH_UNITS:
        inner = walk_packages(getattr(import_module(outer), "__path__", ()), f"{outer}.")
        for module in [outer, *(each.name for each in inner)]:
            for name, value in vars(import_module(module)).items():
                if isinstance(value, Unit) and value.__module__ == module:
                    units[module, name] = value
    yield from sorted(units.items(), key=lambda item: -len(sources_of(item[0][0]) or ()))


def _compile_all(units: Any) -> None:
    """Compile units, each in one of as many processes as there are processors."""
    from concurrent.futures import as_completed

    from tline.words.progress import Progress
    from tline.workers import Workers

    pool = Workers(min(os.cpu_count() or 1, len(units)))
    try:
        with Progress(len(units), "unit", sys.stderr.isatty(), "compiling") as bar:
            for done in as_completed([pool.submit(_compile, *where) for where in units]):
                done.result()
                bar.update()
        pool.shutdown()  # all are idle; else the thread that ends them may still be writing when this process ends
    finally:
        pool.end()


def _compile(module: str, name: str) -> None:
    """Compile and keep a unit; in a process of its own, whose warnings the first process does not need."""
    import warnings
    from importlib import import_module

    warnings.simplefilter("ignore")
    _ = getattr(import_module(module), name).address


def _in_words(told: dict[str, Any]) -> str:
    kept = f"kept in {', '.join(told['folders'])}" if told["folders"] else "there is no folder to keep them in"
    if not told["compiled"]:
        return f"nothing to do: all {told['units']} units are compiled, {kept}"
    text = f"compiled {told['compiled']} of {told['units']} units in {told['seconds']:.2g} s, {kept}"
    return text + "".join(f"\nnot kept: {name}" for name in told["not_kept"])
