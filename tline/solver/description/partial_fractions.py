"""A measured load: its poles as they were fitted, never multiplied out to coefficients of powers of s."""

from typing import TYPE_CHECKING

import numpy as np

from tline.solver.description.load_step import StateSpace

if TYPE_CHECKING:
    from passivity import PoleResidueModel


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
