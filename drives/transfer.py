"""Transfer functions with exact coefficients: poles, zeros, gain, values, phase without jumps."""

import math
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from flint import acb, ctx, fmpq_poly
from numpy.typing import ArrayLike, NDArray

from drives.number import roots, written
from tline.errors import InputError, as_numbers, import_extra
from tline.presentation import Presentation, plain


class TransferFunction(Presentation):
    """p(s)/q(s) with exact coefficients, common factors cancelled, q monic.

    Parameters
    ----------
    p, q : flint.fmpq_poly
    name : str
        Output over input, such as ``x_k/T1``.

    Examples
    --------
    >>> from drives import CoupledDrives
    >>> f = CoupledDrives().transfer("tension", "T1")
    >>> print(f)
    tension/T1 = 10000/(s^2 + 500*s + 2000)
    >>> f.dc_gain, f.relative_degree, [round(p.real, 6) for p in f.poles], f.zeros
    (Fraction(5, 1), 2, [-495.967478, -4.032522], [])
    """

    picture = "drives.picture:draw_response"

    def __init__(self, p: fmpq_poly, q: fmpq_poly, name: str = "H"):
        if q == 0:
            raise InputError(name, "no transfer function", "a denominator other than 0")
        common = p.gcd(q) if p else q
        leading = (q // common).leading_coefficient()
        self.p, self.q, self.name = p // common / leading, q // common / leading, name
        self._whole = self.p.numer() * self.q.denom(), self.q.numer() * self.p.denom()

    @property
    def numerator(self) -> tuple[Fraction, ...]:
        """Coefficients of p, highest power first."""
        return _coefficients(self.p)

    @property
    def denominator(self) -> tuple[Fraction, ...]:
        """Coefficients of q, highest power first; the first is 1."""
        return _coefficients(self.q)

    @cached_property
    def poles(self) -> list[complex]:
        """Roots of q, rad/s, each part within 1 ulp."""
        return roots(self.q)

    @cached_property
    def zeros(self) -> list[complex]:
        """Roots of p, rad/s, each part within 1 ulp."""
        return roots(self.p)

    @property
    def dc_gain(self) -> Fraction | float:
        """Value at s = 0, exact; infinite at a pole, with the sign of the value at small s > 0."""
        p, q = _fraction(self.p[0]), _fraction(self.q[0])
        if q:
            return p / q
        slope = next(_fraction(c) for c in self.q.coeffs() if c != 0)
        return math.inf if p * slope > 0 else -math.inf

    @property
    def relative_degree(self) -> int:
        """How many more poles than zeros: the slope at high frequency is -20 dB per decade times this."""
        return self.q.degree() - self.p.degree()

    def __call__(self, s: ArrayLike) -> Any:
        """Value at complex s, one or an array, each part within 1 ulp.

        Raises
        ------
        InputError
            At a pole, or s is not finite.
        """
        points = np.asarray(s, complex)
        values = np.array([self._value(complex(z)) for z in points.ravel()], complex).reshape(points.shape)
        return values if points.ndim else complex(values)

    def _value(self, s: complex) -> complex:
        if not (math.isfinite(s.real) and math.isfinite(s.imag)):
            raise InputError("s", "no value here", "a finite complex number", f"{s}")
        point, bits, value = acb(s.real, s.imag), 128, acb("nan")
        while bits < 1 << 16:
            with ctx.workprec(bits):
                p, q = (side(point) for side in self._whole)
                value = p / q if q != 0 else acb("nan")
                parts = value.real, value.imag
                if all(part == 0 or part.rel_accuracy_bits() >= 60 for part in parts):
                    return complex(*map(float, parts))
            bits *= 2
        if any(abs(s - pole) <= 4e-16 * abs(s) for pole in self.poles):
            raise InputError("s", f"a pole of {self.name}", "another point", f"{s}")
        return complex(float(value.real.mid()), float(value.imag.mid()))  # one part is exactly 0

    def magnitude(self, omega: ArrayLike) -> NDArray[np.float64]:
        """|H(j omega)|."""
        return np.abs(self(1j * frequencies(omega)))

    def phase(self, omega: ArrayLike) -> NDArray[np.float64]:
        """Phase of H(j omega) in rad, without jumps on any grid.

        It starts, for omega to 0, at 0 if H is positive there and at -pi if it is negative, plus pi/2 for each zero and
        minus pi/2 for each pole at 0. From there it is continuous; poles and zeros on the imaginary axis turn it as if
        they were a little damped. Each pole and zero gives its own angle, so nothing has to be unwrapped.
        """
        w = frequencies(omega)
        right = sum(z.real > 0 for z in self.poles + self.zeros)
        sign = (-1) ** right * (1 if self.p.leading_coefficient() > 0 else -1)
        total = np.full(w.shape, 0.0 if sign > 0 else -math.pi)
        for factors, side in ((self.zeros, 1), (self.poles, -1)):
            for z in factors:
                angle = np.arctan2(z.imag - w, z.real) if z.real > 0 else np.arctan2(w - z.imag, abs(z.real))
                total += side * angle
        return total

    def to_floats(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Numerator and denominator as the nearest floats, highest power first."""
        return np.array([float(c) for c in self.numerator]), np.array([float(c) for c in self.denominator])

    def to_control(self) -> Any:
        """Convert to `control.TransferFunction`, with the package control."""
        control = import_extra("control", "python-control", "control", "to_control")

        return control.TransferFunction(*self.to_floats())

    def to_scipy(self) -> Any:
        """Convert to `scipy.signal.TransferFunction`."""
        from scipy.signal import TransferFunction as Scipy

        return Scipy(*self.to_floats())

    def response(self, omega: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The Bode plot as numbers: ``magnitude``, ``decibel`` and ``degrees`` at angular frequencies, rad/s."""
        size = self.magnitude(omega)
        return {"magnitude": size, "decibel": 20 * np.log10(size), "degrees": np.degrees(self.phase(omega))}

    def text_lines(self) -> Iterator[str]:
        """The quotient, with its poles, zeros and DC gain."""
        yield str(self)
        poles, zeros = (", ".join(map(written, found)) or "none" for found in (self.poles, self.zeros))
        yield f"  poles {poles} rad/s; zeros {zeros}; DC gain {float(self.dc_gain):.6g}"

    def to_dict(self) -> dict[str, Any]:
        """Coefficients as fractions in texts, highest power first, poles, zeros, DC gain and relative degree."""
        coefficients = {key: [str(c) for c in getattr(self, key)] for key in ("numerator", "denominator")}
        found = {key: getattr(self, key) for key in ("poles", "zeros", "dc_gain", "relative_degree")}
        return coefficients | plain(found)

    def __str__(self) -> str:
        return f"{self.name} = {_side(self.p)}/{_side(self.q)}"

    def _repr_html_(self) -> str:
        return self._shown(self.text_lines())


def frequencies(omega: ArrayLike) -> NDArray[np.float64]:
    """Angular frequencies as an array of floats."""
    w = as_numbers("omega", omega)
    if not np.isfinite(w).all() or (w < 0).any():
        raise InputError("omega", "no angular frequencies", "finite values in rad/s, 0 or more", f"{omega!r:.40}")
    return w


def _fraction(value: Any) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _coefficients(polynomial: fmpq_poly) -> tuple[Fraction, ...]:
    return tuple(_fraction(c) for c in reversed(polynomial.coeffs())) or (Fraction(0),)


def _side(polynomial: fmpq_poly) -> str:
    """Write a polynomial in decimals; in parentheses if it has several terms."""
    terms: Iterable[tuple[int, Fraction]] = ((k, c) for k, c in enumerate(_coefficients(polynomial)[::-1]) if c)
    text = ""
    for power, c in sorted(terms, reverse=True):
        variable = {0: "", 1: "s"}.get(power, f"s^{power}")
        size = "" if abs(c) == 1 and variable else f"{float(abs(c)):.10g}"
        text += (" - " if c < 0 else " + ") + "*".join(x for x in (size, variable) if x)
    text = re.sub(r"^ - ", "-", text).removeprefix(" + ") or "0"
    return f"({text})" if " " in text else text
