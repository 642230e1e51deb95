"""Circuits of resistors and one kind of store: laws that are rational."""

from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tline.errors import InputError
from tline.loss.arithmetic import Arithmetic
from tline.loss.check import not_negative, positive
from tline.loss.law import Law

if TYPE_CHECKING:
    from passivity import RationalFunction, Verdict


class Foster(Law):
    """loss + s·storage + Σ r_k s/(s + p_k), all coefficients positive.

    As an impedance: resistors r_k, each with an inductor r_k/p_k beside it, in series. As an admittance: conductors
    r_k, each in series with a capacitor r_k/p_k, side by side.

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
        """The sum without s·storage."""
        pairs = zip(self.strengths.tolist(), self.rates.tolist(), strict=True)
        return sum((s / (s + p) * r for r, p in pairs), start=0 * s + self.loss)

    @cached_property
    def rational(self) -> "RationalFunction":
        """The law as an exact quotient of polynomials, its doubles taken as the binary numbers they are."""
        from passivity import RationalFunction

        of = RationalFunction.from_coefficients
        total = of([Fraction(self.storage), Fraction(self.loss)], [1])
        for r, p in zip(self.strengths, self.rates, strict=True):
            total += of([Fraction(r), 0], [1, Fraction(p)])
        return total

    @cached_property
    def verdict(self) -> "Verdict":
        """The proof by `passivity` that the law is positive real."""
        from passivity import check_positive_real

        return check_positive_real(self.rational)
