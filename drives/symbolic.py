"""The transfer functions in closed form, over any ring: with symbols for the parameters, or with exact numbers.

With a_i = J_i*s + B_i, b_i = K_i + B_bi*s, c = cos(theta) and E = 4*c^2*b1*b2 + k*(b1 + b2), where k + m*s^2 takes the
place of k if the pulley has a mass:

    Delta = s*a1*a2*E + k*b1*b2*(r2^2*a1 + r1^2*a2)
    f   = k*b1*b2*(r1*a2*T1 + r2*a1*T2)/Delta                  x_k = -2*c*f/k
    w1  = (-(s*a2*E + k*b1*b2*r2^2)*T1 + r1*r2*k*b1*b2*T2)/Delta
    w2  = (-r1*r2*k*b1*b2*T1 + (s*a1*E + k*b1*b2*r1^2)*T2)/Delta
    phi = w/s,  belt_speed = (r1*w1 + r2*w2)/2
"""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from flint import Ordering, fmpq_poly, fmpz_mpoly, fmpz_mpoly_ctx

from drives.number import known_names, rational
from drives.transfer import TransferFunction

INPUTS = ("T1", "T2")
OUTPUTS = ("x_k", "tension", "belt_speed", "w1", "w2", "phi1", "phi2")
UNITS = {"x_k": "m", "tension": "N", "belt_speed": "m/s", "w1": "rad/s", "w2": "rad/s", "phi1": "rad", "phi2": "rad"}
ALL_UNITS = UNITS | {"T1": "N m", "T2": "N m", "r1": "m", "r2": "m", "J1": "kg m^2", "J2": "kg m^2"}
SYMBOLS = ("s", "J1", "B1", "r1", "J2", "B2", "r2", "K1", "Bb1", "K2", "Bb2", "k", "c")


class Parameters(NamedTuple):
    """s and the parameters, in one ring."""

    s: Any
    J1: Any
    B1: Any
    r1: Any
    J2: Any
    B2: Any
    r2: Any
    K1: Any
    Bb1: Any
    K2: Any
    Bb2: Any
    k: Any
    c: Any
    c_squared: Any


def fractions_of(p: Parameters) -> dict[tuple[str, str], tuple[Any, Any]]:
    """Numerator and denominator for each (output, input), nothing cancelled."""
    s, k, r1, r2 = p.s, p.k, p.r1, p.r2
    a1, a2 = p.J1 * s + p.B1, p.J2 * s + p.B2
    b1, b2 = p.K1 + p.Bb1 * s, p.K2 + p.Bb2 * s
    e = 4 * p.c_squared * b1 * b2 + k * (b1 + b2)
    bb = b1 * b2
    delta = s * a1 * a2 * e + k * bb * (r2 * r2 * a1 + r1 * r1 * a2)
    per_stretch = {"T1": bb * r1 * a2, "T2": bb * r2 * a1}  # f/k
    w1 = {"T1": -(s * a2 * e + k * bb * r2 * r2), "T2": r1 * r2 * k * bb}
    w2 = {"T1": -r1 * r2 * k * bb, "T2": s * a1 * e + k * bb * r1 * r1}
    found = {}
    for source in INPUTS:
        found["x_k", source] = -2 * p.c * per_stretch[source], delta
        found["tension", source] = k * per_stretch[source], delta
        found["belt_speed", source] = r1 * w1[source] + r2 * w2[source], 2 * delta
        found["w1", source] = w1[source], delta
        found["w2", source] = w2[source], delta
        found["phi1", source] = w1[source], s * delta
        found["phi2", source] = w2[source], s * delta
    return found


def transfer(parameters: Mapping[str, Fraction], output: str, source: str) -> TransferFunction:
    """Transfer function for given parameters, exact; common factors are cancelled.

    Parameters
    ----------
    parameters : mapping of str to Fraction
        Those of `CoupledDrives.parameters`; a negative k is the exercise's pulley with the wrong sign.
    output, source : str
        Of ``OUTPUTS`` and ``INPUTS``.
    """
    known_names("output", (output,), OUTPUTS)
    known_names("input", (source,), INPUTS)
    constants = {name: fmpq_poly([rational(value)]) for name, value in parameters.items()}
    constants["k"] += constants.pop("m") * fmpq_poly([0, 0, 1])  # mass moving with the spring
    numerator, denominator = fractions_of(Parameters(s=fmpq_poly([0, 1]), **constants))[output, source]
    return TransferFunction(numerator, denominator, f"{output}/{source}")


def symbolic_transfer(output: str, source: str, *, equal: bool = False) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Transfer function with symbols for all parameters, common factors cancelled.

    Parameters
    ----------
    output, source : str
        Of ``OUTPUTS`` and ``INPUTS``.
    equal : bool
        Write J, B, r, K, Bb for both sides.

    Returns
    -------
    tuple of flint.fmpz_mpoly
        Numerator and denominator, polynomials in ``SYMBOLS`` or in s, J, B, r, K, Bb, k, c; c is cos(theta).

    Raises
    ------
    InputError
        An unknown name.

    Examples
    --------
    >>> for side in symbolic_transfer("belt_speed", "T2", equal=True):
    ...     print(side)
    r
    2*s*J + 2*B
    """
    known_names("output", (output,), OUTPUTS)
    known_names("input", (source,), INPUTS)
    written = [name.rstrip("12") if equal else name for name in SYMBOLS]
    names = tuple(dict.fromkeys(written))
    ring = fmpz_mpoly_ctx.get(names, Ordering.lex)
    symbol = dict(zip(names, ring.gens(), strict=True))
    given = [symbol[name] for name in written]
    numerator, denominator = fractions_of(Parameters(*given, c_squared=symbol["c"] ** 2))[output, source]
    common = numerator.gcd(denominator)
    return numerator / common, denominator / common
