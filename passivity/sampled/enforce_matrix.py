"""The nearest passive model of several ports: the least change of residues under which no singular value exceeds 1.

Poles stay. Wherever the largest singular value of S(jw) has a maximum above 1, S = ... + u sigma v^H + ..., a passive
model must have Re(u^H S(jw) v) <= 1: a condition that is linear in residues and constant. All of them, old and new, are
kept, and what is made small under them is the sum of |change|^2 at the samples. The conditions are necessary, so the
limit is the best possible change but for SPARE. What comes out is proved, or not, by the exact test.

References
----------
B. Gustavsen, A. Semlyen, "Enforcing passivity for admittance matrices approximated by rational functions", IEEE
Transactions on Power Systems 16 (2001), 97-104, DOI 10.1109/59.910786.
S. Grivet-Talocia, "Passivity enforcement via perturbation of Hamiltonian matrices", IEEE Transactions on Circuits and
Systems I 51 (2004), 1755-1769, DOI 10.1109/TCSI.2004.834527 (singular values of S).
"""

import numpy as np
from numpy.typing import NDArray

from passivity.sampled.least_change import least_change, whitening
from passivity.sampled.matrix_model import MatrixModel
from passivity.sampled.model import terms

MAX_ROUNDS = 30
SPARE = 1e-4  # of the first violation: how far inside the bound is aimed at
LEAST_SPARE = 1e-9
BEYOND = 1e6  # times the highest frequency: stands for infinity
AROUND = np.tan(np.linspace(-1.5, 1.5, 17))  # of the half width of a resonance: frequencies that show it
EVEN = 100  # frequencies at equal ratios
CLOSER = 3  # rounds, ten times closer each, in which a maximum is located


def nearest_passive(model: MatrixModel, w: NDArray, also: NDArray) -> MatrixModel:
    """The nearest model of S that seems passive at all frequencies that show its resonances; the given one if it does.

    Parameters
    ----------
    model : MatrixModel
        All poles in Re s < 0.
    w : ndarray, shape (n,)
        Angular frequencies of the samples, rad/s, at which the change is measured.
    also : ndarray
        Further frequencies to look at, rad/s.
    """
    from scipy.linalg import solve_triangular

    x0, whiten = model.coefficients, whitening(terms(model.poles, w)[:, :-1])
    rows, bounds, spare, changed = [], [], 0.0, model
    for _ in range(MAX_ROUNDS):
        found = _violations(changed, w, also)
        if not found:
            return changed
        spare = spare or max(SPARE * (max(sigma for _, sigma, _, _ in found) - 1), LEAST_SPARE)
        for at, _, u, v in found:
            row = (terms(model.poles, np.array([at]))[0, :-1, None, None] * np.outer(u.conj(), v)).real
            rows.append(-solve_triangular(whiten, row.reshape(len(x0), -1), trans=1).ravel())
            bounds.append(spare - 1 + (row * x0).sum())
        step = least_change(np.array(rows), np.array(bounds))
        if step is None:
            return changed
        changed = MatrixModel.of_coefficients(
            model.poles, x0 + solve_triangular(whiten, step.reshape(len(x0), -1)).reshape(x0.shape)
        )
    return changed


def _violations(model: MatrixModel, w: NDArray, also: NDArray) -> list[tuple[float, float, NDArray, NDArray]]:
    """Frequency, singular value above 1 and its vectors u, v, wherever the largest has a maximum."""
    a, top = model.poles, max(w[-1], float(np.abs(model.poles).max(initial=0.0)))
    around = np.abs(a.imag[:, None] + a.real[:, None] * AROUND).ravel()
    even = np.geomspace(top / BEYOND, top * BEYOND, EVEN)
    grid = np.unique(np.concatenate([[0.0], w, also, around, even]))
    peaks = _peaks(model, grid)
    for _ in range(CLOSER):
        low, high = grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, len(grid) - 1)]
        between = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 12)
        grid = np.unique(between)
        peaks = _peaks(model, grid)
    left, sizes, right = np.linalg.svd(model.at(grid[peaks]))
    return [
        (float(grid[k]), float(sizes[i, j]), left[i, :, j], right[i, j].conj())
        for i, k in enumerate(peaks)
        for j in np.flatnonzero(sizes[i] > 1)
    ]


def _peaks(model: MatrixModel, grid: NDArray) -> NDArray:
    """Where the largest singular value is above 1 and no lower than at the neighbours."""
    sigma = np.pad(np.linalg.svd(model.at(grid), compute_uv=False)[:, 0], 1)
    inner = sigma[1:-1]
    return np.flatnonzero((inner > 1) & (inner >= sigma[:-2]) & (inner >= sigma[2:]))
