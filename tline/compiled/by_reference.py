"""Types in numba for the structures of `tline.compiled.structure`, and calls between compiled units by address.

Members are read from memory when they are used: nothing is unpacked at the border, no references are counted, and
the code of a function grows with the members it reads, not with all there are.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_untracked
from numba.core.registry import cpu_target
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model
from numba.np.numpy_support import from_dtype

from tline.compiled.structure import Field, fields

WORD, BYTES = ir.IntType(64), 8
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
    data_type = context.get_data_type(member.dtype)
    shape = [_load(builder, pointer, field.word + 1 + k, WORD) for k in range(field.dimensions)]
    size = context.get_abi_sizeof(data_type)
    strides = [ir.Constant(WORD, size)]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent))
    items = ir.Constant(WORD, 1)
    for extent in shape:
        items = builder.mul(items, extent)
    array = context.make_array(member)(context, builder)
    array.data = _load(builder, pointer, field.word, data_type.as_pointer())
    array.nitems, array.itemsize = items, ir.Constant(WORD, size)
    array.shape = cgutils.pack_array(builder, shape, WORD)
    array.strides = cgutils.pack_array(builder, strides, WORD)
    array.meminfo = cgutils.get_null_value(array.meminfo.type)
    array.parent = cgutils.get_null_value(array.parent.type)
    return impl_ret_untracked(context, builder, member, array._getvalue())


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


def type_of(value: Any) -> Any:
    """Type of an intrinsic in numba."""
    context: Any = cpu_target.typing_context
    return context.resolve_value_type(value)
