"""Object code of compiled units on disk: found, checked, and loaded by llvmlite alone, without numba.

A file is valid while all source code of the unit has the same meaning (`tline.compiled.stamp`), for one
processor, one version of numba and one set of its options. It is read only if nobody else, but root, can have
written it. The C library's functions that it needs must be found before it is loaded.

A wheel for one platform brings code of all its units (`.ci/wheel`), made for any processor that has `BASELINE`. It
does not depend on numba's version, and anyone able to change it could change the program next to it.
"""

import ctypes
import hashlib
import json
import os
import platform
import stat
import sys
import warnings
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any
from uuid import uuid4

from tline.compiled.stamp import SourceText, are_unchanged, digests, sources_of

OTHERS = stat.S_IWGRP | stat.S_IWOTH
BEYOND_LINKS = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


class UntrustedError(Exception):
    """Somebody else can have written this."""


def read_trusted(path: Path) -> bytes:
    """Content of a file that nobody else can have written.

    Raises UntrustedError: somebody else can, or it is a link, or not a file. Raises OSError: the file is missing, or
    cannot be read.
    """
    if os.name != "posix":  # where owners and modes have no meaning
        return path.read_bytes()
    folder = _opened_folder(path.parent)
    try:
        if not stat.S_ISREG(os.stat(path.name, dir_fd=folder, follow_symlinks=False).st_mode):
            raise UntrustedError(f"{path} is a link, or no file")
        with open(os.open(path.name, BEYOND_LINKS, dir_fd=folder), "rb") as file:
            _check(os.fstat(file.fileno()), path)
            return file.read()
    finally:
        os.close(folder)


def check_folder(path: Path) -> None:
    """Raise an error for a folder into which somebody else can write.

    Raises UntrustedError: somebody else can. Raises OSError: it is not there, or cannot be read.
    """
    if os.name == "posix":
        os.close(_opened_folder(path))


def _opened_folder(path: Path) -> int:
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        _check(os.fstat(folder), path)
    except UntrustedError:
        os.close(folder)
        raise
    return folder


def _check(found: os.stat_result, path: Path) -> None:
    if found.st_uid not in (os.geteuid(), 0):
        raise UntrustedError(f"{path} belongs to another user")
    if found.st_mode & OTHERS:
        raise UntrustedError(f"other users may write to {path}")


COMPILING = "tline.compiled.compiler", "tline.compiled.compiler"  # affect all code, though no unit imports them
NO_MATTER = {"NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_THREADING_LAYER"}  # numba's settings without effect on code
SHIPPED = Path(__file__).with_name("shipped")  # code that came with a wheel
BASELINE = {"x86_64": {"avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"}}  # x86-64-v3; no requirement for others
SETTINGS_FILE = Path(".numba_config.yaml")  # of numba, in the folder where the program runs
EXPECTED = "expected a folder of your own to which nobody else may write"
OWN_FOLDER, OWN_FILE = 0o755, 0o644  # modes, independent of the umask
_said: set[str] = set()


def load(unit: Any) -> tuple[int, Any] | None:
    """Load a unit's kept code: its address, and the object to keep alive; None if there is none, or it is not valid."""
    try:
        found = _read(unit)
        return None if found is None else _linked(*found)
    except Exception:  # noqa: BLE001 (whatever the defect of a file, it is compiled again)
        return None


def _read(unit: Any) -> tuple[str, list[str], bytes] | None:
    """Read a unit's name, the functions it needs, and its code, if there is valid code of it."""
    return _shipped(unit) or _kept(unit)


def _shipped(unit: Any) -> tuple[str, list[str], bytes] | None:
    """Read the code shipped with the program, if it is valid."""
    name = _name_of(unit)
    if name is None or not _is_for_this_processor():
        return None
    return _valid(unit, (SHIPPED / f"{name}.unit").read_bytes()) if (SHIPPED / f"{name}.unit").is_file() else None


def _kept(unit: Any) -> tuple[str, list[str], bytes] | None:
    """Read the code compiled here, if it is valid."""
    path = path_of(unit)
    if path is None:
        return None
    try:
        return _valid(unit, read_trusted(path), _versions())
    except UntrustedError as error:
        _say(f"compiled code is not read, but compiled anew: {error}, {EXPECTED}")
        return None


def _valid(unit: Any, file: bytes, versions: str | None = None) -> tuple[str, list[str], bytes] | None:
    """Parse a file, if it is whole, of these versions and of the unit's present source code."""
    digest, _, content = file.partition(b"\n")
    if hashlib.sha256(content).hexdigest().encode() != digest:
        return None
    first, _, code = content.partition(b"\n")
    about = json.loads(first)
    valid = versions in (None, about["versions"]) and are_unchanged(unit.sources, about["sources"])
    return (about["name"], about["needed"], code) if valid else None


