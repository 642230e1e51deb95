"""A rational load at a node, advanced over one slab by Radau IIA collocation.

The load is realised through its reflection (Z - z)/(Z + z) against the node's Thévenin impedance z, which is proper for
every passive Z, be Z or 1/Z improper. A switch beside the load only feeds part of the reflected wave back. One slab is
then a constant linear map from the Thévenin wave w at the points and the load's state at the slab's start to the
node's effort u at the points and the state at the slab's end.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.solver.radau import Basis, Matrix

if TYPE_CHECKING:
    from passivity import RationalFunction


class StateSpace(NamedTuple):
    """dx/dt = A x + b w, output c x + d w, with n states and k inputs and outputs."""

    A: Matrix  # (n, n)
    b: Matrix  # (n, k)
    c: Matrix  # (k, n)
    d: Matrix  # (k, k)

    @property
    def constant(self) -> Matrix:
        """Which states nothing moves; these are 1."""
        return np.array(~(np.any(self.A, axis=1) | np.any(self.b, axis=1)))

    def at_rest_under(self, wave: float) -> Matrix:
        """State in the steady state under a constant input, the same at all ports."""
        state, moving = self.constant.astype(float), ~self.constant
        forcing = self.b[moving].sum(axis=1) * wave + self.A[moving] @ state
        if forcing.any():
            state[moving] = -np.linalg.solve(self.A[np.ix_(moving, moving)], forcing)
        return state


NO_LOAD = StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1)))  # the effort is the wave


def side_by_side(systems: Sequence[StateSpace], more: int = 0) -> StateSpace:
    """All systems as one, and behind their states some more that nothing moves yet."""
    first = np.cumsum([0, *(len(system.A) for system in systems)])
    k, n = len(systems), int(first[-1]) + more
    A, B, C, D = np.zeros((n, n)), np.zeros((n, k)), np.zeros((k, n)), np.zeros((k, k))
    for p, system in enumerate(systems):
        part = slice(first[p], first[p + 1])
        A[part, part], B[part, p], C[p, part], D[p, p] = system.A, system.b[:, 0], system.c[0], system.d[0, 0]
    return StateSpace(A, B, C, D)


def effort(reflection: StateSpace, g: float) -> StateSpace:
    """From the wave w to the effort u of a node with a load and, beside it, a switch.

    Parameters
    ----------
    reflection : StateSpace
        From the wave a = u + z i into the load to the wave r = u - z i out of it.
    g : float
        Conductance of the switch in units of 1/z, 0 to infinity: a = (2 w - g r)/(2 + g).

    Raises
    ------
    ZeroDivisionError
        If a closed switch (g infinite) shorts a load that holds its effort, such as a capacitor.
    """
    A, b, c, d = reflection
    direct = 1.0 + float(d[0, 0])
    if np.isinf(g):
        back, passed = 1.0 / direct, 0.0
    else:
        back, passed = g / (2.0 + g * direct), 2.0 / (2.0 + g * direct)
    return StateSpace(A - back * b @ c, b * passed, c * passed / 2, (1.0 + d) * passed / 2)


def counted_from(level: float, system: StateSpace) -> StateSpace:
    """A system of one port whose wave and effort both count from a level; its last state is 1 and nothing moves it."""
    A, b, c, d = system
    n = len(A)
    return StateSpace(
        np.block([[A, -level * b], [np.zeros((1, n + 1))]]),
        np.vstack([b, np.zeros((1, 1))]),
        np.hstack([c, level * (1.0 - d)]),
        d,
    )


@lru_cache
def reflection(impedance: "RationalFunction", z: float, where: str) -> StateSpace:
    """Realise the reflection of a rational impedance against z in balanced companion form.

    Parameters
    ----------
    impedance : RationalFunction
        Z(s), at least of degree 1.
    z : float
        Thévenin impedance of the node, > 0 and finite.
    where : str
        Name for messages.

    Raises
    ------
    InputError
        If Z + z falls to a lower degree: Z tends to -z at high frequency, and no wave is defined.
    """
    p, q = ([int(a) for a in reversed(side.coeffs())] for side in (impedance.p, impedance.q))
    n = max(len(p), len(q)) - 1
    p, q = [0] * (n + 1 - len(p)) + p, [0] * (n + 1 - len(q)) + q
    top, bottom = float(z).as_integer_ratio()
    if bottom * p[0] + top * q[0] < 0:  # let the leading coefficient be positive
        top, bottom = -top, -bottom
    denominator = [bottom * a + top * b for a, b in zip(p, q, strict=True)]
    numerator = [bottom * a - top * b for a, b in zip(p, q, strict=True)]
    leading = denominator[0]
    if leading == 0:
        raise InputError(
            where, f"its impedance tends to minus the line's {z:.6g} at high frequency: no wave is defined"
        )
    lowest = next(k for k in range(n, -1, -1) if denominator[k] != 0)
    exponent = _root(Fraction(denominator[lowest], leading), lowest)  # of the rate, at which all are of one size

    def scaled(a: int, b: int, k: int) -> float:  # a/(b rate^k), rounded once
        return (a << max(-k * exponent, 0)) / (b << max(k * exponent, 0))

    monic = [scaled(a, leading, k) for k, a in enumerate(denominator)]
    output = [
        scaled(b * leading - numerator[0] * a, leading**2, k)
        for k, (a, b) in enumerate(zip(denominator, numerator, strict=True))
    ]
    A = np.eye(n, k=-1)
    A[0] = [-a for a in monic[1:]]
    b, c, d = np.eye(n)[:, :1], np.array([output[1:]]), np.array([[numerator[0] / leading]])
    scale = _balance(A)
    rate = 2.0**exponent
    return StateSpace(rate * A / scale[:, None] * scale, rate * b / scale[:, None], c * scale, d)


def _root(ratio: Fraction, n: int) -> int:
    """A whole number e such that 2**e has the size of abs(ratio)**(1/n)."""
    return (abs(ratio.numerator).bit_length() - ratio.denominator.bit_length()) // n if n else 0


def _balance(A: Matrix) -> Matrix:
    """Powers of two by which to scale the states so that rows and columns of A have one size (Osborne 1960).

    As scipy.linalg.matrix_balance, whose import would cost a short run a tenth of its time.
    """
    size, scale = np.abs(A) * (1 - np.eye(len(A))), np.ones(len(A))
    for _ in range(8 if size.any() else 0):
        before = scale.copy()
        for k in range(len(A)):
            row, column = (size[k] * scale).sum() / scale[k], (size[:, k] / scale).sum() * scale[k]
            if row > 0 and column > 0:
                scale[k] *= 2.0 ** np.round(np.log2(row / column) / 2)
        if (scale == before).all():
            break
    return scale


def load_step(system: StateSpace, basis: Basis, h: float) -> Matrix:
    """Radau IIA over one slab of width h for dx/dt = A x + b w, u = c x + d w (order 2s - 1 at the slab's end).

    Returns
    -------
    ndarray, shape (k s + n, k s + n)
        From (w, x) to (u, x at the slab's end): port by port the s points, then the states.
    """
    s, (n, k) = basis.s, system.b.shape
    one, drive = np.eye(s), np.empty((n * s, k * s + n))
    drive[:, : k * s], drive[:, k * s :] = h * _kron(system.b, basis.A), _kron(np.eye(n), np.ones((s, 1)))
    x = np.linalg.solve(np.eye(s * n) - h * _kron(system.A, basis.A), drive)  # states at all points
    step = np.empty((k * s + n, k * s + n))
    np.matmul(_kron(system.c, one), x, out=step[: k * s])
    step[: k * s, : k * s] += _kron(system.d, one)
    step[k * s :] = x[s - 1 :: s]
    return step


def _kron(a: Matrix, b: Matrix) -> Matrix:
    """As numpy.kron, in a tenth of the time for matrices this small."""
    return (a[:, None, :, None] * b[:, None, :]).reshape(a.shape[0] * b.shape[0], a.shape[1] * b.shape[1])
