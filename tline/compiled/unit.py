"""Compiled units: C functions of addresses and numbers, kept as object code that loads without numba.

A unit is compiled at its first call, with all functions that it calls by name; other units it calls by address. The
code is kept on disk (`tline.compiled.object_code`), valid while all its source code has the same
meaning.
"""

import ctypes
import inspect
from collections.abc import Callable
from functools import cached_property
from typing import Any, get_type_hints

from tline.compiled.object_code import keep, load, sources_for
from tline.compiled.structure import Packed


class Function:
    """Function that is compiled as a part of the units that use it; called from Python, it runs as Python."""

    def __init__(self, function: Callable[..., Any]):
        self.py_func = function

    def __call__(self, *arguments: Any) -> Any:
        """Run the function, uncompiled."""
        return self.py_func(*arguments)

    @cached_property
    def _dispatcher(self) -> Any:
        from tline.compiled.compiler import dispatcher_of

        return dispatcher_of(self.py_func)

    @property
    def _numba_type_(self) -> Any:
        """Type of the function for numba."""
        return self._dispatcher._numba_type_


def function(code: Callable[..., Any]) -> Any:
    """Mark a function that units call by name."""
    return Function(code)


class _Intrinsic:
    """Name in compiled code, defined in `tline.compiled.compiler`."""

    def __init__(self, name: str):
        self._name = name

    @property
    def _numba_type_(self) -> Any:
        from tline.compiled import compiler

        return compiler.type_of(getattr(compiler, self._name))


invoke: Any = _Intrinsic("invoke")
callback: Any = _Intrinsic("callback")
address_of: Any = _Intrinsic("address_of")


class Unit:
    """Function that is compiled alone, for one signature, and called from Python and by its address.

    Parameters
    ----------
    code : function
        Its parameters are annotated: `int`, `float`, or the class of a structure (`tline.compiled.structure`), passed
        by reference. It returns an `int`, allocates nothing, raises nothing, and has no negative index.
    long_loops : bool
        Whether its loops are long, so that it is worth while to vectorise and unroll them.
    """

    def __init__(self, code: Callable[..., Any], long_loops: bool = False):
        self.long_loops = long_loops
        self.code, self.__doc__, self.__name__, self.__module__ = code, code.__doc__, code.__name__, code.__module__
        self.sources = sources_for(code.__module__)

    @cached_property
    def parameters(self) -> list[Any]:
        """Types of the parameters."""
        hints = get_type_hints(self.code)
        return [hints[name] for name in inspect.signature(self.code).parameters]

    @cached_property
    def _loaded(self) -> tuple[int, Any]:
        """Address of the code, and the object that keeps it alive."""
        return load(self) or self._compiled()

    @property
    def address(self) -> int:
        """Address of the code, for other units; compiles it if need be."""
        return self._loaded[0]

    @cached_property
    def _native(self) -> Any:
        kinds = [ctypes.c_double if kind is float else ctypes.c_int64 for kind in self.parameters]
        prototype = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *kinds)
        return prototype(self.address)

    def __call__(self, *arguments: Any) -> int:
        """Run the unit; structures are given packed."""
        result, error = ctypes.c_int64(), ctypes.c_void_p()
        given = [each.address if isinstance(each, Packed) else each for each in arguments]
        if self._native(ctypes.addressof(result), ctypes.addressof(error), *given):
            raise RuntimeError(f"{self.__module__}.{self.__name__}: an access outside an array")
        return result.value

    def _compiled(self) -> tuple[int, Any]:
        from tline.compiled.announce import announced, counted
        from tline.compiled.compiler import compile_unit

        with counted(), announced(self.__module__):
            result = compile_unit(self.code, self.parameters, self.long_loops)
        keep(self, result.fndesc.llvm_func_name, result.library)
        return result.library.get_pointer_to_function(result.fndesc.llvm_func_name), result


def unit(code: Callable[..., Any]) -> Unit:
    """Make a unit of a function.

    Examples
    --------
    >>> @unit
    ... def double(n: int) -> int:
    ...     return 2 * n
    >>> double(21)
    42
    """
    return Unit(code)


def unit_of_long_loops(code: Callable[..., Any]) -> Unit:
    """Make a unit of a function with long loops, to be vectorised and unrolled."""
    return Unit(code, long_loops=True)
