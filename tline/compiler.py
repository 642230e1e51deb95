"""How numba compiles a unit: the functions that it calls are linked into it, optimised and translated once, with it.

Left alone, numba optimises every function with all that it calls, and translates each to machine code that nobody runs:
several times the work. The classes of this file lean on how numba 0.60 to 0.68 names its steps.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numba
from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

from tline.by_reference import Reference


class _Part(JITCodeLibrary):
    """Code of a function that is linked into units."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        """Left to the unit."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """It is nowhere in memory."""
        return 0


class _Whole(JITCodeLibrary):
    """Code of a unit; nothing but the unit is called from outside, and no reference is counted."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout
        self._names = [f.name for f in ll_module.functions if not f.is_declaration]

    def _optimize_final_module(self) -> None:
        for f in self._final_module.functions:
            if not f.is_declaration and f.name not in self._names:
                f.linkage = "internal"
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


@contextmanager
def _libraries(name: str) -> Iterator[None]:
    context: Any = cpu_target.target_context
    codegen = context.codegen()
    codegen._library_class = lambda owner, made: (_Whole if made == name else _Part)(owner, made)
    codegen.set_env = lambda *_: None  # constants that are Python objects: there are none
    try:
        yield
    finally:
        del codegen._library_class, codegen.set_env


def compile_unit(code: Any, parameters: list[Any], options: dict[str, Any]) -> Any:
    """Compile a function with parameters `int`, `float` or of a structure; gives what numba makes of it.

    Raises
    ------
    TypeError
        The function does not return an integer.
    """
    kinds = [{int: types.int64, float: types.float64}.get(kind) or Reference(kind) for kind in parameters]
    decorate: Any = numba.njit
    dispatcher = decorate(**options, _nrt=False)(code)
    with global_compiler_lock, _libraries(code.__qualname__):
        dispatcher.compile(tuple(kinds))
    (result,) = dispatcher.overloads.values()
    if types.unliteral(result.signature.return_type) != types.int64:
        raise TypeError(f"{code.__module__}.{code.__name__} returns {result.signature.return_type}, not an integer")
    return result
