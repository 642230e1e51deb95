"""Numbers of poles that are tried in turn until a model meets the samples, and when to give up."""

import math

from passivity.errors import ExpressionError

ORDERS = (0, 1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 60, 80, 100, 130, 160, 200)
MANY = 40  # poles from which on more must pay
PAYS = 0.8  # of the least error: what an order must reach to pay
IN_VAIN = 3  # orders that do not pay, after which no higher is tried


class Reached:
    """The least error so far, and whether more poles still pay.

    Examples
    --------
    >>> reached = Reached()
    >>> [reached.is_enough(error, order) for order, error in ((40, 0.5), (50, 0.3), (60, 0.29), (80, 0.3), (100, 0.3))]
    [False, False, False, False, True]
    """

    def __init__(self):
        self.error, self.fewest, self.most, self.in_vain = math.inf, 0, 0, 0

    def is_enough(self, error: float, order: int, fits: bool = False) -> bool:
        """Take note of a model, or of the passive one near one that fits; whether no more poles are worth trying."""
        pays = error < PAYS * self.error
        self.most = max(self.most, order)
        if error < self.error:
            self.error, self.fewest = error, order
        self.in_vain = 0 if pays else self.in_vain + (fits or order >= MANY)
        return self.in_vain == IN_VAIN

    def refusal(self, tolerance: float, passive: bool, otherwise: str = "") -> ExpressionError:
        """That no model is near enough, and what was reached."""
        problem = f"no {'passive ' * passive}model of up to {self.most} poles is that near to the samples"
        expected = f"at least {self.error:.3g}, which {self.fewest} poles reach{otherwise}"
        return ExpressionError("tolerance", problem, expected, f"{tolerance:g}")
