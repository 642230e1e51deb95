"""A rational load at a node, advanced over one slab by Radau IIA collocation.

The load is realised through its reflection (Z - z)/(Z + z) against the node's Thévenin impedance z, which is proper for
every passive Z, be Z or 1/Z improper. A switch beside the load only feeds part of the reflected wave back. One slab is
then a constant linear map from the Thévenin wave w at the points and the load's state at the slab's start to the
node's effort u at the points and the state at the slab's end.

A measured load: its poles as they were fitted, never multiplied out to coefficients of powers of s.
"""

from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.solver.description.given import Ratio
from tline.solver.radau import Basis, Matrix

if TYPE_CHECKING:
    from passivity import PoleResidueModel


class StateSpace(NamedTuple):
    """dx/dt = A x + b w, output c x + d w, with n states and k inputs and outputs."""

    A: Matrix  # (n, n)
    b: Matrix  # (n, k)
    c: Matrix  # (k, n)
    d: Matrix  # (k, k)


def reflection(impedance: Ratio, z: float, where: str) -> StateSpace:
    """Realise the reflection of a rational impedance against z in balanced companion form.

    For Z of degree 1 or more, and 0 < z finite; refused where Z + z falls to a lower degree, so that no wave is
    defined.
    """
    p, q = impedance
    n = max(len(p), len(q)) - 1
    p, q = (0,) * (n + 1 - len(p)) + p, (0,) * (n + 1 - len(q)) + q
    top, bottom = float(z).as_integer_ratio()
    if bottom * p[0] + top * q[0] < 0:  # let the leading coefficient be positive
        top, bottom = -top, -bottom
    numerator, denominator = [], []
    for a, b in zip(p, q, strict=True):
        numerator.append(bottom * a - top * b)
        denominator.append(bottom * a + top * b)
    leading, too_far = denominator[0], "its coefficients are too far apart for floating-point numbers"
    if leading == 0:
        raise InputError(
            where, f"its impedance tends to minus the line's {z:.6g} at high frequency: no wave is defined"
        )
    lowest = n
    while denominator[lowest] == 0:
        lowest -= 1
    larger = denominator[lowest].bit_length() - leading.bit_length()
    exponent = larger // lowest if lowest else 0  # of the rate 2**exponent, at which all are of one size

    def scaled(a: int, b: int, k: int) -> float:  # a/(b rate^k), rounded once
        return (a << max(-k * exponent, 0)) / (b << max(k * exponent, 0))

    try:
        rate, through = 2.0**exponent, numerator[0] / leading
        back = [-rate * scaled(denominator[k], leading, k) for k in range(1, n + 1)]
        out = [scaled(numerator[k] * leading - numerator[0] * denominator[k], leading**2, k) for k in range(1, n + 1)]
    except OverflowError:
        raise InputError(where, too_far) from None
    if not all(map(isfinite, (rate, through, *back, *out))):
        raise InputError(where, too_far)
    c, d = np.array([out]), np.array([[through]])
    if n == 1:
        return StateSpace(np.array([back]), np.array([[rate]]), c, d)
    A, b = np.zeros((n, n)), np.zeros((n, 1))
    A[0], b[0] = back, rate
    A.ravel()[n :: n + 1] = rate
    with np.errstate(all="ignore"):
        scale = _balance(A)
        system = StateSpace(A / scale[:, None] * scale, b / scale[:, None], c * scale, d)
    if not all(np.isfinite(part).all() for part in system):
        raise InputError(where, too_far)
    return system


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


def load_step(system: StateSpace, basis: Basis, h: float | Matrix) -> Matrix:
    """Radau IIA over one slab of width h for dx/dt = A x + b w, u = c x + d w (order 2s - 1 at the slab's end).

    A matrix (k s + n, k s + n) from (w, x) to (u, x at the slab's end): port by port the s points, then the states.
    Of many systems and widths, on axes in front that broadcast against each other, as many matrices.
    """
    s, (n, k) = basis.s, system.b.shape[-2:]
    size, given = n * s, k * s + n
    if n == k == 1 and system.b.ndim == 2:  # most often, and then arrays of two dimensions will do
        A, b, c, d = system
        integral, drive, step = h * basis.A, np.empty((s, given)), np.empty((given, given))
        implicit = -A * integral
        drive[:, :s], drive[:, s] = b * integral, 1.0
        implicit.ravel()[:: s + 1] += 1.0
        x = np.linalg.solve(implicit, drive)  # states at all points
        np.multiply(x, c, out=step[:s])
        step.ravel()[: s * given : given + 1] += d[0]  # of each point to itself
        step[s] = x[-1]
        return step
    integral = np.asarray(h)[..., None, None, None, None] * basis.A[:, None]
    implicit = -system.A[..., :, None, :, None] * integral
    lead = implicit.shape[:-4]
    implicit = implicit.reshape(*lead, size, size)
    implicit[..., range(size), range(size)] += 1.0
    drive = np.zeros((*lead, n, s, given))
    drive[..., : k * s] = (system.b[..., :, None, :, None] * integral).reshape(*lead, n, s, k * s)
    for j in range(n):
        drive[..., j, :, k * s + j] = 1.0
    x = np.linalg.solve(implicit, drive.reshape(*lead, size, given))
    step, points = np.empty((*lead, given, given)), np.arange(s)
    step[..., : k * s, :] = (system.c @ x.reshape(*lead, n, s * given)).reshape(*lead, k * s, given)
    for i, j in np.ndindex(k, k):
        step[..., i * s + points, j * s + points] += system.d[..., i, j, None]
    step[..., k * s :, :] = x[..., s - 1 :: s, :]
    return step


def reflection_of_poles(model: "PoleResidueModel", ratio: float) -> StateSpace:
    """Realise a load, whose reflection S against z0 is given by poles, by its reflection against z.

    Each pole is a state, each pair two of a rotation; S is kept to the last bit. The waves against z0 are combinations
    of those against z, a0 = (1 + z/z0)/2 a + (1 - z/z0)/2 r at the load, so that only the feedback of S is rounded.

    The model is of S, |S| <= 1; `ratio` is z0/z > 0.
    """
    n = len(model.coefficients) - 2
    A, b, c, k = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n)), 0
    for a, r in zip(model.poles, model.residues, strict=True):
        size = np.sqrt(abs(r)) or 1.0  # of inputs and outputs alike
        if a.imag > 0:
            A[k : k + 2, k : k + 2] = [[a.real, a.imag], [-a.imag, a.real]]
            b[k], c[0, k : k + 2] = 2 * size, [r.real / size, r.imag / size]
        else:
            A[k, k], b[k], c[0, k] = a.real, size, r.real / size
        k += 1 + (a.imag > 0)
    # u = (a0 + r0)/2 and z0 i = (a0 - r0)/2: with g = z0/z, a = u + z i = ((g + 1) a0 + (g - 1) r0)/(2 g)
    d = np.array([[model.constant]])
    direct = (ratio + 1) + (ratio - 1) * model.constant
    given, back = 2 * ratio / direct, (1 - ratio) / direct  # a0 = given a + back c x
    through = (ratio - 1) / (2 * ratio) + (ratio + 1) / (2 * ratio) * d  # r of a0
    output = (ratio + 1) / (2 * ratio) * c + back * through * c
    return StateSpace(A + back * b @ c, given * b, output, given * through)
