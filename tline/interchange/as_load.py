"""Impedances as R, L and C in series or side by side, where they are that."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from passivity import RationalFunction


def as_load(impedance: RationalFunction) -> dict[str, Any]:
    """A load of that impedance as in a scene file: R, L and C in series or side by side where it is that.

    Examples
    --------
    >>> as_load(RationalFunction.from_expression("50/(50*s*C + 1)", {"C": "1 nF"}))
    {'kind': 'parallel', 'resistance': 50.0, 'capacitance': 1e-09}
    """
    impedance = impedance.reduced()
    if impedance.degree == 0:
        return {"kind": "resistor", "resistance": float(impedance.at_zero())}
    p, q = impedance.numerator, impedance.denominator
    series, parallel = _parts(p, q), _parts(q, p)
    if series:
        keys = ("inductance", "resistance", "capacitance")
        values = [series[0], series[1], 1 / series[2] if series[2] else Fraction(0)]
    elif parallel:
        keys = ("capacitance", "resistance", "inductance")
        values = [parallel[0], *(1 / part if part else Fraction(0) for part in parallel[1:])]
    else:
        return {"kind": "impedance", "numerator": [str(a) for a in p], "denominator": [str(a) for a in q]}
    given = {key: float(value) for key, value in zip(keys, values, strict=True) if value}
    order = ("resistance", "inductance", "capacitance")
    return {"kind": "series" if series else "parallel"} | {key: given[key] for key in order if key in given}


def _parts(p: Sequence[Fraction], q: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction] | None:
    """a, b, c of p/q = a s + b + c/s, all at least zero; None if it is not that."""
    power = len(q) - 1
    if power > 1 or any(q[1:]) or len(p) > power + 2:
        return None
    a, b, c = [Fraction(0)] * (3 - len(p) - (power == 0)) + [x / q[0] for x in p] + [Fraction(0)] * (power == 0)
    return (a, b, c) if min(a, b, c) >= 0 else None
