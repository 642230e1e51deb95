"""A response given by samples on the imaginary axis."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from passivity.errors import ExpressionError, shorten, shown
from passivity.sampled.digits import Rounding
from passivity.status import Kind

MAX_PORTS = 16
MAX_NUMBERS = 1_000_000  # complex numbers in all samples together
MAX_SAMPLES = 20_000  # of a response to which a model is fitted
LARGEST = 1e150  # of a value or frequency: squares stay finite


class Parameter(StrEnum):
    """What the samples are samples of."""

    S = "S"  # scattering matrix or reflection
    Z = "Z"  # impedance
    Y = "Y"  # admittance

    @classmethod
    def _missing_(cls, value: object):
        raise ExpressionError("parameter", "not known", "Z, Y or S", shown(value, repr))

    @property
    def kind(self) -> Kind:
        """What is asked of a passive one."""
        return Kind.BR if self is Parameter.S else Kind.PR


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Z, Y or S of a system with p ports at n frequencies; signals vary as exp(+j 2 pi f t).

    Parameters
    ----------
    f : array_like, shape (n,)
        Frequencies in hertz, increasing, >= 0.
    values : array_like of complex, shape (n,) for one port or (n, p, p)
        Kept as (n, p, p). Z in ohm, Y in siemens; S in power waves.
    parameter : Parameter or str
        "Z", "Y" or "S".
    z0 : float or array_like, shape (p,)
        Reference resistances of S, above zero, ohm; kept as (p,). Without effect on Z and Y.
    rounding : Rounding, optional
        What the digits leave open where the values were read from text.

    Raises
    ------
    ExpressionError
        Naming what does not fit: shapes, order, numbers that are not finite, more than MAX_PORTS or MAX_NUMBERS.

    Examples
    --------
    >>> response = SampledResponse([1e6, 2e6], [50 + 1j, 50 + 2j], "Z")
    >>> response.values.shape
    (2, 1, 1)
    """

    f: Any
    values: Any
    parameter: Any
    z0: Any = 50.0
    rounding: Rounding | None = None

    def __post_init__(self):
        parameter = Parameter(self.parameter)
        f, values = array(self.f, float, "f"), array(self.values, complex, "values")
        if f.ndim != 1 or not len(f):
            raise ExpressionError("f", "not a list of frequencies", "shape (n,), n > 0", f"{f.shape}")
        if values.ndim == 1:
            values = values[:, None, None]
        if values.ndim != 3 or len(values) != len(f) or values.shape[1] != values.shape[2]:
            expected = f"shape ({len(f)},) or ({len(f)}, p, p)"
            raise ExpressionError(
                "values", "not one number or square matrix for each frequency", expected, f"{values.shape}"
            )
        if not 0 < values.shape[1] <= MAX_PORTS or values.size > MAX_NUMBERS:
            expected = f"1 to {MAX_PORTS} ports and at most {MAX_NUMBERS} numbers"
            raise ExpressionError("values", "too few or too many", expected, f"{values.shape}")
        if f[0] < 0 or (np.diff(f) <= 0).any():
            k = int(np.argmax(np.diff(f, prepend=-0.5 if f[0] >= 0 else 0.0) <= 0))
            raise ExpressionError(f"f[{k}]", "out of order", "increasing frequencies >= 0", f"{f[k]:.6g}")
        z0 = array(self.z0, float, "z0")
        if z0.ndim > 1 or z0.size not in (1, values.shape[1]) or (z0 <= 0).any():
            raise ExpressionError(
                "z0", "not a reference resistance", "a number > 0, or one for each port", shorten(shown(self.z0))
            )
        z0 = np.broadcast_to(z0, (values.shape[1],))
        for name, value in (("f", f), ("values", values), ("parameter", parameter), ("z0", z0)):
            object.__setattr__(self, name, value)

    @property
    def ports(self) -> int:
        """Number of ports."""
        return self.values.shape[1]


def array(given: ArrayLike, kind: type, name: str) -> NDArray:
    """A copy as an array of finite numbers that nobody can change; `name` stands in the error."""
    try:
        if kind is float and np.iscomplexobj(given):
            raise TypeError
        found = np.array(given, dtype=kind)
    except (TypeError, ValueError, OverflowError):
        raise ExpressionError(
            name, "not an array of numbers", f"{'real' if kind is float else 'complex'} numbers", type(given).__name__
        ) from None
    good = np.abs(found) <= LARGEST
    if not good.all():
        place = name + "".join(f"[{k}]" for k in np.unravel_index(np.argmin(good), found.shape))
        raise ExpressionError(place, "not a number of reasonable size", f"at most {LARGEST:g}", f"{found[~good][0]:g}")
    found.flags.writeable = False
    return found
