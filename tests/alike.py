"""Whether two objects hold the same, through all that they are made of; for tests of copies."""

from collections.abc import Iterator, Mapping
from enum import Enum
from fractions import Fraction
from pathlib import PurePath
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

import flint
import numpy as np

from tline.solver.description.description import Beside

PLAIN = (
    str,
    bytes,
    int,
    complex,
    bool,
    type(None),
    Fraction,
    Enum,
    type,
    PurePath,
    range,
    set,
    frozenset,
    FunctionType,
    BuiltinFunctionType,
    ModuleType,
)
EXACT = tuple(kind for kind in vars(flint).values() if isinstance(kind, type))


def differences(one: Any, other: Any, at: str = "") -> Iterator[str]:
    """Places where they differ; what is compared by identity elsewhere is compared by what it holds."""
    if type(one) is not type(other):
        yield f"{at}: {type(one)} and {type(other)}"
    elif isinstance(one, float | np.ndarray | np.generic):
        a, b = np.asarray(one), np.asarray(other)
        if a.dtype != b.dtype or a.shape != b.shape or a.tobytes() != b.tobytes():
            yield f"{at}: {one} and {other}"
    elif isinstance(one, PLAIN):
        if one != other:
            yield f"{at}: {one} and {other}"
    elif isinstance(one, EXACT):
        if repr(one) != repr(other):
            yield f"{at}: {one} and {other}"
    elif isinstance(one, Mapping):
        if list(one) != list(other):
            yield f"{at}: keys {list(one)} and {list(other)}"
        else:
            for key in one:
                yield from differences(one[key], other[key], f"{at}[{key!r}]")
    elif isinstance(one, list | tuple):
        if len(one) != len(other):
            yield f"{at}: {len(one)} and {len(other)} of them"
        for k, (a, b) in enumerate(zip(one, other, strict=False)):
            yield from differences(a, b, f"{at}[{k}]")
    else:
        yield from _members(one, other, at)


def _members(one: Any, other: Any, at: str) -> Iterator[str]:
    parts = []
    for each in (one, other):
        kept = dict(getattr(each, "__dict__", {}))
        slots = {name for kind in type(each).__mro__ for name in getattr(kind, "__slots__", ())}
        kept |= {name: getattr(each, name) for name in slots if hasattr(each, name) and not name.startswith("__")}
        kept |= getattr(each, "__pydantic_private__", None) or {}
        found = {name: value for name, value in kept.items() if not isinstance(value, Beside)}  # others are found anew
        parts.append(dict(sorted(found.items())))  # in whatever order they were set
    if not parts[0] and not parts[1]:
        yield f"{at}: {type(one)} holds nothing that can be compared"
    yield from differences(parts[0], parts[1], at)
