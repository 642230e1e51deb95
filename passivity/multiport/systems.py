"""Networks with several ports from the systems of scipy.signal and python-control."""

from typing import Any

from passivity.errors import ExpressionError
from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import Network
from passivity.rational.function import RationalFunction


def from_system(system: Any) -> Network:
    """Network of a scipy.signal.lti or python-control system with as many outputs as inputs.

    Parameters
    ----------
    system : object
        Continuous: a state space, or transfer functions. Taken exactly as the floats it holds; with one port, zeros,
        poles and gain are read too (see `RationalFunction.from_system`).

    Raises
    ------
    ExpressionError
        For a discrete system, another number of outputs than of inputs, or any other object.

    Examples
    --------
    >>> from scipy.signal import lti
    >>> from_system(lti([[-1]], [[1, 0]], [[1], [0]], [[0, 0], [0, 1]])).size
    2
    """
    if getattr(system, "dt", None) not in (None, 0):
        got = f"{type(system).__name__} with dt={system.dt}"
        raise ExpressionError("system", "discrete in time", "a continuous system", got)
    if all(hasattr(system, name) for name in "ABCD"):
        return StateSpace.from_entries(system.A, system.B, system.C, system.D)
    if hasattr(system, "ninputs") and hasattr(system, "num"):  # python-control: tables of coefficients
        return RationalMatrix.from_rows(
            [[(p, q) for p, q in zip(*rows, strict=True)] for rows in zip(system.num, system.den, strict=True)]
        )
    return RationalMatrix(((RationalFunction.from_system(system),),))
