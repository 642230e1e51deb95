"""Growth rates that theory predicts for methods on one line of delay 1; nothing here runs a method.

All rates are per transit: waves grow as exp(rate t). A line lies between reflections whose product is g; where the ends
are lossless, g = 1.
"""

import numpy as np
from numpy.typing import NDArray

ANGLES = np.linspace(0.0, np.pi, 721)  # phase of a wave from cell to cell


def upwind(courant: float, cells: int) -> float:
    """Von Neumann growth rate of upwind: amplification 1 - C + C exp(-i theta) per step."""
    return _per_transit(np.abs(1 - courant + courant * np.exp(-1j * ANGLES)).max(), courant, cells)


def lax_wendroff(courant: float, cells: int) -> float:
    """Von Neumann growth rate of Lax-Wendroff: amplification 1 - i C sin(theta) - C² (1 - cos(theta)) per step."""
    factor = 1 - 1j * courant * np.sin(ANGLES) - courant**2 * (1 - np.cos(ANGLES))
    return _per_transit(np.abs(factor).max(), courant, cells)


def leapfrog(courant: float, cells: int) -> float:
    """Von Neumann growth rate of leapfrog: z + 1/z = 2 - 4 C² sin²(theta/2), so 2 arcosh(C) beyond C = 1."""
    half = 1 - 2 * (courant * np.sin(ANGLES / 2)) ** 2
    return _per_transit(np.abs(half - np.sqrt(half**2 - 1 + 0j)).max(), courant, cells)


def _per_transit(factor: float, courant: float, cells: int) -> float:
    return float(np.log(max(factor, 1.0))) * cells / courant + 0.0


def delay_roots(weights: tuple[float, float, float, float], late: int, delay: float) -> float:
    """Growth rate from the roots of z^late = ±(w0 z + w1 + w2/z + w3/z²): a lossless loop with interpolation."""
    largest = 0.0
    for sign in (1.0, -1.0):
        polynomial = np.zeros(late + 3)
        polynomial[0] = 1.0
        polynomial[late - 1 :] -= sign * np.array(weights)
        largest = max(largest, np.abs(np.roots(polynomial)).max())
    return delay * float(np.log(largest))


def slab_matrix(now: NDArray, before: NDArray, late: int, delay: float) -> float:
    """Growth rate of slabs on a lossless loop, v[k] = ±(now v[k - late] + before v[k - late - 1]), per delay."""
    s, largest = len(now), 0.0
    for sign in (1.0, -1.0):
        step = np.eye(s * (late + 1), k=-s)
        step[:s, -2 * s : -s], step[:s, -s:] = sign * now, sign * before
        largest = max(largest, np.abs(np.linalg.eigvals(step)).max())
    return delay * float(np.log(largest))


def euler_load(x: float, steps: int) -> float:
    """Growth rate of forward Euler behind a matched line: factor 1 - x per step, x = step times rate of the load."""
    return steps * float(np.log(abs(1 - x)))


def backward_load(x: float, steps: int) -> float:
    """Growth rate of backward Euler behind a matched line: factor 1/(1 + x) per step."""
    return -steps * float(np.log1p(x))


def trapezoid_load(x: float, steps: int) -> float:
    """Growth rate of the trapezoidal rule behind a matched line: factor (1 - x/2)/(1 + x/2) per step."""
    return steps * float(np.log(abs((1 - x / 2) / (1 + x / 2))))


def euler_loop(x: float, steps: int, share: float) -> float:
    """Growth rate of forward Euler at a line with a lossless other end: z^(2 steps) = R(z) = 2 share x/(z - 1 + x) - 1.

    |R| > 1 at z = -1 for every x > 0: the passive load has become an active one.
    """
    polynomial = np.zeros(2 * steps + 2)
    polynomial[:2] = 1.0, x - 1
    polynomial[-2:] += 1.0, x - 1 - 2 * share * x
    return steps * float(np.log(np.abs(np.roots(polynomial)).max()))


def gain(g: float) -> float:
    """Growth rate of the line itself: ln|g|/2, since each round trip of 2 multiplies by g."""
    return float(np.log(g)) / 2


def pi_chain(near: float, far: float, cells: int) -> float:
    """Growth rate of a chain of pi sections between two conductances, 1/z0: largest real part of its eigenvalues."""
    D, heavy, G = _chain(near, far, cells)
    A = np.block([[-G / heavy[:, None], D.T / heavy[:, None]], [-D, np.zeros((cells, cells))]])
    return cells * float(np.linalg.eigvals(A).real.max())


def t_chain(near: float, far: float, cells: int) -> float:
    """Growth rate of a chain of T sections: that of the dual chain, between resistances, in units of z0."""
    return pi_chain(1 / near, 1 / far, cells)


def leapfrog_chain(near: float, far: float, courant: float, cells: int) -> float:
    """Growth rate of leapfrog on a chain of pi sections, conductances by the mean of old and new effort."""
    D, heavy, G = _chain(near, far, cells)
    flow = np.hstack([-courant * D, np.eye(cells)])
    drive = np.hstack([np.diag(heavy) - courant * G / 2, np.zeros((cells + 1, cells))]) + courant * D.T @ flow
    step = np.vstack([np.linalg.solve(np.diag(heavy) + courant * G / 2, drive), flow])
    return cells / courant * float(np.log(np.abs(np.linalg.eigvals(step)).max()))


def _chain(near: float, far: float, cells: int) -> tuple[NDArray, NDArray, NDArray]:
    """Differences from cell edge to cell edge, capacitances at the edges in units of a cell's, conductances."""
    D = np.eye(cells, cells + 1, k=1) - np.eye(cells, cells + 1)
    heavy = np.ones(cells + 1)
    heavy[[0, cells]] = 0.5
    return D, heavy, np.diag([near, *[0.0] * (cells - 1), far])
