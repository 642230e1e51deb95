"""Accepted questions: text, numbers, systems and networks of other libraries, samples, lines and scenes."""

from collections.abc import Sequence
from decimal import Decimal
from numbers import Real
from typing import Any, NamedTuple

from passivity.discrete import Discrete
from passivity.errors import ExpressionError, shorten, shown
from passivity.rational.evaluate import exact
from passivity.rational.function import RationalFunction
from passivity.status import Decided, Kind

_EXPECTED = (
    "text, a number, (numerator, denominator), (A, B, C, D), (E, A, B, C, D), these with dt behind them, a system of "
    "scipy.signal or python-control, a network of scikit-rf, samples, or a line or scene of tline"
)


class Structure(NamedTuple):
    """Text with names, the assumptions on these, and its statement in words."""

    text: str
    assume: Sequence[str]
    statement: str


def given(what: Any, kind: Kind) -> Any:
    """Convert an argument to text, Structure, RationalFunction, RationalMatrix, StateSpace, SampledResponse or verdict.

    A network of scikit-rf is taken as samples of its scattering matrix: its impedances are positive real if and only
    if that is bounded real. An object with a method ``passivity_model(kind)``, as lines and scenes of tline have,
    is replaced by the result of that method: one of these, or a verdict.

    Raises
    ------
    ExpressionError
        For anything else.

    Examples
    --------
    >>> print(given(([1, 0], [2, 1]), Kind.PR), given(0.5, Kind.PR))
    (s)/(2*s + 1) (1)/(2)
    """
    if isinstance(what, str | Structure | RationalFunction | Decided):
        return what
    if isinstance(what, Real | Decimal) and not isinstance(what, bool):
        return RationalFunction.constant(exact(what, "what"))  # pyright: ignore[reportArgumentType]
    from passivity.rational.matrix import RationalMatrix
    from passivity.rational.state_space import StateSpace, from_system
    from passivity.sampled.response import SampledResponse
    from passivity.verdict import Network

    if isinstance(what, SampledResponse | Network | Discrete):
        return what
    if callable(model := getattr(what, "passivity_model", None)) and not isinstance(what, type):
        return given(model(kind), kind)
    if all(hasattr(what, name) for name in ("s", "f", "z0")):
        return SampledResponse.from_network(what)
    if hasattr(what, "tolist"):  # numpy
        what = what.tolist()
    if isinstance(what, tuple | list):
        parts = [part.tolist() if hasattr(part, "tolist") else part for part in what]
        *most, last = parts or [None]
        if len(parts) in (3, 5, 6) and (
            last is True or (isinstance(last, Real) and float(last) > 0)
        ):  # dt, as scipy has it
            return Discrete(given(most, kind))
        if len(parts) == 2 and all(isinstance(part, Sequence) and not isinstance(part, str) for part in parts):
            return RationalFunction.from_coefficients(*parts)
        if len(parts) in (4, 5):
            return (StateSpace.from_entries if len(parts) == 4 else StateSpace.from_descriptor)(*parts)
    elif any(hasattr(what, name) for name in ("A", "num", "zeros")):
        network = from_system(what)
        network = network.rows[0][0] if isinstance(network, RationalMatrix) and network.size == 1 else network
        return Discrete(network) if getattr(what, "dt", None) not in (None, 0) else network
    raise ExpressionError("what", "not a function of s", _EXPECTED, shorten(shown(what, repr)))


def checked(what: Any, kind: Kind) -> Any:
    """Return the verdict on a network or on samples; samples of S answer for both properties of their system."""
    from passivity.exact.positive_real import check
    from passivity.sampled.check import check_samples
    from passivity.sampled.response import SampledResponse
    from passivity.verdict import Verdict

    if isinstance(what, Decided):
        return what if isinstance(what, Verdict) else Verdict(kind, None, what.status, reason=getattr(what, "why", ""))
    if not isinstance(what, SampledResponse):
        return check(what, kind)
    if what.parameter != "S" and kind is Kind.BR:
        raise ExpressionError("what", f"samples of {what.parameter}", "samples of S, or is_positive_real")
    return check_samples(what)
