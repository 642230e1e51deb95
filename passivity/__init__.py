"""Proofs that impedances are positive real and reflections bounded real; knows nothing of lines.

So far the base: exact rational functions of the Laplace variable, from expressions, coefficients or systems.
"""

from passivity.errors import ExpressionError
from passivity.rational import RationalFunction

__all__ = ["ExpressionError", "RationalFunction"]
