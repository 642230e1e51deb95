"""Laws beside a linear rest with a memory, by another method: BDF2's convolution quadrature on a fine grid, in numpy.

Nothing is shared with the solver: no waves, no slabs, no stages, no moved delays, no compiled law. The rest is an
impedance matrix Z(s) at the laws and the efforts there without them: v = e(t) - Z(d/dt) i, i = f(v) at each instant.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray


def efforts_at_laws(
    rest: Callable[[NDArray], tuple[NDArray, NDArray]],
    source: Callable[[NDArray], NDArray],
    law: Callable[[NDArray], tuple[NDArray, NDArray]],
    t_end: float,
    n: int,
) -> tuple[NDArray, NDArray]:
    """Instants (n,) and efforts (n, K) across laws.

    Parameters
    ----------
    rest : callable
        s of shape (m,) to Z (m, K, K) and to the efforts without laws per unit of the source (m, K).
    source : callable
        Over time; 0 at t <= 0.
    law : callable
        Efforts (K,) to flows and their slopes.
    t_end : float
    n : int
        Steps.

    References
    ----------
    C. Lubich: Convolution quadrature and discretized operational calculus I, Numer. Math. 52 (1988) 129-145,
    doi:10.1007/BF01398686.
    """
    h, length = t_end / n, 2 * n
    radius = np.finfo(float).eps ** (1 / (2 * length))
    zeta = radius * np.exp(-2j * np.pi * np.arange(length // 2 + 1) / length)
    Z, per_source = rest((1 - zeta) * (3 - zeta) / (2 * h))
    undo = radius ** -np.arange(n)
    weights = np.fft.irfft(Z, length, axis=0)[:n] * undo[:, None, None]
    t = np.arange(1, n + 1) * h
    driven = np.fft.rfft(source(t) / undo, length)
    open_efforts = np.fft.irfft(per_source * driven[:, None], length, axis=0)[:n] * undo[:, None]
    K = Z.shape[1]
    reversed_weights = weights[::-1].transpose(1, 0, 2).reshape(K, -1)
    v, i, one = np.zeros((n, K)), np.zeros((n, K)), np.eye(K)
    for k in range(n):
        past = reversed_weights[:, (n - 1 - k) * K : (n - 1) * K] @ i[:k].ravel()
        aim, now = open_efforts[k] - past, v[k - 1].copy()
        for _ in range(200):
            flow, slope = law(now)
            step = np.linalg.solve(one + weights[0] * slope, now - aim + weights[0] @ flow)
            now -= np.clip(step, -0.2, 0.2)
            if np.abs(step).max() < 1e-13:
                break
        v[k], i[k] = now, law(now)[0]
    return t, v
