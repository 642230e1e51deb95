"""Compilation of a unit by numba: the functions that it calls are linked into it, optimised and translated once.

By default numba optimises every function with all that it calls, and translates each to machine code that is never
run: several times the work. It also looks up the types of `a + b` and the size of a type again wherever they occur.
Structures of `tline.compiled.structure` are passed by reference; units call each other by address.

This file depends on the names of the steps in numba 0.60 to 0.68.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, cast

import numba
import numpy as np
from llvmlite import binding as llvm, ir
from numba import types
from numba.core import cgutils, typed_passes as typed, untyped_passes as untyped
from numba.core.base import BaseContext
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager
from numba.core.registry import cpu_target
from numba.core.types.functions import BaseFunction
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model
from numba.np.numpy_support import from_dtype

from tline.compiled.indexing import WORD, access_of, array_of
from tline.compiled.structure import Field, fields
from tline.gc_paused import gc_paused

BYTES = 8
INVARIANT = "invariant.load"  # no word changes while compiled code runs


class Reference(types.Type):
    """Address of a packed structure."""

    def __init__(self, structure: type):
        self.structure = structure
        self.members = {field.name: field for field in fields(structure)}
        super().__init__(f"Reference({structure.__module__}.{structure.__qualname__}{fields(structure)})")


@register_model(Reference)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any):
        super().__init__(manager, kind, WORD.as_pointer())


def _type(field: Field) -> Any:
    if field.dimensions >= 0:
        return types.Array(from_dtype(np.dtype(field.kind)), field.dimensions, "C")
    return {int: types.int64, float: types.float64}.get(field.kind) or Reference(field.kind)


@infer_getattr
class _Members(AttributeTemplate):
    key = Reference

    def generic_resolve(self, value: Any, attr: str) -> Any:
        return _type(value.members[attr]) if attr in value.members else None


def _load(builder: Any, pointer: Any, word: int, kind: Any) -> Any:
    place = builder.gep(pointer, [ir.Constant(ir.IntType(32), word)])
    loaded = builder.load(builder.bitcast(place, kind.as_pointer()))
    loaded.set_metadata(INVARIANT, builder.module.add_metadata([]))
    return loaded


@lower_getattr_generic(Reference)
def _member(context: Any, builder: Any, kind: Any, pointer: Any, attr: str) -> Any:
    field = kind.members[attr]
    member = _type(field)
    if field.dimensions < 0:
        loaded = _load(builder, pointer, field.word, context.get_value_type(member))
        if isinstance(member, Reference):  # it may be read ahead of time, out of a loop
            size = ir.Constant(WORD, BYTES * sum(inner.words for inner in member.members.values()))
            loaded.set_metadata("dereferenceable", builder.module.add_metadata([size]))
        return loaded
    shape = [_load(builder, pointer, field.word + 1 + k, WORD) for k in range(field.dimensions)]
    data = _load(builder, pointer, field.word, context.get_data_type(member.dtype).as_pointer())
    return array_of(context, builder, member, data, shape)


@intrinsic
def invoke(_: Any, address: Any, arguments: Any) -> Any:
    """Call the unit at an address; returns its integer."""

    def call(context: Any, builder: Any, _: Any, values: Any) -> Any:
        given = cgutils.unpack_tuple(builder, values[1])
        info = ir.IntType(BYTES).as_pointer()
        kinds = [value.type for value in given]
        function = ir.FunctionType(ir.IntType(32), [WORD.as_pointer(), info.as_pointer(), *kinds])
        result, error = cgutils.alloca_once(builder, WORD), cgutils.alloca_once(builder, info)
        builder.call(builder.inttoptr(values[0], function.as_pointer()), [result, error, *given])
        return builder.load(result)

    return types.int64(types.int64, arguments), call


@intrinsic
def callback(_: Any, address: Any, effort: Any, control: Any) -> Any:
    """Value of the C function ``double f(double effort, double control)`` at an address."""

    def call(context: Any, builder: Any, _: Any, values: Any) -> Any:
        function = ir.FunctionType(ir.DoubleType(), [ir.DoubleType(), ir.DoubleType()])
        return builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])

    return types.float64(types.int64, types.float64, types.float64), call


@intrinsic
def address_of(_: Any, structure: Any) -> Any:
    """Address of a structure, to be handed on to a unit that the one in between does not know."""
    return types.int64(structure), lambda _, builder, __, values: builder.ptrtoint(values[0], WORD)


def type_of(value: Any) -> Any:
    """Type of an intrinsic in numba."""
    context: Any = cpu_target.typing_context
    return context.resolve_value_type(value)


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

    long_loops = False

    def _optimize_functions(self, ll_module: Any) -> None:
        super()._optimize_functions(ll_module)
        self._names = [f.name for f in ll_module.functions if not f.is_declaration]

    def _optimize_final_module(self) -> None:
        for f in self._final_module.functions:
            if not f.is_declaration and f.name not in self._names:
                f.linkage = "internal"
        tuning = llvm.create_pipeline_tuning_options(3 if self.long_loops else 2)
        tuning.loop_vectorization = tuning.slp_vectorization = self.long_loops
        tuning.loop_interleaving = tuning.loop_unrolling = self.long_loops
        builder = llvm.create_pass_builder(self._codegen._tm, tuning)
        builder.getModulePassManager().run(self._final_module, builder)


class _WholeOfLongLoops(_Whole):
    long_loops = True


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


def _code_of(context: Any, operation: Any, signature: Any, **named: Any) -> Any:
    return access_of(context, operation, signature) or BaseContext.get_function(context, operation, signature, **named)


@contextmanager
def _quickly(name: str, whole: type[_Whole]) -> Iterator[None]:
    """Let numba generate the code of one unit without repeated look-ups, and by simpler accesses to arrays."""
    context: Any = cpu_target.target_context
    codegen, builtin, generator = context.codegen(), cast(Any, types.Function), cast(Any, type(context))
    codegen._library_class = lambda owner, made: (whole if made == name else _Part)(owner, made)
    codegen.set_env = lambda *_: None  # constants that are Python objects: there are none
    context.get_abi_sizeof, builtin.get_call_type = _size_of, _call_type
    generator.get_function = _code_of  # of copies for a function each, too
    try:
        yield
    finally:
        del codegen._library_class, codegen.set_env, context.get_abi_sizeof, builtin.get_call_type
        del generator.get_function


def dispatcher_of(code: Any) -> Any:
    """Create numba's dispatcher, with one version for each kind of arguments, literal or not."""
    decorate: Any = numba.njit
    dispatcher = decorate(**OPTIONS, **BARE, pipeline_class=_Steps)(code)
    template = dispatcher.get_call_template
    dispatcher.get_call_template = lambda kinds, named: template([types.unliteral(kind) for kind in kinds], named)
    return dispatcher


def compile_unit(code: Any, parameters: list[Any], long_loops: bool = False) -> Any:
    """Compile a function with parameters `int`, `float` or of a structure; returns numba's result.

    Loops over the few points of a slab are slower vectorised or unrolled, and take twice as long to compile.

    Raises TypeError: the function does not return an integer.
    """
    kinds = [{int: types.int64, float: types.float64}.get(kind) or Reference(kind) for kind in parameters]
    dispatcher = dispatcher_of(code)
    with global_compiler_lock, gc_paused(), _quickly(code.__qualname__, _WholeOfLongLoops if long_loops else _Whole):
        dispatcher.compile(tuple(kinds))
    (result,) = dispatcher.overloads.values()
    if types.unliteral(result.signature.return_type) != types.int64:
        raise TypeError(f"{code.__module__}.{code.__name__} returns {result.signature.return_type}, not an integer")
    return result
