"""Exact evolution over a slab of a piece of lossy line one slab long, projected on polynomials.

In units of a slab, of z0 and of the travel time x, with u the effort, v the flow and a = u + v, b = u - v,

    u_t + v_x = -g0 u - sum g_k (u - q_k),  q_k' = p_k (u - q_k),
    v_t + u_x = -r0 v - sum r_k (v - w_k),  w_k' = p_k (v - w_k).

In Laplace's z these are Y u + v_x = f and Z v + u_x = e, where f and e are due to what was there at t = 0. With
polynomials a°, b° that solve the equations, and with A and B, which enter at the left and at the right,

    a = a° + (A - a°(0)) exp(-γ x) + K (B - b°(1)) exp(-γ (1 - x)),  γ = √(Y Z),  K = (Zc - 1)/(Zc + 1),  Zc = √(Z/Y),

and b is its mirror image; what comes with exp(-γ) once more is left out, for it only begins at t = 1. All this is
analytic but for z <= 0. So a contour round there gives what is at t = 1 by few of its points, however stiff the
circuits are. Great parts cancel: the polynomials grow outside the piece, so the arithmetic has digits to spare.

References
----------
L. N. Trefethen, J. A. C. Weideman, T. Schmelzer, BIT 46 (2006) 653-670, doi:10.1007/s10543-006-0077-9: the contour.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from flint import acb, acb_mat, arb, ctx
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tline.loss.arithmetic import BALLS
from tline.loss.foster import Foster
from tline.solver.radau import Matrix, basis

POINTS = 24, 6  # of the contour: some, and some for each order
BITS = 4  # for each of them

Balls = NDArray[Any]  # of acb


def evolution(series: Foster, shunt: Foster, h: float, s: int) -> Matrix:
    """From values at the points of (a, b, w.., q.., a and b that enter) to (a, b, w.., q.., a and b that leave).

    Parameters
    ----------
    series, shunt : Foster
        Circuits per metre; what they store fixes z0 and the speed.
    h : float
        Slab, s.
    s : int
        Order, above 0.

    Returns
    -------
    ndarray, shape ((n + 2) s, (n + 2) s)
        For n fields over x, and two waves over t.

    Examples
    --------
    >>> lossless = Foster(0, 1, [], [])
    >>> evolution(lossless, lossless, h=1, s=1).round(12).tolist()
    [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    """
    points = POINTS[0] + POINTS[1] * s
    with ctx.workprec(BITS * points):
        given, seen, responses = [], [], []
        for z, weight in _contour(points):
            Z, Y = (z + h / law.storage * law.beyond(z / h, BALLS) for law in (series, shunt))
            for parts, part in zip((given, seen), _memories(series, shunt, h, z), strict=True):
                parts.append(part)
            responses.append((weight * _response(z, Z, Y, s)).reshape(4, s, 4, s))
        fields, waves = slice(2), slice(2, 4)
        same = [_balls(np.eye(2))] * len(responses)
        whole = np.block(
            [
                [
                    _summed(out, [each[rows][:, :, columns] for each in responses], into)
                    for into, columns in ((given, fields), (same, waves))
                ]
                for out, rows in ((seen, fields), (same, waves))
            ]
        )
    for k, p in enumerate(h * np.concatenate([series.rates, shunt.rates]), start=2):
        whole[k * s : (k + 1) * s, k * s : (k + 1) * s] += np.exp(-p) * np.eye(s)
    order, every = basis(s), np.eye(len(whole) // s)
    return np.kron(every, order.to_points) @ whole @ np.kron(every, order.to_legendre)


def _contour(points: int) -> Iterator[tuple[acb, acb]]:
    """Half of the points z, and weights: f(1) is the real part of the weighted sum of its transform there."""
    one, other, third, fourth = (arb(x) / 10_000 for x in (5017, 6407, 6122, 2645))
    for k in range(points // 2):
        angle = arb.pi() * (2 * k + 1) / points
        cot = (angle * other).cot()
        z = points * acb(one * angle * cot - third, fourth * angle)
        slope = acb(one * (cot - angle * other * (1 + cot**2)), fourth)
        yield z, 2 * z.exp() * slope / acb(0, 1)


def _memories(series: Foster, shunt: Foster, h: float, z: acb) -> tuple[Balls, Balls]:
    """From the fields to (f, e), shape (2, n), and from (a, b) to the fields, shape (n, 2)."""
    half, zero = acb(1) / 2, acb(0)
    given, seen = [(half, half), (half, -half)], [(acb(1), zero), (zero, acb(1))]
    for law, sign in (series, -1), (shunt, 1):
        for strength, rate in zip((h / law.storage * law.strengths).tolist(), (h * law.rates).tolist(), strict=True):
            source, answer = strength / (z + rate), half * rate / (z + rate)
            given.append((zero, source) if sign < 0 else (source, zero))
            seen.append((answer, sign * answer))
    return np.array(given, object).T, np.array(seen, object)


def _response(z: acb, Z: acb, Y: acb, s: int) -> Balls:
    """From Legendre coefficients of (f, e, A, B) to those of (a, b, a that leaves, b that leaves); (4 s, 4 s)."""
    D, right, left = _derivatives(s), _balls(np.ones(s)), _balls((-1.0) ** np.arange(s))
    series, shunt = (Z / z).sqrt(), (Y / z).sqrt()
    gamma, K = z * series * shunt, (series - shunt) / (series + shunt)
    inverse = np.add.reduce([D[j] / (Y * Z) ** (j // 2 + 1) for j in range(0, s, 2)])  # of γ² - D²
    slope, nothing, over_t = D[1] @ inverse, 0 * D[0], _transforms(z, s)
    a = np.hstack([Z * inverse - slope, Y * inverse - slope, nothing, nothing])
    b = np.hstack([Z * inverse + slope, -Y * inverse - slope, nothing, nothing])
    A = np.concatenate([nothing[0], nothing[0], over_t, nothing[0]]) - left @ a
    B = np.concatenate([nothing[0], nothing[0], nothing[0], over_t]) - right @ b
    norm = _balls(2.0 * np.arange(s) + 1)
    decay, past = norm * _transforms(gamma, s), norm * left * over_t
    return np.vstack(
        [
            a + np.outer(decay, A) + np.outer(left * decay, K * B),
            b + np.outer(decay, K * A) + np.outer(left * decay, B),
            np.outer(past, right @ a + K * B),
            np.outer(past, left @ b + K * A),
        ]
    )


@lru_cache
def _derivatives(s: int) -> Balls:
    """All derivatives of a Legendre series on [0, 1], as matrices, shape (s + 1, s, s)."""
    first = np.zeros((s, s))
    for k in range(1, s):
        first[:k, k] = 2 * legendre.legder(np.eye(s)[k])[:k]
    powers = [_balls(np.eye(s))]
    for _ in range(s):
        powers.append(_balls(first) @ powers[-1])
    return np.array(powers)


def _transforms(z: acb, s: int) -> Balls:
    """Laplace transforms of the Legendre polynomials on [0, 1], continued; also ∫ P exp(-z x) dx but for exp(-z)."""
    at_zero = _balls((-1.0) ** np.arange(s)) @ _derivatives(s)
    return np.add.reduce([at_zero[j] / z ** (j + 1) for j in range(s)])


def _balls(values: NDArray) -> Balls:
    balls = np.empty(values.shape, object)
    balls.ravel()[:] = [acb(x) for x in values.ravel().tolist()]
    return balls


def _summed(out: list[Balls], responses: list[Balls], into: list[Balls]) -> Matrix:
    """Real part of the sum of (out x 1) response (1 x into), with 1 on the s coefficients."""
    rows, columns, s = len(out[0]), into[0].shape[1], responses[0].shape[1]
    pairs = [
        (left[:, None, :, None] * right.T[:, None]).reshape(rows * columns, -1)
        for left, right in zip(out, into, strict=True)
    ]
    parts = [each.transpose(0, 2, 1, 3).reshape(-1, s * s) for each in responses]
    left, right = (acb_mat(each.tolist()) for each in (np.hstack(pairs), np.vstack(parts)))
    real = np.array([float(x.real.mid()) for x in (left * right).entries()])
    return real.reshape(rows, columns, s, s).transpose(0, 2, 1, 3).reshape(rows * s, columns * s)
