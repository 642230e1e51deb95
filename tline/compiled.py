"""Functions that numba compiles, with a cache that is never stale and never in the way.

The cache of numba looks at the file of a function alone and not at those it inlines or takes constants from, at the
names of a tuple's members not at all, and it stops where no folder can be written. This one leaves the choice of the
folder to numba, and keeps one file for each function and signature, which says what it was made of.
"""

import hashlib
import os
import pickle
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import Any
from uuid import uuid4

import llvmlite
import numba
from numba import types
from numba.core import config
from numba.core.caching import CompileResultCacheImpl, _Cache
from numba.core.serialize import dumps

from tline.sources import Source, are_unchanged, digests, sources_of

VERSIONS = f"numba {numba.__version__}, llvmlite {llvmlite.__version__}\n".encode()
SETTINGS = "OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT"  # of numba, that change code
_said: set[str] = set()


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function at its first call, and keep the result: `numba.njit` with the cache of this module.

    Parameters
    ----------
    **options
        Of `numba.njit`, except ``cache``.

    Examples
    --------
    >>> @njit(error_model="numpy")
    ... def double(x):
    ...     return 2 * x
    >>> double(21)
    42
    """

    def decorate(function: Callable[..., Any]) -> Any:
        compiled: Any = numba.njit(cache=False, **options)(function)
        compiled._cache = UnitCache(function)
        return compiled

    return decorate


class UnitCache(_Cache):
    """Compiled code of one function on disk, valid while all source code that it is made of means the same.

    What no file tells all about is not kept: functions made within functions, or from text.
    """

    def __init__(self, function: Any):
        self._function = function
        self._sources: Mapping[str, Source] | None = None
        spec = getattr(sys.modules.get(function.__module__), "__spec__", None)
        if spec and function.__code__.co_filename == spec.origin and not function.__closure__:
            self._sources = sources_of(function.__module__)
        self._enabled = True

    @cached_property
    def _numba(self) -> Any:
        """The cache of numba, which knows a place and how to take results to pieces; None if there is no place."""
        if self._sources is None:
            return None
        try:
            return CompileResultCacheImpl(self._function)
        except RuntimeError:
            _say("no folder for it can be written, expected NUMBA_CACHE_DIR to name one")
            return None

    @property
    def cache_path(self) -> Any:
        """The folder, None if there is none."""
        return self._numba and self._numba.locator.get_cache_path()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was compiled for a signature, None if that is not kept or no longer valid."""
        target_context.refresh()
        if not self._enabled or self._numba is None:
            return None
        payload = self._read(self._path(sig, target_context.codegen()))
        return None if payload is None else self._numba.rebuild(target_context, payload)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, in place of what is no longer valid; whatever happens to the disk is no error."""
        if not self._enabled or self._numba is None or not self._numba.check_cachable(data):
            return
        path, payload = self._path(sig, data.codegen), dumps(self._numba.reduce(data))
        head = VERSIONS + dumps(digests(self._sources or {}))
        try:
            self._numba.locator.ensure_cache_path()
            _write(path, head + hashlib.sha256(payload).digest() + payload)
            for other in self._files():
                if not self._is_valid(other):
                    other.unlink(missing_ok=True)
        except OSError as error:
            _say(f"it cannot be written into {path.parent}, got {(error.strerror or str(error)).lower()}")

    def enable(self) -> None:
        """Use the cache."""
        self._enabled = True

    def disable(self) -> None:
        """Neither load nor keep anything."""
        self._enabled = False

    def flush(self) -> None:
        """Forget what is kept of the function."""
        with suppress(OSError):
            for path in self._files():
                path.unlink(missing_ok=True)

    def _name(self) -> str:
        python = f"py{sys.version_info[0]}{sys.version_info[1]}{getattr(sys, 'abiflags', '')}"
        return f"{self._function.__module__}.{self._function.__qualname__}.{python}".replace("<", "").replace(">", "")

    def _files(self) -> list[Path]:
        return list(Path(self.cache_path).glob(f"{self._name()}-*.nbc")) if self._numba else []

    def _path(self, sig: Any, codegen: Any) -> Path:
        """One for each signature, processor and setting."""
        members = [list(_members(kind)) for kind in (sig if isinstance(sig, tuple) else sig.args)]
        settings = [str(getattr(config, name)) for name in SETTINGS]
        key = hashlib.sha256(repr((sig, members, codegen.magic_tuple(), settings)).encode()).hexdigest()
        return Path(self.cache_path) / f"{self._name()}-{key[:16]}.nbc"

    def _read(self, path: Path) -> Any:
        """The pieces of a result, None if the file is not there, not valid or broken."""
        try:
            with path.open("rb") as file:
                if not self._is_made_of_the_same(file):
                    return None
                digest, payload = file.read(32), file.read()
            return pickle.loads(payload) if hashlib.sha256(payload).digest() == digest else None
        except Exception:  # noqa: BLE001 (it may name what is no longer there)
            return None

    def _is_valid(self, path: Path) -> bool:
        try:
            with path.open("rb") as file:
                return self._is_made_of_the_same(file)
        except Exception:  # noqa: BLE001 (as above)
            return False

    def _is_made_of_the_same(self, file: Any) -> bool:
        return file.readline() == VERSIONS and are_unchanged(self._sources or {}, pickle.load(file))


def _members(kind: Any) -> Iterator[str]:
    """Classes and member names of all named tuples within a type: members are found by their place."""
    if isinstance(kind, types.NamedTuple | types.NamedUniTuple):
        yield f"{kind.instance_class.__module__}.{kind.instance_class.__qualname__}{kind.fields}"
    for part in vars(kind).values():
        for inner in part if isinstance(part, tuple) else (part,):
            if isinstance(inner, types.Type):
                yield from _members(inner)


def _write(path: Path, content: bytes) -> None:
    """Write a file that others see whole or not at all."""
    passing = path.with_name(f"{uuid4().hex}.tmp")
    try:
        passing.write_bytes(content)
        os.replace(passing, path)
    except OSError:
        with suppress(OSError):
            passing.unlink()
        raise


def _say(reason: str) -> None:
    """Warn once that each process compiles for itself."""
    from tline.errors import NotKeptWarning

    if not _said:
        _said.add(reason)
        text = f"compiled code is not kept, so every process compiles anew: {reason}"
        warnings.warn(text, NotKeptWarning, stacklevel=2)
