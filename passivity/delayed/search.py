"""A rational point of the right half plane where the property fails: searched in floats, shown in balls."""

import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import NamedTuple, TypeAlias

from flint import acb

from passivity.ball import near
from passivity.delayed.floats import Array, periods, scales, values
from passivity.delayed.form import Form, functions, multiply
from passivity.delayed.value import exact_value
from passivity.status import Kind

_RADII = 240  # on the logarithmic grid
_ANGLES = 16
_AXIS = 4000
_POLISHED = 12  # best points that are improved
_STEPS = 60
_WITH_POLES = ("tanh", "coth", "sech", "csch")
_STARTS = 400  # points from which Newton's method looks for poles
_NEWTON = 16

_DISTANCES = (4, 8, 16, 32, 64, 128, 256)  # binary, in parts of the modulus
_DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))

Place: TypeAlias = tuple[Fraction, Fraction]


class Point(NamedTuple):
    """A point s = re + j im, re > 0, and the ball that holds the value there."""

    re: Fraction
    im: Fraction
    value: acb


def find_witness(kind: Kind, form: Form) -> Point | None:
    """A point where Re Z < 0, |H| > 1, or where the value at a real s is not real; None if none was found.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> found = find_witness(Kind.BR, of_text("exp(2*s)/2"))
    >>> float(found.re), found.im, found.value.real > 1
    (0.75, Fraction(7, 32), True)
    """
    import numpy as np

    with np.errstate(all="ignore"):
        return next(filter(None, (check(kind, form, *place) for place in _candidates(kind, form))), None)


def beside(kind: Kind, form: Form, w: float) -> Point | None:
    """A witness near a frequency on the axis."""
    return next(filter(None, (check(kind, form, *place) for place in _beside(w))), None)


def around(kind: Kind, form: Form, root: acb) -> Point | None:
    """A witness ever nearer to a pole or a zero in Re s >= 0."""
    size = max(abs(near(root.real)), abs(near(root.imag))) or Fraction(1)
    unit = Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length())
    for distance in _DISTANCES:
        grid = unit / 2**distance
        re, im = (round(near(part) / grid) for part in (root.real, root.imag))
        for x, y in _DIRECTIONS:
            if found := check(kind, form, (re + x) * grid, (im + y) * grid):
                return found
    return None


def check(kind: Kind, form: Form, re: Fraction, im: Fraction) -> Point | None:
    """The point as a witness, if ball arithmetic shows that it is one."""
    if re <= 0:
        return None
    found = exact_value(form, re, im)
    wrong = found.real < 0 if kind is Kind.PR else abs(found) > 1
    unreal = not im and (found.imag > 0 or found.imag < 0)
    return Point(re, im, found) if found.is_finite() and (wrong or unreal) else None


def lowest(kind: Kind, form: Form) -> float | None:
    """The frequency of a sampled axis where Re Z(jw) is least, or |H(jw)| largest; None if there is none."""
    import numpy as np

    with np.errstate(all="ignore"):
        w = _refined(kind, form, 0.0)
        value = _badness(kind, form, 1j * w, relative=False)
        least = w[value > value.max() - 1e-9 * (1 + abs(value.max()))] if len(w) else w
    return float(least.min()) if len(least) else None


