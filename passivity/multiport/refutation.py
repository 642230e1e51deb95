"""Networks too large for the exact test: points where floating point sees the property fail, shown exactly."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from passivity.multiport.axis_analysis import AxisAnalysis, analyse
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import MatrixVerdict
from passivity.multiport.witness import witness_at
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.status import Kind, Status

if TYPE_CHECKING:
    from passivity.multiport.float_system import FloatSystem

_HALVINGS = 60
_ON_AXIS = 1e-8  # real part of a pole in parts of its modulus


def refuted_or_undecided(kind: Kind, network: StateSpace, budget: str) -> MatrixVerdict:
    """The verdict on a state space for which an exact proof takes too long, with what floating point sees.

    Modes that do not show at the ports are not looked for.

    Examples
    --------
    >>> system = StateSpace.from_entries([[-1]], [[1]], [[1]], [["-1/5"]])
    >>> refuted_or_undecided(Kind.PR, system, "too large").witness.value < 0
    True
    """
    verdict = MatrixVerdict(kind, network, Status.UNDECIDED, budget=budget)
    from passivity.multiport.float_system import FloatSystem

    try:
        system = FloatSystem.of(kind, network)
        analysis = analyse(system)
    except (OverflowError, ValueError):  # beyond the range of doubles, or the eigenvalues do not converge
        return verdict
    try:
        for re, im in suspects(system, analysis):
            if witness := witness_at(kind, network, re, im):
                return MatrixVerdict(kind, network, Status.REFUTED, witness=witness, analysis=analysis)
    except UndecidedError as error:
        return replace(verdict, analysis=analysis, budget=f"{budget}; {error}")
    return replace(verdict, analysis=analysis)


def suspects(system: "FloatSystem", analysis: AxisAnalysis) -> Iterator[tuple[Fraction, Fraction]]:
    """Points with few digits where the form is negative beyond its error: over the axis, then around poles."""
    for points in (_over_axis(analysis.frequency / system.unit), _around_poles(system)):
        places = system.at(*points)
        negative = [(x.value, s) for x, s in zip(places, points, strict=True) if x.is_negative]
        if negative:
            enough = min(value for value, _ in negative) / 4
            s = next(s for value, s in negative if value <= enough)
            unit = Fraction(system.unit)
            yield Fraction(s.real) * unit, Fraction(s.imag) * unit


def _over_axis(w: float) -> list[complex]:
    """Ever closer to a frequency, or ever farther out."""
    if w == math.inf:
        return [complex(2.0**k) for k in range(_HALVINGS)]
    size = 2.0 ** round(math.log2(w)) if w else 1.0
    return [_rounded(size / 2**k, w, size / 2**k) for k in range(_HALVINGS)]


def _around_poles(system: "FloatSystem") -> list[complex]:
    """To the right of poles on the axis, and around those to the right of it."""
    found = []
    for p in system.poles:
        size = 2.0 ** round(math.log2(abs(p))) if p else 1.0
        if p.real > _ON_AXIS * size:
            size = 2.0 ** math.floor(math.log2(p.real))
            ring = [complex(re, im) for re in (-1, 0, 1) for im in (-1, 0, 1) if re or im]
            for r in (size / 2, size / 64):
                found += [_rounded(p.real + r * x.real, p.imag + r * x.imag, r) for x in ring]
        elif p.real > -_ON_AXIS * size:
            found += [_rounded(r, p.imag, r) for r in (size / 2**8, size / 2**16)]
    return found


def _rounded(re: float, im: float, size: float) -> complex:
    """On a grid of eighths."""
    return complex(round(re / size * 8) * size / 8, round(im / size * 8) * size / 8)
