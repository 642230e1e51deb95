"""Modes of a network that do not die out and that its ports do not show."""

from flint import fmpz_poly

from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import Network
from passivity.one_port.hurwitz import routh_column
from passivity.one_port.polynomial_sign import coprime


def hidden_modes(network: Network) -> fmpz_poly | None:
    """A polynomial with roots in Re s >= 0 that does not show at the ports, None if there is none.

    Of a state space: the modes that the inputs do not reach or the outputs do not see; of a matrix: the factors common
    to numerator and denominator of an entry.

    Examples
    --------
    >>> hidden_modes(StateSpace.from_entries([[-1, 0], [0, 2]], [[1], [0]], [[1, 1]], [[0]]))
    x + (-2)
    """
    if isinstance(network, StateSpace):
        factor = network.modes // network.reached()[1].dual().reached()[1].modes
        return factor if _stays(factor) else None
    found = fmpz_poly([1])
    for entry in (entry for row in network.rows for entry in row):
        factor = fmpz_poly([1]) if coprime(entry.p, entry.q) else entry.p.gcd(entry.q)
        if _stays(factor):
            found *= factor // found.gcd(factor)
    return found if found.degree() > 0 else None


def _stays(factor: fmpz_poly) -> bool:
    return factor.degree() > 0 and routh_column(factor) is None
