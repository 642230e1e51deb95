"""Laws beside a linear rest with a memory, by another method: BDF2's convolution quadrature on a fine grid, in numpy.

Nothing is shared with the solver: no waves, no slabs, no stages, no moved delays, no compiled law. The rest is an
impedance matrix Z(s) at the laws and the efforts there without them: v = e(t) - Z(d/dt) i, i = f(v) at each instant.
"""

from collections.abc import Callable, Sequence

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


def efforts_at_nodes(
    rest: Callable[[NDArray], tuple[NDArray, NDArray, NDArray, NDArray]],
    sources: Sequence[Callable[[NDArray], NDArray]],
    laws: Sequence[Callable[[float, float], tuple[float, float]]],
    t_end: float,
    n: int,
) -> tuple[NDArray, NDArray]:
    """Instants (n,) and efforts (n, P) at nodes, of several sources, and laws that may change with time.

    `rest` maps s to Z at the laws (m, K, K), efforts there per unit of each source (m, K, S), Z from laws to nodes
    (m, P, K), and efforts there per source (m, P, S). A law maps an effort and an instant to a flow and its slope.
    """
    h, length = t_end / n, 2 * n
    radius = np.finfo(float).eps ** (1 / (2 * length))
    zeta = radius * np.exp(-2j * np.pi * np.arange(length // 2 + 1) / length)
    Z, into_laws, seen, into_nodes = rest((1 - zeta) * (3 - zeta) / (2 * h))
    undo = radius ** -np.arange(n)[:, None]
    t, K = np.arange(1, n + 1) * h, Z.shape[1]
    driven = np.fft.rfft(np.stack([source(t) for source in sources], axis=1) / undo, length, axis=0)

    def back(transforms: NDArray) -> NDArray:
        return np.fft.irfft(transforms, length, axis=0)[:n] * undo

    u = back((into_nodes @ driven[:, :, None])[:, :, 0])
    if not K:
        return t, u
    weights = back(Z.reshape(len(Z), -1)).reshape(n, K, K)
    aims = back((into_laws @ driven[:, :, None])[:, :, 0])
    reversed_weights = np.ascontiguousarray(weights[::-1].transpose(1, 0, 2)).reshape(K, -1)
    v, i, one = np.zeros((n, K)), np.zeros((n, K)), np.eye(K)
    for k in range(n):
        past = reversed_weights[:, (n - 1 - k) * K : (n - 1) * K] @ i[:k].ravel()
        now, aim, damped = v[k - 1].copy(), aims[k] - past, 1.0
        for step in range(400):
            flow, slope = np.array([law(float(e), float(t[k])) for law, e in zip(laws, now, strict=True)]).T
            move = np.linalg.solve(one + weights[0] * slope, now - aim + weights[0] @ flow)
            now -= damped * np.clip(move, -0.2, 0.2)
            damped = 1.0 if step < 40 else 0.5
            if np.abs(move).max() < 1e-12:
                break
        v[k], i[k] = now, flow
    return t, u - back((seen @ np.fft.rfft(i / undo, length, axis=0)[:, :, None])[:, :, 0])
