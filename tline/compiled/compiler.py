"""Compilation of a unit by numba: the functions that it calls are linked into it, optimised and translated once.

By default numba optimises every function with all that it calls, and translates each to machine code that is never
run: several times the work. It also looks up the types of `a + b` and the size of a type again wherever they occur.
This file depends on the names of the steps in numba 0.60 to 0.68.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, cast

import numba
from numba import types
from numba.core import typed_passes as typed, untyped_passes as untyped
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager
from numba.core.registry import cpu_target
from numba.core.types.functions import BaseFunction

from tline.compiled.by_reference import Reference
from tline.gc_paused import gc_paused

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}, "_nrt": False}
BARE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
STEPS = (  # numba's steps needed for plain loops over arrays: half the time
    untyped.TranslateByteCode, untyped.FixupArgs, untyped.IRProcessing, untyped.GenericRewrites,
    untyped.ReconstructSSA, typed.NopythonTypeInference, typed.PreLowerStripPhis, typed.IRLegalization,
    typed.NativeLowering, typed.NoPythonBackend,
)  # fmt: skip


class _Steps(CompilerBase):
    """Steps of the compilation of a function."""

    def define_pipelines(self) -> list[Any]:
        """Define the only pipeline, in numba's terms."""
        steps = PassManager("unit")
        for step in STEPS:
            steps.add_pass(step, step._name)
        steps.finalize()
        return [steps]


class _Linked(JITCodeLibrary):
    """Code of a function, and of all that it calls, each once."""

    def add_linking_library(self, library: Any) -> None:
        """Add the code of a called function."""
        library._ensure_finalized()
        self._linking_libraries += [
            each for each in (library, *library._linking_libraries) if each not in self._linking_libraries
        ]

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout


class _Part(_Linked):
    """Code of a function that is linked into units."""

    def finalize(self) -> None:
        """Do nothing, as the unit links and optimises the code."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return no address, as the function is not in memory."""
        return 0


class _Whole(_Linked):
    """Code of a unit; only the unit is called from outside, and no reference is counted."""

    def _optimize_functions(self, ll_module: Any) -> None:
        super()._optimize_functions(ll_module)
        self._names = [f.name for f in ll_module.functions if not f.is_declaration]

    def _optimize_final_module(self) -> None:
        for f in self._final_module.functions:
            if not f.is_declaration and f.name not in self._names:
                f.linkage = "internal"
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


@cache
def _size_of(kind: Any) -> int:
    """Size of an LLVM type in bytes."""
    context: Any = cpu_target.target_context
    return kind.get_abi_size(context.target_data)


@cache
def _signature(operation: Any, arguments: tuple[Any, ...]) -> Any:
    """Types of an operation that numba supports, such as `operator.add`."""
    context: Any = cpu_target.typing_context
    return BaseFunction.get_call_type(operation, context, arguments, {})


def _call_type(operation: Any, context: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
    if named:
        return BaseFunction.get_call_type(operation, context, arguments, named)
    return _signature(operation, arguments)


@contextmanager
def _quickly(name: str) -> Iterator[None]:
    """Let numba generate the code of one unit without repeated look-ups."""
    context: Any = cpu_target.target_context
    codegen, builtin = context.codegen(), cast(Any, types.Function)
    codegen._library_class = lambda owner, made: (_Whole if made == name else _Part)(owner, made)
    codegen.set_env = lambda *_: None  # constants that are Python objects: there are none
    context.get_abi_sizeof, builtin.get_call_type = _size_of, _call_type
    try:
        yield
    finally:
        del codegen._library_class, codegen.set_env, context.get_abi_sizeof, builtin.get_call_type


def dispatcher_of(code: Any) -> Any:
    """Create numba's dispatcher, with one version for each kind of arguments, literal or not."""
    decorate: Any = numba.njit
    dispatcher = decorate(**OPTIONS, **BARE, pipeline_class=_Steps)(code)
    template = dispatcher.get_call_template
    dispatcher.get_call_template = lambda kinds, named: template([types.unliteral(kind) for kind in kinds], named)
    return dispatcher


def compile_unit(code: Any, parameters: list[Any]) -> Any:
    """Compile a function with parameters `int`, `float` or of a structure; returns numba's result.

    Raises TypeError: the function does not return an integer.
    """
    kinds = [{int: types.int64, float: types.float64}.get(kind) or Reference(kind) for kind in parameters]
    dispatcher = dispatcher_of(code)
    with global_compiler_lock, gc_paused(), _quickly(code.__qualname__):
        dispatcher.compile(tuple(kinds))
    (result,) = dispatcher.overloads.values()
    if types.unliteral(result.signature.return_type) != types.int64:
        raise TypeError(f"{code.__module__}.{code.__name__} returns {result.signature.return_type}, not an integer")
    return result
