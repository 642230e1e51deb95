"""The pulley from a balance of forces in both directions, checked against the model in use."""

import math
from dataclasses import dataclass

import numpy as np

from drives.coupled import CoupledDrives
from drives.parts import Pulley
from drives.symbolic import transfer

DEFLECTION = -0.01  # m, for the check


@dataclass(frozen=True)
class PulleyCheck:
    """Balances solved at one deflection, compared with the model.

    Attributes
    ----------
    x_k : float
        m.
    F1, F2 : float
        From the horizontal and the vertical balance, N.
    by_model, by_stiffness : float
        Tension by `Pulley.tension`, and k_p e_p, N.
    power : float
        F1 v1 - F2 v2 less the spring's F_k v_k at v_k = 1 m/s, W; 0 but for rounding.
    """

    x_k: float
    F1: float
    F2: float
    by_model: float
    by_stiffness: float
    power: float


def check_pulley(pulley: Pulley, x_k: float = DEFLECTION) -> PulleyCheck:
    """Solve both balances for F1 and F2 and compare.

    Parameters
    ----------
    pulley : Pulley
    x_k : float
        Deflection [m], negative under tension.

    Examples
    --------
    >>> found = check_pulley(CoupledDrives().pulley)
    >>> [round(force, 6) for force in (found.F1, found.F2, found.by_model, found.by_stiffness)]
    [1.414214, 1.414214, 1.414214, 1.414214]
    """
    sine, cosine = math.sin(pulley.angle), math.cos(pulley.angle)
    spring = -float(pulley.stiffness) * x_k
    first, second = np.linalg.solve([[-sine, sine], [-cosine, -cosine]], [0.0, -spring])
    v1, v2 = cosine, -cosine  # v1 - v2 = 2 v_k cos(theta) at v_k = 1 m/s
    return PulleyCheck(
        x_k,
        float(first),
        float(second),
        pulley.tension(x_k),
        float(pulley.belt_stiffness) * -2 * x_k * cosine,
        float(first * v1 - second * v2 - spring),
    )


def wrong_sign(drives: CoupledDrives) -> complex:
    """Rightmost pole of the tension if the pulley had F_k = +k x_k, rad/s: a spring of negative stiffness.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> round(wrong_sign(CoupledDrives()).real, 3)
    306.525
    """
    parameters = drives.parameters | {"k": -drives.pulley.stiffness}
    return max(transfer(parameters, "tension", "T1").poles, key=lambda z: z.real)
