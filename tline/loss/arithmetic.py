"""The functions that laws are made of, in doubles and in balls: a law is written once and evaluated in both."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from flint import acb

SMALL, LARGE = 1e-4, 1e8  # of |z|: there two terms of its expansions give the quotient to rounding


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
    ordinary = (size > SMALL) & (size < LARGE)
    inside = np.where(ordinary, z, 1)
    beside = np.where(size <= SMALL, 2 * (n + 1) + z * z / (2 * (n + 2)), z + n + 0.5)
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
