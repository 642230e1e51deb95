"""Records of a rig that moves a contact slowly and quickly: random laws by SciPy, with 1 % noise in the force."""

from math import pi, sin

import numpy as np
from friction_moved import force_by_scipy
from numpy.typing import NDArray

from friction import Coulomb, Dahl, ElastoPlastic, Karnopp, LuGre, Model, Tanh

TIMES = np.linspace(0.0, 20.0, 2001)
NOISE = 0.01  # of the largest force


def velocity(t: float) -> float:
    """Strokes that grow and fade, and a faster motion of a tenth of a millimetre [m/s]."""
    return 0.06 * sin(0.5 * pi * t) * sin(0.1 * pi * t) + 0.004 * sin(3.4 * pi * t)


VELOCITY = np.array([velocity(float(t)) for t in TIMES])


def random_law(name: str, rng: np.random.Generator) -> Model:
    """Every parameter within a factor of 1.5 of a bearing's with a soft seal."""

    def near(value: float) -> float:
        return value * 1.5 ** rng.uniform(-1.0, 1.0)

    F_c, v_s, sigma0, viscous = near(1.0), near(0.01), near(3000.0), near(0.8)
    F_s, sigma1 = F_c * (1.0 + near(0.4)), near(20.0)
    return {
        "coulomb": lambda: Coulomb(F_c, viscous),
        "karnopp": lambda: Karnopp(F_c, F_s, viscous, v_s),
        "lugre": lambda: LuGre(F_c, F_s, v_s, sigma0, sigma1, viscous),
        "dahl": lambda: Dahl(F_c, sigma0),
        "elasto-plastic": lambda: ElastoPlastic(F_c, F_s, v_s, sigma0, sigma1, viscous, 0.5 * F_c / sigma0),
        "tanh": lambda: Tanh(F_c, F_s, viscous, v_s, near(0.002)),
    }[name]()


def record(law: Model, rng: np.random.Generator) -> NDArray:
    """Its force at `TIMES`, with noise; 0 at rest under a static law [N]."""
    force = np.nan_to_num(force_by_scipy(law, velocity, TIMES, tol=1e-8)[:, 1])
    return force + NOISE * np.max(np.abs(force)) * rng.normal(size=force.size)
