"""Structures that compiled code reads by reference: one row of words, each a number or an address.

A structure is declared as a named tuple whose members are `int`, `float`, arrays of this module's kinds, or other
structures. `pack` writes it once; compiled code gets one address, however many arrays there are.
"""

from collections.abc import Callable, Mapping
from ctypes import addressof, c_char
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Floats = Annotated[NDArray[np.float64], np.float64, 1]
Floats2 = Annotated[NDArray[np.float64], np.float64, 2]
Floats3 = Annotated[NDArray[np.float64], np.float64, 3]
Floats4 = Annotated[NDArray[np.float64], np.float64, 4]
Floats5 = Annotated[NDArray[np.float64], np.float64, 5]
Integers = Annotated[NDArray[np.int64], np.int64, 1]
Integers2 = Annotated[NDArray[np.int64], np.int64, 2]
Flags = Annotated[NDArray[np.bool_], np.bool_, 1]


class Field(NamedTuple):
    """Member of a structure: its first word, and its kind."""

    name: str
    word: int
    kind: Any  # int, float, the class of a structure, or the type of an array's elements
    dimensions: int  # of an array, whose words are its address and its shape; -1 otherwise
    shape: tuple[tuple[str, int], ...] = ()  # of a workspace: each dimension is a size by name, or none, and a number

    @property
    def words(self) -> int:
        """Number of words of the member."""
        return 1 + max(self.dimensions, 0)


@cache
def fields(structure: type) -> tuple[Field, ...]:
    """Members of a structure in order. Raises TypeError: a member has a type that compiled code cannot read."""
    found: list[Field] = []
    word = 0
    for name, hint in get_type_hints(structure, include_extras=True).items():
        kind, dimensions, shape = hint, -1, [""]
        if get_origin(hint) is Annotated:
            _, kind, dimensions, *shape = get_args(hint)
        elif hint not in (int, float) and not hasattr(hint, "_fields"):
            raise TypeError(f"{structure.__name__}.{name}: compiled code cannot read {hint}")
        sizes = [size.partition("+")[::2] for each in shape for size in each.split()]
        own = tuple(("", int(size)) if size.isdigit() else (size, int(more or 0)) for size, more in sizes)
        found.append(Field(name, word, kind, dimensions, own))
        word += found[-1].words
    return tuple(found)


@cache
def empty(structure: Any) -> Any:
    """Return the structure without content: arrays of no length, and zeros.

    Examples
    --------
    >>> class Both(NamedTuple):
    ...     number: int
    ...     values: Floats2
    >>> empty(Both)
    Both(number=0, values=array([], shape=(0, 0), dtype=float64))
    """
    found = []
    for field in fields(structure):
        if field.dimensions >= 0:
            found.append(np.zeros((0,) * field.dimensions, field.kind))
        else:
            found.append(field.kind(0) if field.kind in (int, float) else empty(field.kind))
    return structure(*found)


def allocated(structure: Any, sizes: Mapping[str, int], make: Callable = np.zeros, **given: Any) -> Any:
    """Create a structure of zeros, whose arrays have the shapes that are declared with them, beside members `given`.

    `make` is `numpy.empty` where what is in large arrays does not matter.

    Examples
    --------
    >>> class Work(NamedTuple):
    ...     steps: Annotated[Floats2, "n n+1"]
    ...     largest: Annotated[Floats, "1"]
    >>> allocated(Work, {"n": 2}).steps.shape
    (2, 3)
    """
    sizes = {"": 0, **sizes}
    return structure._make(
        [
            given[name] if name in given else make(tuple([sizes[size] + more for size, more in shape]), kind)
            for name, _, kind, _, shape in fields(structure)
        ]
    )


class Packed:
    """Structure in memory, and all that its words point to.

    Attributes
    ----------
    structure : type
        Its declaration.
    values : NamedTuple
        Values that were packed.
    address : int
        Address of its first word; valid as long as this object.
    """

    __slots__ = ("_floats", "_inner", "_words", "address", "structure", "values")

    def __init__(self, values: Any):
        self.structure = type(values)
        last = fields(self.structure)[-1]
        words = bytearray(8 * (last.word + last.words))
        self._words, self._floats = memoryview(words).cast("q"), memoryview(words).cast("d")
        self._inner: dict[str, Packed] = {}
        self.values, self.address = (), addressof(c_char.from_buffer(words))
        self.write(values)

    def write(self, values: Any) -> None:
        """Replace the values of this structure; members that are the same object stay."""
        words, before = self._words, self.values or (None,) * len(values)
        for (name, word, kind, dimensions, _), value, old in zip(fields(self.structure), values, before, strict=True):
            if value is old:
                continue
            if dimensions >= 0:
                at = _address(value) if value.dtype == kind and value.ndim == dimensions else None
                if at is None:
                    kind = f"a contiguous array of {dimensions} dimensions of {kind.__name__}"
                    raise TypeError(f"{self.structure.__name__}.{name}: {kind} is needed, not {value!r}")
                words[word] = at
                for k, size in enumerate(value.shape, word + 1):
                    words[k] = size
            elif kind is int:
                words[word] = value
            elif kind is float:
                self._floats[word] = value
            elif isinstance(value, Packed):
                words[word] = value.address
            else:
                if name in self._inner:
                    self._inner[name].write(value)
                else:
                    self._inner[name] = Packed(value)
                words[word] = self._inner[name].address
        self.values = values


def _address(array: NDArray[Any]) -> int | None:
    """Address of the first element of an array; None if not contiguous. Through its buffer, ten times as fast."""
    if not array.size:
        return 0  # which is never read
    try:
        return addressof(c_char.from_buffer(array))  # type: ignore[arg-type]
    except TypeError:  # not contiguous, or read only
        return array.__array_interface__["data"][0] if array.flags.c_contiguous else None


def pack(values: Any) -> Any:
    """Write a structure for compiled code, which reads and writes the arrays themselves, as a `Packed`.

    Parameters
    ----------
    values : NamedTuple
        Of a class whose members are declared by kinds of this module. A member that is a structure may be packed.

    Raises
    ------
    TypeError
        An array is not of the declared kind.

    Examples
    --------
    >>> class Pair(NamedTuple):
    ...     scale: float
    ...     values: Floats
    >>> [field.word for field in fields(Pair)], pack(Pair(2.0, np.zeros(3))).values.scale
    ([0, 1], 2.0)
    """
    return Packed(values)