def keep(unit: Any, name: str, library: Any) -> None:
    """Write a unit's code, in place of invalid code; failures of the disk are not errors."""
    path = path_of(unit)
    if path is None:
        return
    needed = [f.name for f in library._final_module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    about = {"versions": _versions(), "sources": digests(unit.sources), "name": name, "needed": needed}
    content = json.dumps(about).encode() + b"\n" + bytes(library._get_compiled_object())
    try:
        path.parent.mkdir(OWN_FOLDER, parents=True, exist_ok=True)
        check_folder(path.parent)
        _write(path, hashlib.sha256(content).hexdigest().encode() + b"\n" + content)
    except UntrustedError as error:
        _not_kept(f"{error}, {EXPECTED}")
    except OSError as error:
        _not_kept(f"it cannot be written into {path.parent}, got {(error.strerror or str(error)).lower()}")


def is_kept(unit: Any) -> bool:
    """Whether a unit has valid code on disk."""
    with suppress(Exception):
        return _read(unit) is not None
    return False


def _linked(name: str, needed: list[str], code: bytes) -> tuple[int, Any] | None:
    import llvmlite.binding as llvm

    if not all(_is_found(symbol) for symbol in needed):
        return None
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine.get_function_address(name), engine


def _is_found(symbol: str) -> bool:
    """Whether llvmlite finds a function of the C library, after registering Python's or numba's address of it."""
    import llvmlite.binding as llvm

    if llvm.address_of_symbol(symbol) is not None:
        return True
    with suppress(AttributeError, OSError, TypeError):  # Windows has no library of all that a process has loaded
        llvm.add_symbol(symbol, ctypes.cast(getattr(ctypes.CDLL(None), symbol), ctypes.c_void_p).value or 0)
        return True
    from numba.core.registry import cpu_target

    _ = cpu_target.target_context
    return llvm.address_of_symbol(symbol) is not None


@cache
def _engine() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


@cache
def _versions() -> str:
    import llvmlite

    return f"numba {version('numba')}, llvmlite {llvmlite.__version__}"


def _settings() -> tuple[list[tuple[str, str]], bytes]:
    """Settings of numba that change code."""
    settings = sorted(item for item in os.environ.items() if item[0].startswith("NUMBA_") and item[0] not in NO_MATTER)
    return settings, SETTINGS_FILE.read_bytes() if SETTINGS_FILE.is_file() else b""


@cache
def _processor() -> str:
    """Target of numba: this processor, unless one of its settings names another or disables features."""
    import llvmlite.binding as llvm

    host = llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return repr((host, *_settings()))


@cache
def _is_for_this_processor() -> bool:
    """Whether shipped code can run here, and no setting requires other code."""
    import llvmlite.binding as llvm

    if not SHIPPED.is_dir() or _settings() != ([], b""):
        return False
    has = llvm.get_host_cpu_features()
    return all(has.get(feature) for feature in BASELINE.get(platform.machine(), ()))


def sources_for(module: str) -> dict[str, SourceText] | None:
    """Sources of the units of a module; to be read when it is loaded, as an upgrade may change files later."""
    return sources_of(module, *COMPILING)


def _name_of(unit: Any) -> str | None:
    """Name of a unit's file; None if its source code cannot be found."""
    spec = getattr(sys.modules.get(unit.__module__), "__spec__", None)
    if spec is None or unit.code.__code__.co_filename != spec.origin or unit.code.__closure__:
        return None
    if unit.code.__qualname__ != unit.__name__ or unit.sources is None:
        return None
    return f"{unit.__module__}.{unit.__name__}"


def path_of(unit: Any) -> Path | None:
    """Path of a unit's code, a file for each processor and setting; None if there is no place."""
    name, origin = _name_of(unit), unit.code.__code__.co_filename
    folder = None if name is None else _folder(Path(origin).parent)
    key = hashlib.sha256(f"{origin} {_processor()}".encode()).hexdigest()[:16]
    return None if folder is None else folder / f"{name}-{key}.unit"


@cache
def _folder(beside: Path) -> Path | None:
    """Folder for code: the one set by the user, else next to the source, else in the user's own cache."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.environ["NUMBA_CACHE_DIR"]).absolute()
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or str(Path.home() / ".cache")
    for folder in (beside / "__pycache__", Path(home) / "tline"):
        with suppress(OSError, UntrustedError):
            folder.mkdir(OWN_FOLDER, parents=True, exist_ok=True)
            check_folder(folder)
            if os.access(folder, os.W_OK):
                return folder
    _not_kept("no folder for it can be written, expected NUMBA_CACHE_DIR to name one")
    return None


def _write(path: Path, content: bytes) -> None:
    """Write a file that others see whole or not at all."""
    passing = path.with_name(f"{uuid4().hex}.tmp")
    try:
        with open(os.open(passing, os.O_WRONLY | os.O_CREAT | os.O_EXCL, OWN_FILE), "wb") as file:
            file.write(content)
        os.replace(passing, path)
    except OSError:
        with suppress(OSError):
            passing.unlink()
        raise


def _not_kept(reason: str) -> None:
    _say(f"compiled code is not kept, so every process compiles anew: {reason}")


def _say(text: str) -> None:
    """Warn, once in a process."""
    from tline.errors import NotKeptWarning

    if not _said:
        _said.add(text)
        warnings.warn(text, NotKeptWarning, stacklevel=2)
