"""Convolution quadrature by Radau IIA: response of a transfer function to polynomials on slabs.

With stage values g_k on slab k and G(ζ) = sum g_k ζ^k, Radau IIA turns d/dt into D(ζ)/h, D(ζ) = A^-1 (1 - ζ 1 e^T),
with e^T the last row of the unit matrix. So K(d/dt) g has the stage values whose sum is K(D(ζ)/h) G(ζ). D has s
eigenvalues; K is needed there alone, and sums over slabs are Fourier transforms on a circle |ζ| = λ.

References
----------
C. Lubich, A. Ostermann: Runge-Kutta methods for parabolic equations and convolution quadrature, Math. Comp. 60 (1993)
105-131, doi:10.1090/S0025-5718-1993-1153166-7.

A line cannot create energy where Radau IIA approximates all of exp(-sT). The scattering S of the line is analytic, and
at most 1, where Re s > 0; the numerical range of D(ζ) lies there for |ζ| < 1, in the norm of the weights of Radau's
quadrature; so ‖S(D)‖ <= 1, by von Neumann's inequality. Where whole slabs of the delay are moved as they are, ζ^m
replaces a part of exp(-sT), and the norm is computed.

References
----------
J. von Neumann, Math. Nachr. 4 (1951) 258-281, doi:10.1002/mana.3210040124.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.loss import LossyLine
from tline.solver.description.bundle import Bundle
from tline.solver.radau import Basis, basis, thin_product
from tline.solver.stability.scattering import carried

PADDED = 1, 2, 3, 7, 15  # lengths of a transform over the number of slabs
ALIASING_SHARE = 0.2  # of a tolerance: largest error by aliasing and rounding
ANCHORS, STEPS = 64, 6  # places from which eigenvalues are followed, and steps of Newton's method
WRONG = 1e-12  # largest error of a product of eigenvectors and their inverses
EPS = float(np.finfo(float).eps)
MOST_GAIN = 1 + 1e-9  # largest gain of a line that creates no energy, with rounding
SMOOTH = 8, 9, 10, 12, 15  # times powers of 2: lengths of fast transforms
KEPT_SLABS = 1000  # slabs of transforms whose modes are kept for the next scene
SLOWEST, PLACES = 1e-6, 400  # cycles per slab, and from there to a half
FAST, SPARSE = 0.3, 8  # smallest eigenvalue of a change within a few slabs; one in so many is looked at
GROWING = np.geomspace(0.1, 1e3, 100)  # rates of growth per slab, from the smallest seen within a few slabs on


def rounding(padded: int) -> float:
    """Error by aliasing and rounding, of the largest value, of transforms `padded` times as long as the slabs."""
    return (1e3 if padded > 1 else 5e3) * EPS ** (padded / (padded + 1))


def padding(tol: float) -> int:
    """Times the slabs that transforms need for a tolerance."""
    return next((padded for padded in PADDED if rounding(padded) <= ALIASING_SHARE * tol), PADDED[-1])


Modes = tuple[NDArray, NDArray, NDArray]  # D at n places: eigenvalues (n, s), eigenvectors (n, s, s), their inverses


def derivative(basis: Basis, zeta: NDArray) -> Modes:
    """D at places ζ that follow each other closely, such as those of a circle.

    Its eigenvalues λ are the roots of R(λ) = 1/ζ, with R the stability function, by Newton's method from those at the
    nearest of a few places; eigenvectors are (1 - λA)^-1 1, and from the left e^T A (1 - λA)^-1 / R'(λ).
    """
    anchors = np.arange(0, len(zeta), max(len(zeta) // ANCHORS, 1))
    start = _by_decomposition(basis, zeta[anchors])[0]
    rates = start[np.minimum((np.arange(len(zeta)) * len(anchors)) // len(zeta), len(anchors) - 1)]
    alpha, X = np.linalg.eig(basis.A)
    above, below = (np.real(np.poly(each)) for each in (np.linalg.eigvals(basis.A - basis.A[-1]), alpha))  # of 1/λ
    sums = below - zeta[:, None] * above  # by rising powers of λ
    for _ in range(STEPS):
        value, slope = np.zeros_like(rates), np.zeros_like(rates)
        for coef in sums.T[::-1]:
            slope = slope * rates + value
            value = value * rates + coef[:, None]
        rates = rates - value / slope
    one, last, back = np.linalg.solve(X, np.ones(basis.s)), X[-1] * alpha, np.linalg.inv(X)
    share = 1 / (1 - rates[:, :, None] * alpha)
    vectors = np.swapaxes(share @ (X * one).T, 1, 2)
    inverse = (share @ (last[:, None] * back)) / ((share * share) @ (last * one))[:, :, None]
    wrong = ~(np.abs(vectors @ inverse - np.eye(basis.s)).max(axis=(1, 2)) < WRONG)
    if wrong.any():
        for part, right in zip((rates, vectors, inverse), _by_decomposition(basis, zeta[wrong]), strict=True):
            part[wrong] = right
    return rates, vectors, inverse


def _by_decomposition(basis: Basis, zeta: NDArray) -> Modes:
    inverse, last = np.linalg.inv(basis.A), np.eye(basis.s)[-1]
    rates, vectors = np.linalg.eig(inverse - zeta[:, None, None] * np.outer(inverse.sum(axis=1), last))
    return rates, vectors, np.linalg.inv(vectors)


def _places(radius: float, n: int) -> NDArray:
    """Half a circle, on which a transform of n real numbers is known."""
    return radius * np.exp(-2j * np.pi * np.arange(n // 2 + 1) / n)


def on_circle(s: int, radius: float, n: int) -> Modes:
    """D of order s on half a circle."""
    return derivative(basis(s), _places(radius, n))


_kept = lru_cache(maxsize=16)(on_circle)


def _smooth(n: int) -> int:
    halved = max(n.bit_length() - 4, 0)
    return min(part * 2**k for part in SMOOTH for k in (halved, halved + 1) if part * 2**k >= n)


class Quadrature:
    """Transforms of values at the Radau points of n slabs of width h.

    Parameters
    ----------
    basis : Basis
    h : float
        s.
    n : int
    padded : int
        Smallest length of transforms over n: see `padding`.

    Examples
    --------
    >>> from tline.solver.radau import basis
    >>> rule = Quadrature(basis(3), h=0.1, n=20)
    >>> decay = rule.backward(rule.forward(np.ones((20, 3, 1))) / (rule.points[:, None] + 1))  # of x' + x = 1
    >>> bool(abs(decay[-1, -1, 0] - (1 - np.exp(-2))) < 1e-8)
    True
    """

    def __init__(self, basis: Basis, h: float, n: int, padded: int = PADDED[-1]):
        self.n, self.h, self.length = n, h, _smooth(padded * n)
        radius = EPS ** (1 / (n + self.length))  # makes aliasing as small as the rounding of the last slabs
        self.decay = radius ** np.arange(n)
        rates, self._from_eigen, self._to_eigen = (_kept if n <= KEPT_SLABS else on_circle)(
            basis.s, radius, self.length
        )
        self.points: NDArray = rates.ravel() / h  # where transfer functions are needed, 1/s
        late = -np.log(_places(radius, self.length))[:, None] - rates
        self.late: NDArray = late.ravel()  # of a slab, excess of its delay over sh

    def forward(self, values: NDArray) -> NDArray:
        """Transforms at all points, shape (points, k), of values of shape (n, s, k)."""
        sums = np.fft.rfft(values * self.decay[:, None, None], self.length, axis=0)
        return (self._to_eigen @ sums).reshape(len(self.points), -1)

    def backward(self, transforms: NDArray) -> NDArray:
        """Values, shape (n, s, k), of transforms of shape (points, k)."""
        every = transforms.reshape(*self._from_eigen.shape[:2], -1)
        sums = np.swapaxes(thin_product(*(np.swapaxes(each, 1, 2) for each in (every, self._from_eigen))), 1, 2)
        return np.fft.irfft(sums, self.length, axis=0)[: self.n] / self.decay[:, None, None]

    def weights(self, transfer: NDArray) -> NDArray:
        """Weights S_0, S_1, … by which values of slabs send others, shape (n, K s, K s), port by port.

        `transfer` has the shape (points, K, K), of K ports.
        """
        K, (places, s, _) = transfer.shape[1], self._from_eigen.shape
        at, found = transfer.reshape(places, s, K, K), np.empty((self.n, K, s, K, s))
        for a in range(K):
            for b in range(K):
                sums = (self._from_eigen * at[:, None, :, a, b]) @ self._to_eigen
                found[:, a, :, b] = np.fft.irfft(sums, self.length, axis=0)[: self.n] / self.decay[:, None, None]
        return found.reshape(self.n, K * s, K * s)


def gain(line: LossyLine, z0: float, order: Basis, h: float, slabs: float) -> float:
    """The largest norm of the scattering of a line, at places all round the circle |ζ| = 1.

    The line has the impedance z0 for a front; `slabs` whole slabs of its delay, h s each, move waves as they are.
    """
    rates, late, vectors, inverse = circle(order.s)
    across, back = carried(line, z0, rates.ravel() / h, slabs * late.ravel())
    modes = ((across + sign * back).reshape(-1, 1, order.s) for sign in (1, -1))  # of equal and opposite waves
    return max(float(np.linalg.norm((vectors * mode) @ inverse, 2, axis=(1, 2)).max()) for mode in modes)


def bundle_creates_energy(bundle: Bundle, order: Basis, h: float, slabs: NDArray) -> bool:
    """Whether that norm of coupled conductors whose modes mix is beyond 1, in power waves; slabs of each mode."""
    rates, late, vectors, inverse = circle(order.s)
    own, other = bundle.admittances(rates.ravel() / h, np.outer(late.ravel(), slabs))
    root, k = np.sqrt(bundle.z0), len(bundle.z0)
    for sign in (1, -1):  # of equal and opposite waves
        seen = root[:, None] * (own + sign * other) * root
        back = np.linalg.solve(np.eye(k) + seen, np.eye(k) - seen).reshape(-1, order.s, k, k)
        whole = np.einsum("nij,njab,njl->nialb", vectors, back, inverse, optimize=True)
        whole = whole.reshape(-1, order.s * k, order.s * k)
        try:
            np.linalg.cholesky(MOST_GAIN**2 * np.eye(order.s * k) - np.swapaxes(whole.conj(), 1, 2) @ whole)
        except np.linalg.LinAlgError:
            return True
    return False


@lru_cache
def fast(s: int) -> NDArray:
    """Some eigenvalues of D on |ζ| = 1, of changes within a few slabs, and behind them rates of growth."""
    rates = circle(s)[0].ravel()
    return np.append(rates[np.abs(rates) > FAST][::SPARSE], GROWING)


@lru_cache
def circle(s: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Eigenvalues of D, excess of a slab's delay over them, eigenvectors with inverse, in the norm of the weights."""
    order = basis(s)
    zeta = np.exp(-2j * np.pi * np.geomspace(SLOWEST, 0.5, PLACES))
    rates, vectors, inverse = derivative(order, zeta)
    root = np.sqrt(order.A[-1])
    return rates, -np.log(zeta)[:, None] - rates, root[:, None] * vectors, inverse / root
