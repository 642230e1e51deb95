"""Forms in floating point, for the search: values at many points, and where to look."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, TypeAlias

from passivity.budget import spend
from passivity.delayed.form import Base, Form, functions
from passivity.expression.number import double

Array: TypeAlias = Any  # of numpy, which is loaded only when it is needed


def values(form: Form, s: Array) -> Array:
    """Values at an array of points, in complex doubles; what overflows is not finite."""
    import numpy as np

    spend(form.size * (5_000 + 20 * s.size), "a search for a counterexample")
    total = np.zeros_like(s, dtype=complex)
    for term in form.terms:
        r = term.rational
        part = _polynomial(r.p, s) / _polynomial(r.q, s)
        for base, e in term.factors:
            part = part * _base(base, s) ** e
        total = total + part
    return total


def _base(base: Base, s: Array) -> Array:
    import numpy as np

    if isinstance(base, Form):
        return values(base, s)
    x = values(base.argument, s)
    match base.name:
        case "coth":
            return 1 / np.tanh(x)
        case "sech":
            return 1 / np.cosh(x)
        case "csch":
            return 1 / np.sinh(x)
    return getattr(np, base.name)(x)


def _polynomial(f: Any, s: Array) -> Array:
    total = 0 * s
    for c in reversed(f.coeffs()):
        total = total * s + double(int(c))
    return total


def periods(form: Form) -> list[float]:
    """Some 8 turns of each function whose argument has a multiple of s."""
    found = set()
    for f in functions(form):
        for term in f.argument.terms:
            if term.rational.degree == 1 and term.rational.q.degree() == 0:
                found.add(50 * _exp(_log(term.rational.q[0]) - _log(term.rational.p[1])))
    return sorted(found)[:8]


def scales(form: Form) -> tuple[float, float]:
    """A range of |s| around all that are set by the ratios of coefficients and by the delays."""
    sizes = [x / 50 for x in periods(form)] or [1.0]
    for r in _rationals(form):
        for f in (r.p, r.q):
            known = [(k, _log(c)) for k, c in enumerate(f.coeffs()) if c]
            sizes += [_exp((a - b) / (j - i)) for (i, a), (j, b) in pairwise(known)]
    return min(sizes) * 1e-6, max(sizes) * 1e6


def _log(c: Any) -> float:
    return math.log(abs(int(c)))


def _exp(x: float) -> float:
    return math.exp(max(-500.0, min(500.0, x)))


def _rationals(form: Form) -> Iterator[Any]:
    for term in form.terms:
        yield term.rational
        for base, _ in term.factors:
            yield from _rationals(base if isinstance(base, Form) else base.argument)
