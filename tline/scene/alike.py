"""Tables of equal content, of which networks have many: read once, and shared."""

from collections.abc import Mapping
from typing import Any

PLAIN = {str, int, float}  # types compared by value alone, unlike truth values and quantities


def content(table: Mapping[str, Any], besides: str = "") -> tuple[Any, ...] | None:
    """Hashable content of a table without one key, as typed; None if it holds more than numbers, texts and tables.

    Examples
    --------
    >>> content({"nodes": ["a", "b"], "length": 1.0, "friction": {"kind": "darcy"}}, besides="nodes")
    (('length', <class 'float'>, 1.0), ('friction', <class 'dict'>, (('kind', <class 'str'>, 'darcy'),)))
    """
    found = []
    for key, value in table.items():
        kind = type(value)
        if kind in PLAIN:
            found.append((key, kind, value))
        elif kind is dict and (inside := content(value)) is not None:
            found.append((key, kind, inside))
        elif key != besides:
            return None
    return tuple(found)
