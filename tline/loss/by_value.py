"""Objects that are equal when all they were made of is."""

from functools import cached_property
from typing import Any

import numpy as np


class ByValue:
    """Equality and hash by the attributes, arrays by their entries; what is cached beside them does not count."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _content(self) == _content(other)

    def __hash__(self) -> int:
        return hash((type(self), _content(self)))


def _content(part: Any) -> tuple[Any, ...]:
    kind = type(part)
    return tuple(
        (name, value.tobytes() if isinstance(value, np.ndarray) else value)
        for name, value in vars(part).items()
        if not isinstance(getattr(kind, name, None), cached_property)
    )
