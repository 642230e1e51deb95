"""Tuples of arrays lent to a call: handed on as one pointer, and references to their arrays are not counted.

A tuple of fifty arrays by value is some three hundred arguments, of every call; counting is atomic. Both take longer
than most of what a small kernel does, and than its arithmetic takes to compile.
"""

from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_untracked
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model


class Lent(types.Type):
    """A named tuple that someone else holds: its members are read by name, and are lent as well."""

    def __init__(self, whole: Any):
        self.whole = whole
        super().__init__(f"Lent({whole})")


@register_model(Lent)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any):
        super().__init__(manager, kind, manager.lookup(kind.whole).get_value_type().as_pointer())


@infer_getattr
class _Members(AttributeTemplate):
    key = Lent

    def generic_resolve(self, value: Any, attr: str) -> Any:
        if attr in value.whole.fields:
            return _lent(value.whole[value.whole.fields.index(attr)])
        return None


@lower_getattr_generic(Lent)
def _member(context: Any, builder: Any, kind: Any, pointer: Any, attr: str) -> Any:
    place = kind.whole.fields.index(attr)
    member = cgutils.gep_inbounds(builder, pointer, 0, place)
    if isinstance(_lent(kind.whole[place]), Lent):
        return member
    return impl_ret_untracked(context, builder, kind.whole[place], builder.load(member))


def _lent(kind: Any) -> Any:
    return Lent(kind) if isinstance(kind, types.BaseNamedTuple) else kind


def _release(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The same without owners."""
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
    """An array or a named tuple of arrays and named tuples, without an owner; who calls must hold it meanwhile."""

    def lend(context: Any, builder: Any, _: Any, values: Any) -> Any:
        value = _release(context, builder, given, values[0])
        if not isinstance(given, types.BaseNamedTuple):
            return value
        place = cgutils.alloca_once(builder, value.type)
        builder.store(value, place)
        return place

    return _lent(given)(given), lend


borrowed: Any = intrinsic(_borrowed)