def _candidates(kind: Kind, form: Form) -> Iterator[Place]:
    """Points to try: of a grid, on the real axis where values are not real, improved, beside the axis."""
    import numpy as np

    low, high = scales(form)
    radii = np.geomspace(low, high, _RADII)
    unreal = radii[np.abs(values(form, radii + 0j).imag) > 1e-6 * np.abs(values(form, radii + 0j))]
    angles = np.pi / 2 * np.linspace(0, 1, _ANGLES, endpoint=False)
    s = (radii[:, None] * np.exp(1j * angles)).ravel()
    for root in _singular(kind, form, s[:: max(len(s) // _STARTS, 1)]):
        yield from _near_root(root)
    wrong = _badness(kind, form, s)
    clear = s[wrong > min(max(wrong.max() / 2, 0), 1)]
    middle = math.sqrt(low) * math.sqrt(high)
    for point in (*_nearest(clear, middle), *_nearest(unreal, middle), *_descended(kind, form, s, wrong)):
        yield from _rounded(complex(point))
    for tilt in (0.0, 1e-6):
        for w in _refined(kind, form, tilt)[:4]:
            yield from _beside(float(w))


def _suspects(kind: Kind, form: Form) -> Iterator[tuple[Form, int]]:
    """Functions whose poles (1) or zeros (-1) in Re s > 0 may be poles of the whole, or zeros of an impedance."""
    yield from ((form, sign) for sign in ((1, -1) if kind is Kind.PR else (1,)))
    for term in form.terms:
        yield from ((base, -1) for base, e in term.factors if isinstance(base, Form) and e < 0)
    yield from ((multiply([(f, 1)]), 1) for f in functions(form) if f.name in _WITH_POLES)


def _singular(kind: Kind, form: Form, s: Array) -> list[complex]:
    """Where Newton's method, from some points, finds poles and zeros of the suspects in Re s > 0."""
    import numpy as np

    found: list[complex] = []
    for suspect, sign in islice(_suspects(kind, form), _POLISHED):
        z, step = s, np.full(len(s), np.inf)
        for _ in range(_NEWTON):
            h = 1e-6 * np.abs(z)
            slope = (values(suspect, z + h) - values(suspect, z - h)) / (2 * h)
            after = z + sign * values(suspect, z) / slope
            near_by = (np.abs(after) < 3 * np.abs(z)) & (after.real > 0)
            step = np.where(near_by, np.abs(after - z), np.where(np.isfinite(after), np.inf, step))
            z = np.where(near_by, after, z)
        settled = z[step < 1e-6 * np.abs(z)]
        for root in settled[np.argsort(np.abs(settled.imag))]:
            if all(abs(root - other) > 1e-4 * abs(root) for other in found):
                found.append(complex(root))
    return found[: 2 * _POLISHED]


def _near_root(root: complex) -> Iterator[Place]:
    """Points around one that is known to some six digits."""
    for bits in (4, 12, 24, 34):
        step = Fraction(abs(root)) / 2**bits
        re, im = _short(root.real, bits + 4), _short(abs(root.imag), bits + 4)
        yield from ((re + x * step, im + y * step) for x, y in _DIRECTIONS)


def _nearest(s: Array, size: float) -> Array:
    """The three points whose modulus is nearest to a size."""
    import numpy as np

    return s[np.argsort(np.abs(np.log(np.abs(s) / size)))[:3]]


def _descended(kind: Kind, form: Form, s: Array, wrong: Array) -> Iterator[complex]:
    """The worst points of a grid, each improved by a walk in log s."""
    import numpy as np

    order = np.argsort(-wrong)[: 3 * _POLISHED]
    best, size = np.log(s[order]), np.full(len(order), 0.2)
    value = wrong[order]
    turns = np.exp(1j * np.pi / 4 * np.arange(8))
    for _ in range(_STEPS):
        trial = best[:, None] + size[:, None] * turns
        trial = trial.real + 1j * np.clip(trial.imag, -np.pi / 2 + 1e-12, np.pi / 2 - 1e-12)
        found = _badness(kind, form, np.exp(trial))
        k = np.argmax(found, axis=1)
        rows = np.arange(len(best))
        better = found[rows, k] > value
        best = np.where(better, trial[rows, k], best)
        value = np.where(better, found[rows, k], value)
        size = np.where(better, size * 1.2, size / 2)
    yield from (complex(np.exp(best[k])) for k in np.argsort(-value)[:_POLISHED] if value[k] > 0)


def _refined(kind: Kind, form: Form, tilt: float) -> Array:
    """Frequencies of the worst points near the axis, after shrinking a grid around each."""
    import numpy as np

    low, high = scales(form)
    w = np.concatenate([np.geomspace(low, high, _AXIS), *(np.linspace(0, x, _AXIS // 4)[1:] for x in periods(form))])
    w = np.unique(w)
    value = _badness(kind, form, (tilt + 1j) * w, relative=False)
    peaks = np.flatnonzero((value >= np.roll(value, 1)) & (value >= np.roll(value, -1)) & np.isfinite(value))
    peaks = np.union1d(peaks[np.argsort(-value[peaks])][:_POLISHED], peaks[:_POLISHED])
    left, right = w[np.maximum(peaks - 1, 0)], w[np.minimum(peaks + 1, len(w) - 1)]
    for _ in range(12):
        grid = np.linspace(left, right, 17, axis=-1)
        best = np.argmax(_badness(kind, form, (tilt + 1j) * grid, relative=False), axis=-1)
        rows = np.arange(len(grid))
        left, right = grid[rows, np.maximum(best - 1, 0)], grid[rows, np.minimum(best + 1, 16)]
    middle = (left + right) / 2
    return middle[np.argsort(-_badness(kind, form, (tilt + 1j) * middle, relative=False))]


def _badness(kind: Kind, form: Form, s: Array, relative: bool = True) -> Array:
    import numpy as np

    f = values(form, s)
    size = np.abs(f)
    found = size - 1 if kind is Kind.BR else -f.real / (size if relative else 1)
    return np.where(np.isfinite(found), found, -np.inf)


def _rounded(s: complex) -> Iterator[Place]:
    """The point with few digits, then with more."""
    if not math.isfinite(abs(s)) or s.real <= 0:
        return
    for bits in (3, 6, 12, 24, 50):
        yield _short(s.real, bits), _short(abs(s.imag), bits)


def _beside(w: float) -> Iterator[Place]:
    """Points ever nearer to the axis at a frequency."""
    for distance in (4, 8, 16, 32, 64, 128):
        for bits in (6, 24, 50):
            near = _short(w, bits)
            yield (near or Fraction(1)) / 2**distance, near


def _short(x: float, bits: int) -> Fraction:
    grid = Fraction(2) ** (math.frexp(x)[1] - bits)
    return round(Fraction(x) / grid) * grid
