"""Functions at an address: how compiled code asks a law that is not compiled with it."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _answer(_: Any, address: Any, effort: Any, factor: Any) -> Any:
    """What the C function ``double f(double effort, double factor)`` at an address returns; who calls must hold it."""

    def call(context: Any, builder: Any, _: Any, values: Any) -> Any:
        function = ir.FunctionType(ir.DoubleType(), [ir.DoubleType(), ir.DoubleType()])
        return builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])

    return types.float64(types.int64, types.float64, types.float64), call


answer: Any = intrinsic(_answer)
