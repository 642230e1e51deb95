"""Law of a line: the series impedance or the shunt admittance per metre, exactly."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from math import ceil, log2
from numbers import Real
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError

if TYPE_CHECKING:
    from flint import acb

SMALL_Z, LARGE_Z = 1e-4, 1e8  # of |z|: there two terms of its expansions give the quotient to rounding
MOST_DIGITS = 1_000
MOST_BITS = 20_000


def positive(**parameters: float) -> None:
    """Raise an error for a parameter that is not a finite number above zero."""
    for name, value in parameters.items():
        if not (_finite(value) and value > 0):
            raise InputError(name, "not positive", "a finite number above 0", repr(value))


def not_negative(**parameters: float) -> None:
    """Raise an error for a parameter that is not a finite number from zero on."""
    for name, value in parameters.items():
        if not (_finite(value) and value >= 0):
            raise InputError(name, "negative or no number", "a finite number from 0 on", repr(value))


def _finite(value: object) -> bool:
    return (type(value) is float or isinstance(value, Real)) and math.isfinite(value)


class Arithmetic(NamedTuple):
    """Functions of a complex argument, principal branches."""

    sqrt: Callable[[Any], Any]
    log1p: Callable[[Any], Any]
    # (n, z) to z I_n(z)/I_{n+1}(z), I the modified Bessel functions: 2(n+1) + z²/(2(n+2)) + ... at 0 and z + n + 1/2
    # + ... far out
    quotient: Callable[[int, Any], Any]
    log_ratio: Callable[[Any], Any]  # z to z ln((z + 1)/z): 0 at 0 and 1 - 1/(2z) + ... far out; not for Re z < 0


def _quotient(n: int, z: NDArray) -> NDArray:
    from scipy.special import ive

    size = np.abs(z)
    ordinary = (size > SMALL_Z) & (size < LARGE_Z)
    inside = np.where(ordinary, z, 1)
    beside = np.where(size <= SMALL_Z, 2 * (n + 1) + z * z / (2 * (n + 2)), z + n + 0.5)
    return np.where(ordinary, inside * ive(n, inside) / ive(n + 1, inside), beside)


def _log_ratio(z: NDArray) -> NDArray:
    near = np.abs(z) < 1
    inside, outside = np.where(near & (z != 0), z, 1), np.where(near, 1, z)
    return z * np.where(near, np.log(1 + inside) - np.log(inside), 2 * np.arctanh(1 / (2 * outside + 1)))


def _ball_quotient(n: int, z: "acb") -> "acb":
    from flint import acb

    if z == 0:
        return acb(2 * (n + 1))
    return z * z.bessel_i(acb(n), scaled=True) / z.bessel_i(acb(n + 1), scaled=True)


def _ball_log_ratio(z: "acb") -> "acb":
    return z if z == 0 else z * (1 / z).log1p()


DOUBLES = Arithmetic(np.sqrt, np.log1p, _quotient, _log_ratio)
BALLS = Arithmetic(lambda z: z.sqrt(), lambda z: z.log1p(), _ball_quotient, _ball_log_ratio)


class ByValue:
    """Equality and hash by the attributes, arrays by their entries; cached values are ignored."""

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


class Shape(NamedTuple):
    """Part of a law beyond loss and storage as size·law(s/rate), with a law that many share."""

    law: "Law"
    rate: float  # 1/s
    size: float  # of the immittance per metre


class Law(ByValue, ABC):
    """Law F(s) = s·storage + beyond(s): a passive immittance per metre that never resonates.

    All laws are complete Bernstein functions: analytic off the negative real axis, with arg F between 0 and arg s. So
    they are positive real, roots of products of two are analytic there too, and each is the limit of circuits as in
    `Foster`. The doubles below count as exact at any precision.

    Parameters
    ----------
    loss : float
        F(0): resistance or conductance to steady flow, ohm/m or S/m (Pa s/m⁴ or m²/(Pa s)).
    storage : float
        Limit of F(s)/s for s to infinity, which a front meets, H/m or F/m (kg/m⁵ or m²/Pa).

    Notes
    -----
    Laws add up: ``+`` puts impedances in series, admittances side by side.

    References
    ----------
    R. L. Schilling, R. Song, Z. Vondracek, Bernstein Functions, 2nd ed., De Gruyter 2012, chapters 6 and 7,
    doi:10.1515/9783110269338.
    """

    shape: Shape | None = None  # what it shares with others of its kind

    def __init__(self, loss: float, storage: float):
        self.loss, self.storage = float(loss), float(storage)

    @abstractmethod
    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Compute F(s) - s·storage, without cancellation, in the arithmetic of s."""

    def value(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Compute F(s) in the arithmetic of s."""
        return s * self.storage + self.beyond(s, arithmetic)

    def at(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Compute F(s) in doubles.

        Parameters
        ----------
        s : array_like of complex
            Laplace variable, 1/s, off the negative real axis.

        Returns
        -------
        ndarray of complex, shape of s

        Raises
        ------
        InputError
            A point that is not finite, or negative.
        """
        return self.value(points(s), DOUBLES)

    def at_precision(self, s: "complex | acb", digits: int) -> "acb":
        """Compute F(s) as a ball whose radius is below 10^-digits of it: a proved value.

        Parameters
        ----------
        s : complex or flint.acb
            Laplace variable, 1/s, off the negative real axis; taken as exact.
        digits : int
            From 1 to 1000.

        Raises
        ------
        InputError
            Bad digits, or a point on which no ball gets that small.
        """
        from flint import acb, ctx

        if not 1 <= digits <= MOST_DIGITS:
            raise InputError("digits", "not in range", f"1 to {MOST_DIGITS}", repr(digits))
        asked = ceil(digits * log2(10)) + 1
        bits = asked + 32
        while bits <= MOST_BITS:
            with ctx.workprec(bits):
                value: Any = self.value(acb(s), BALLS)
            if value.is_zero() or value.rel_accuracy_bits() >= asked:
                return value
            bits *= 2
        raise InputError("s", f"no {digits} digits there", "a point off the negative real axis", f"{s}")

    def __add__(self, other: "Law") -> "Sum":
        return Sum(self, other)


class Sum(Law):
    """Sum of laws.

    Parameters
    ----------
    *laws : Law

    Examples
    --------
    >>> from tline.loss import ConstantLoss, SkinEffect
    >>> print((ConstantLoss(5.0, 250e-9) + SkinEffect(0.0, 1e-3)).at(1e6j).round(3))
    (5.707+0.957j)
    """

    def __init__(self, *laws: Law):
        super().__init__(sum(law.loss for law in laws), sum(law.storage for law in laws))
        self.laws = laws

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Sum of all parts."""
        return sum((law.beyond(s, arithmetic) for law in self.laws), start=0 * s)


def points(s: ArrayLike) -> NDArray[np.complex128]:
    """Points of the plane cut along the negative real axis."""
    found: NDArray[np.complex128] = np.asarray(s, np.complex128)
    bad = ~np.isfinite(found) | ((found.imag == 0) & (found.real < 0))
    if bad.any():
        raise InputError("s", "no value there", "finite points off the negative real axis", f"{found[bad].flat[0]}")
    return found


class ConstantLoss(Law):
    """Constant law R + s L as an impedance, G + s C as an admittance, per metre.

    Parameters
    ----------
    loss : float
        R or G, from 0: ohm/m, S/m (Pa s/m⁴, m²/(Pa s)).
    storage : float
        L or C, from 0: H/m, F/m (kg/m⁵, m²/Pa).

    Raises
    ------
    InputError
        A negative parameter.

    References
    ----------
    O. Heaviside, Electrical Papers II, Macmillan 1892: the telegrapher's equations.

    Examples
    --------
    >>> print(ConstantLoss(20, 250e-9).at(1e8j))
    (20+25j)
    """

    def __init__(self, loss: float, storage: float = 0.0):
        not_negative(loss=loss, storage=storage)
        super().__init__(loss, storage)

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return R."""
        return 0 * s + self.loss
