"""Discrete time: functions of z outside the unit disc, as functions of s in the right half plane.

With z = (1 + s)/(1 - s), |z| > 1 is Re s > 0, and z = exp(jθ) is s = j tan(θ/2). The map is exact: all that is proved
or refuted of the function of s is so of that of z.
"""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import count
from typing import Any, NamedTuple

from flint import fmpz_poly

from passivity.exact.positive_real import check, of_multiport, of_one_port
from passivity.polynomial.roots import routh_column
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.state_space import StateSpace, identity
from passivity.status import Kind
from passivity.verdict import Network, Verdict, Witness

LET = "let z = (1 + s)/(1 - s); "
_NUMBER = r"\d[\d.]*(?:e[-+]?\d+)?"
_WORDS = {
    r"Z grows like s\^(\d+): .* than one": r"Z has a pole of order \1 at z = -1",
    r"; all eigenvalues of A have Re s <= \S+": "",
    r"a pole at infinity": "a pole at z = -1",
    r"with negative residue": "with residue K z, K < 0",
    r"for ω to infinity": "at ω = inf",
    r"Re s ([<>]=?) 0": r"|z| \1 1",
    r"at s = 0": "at z = 1",
    r"on the axis": "on |z| = 1",
    r"\(jω\)": "(e^jθ)",
}


class Discrete(NamedTuple):
    """A function of z, a matrix of such, or z x = A x + B u, y = C x + D u."""

    network: Network


def in_s(network: Network) -> RationalFunction | RationalMatrix | StateSpace:
    """The function of s that is one of z at z = (1 + s)/(1 - s).

    Of a state space it is ((I + A)^-1 (A - I), (I + A)^-1 B, 2 C (I + A)^-1, D - C (I + A)^-1 B), because
    zI - A = ((I + A) s + I - A)/(1 - s).

    Examples
    --------
    >>> print(in_s(RationalFunction.from_coefficients([1, 1], [1, -1])))
    (1)/(s)
    """
    if isinstance(network, RationalFunction):
        return network.bilinear()
    if isinstance(network, RationalMatrix):
        return RationalMatrix(tuple(tuple(entry.bilinear() for entry in row) for row in network.rows))
    one = identity(network.states)
    try:
        inverse = (one + network.a).inv()
    except ZeroDivisionError:  # a pole at z = -1, which is one at infinity
        return in_s(network.transfer)
    inputs = inverse * network.b
    return StateSpace(inverse * (network.a - one), inputs, network.c * inverse * 2, network.d - network.c * inputs)


def check_outside(network: Network, kind: Kind) -> Verdict:
    """The verdict on a function of z, for |z| > 1.

    Examples
    --------
    >>> verdict = check_outside(RationalFunction.from_coefficients([1, 3], [1, 0]), Kind.PR)
    >>> print(verdict.why, verdict.witness.value.real < 0)
    Re Z(e^jθ) < 0 for 1.9106 < θ <= π True
    """
    return outside(check(in_s(network), kind), network)


def outside(verdict: Verdict, network: Any = None) -> Verdict:
    """The verdict on a function of z from that on a function of s; `network` is the former, as given."""
    if network is None and verdict.function is not None:
        network = verdict.function.bilinear().bilinear().bilinear()  # at -1/s, and then at (s - 1)/(s + 1)
    if (found := verdict.witness) and (found.re, found.im) == (1, 0):  # z is infinite there: a point near it
        test = _test(verdict, found)
        finite = next(filter(None, (test(1 - Fraction(1, 2**k), Fraction(0)) for k in count(2))))
        verdict = replace(verdict, witness=finite)
    witness = verdict.witness and _at_z(verdict.witness, network)
    hidden = _hidden(network) if isinstance(network, RationalFunction) else verdict.hidden
    return replace(verdict, function=network, witness=witness, hidden=hidden, floats=None, in_s=verdict)


def _at_z(found: Witness, network: Any) -> Witness:
    """A witness as a point z."""
    size = (1 - found.re) ** 2 + found.im**2
    re, im = (1 - found.re**2 - found.im**2) / size, 2 * found.im / size
    image = network if isinstance(found.found, StateSpace) and isinstance(network, StateSpace) else found.found
    return replace(found, re=re, im=im, found=image, variable="z")


def _test(verdict: Verdict, found: Witness) -> Callable[[Fraction, Fraction], Witness | None]:
    """Test whether a point s is a witness, too."""
    kind, function = verdict.kind, verdict.function
    if function is None:
        question = verdict.question
        return lambda re, im: question.fails(re, im, found.names)
    if isinstance(function, RationalFunction):
        return of_one_port(kind, function.p, function.q)
    if isinstance(found.found, StateSpace):
        from passivity.floats.modes import is_negative

        vector = [complex(*map(float, x)) for x in found.vector]
        return lambda re, im: replace(found, re=re, im=im) if is_negative(kind, function, re, im, vector) else None
    return of_multiport(kind, function if isinstance(function, RationalMatrix) else function.transfer)


def _hidden(function: RationalFunction) -> fmpz_poly | None:
    """The common factor, if it has roots in |z| >= 1."""
    common = function.p.gcd(function.q)
    mapped = RationalFunction(common, fmpz_poly([1])).bilinear().p
    stable = mapped.degree() == common.degree() and routh_column(mapped) is not None
    return None if stable else common


def angle(w: float) -> float:
    """θ of z = exp(jθ) at s = jw."""
    return 2 * math.atan(w)


def in_words(text: str) -> str:
    """Words about the right half plane and frequencies ω as those about |z| > 1 and angles θ, in rad.

    Examples
    --------
    >>> in_words("Re Z(jω) < 0 for ω > 1"), in_words("|H(jω)| > 1 for 0.5 < ω < 1")
    ('Re Z(e^jθ) < 0 for 1.5708 < θ <= π', '|H(e^jθ)| > 1 for 0.9273 < θ < 1.5708')
    """

    def turned(found: re.Match[str]) -> str:
        low, relation, numbers = found.groups()
        ends = ", ".join(f"{angle(float(x)):.5g}" for x in numbers.split(", "))
        if relation == ">":
            return f"{ends} < θ <= π"
        return f"{'' if low is None else f'{angle(float(low)):.5g} < '}θ {relation} {ends}"

    for pattern, words in _WORDS.items():
        text = re.sub(pattern, words, text)
    text = re.sub(rf"(?:({_NUMBER}) < )?ω ([<=>]) ((?:inf|{_NUMBER})(?:, {_NUMBER})*)", turned, text)
    return text.replace("ω", "θ")
