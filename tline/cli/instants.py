"""Instants that an option names: from one to another, so many."""

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.units import to_si

EXPECTED = "FROM:TO:COUNT, such as '0:1 us:1001'"
MOST = 10_000_000


def instants(text: str, where: str) -> NDArray:
    """Instants, s, apart by equal times, first and last included.

    Examples
    --------
    >>> instants("0:1 us:3", "--at").tolist()
    [0.0, 5e-07, 1e-06]
    """
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 3:
        raise InputError(where, "not two instants and a count", EXPECTED, f"'{text}'")
    first, last = (to_si(part, "s", where) for part in parts[:2])
    count = int(parts[2]) if parts[2].isdecimal() and len(parts[2]) <= len(str(MOST)) else 0
    if not 2 <= count <= MOST:
        raise InputError(where, "not a count", f"2 to {MOST:,} instants", f"'{parts[2]}'")
    if not 0 <= first < last:
        raise InputError(where, "does not run from an instant to a later one", EXPECTED, f"'{text}'")
    return np.linspace(first, last, count)
