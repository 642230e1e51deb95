"""Elements and rows of arrays in compiled code, as values of LLVM.

numba writes an array to memory for each access, reads its parts back, and lets negative indices count from the end.
Here all arrays are contiguous and no index is negative, so an access is a tenth of that code.
"""

import operator
from typing import Any

from llvmlite import ir
from numba import types

WORD = ir.IntType(64)
ITEMS, ITEM_SIZE, DATA, SHAPE, STRIDES = range(2, 7)  # places in numba's arrays, behind what counts references


def array_of(context: Any, builder: Any, kind: Any, data: Any, shape: list[Any]) -> Any:
    """Value of a contiguous array."""
    size = ir.Constant(WORD, context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    value, stride, items = ir.Constant(context.get_value_type(kind), None), size, ir.Constant(WORD, 1)
    value = builder.insert_value(builder.insert_value(value, data, DATA), size, ITEM_SIZE)
    for k in range(kind.ndim - 1, -1, -1):
        value = builder.insert_value(value, shape[k], [SHAPE, k])
        value = builder.insert_value(value, stride, [STRIDES, k])
        items = builder.mul(items, shape[k])
        stride = builder.mul(stride, shape[k]) if k else stride
    return builder.insert_value(value, items, ITEMS)


def access_of(context: Any, operation: Any, signature: Any) -> Any:
    """Code for an access by integers to a contiguous array, given the builder and values; None for any other."""
    operation = getattr(operation, "typing_key", operation)
    if operation is not operator.getitem and operation is not operator.setitem:
        return None
    kind, index = signature.args[:2]
    indices = getattr(index, "types", (index,))
    whole = len(indices) == getattr(kind, "ndim", 0)
    if not (
        isinstance(kind, types.Array) and kind.layout == "C" and all(isinstance(i, types.Integer) for i in indices)
    ):
        return None
    if context.enable_boundscheck or (operation is operator.setitem and not whole):
        return None

    def access(builder: Any, values: Any) -> Any:
        array, given = values[:2]
        places = [builder.extract_value(given, k) for k in range(len(indices))] if index is not indices[0] else [given]
        shape, place = [builder.extract_value(array, [SHAPE, k]) for k in range(kind.ndim)], None
        for k in range(kind.ndim):
            if k < len(indices):
                here = context.cast(builder, places[k], indices[k], types.intp if indices[k].signed else types.uintp)
                place = here if place is None else builder.add(builder.mul(place, shape[k]), here)
            else:
                place = builder.mul(place, shape[k])
        data = builder.gep(builder.extract_value(array, DATA), [place])
        if operation is operator.setitem:
            value = context.cast(builder, values[2], signature.args[2], kind.dtype)
            return context.pack_value(builder, kind.dtype, value, data)
        if whole:
            return context.unpack_value(builder, kind.dtype, data)
        return array_of(context, builder, signature.return_type, data, shape[len(indices) :])

    return access
