"""Circuits of resistors and one kind of store, which are rational laws; and such a law by a table over frequency."""

import math
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tline.errors import InputError
from tline.loss.law import Arithmetic, Law, not_negative, positive

if TYPE_CHECKING:
    from passivity import RationalFunction, Verdict

PER_DECADE, DECADES_OUTSIDE = 8, 2  # rates offered, and decades of them outside the table on both sides
MOST_ROWS = 5_000


class Foster(Law):
    """Rational law loss + s·storage + Σ r_k s/(s + p_k), all coefficients positive.

    As an impedance: resistors r_k, each with an inductor r_k/p_k in parallel, in series. As an admittance: conductors
    r_k, each in series with a capacitor r_k/p_k, in parallel.

    Parameters
    ----------
    loss, storage : float
        As `Law`, from 0.
    strengths : array_like of float, shape (n,)
        r_k, above 0, in the unit of loss.
    rates : array_like of float, shape (n,)
        p_k, 1/s, above 0.

    Raises
    ------
    InputError
        A parameter of the wrong sign, or not one rate for each strength.

    References
    ----------
    R. M. Foster, Bell System Technical Journal 3 (1924) 259-267, doi:10.1002/j.1538-7305.1924.tb01358.x.

    Examples
    --------
    >>> law = Foster(loss=1, storage=0, strengths=[2], rates=[10])
    >>> print(law.at(10j), law.verdict.status)
    (2+1j) proved
    """

    def __init__(self, loss: float, storage: float, strengths: ArrayLike, rates: ArrayLike):
        not_negative(loss=loss, storage=storage)
        super().__init__(loss, storage)
        self.strengths, self.rates = np.array(strengths, float), np.array(rates, float)
        if self.strengths.ndim != 1 or self.strengths.shape != self.rates.shape:
            raise InputError("rates", "not one for each strength", f"{self.strengths.shape}", f"{self.rates.shape}")
        for k, (r, p) in enumerate(zip(self.strengths.tolist(), self.rates.tolist(), strict=True)):
            positive(**{f"strengths[{k}]": r, f"rates[{k}]": p})

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Sum without s·storage."""
        pairs = zip(self.strengths.tolist(), self.rates.tolist(), strict=True)
        return sum((s / (s + p) * r for r, p in pairs), start=0 * s + self.loss)

    @cached_property
    def rational(self) -> "RationalFunction":
        """Convert the law to an exact quotient of polynomials, its doubles taken as the binary numbers they are."""
        from passivity import RationalFunction

        of = RationalFunction.from_coefficients
        total = of([Fraction(self.storage), Fraction(self.loss)], [1])
        for r, p in zip(self.strengths, self.rates, strict=True):
            total += of([Fraction(r), 0], [1, Fraction(p)])
        return total

    @cached_property
    def verdict(self) -> "Verdict":
        """Proof by `passivity` that the law is positive real."""
        from passivity import check_positive_real

        return check_positive_real(self.rational)


def tabulated(frequencies: ArrayLike, loss: ArrayLike, storage: ArrayLike, tolerance: float) -> Foster:
    """Fit the law closest to a table of R(f) and L(f), or G(f) and C(f); refused if no causal and passive law is close.

    Loss and storage of a passive line determine each other: a table that is consistent at all
    frequencies is fitted by a sum of positive relaxations. Bad data are not, and no interpolation corrects them.

    Parameters
    ----------
    frequencies : array_like of float, shape (n,)
        Hz, from 0 and ascending, one above 0 at least.
    loss, storage : array_like of float, shape (n,)
        R in ohm/m and L in H/m, or G in S/m and C in F/m, at these; loss from 0, storage above 0.
    tolerance : float
        Largest |law - (loss + jω storage)|/|loss + jω storage| in the table, 1e-12 to 1.

    Returns
    -------
    Foster
        With at most 8 rates per decade, from two decades below the table to two above.

    Raises
    ------
    InputError
        A bad table, or the row that no passive law comes close to.

    Notes
    -----
    Non-negative least squares on a fixed grid of rates.

    References
    ----------
    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, SIAM 1995, chapter 23, doi:10.1137/1.9781611971217.

    Examples
    --------
    >>> f = np.geomspace(1e3, 1e8, 30)
    >>> z = np.sqrt(1 + 2j * math.pi * f / 1e6) + 2j * math.pi * f * 250e-9
    >>> law = tabulated(f, z.real, z.imag / (2 * math.pi * f), tolerance=1e-3)
    >>> bool(abs(law.at(2j * math.pi * 3e5) / (np.sqrt(1 + 0.6j * math.pi) + 0.15j * math.pi) - 1) < 1e-3)
    True
    """
    from scipy.optimize import nnls

    f, R, L = _checked(frequencies, loss, storage)
    if not 1e-12 <= tolerance < 1:
        raise InputError("tolerance", "out of range", "1e-12 to 1", f"{tolerance}")
    w = 2 * math.pi * f
    table = R + 1j * w * L
    size = np.maximum(np.abs(table), np.finfo(float).tiny)
    first, last = np.log10(w[w > 0][[0, -1]])
    rates = np.logspace(
        first - DECADES_OUTSIDE,
        last + DECADES_OUTSIDE,
        math.ceil((last - first + 2 * DECADES_OUTSIDE) * PER_DECADE) + 1,
    )
    s = 1j * w[:, None]
    columns = np.hstack([np.ones_like(s), s, s / (s + rates)]) / size[:, None]
    stacked = np.vstack([columns.real, columns.imag])
    scale = np.linalg.norm(stacked, axis=0)
    x = nnls(stacked / scale, np.concatenate([(table / size).real, (table / size).imag]))[0] / scale
    error = np.abs(columns @ x - table / size)
    if error.max() > tolerance:
        worst = int(error.argmax())
        problem = f"no passive law comes closer than {error[worst]:.2g} to the row at {f[worst]:.6g} Hz"
        raise InputError("table", problem, f"{tolerance:g}, or loss and storage that belong together")
    kept = x[2:] > 0
    return Foster(x[0], x[1], x[2:][kept], rates[kept])


def _checked(frequencies: ArrayLike, loss: ArrayLike, storage: ArrayLike) -> list[np.ndarray]:
    columns = [np.atleast_1d(np.asarray(column, float)) for column in (frequencies, loss, storage)]
    f, R, L = columns
    if f.ndim != 1 or not f.shape == R.shape == L.shape or not 0 < len(f) <= MOST_ROWS:
        expected = f"three columns of equal length, 1 to {MOST_ROWS} rows"
        raise InputError("table", "shape", expected, ", ".join(str(column.shape) for column in columns))
    good = np.isfinite(f) & np.isfinite(R) & np.isfinite(L) & (f >= 0) & (R >= 0) & (L > 0)
    if not good.all():
        row = int(np.argmin(good))
        got = f"{f[row]:g} Hz, {R[row]:g}, {L[row]:g}"
        raise InputError(f"table[{row}]", "bad row", "finite, frequency and loss from 0, storage above 0", got)
    if (np.diff(f) <= 0).any() or f[-1] == 0:
        raise InputError("frequencies", "not ascending", "each larger than the one before, the last above 0")
    return columns
