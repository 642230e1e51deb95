"""Laws of contacts that stick like springs up to limits, then slide: Maxwell slip, Armstrong of seven parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from friction.kernel.structures import ARMSTRONG, F_C, F_S, F_V, MAXWELL, STIFFNESS
from friction.motion import Motion
from friction.parameters import Parameters
from tline.compiled.structure import pack
from tline.errors import InputError

MOST_LEGS = 5_000_000


@dataclass(frozen=True)
class SpringContact(Parameters):
    """A law of `events` that has springs."""

    name: ClassVar[str]
    signal: ClassVar[int]  # kind of a signal in the kernels
    place = "model"
    viscous = 0.0  # friction beside the springs [N s/m]

    @property
    def elements(self) -> list[tuple[float, ...]]:
        """A row for each spring: F_c, F_s, viscous friction while it slides, v_s, 0, stiffness, lag, dwell."""
        raise NotImplementedError

    @property
    def sliding(self) -> float:
        """F_c [N]."""
        return sum(row[F_C] for row in self.elements)

    @property
    def stiction(self) -> float:
        """F_s [N]."""
        return sum(row[F_S] for row in self.elements)

    def bent(self, forces: NDArray, modes: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Mean deflection [m] and energy [J] of the springs, from their forces [N] and modes, of shape (n, springs)."""
        viscous, stiffness = (np.array([row[column] for row in self.elements], float) for column in (F_V, STIFFNESS))
        held = forces - viscous * v[:, None] * (modes != 0.0)
        return held.sum(axis=1) / stiffness.sum(), 0.5 * (held**2 / stiffness).sum(axis=1)

    def moved(self, motion: Motion, times: NDArray, t_end: float) -> NDArray:
        """F_f [N] at times under a prescribed motion, from no force on.

        Raises InputError: it takes more than 5 million legs, or more than 4096 lie within one lag.
        """
        from friction.kernel.automaton import automaton
        from friction.kernel.law import DONE, STALLED
        from friction.kernel.structures import Inputs
        from friction.mechanism import MOST_PAST, Mechanism

        m = Mechanism()
        f_f, _ = m.contact(self, m.input())
        power = np.ascontiguousarray(motion.cubic[:, None, :])
        run = m.prepared(times, [f_f], Inputs(motion.start, power, *motion.sine), t_end=t_end)
        status = automaton(pack(run), MOST_LEGS)
        if status == STALLED:
            raise InputError("model.lag", "the motion has too many pieces within it", f"at most {MOST_PAST:,}")
        if status != DONE:
            raise InputError(
                "t_end", "the motion takes too many steps", f"at most {MOST_LEGS:,}", f"more at {t_end:g} s"
            )
        return run.record[:, 1]


@dataclass(frozen=True)
class MaxwellSlip(SpringContact):
    """Generalised Maxwell slip: elements that stick like springs until their limit, then slide at it until v turns.

    Element i sticks with F_i growing by k_i·v, up to W_i·g(v)/F_c, where g is the Stribeck curve; there it slides, with
    that force, until the velocity vanishes. F_f = Σ F_i + F_v·v. With F_s = F_c (`peak` = 1) the force depends on the
    place at past turns alone: the elements are play operators, and loops follow Masing's rules. Without the lag of
    friction behind the velocity in slip, the limit of infinite attraction of F. Al-Bender, V. Lampaert and J. Swevers,
    IEEE Trans. Autom. Control 50 (2005) 1883, doi:10.1109/TAC.2005.858676.

    Parameters
    ----------
    stiffness : sequence of float
        Of each element, k_i [N/m], positive.
    limits : sequence of float
        Force at which each slides quickly, W_i [N], positive; their sum is F_c.
    peak : float, optional
        Ratio F_s/F_c, at least 1.
    v_s : float, optional
        Stribeck velocity [m/s], positive.
    F_v : float, optional
        Viscous friction [N s/m].

    Raises
    ------
    InputError
        A number is out of range, or stiffness and limits are not of one length.

    Examples
    --------
    >>> from friction import MaxwellSlip, Sine, prescribe
    >>> law = MaxwellSlip([1000.0, 500.0], [0.4, 0.6])
    >>> round(float(prescribe(law, position=Sine(0.001, 1.0), times=[0.25]).F_f[0]), 12)
    0.9
    """

    stiffness: Sequence[float]
    limits: Sequence[float]
    peak: float = 1.0
    v_s: float = 0.1
    F_v: float = 0.0

    name = "maxwell-slip"
    signal = MAXWELL

    def __post_init__(self):
        super().__post_init__()
        if len(self.stiffness) != len(self.limits) or not len(self.limits):
            raise InputError(
                "model.limits", "not one for each stiffness", f"{len(self.stiffness)}", f"{len(self.limits)}"
            )

    @property
    def viscous(self) -> float:
        """Viscous friction beside the elements [N s/m]."""
        return self.F_v

    @property
    def elements(self) -> list[tuple[float, ...]]:
        """A row for each element."""
        limits = zip(self.limits, self.stiffness, strict=True)
        return [(w, self.peak * w, 0.0, self.v_s, 0.0, k, 0.0, 0.0) for w, k in limits]


@dataclass(frozen=True)
class Armstrong(SpringContact, example=("Armstrong(F_c=0.9).F_s", "1.2")):
    """A spring while it sticks; then F_c + F_v·|v| + P/(1 + (v(t − lag)/v_s)²) against the motion.

    P = P_a + (F_s − F_c − P_a)·t_2/(t_2 + dwell) after a rest of t_2, with P_a its value when the contact came to
    rest; at t = 0 it has rested for ever. It breaks away at F_c + P, and rests from each instant on at which v
    vanishes. B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30 (1994) 1083,
    doi:10.1016/0005-1098(94)90209-7.
    """

    F_c: float = 1.0
    F_s: float = 1.2
    F_v: float = 0.05
    v_s: float = 0.1
    sigma0: float = 500.0
    lag: float = 0.0
    dwell: float = 0.0
    name = "armstrong"
    signal = ARMSTRONG

    @property
    def elements(self) -> list[tuple[float, ...]]:
        """A single row."""
        return [(self.F_c, self.F_s, self.F_v, self.v_s, 0.0, self.sigma0, self.lag, self.dwell)]
