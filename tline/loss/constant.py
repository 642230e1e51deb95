"""Constant R and L, or G and C."""

from typing import Any

from tline.loss.arithmetic import Arithmetic
from tline.loss.check import not_negative
from tline.loss.law import Law


class ConstantLoss(Law):
    """R + s L as an impedance, G + s C as an admittance, per metre.

    Parameters
    ----------
    loss : float
        R or G, from 0: ohm/m, S/m (Pa s/m⁴, m²/(Pa s)).
    storage : float
        L or C, from 0: H/m, F/m (kg/m⁵, m²/Pa).

    Raises
    ------
    InputError
        A negative parameter.

    References
    ----------
    O. Heaviside, Electrical Papers II, Macmillan 1892: the telegrapher's equations.

    Examples
    --------
    >>> print(ConstantLoss(20, 250e-9).at(1e8j))
    (20+25j)
    """

    def __init__(self, loss: float, storage: float = 0.0):
        not_negative(loss=loss, storage=storage)
        super().__init__(loss, storage)

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """R."""
        return 0 * s + self.loss
