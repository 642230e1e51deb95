"""Networks from the systems of scipy.signal and python-control."""

from typing import Any

from passivity.errors import ExpressionError
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.state_space import StateSpace


def from_system(system: Any) -> RationalMatrix | StateSpace:
    """Network of a scipy.signal.lti or python-control system with as many outputs as inputs.

    Parameters
    ----------
    system : object
        Continuous: a state space, transfer functions, or with one port zeros, poles and gain. Taken exactly as the
        floats it holds; zeros and poles pass through their own rounding ``to_tf()``.

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
    kind = type(system).__name__
    if getattr(system, "dt", None) not in (None, 0):
        raise ExpressionError("system", "discrete in time", "a continuous system", f"{kind} with dt={system.dt}")
    if all(hasattr(system, name) for name in "ABCD"):
        return StateSpace.from_entries(system.A, system.B, system.C, system.D)
    if hasattr(system, "ninputs") and hasattr(system, "num"):  # python-control: tables of coefficients
        return RationalMatrix.from_rows(
            [[(p, q) for p, q in zip(*rows, strict=True)] for rows in zip(system.num, system.den, strict=True)]
        )
    if (ports := tuple(getattr(system, name, 1) for name in ("inputs", "outputs"))) != (1, 1):
        raise ExpressionError("system", "too many ports", "one input and one output", f"{ports} of {kind}")
    if hasattr(system, "gain"):
        system = system.to_tf()
    if not hasattr(system, "num"):
        raise ExpressionError("system", "no coefficients", "a scipy.signal.lti or python-control system", kind)
    return RationalMatrix(((RationalFunction.from_coefficients(system.num, system.den),),))
