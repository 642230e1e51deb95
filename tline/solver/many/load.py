"""Loads of R, L and C behind the impedances of their nodes, in many copies at once."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Load(NamedTuple):
    """dx/dt = A x + b w, u = c x + d w, from a node's Thévenin wave to its effort; n states, the copies last."""

    A: Floats  # (n, n, copies)
    b: Floats  # (n, copies)
    c: Floats  # (n, copies)
    d: Floats  # (copies,)


def parallel(z: Floats, inductance: Floats | None, capacitance: Floats | None) -> Load:
    """L and C side by side, R being part of z.

    Parameters
    ----------
    z : ndarray, shape (copies,)
        Thévenin impedance, > 0.
    inductance, capacitance : ndarray, shape (copies,), or None
        H or F, > 0; at least one is given.

    Returns
    -------
    Load
        States are u, and z times the inductor's flow.

    Examples
    --------
    >>> parallel(np.array([50.0]), None, np.array([2e-3])).A.tolist()  # -1/(z C)
    [[[-10.0]]]
    """
    zero, one = np.zeros_like(z), np.ones_like(z)
    back = zero if inductance is None else z / inductance
    if capacitance is None:
        return _stacked([[-back]], [back], [-one], one)
    rate = 1 / (z * capacitance)
    if inductance is None:
        return _stacked([[-rate]], [rate], [one], zero)
    return _stacked([[-rate, -rate], [back, zero]], [rate, zero], [one, zero], zero)


def series(z: Floats, resistance: Floats | float, inductance: Floats | None, capacitance: Floats | None) -> Load:
    """R, L and C one after the other; states are z times the flow, and the capacitor's effort.

    Examples
    --------
    >>> series(np.array([50.0]), 30.0, np.array([4.0]), None).A.tolist()  # -(R + z)/L
    [[[-20.0]]]
    """
    zero, one, total = np.zeros_like(z), np.ones_like(z), resistance + z
    if inductance is None:
        assert capacitance is not None
        rate = 1 / (total * capacitance)
        return _stacked([[-rate]], [rate], [z / total], 1 - z / total)
    rate, back = total / inductance, z / inductance
    if capacitance is None:
        return _stacked([[-rate]], [back], [-one], one)
    return _stacked([[-rate, -back], [1 / (z * capacitance), zero]], [back, zero], [-one, zero], one)


def _stacked(A: list[list[Floats]], b: list[Floats], c: list[Floats], d: Floats) -> Load:
    return Load(np.array(A), np.array(b), np.array(c), d)
