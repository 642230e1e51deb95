"""Arrays whose references are not counted, for the length of a call that is given them.

Counting is atomic and takes longer than most of what a small kernel does.
"""

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


def _release(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    if isinstance(kind, types.Array):
        array = cgutils.create_struct_proxy(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        for place, inner in enumerate(members):
            part = _release(context, builder, inner, builder.extract_value(value, place))
            value = builder.insert_value(value, part, place)
    return value


def _borrowed(_: Any, given: Any) -> Any:
    """The same array, or tuple of arrays and of tuples, without an owner; who calls must hold it meanwhile."""
    return given(given), lambda context, builder, _, values: _release(context, builder, given, values[0])


def _hold(_: Any, given: Any) -> Any:
    """Do nothing, but be the last to use what others have borrowed until now."""
    return types.none(given), lambda context, builder, signature, values: context.get_dummy_value()


borrowed: Any = intrinsic(_borrowed)
hold: Any = intrinsic(_hold)
