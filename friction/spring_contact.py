"""Laws whose contact sticks like a spring up to a limit, and then slides."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from friction.kernel.signals import F_C, F_S, F_V, STIFFNESS
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

        Raises
        ------
        InputError
            It takes more than 5 million legs, or more than 4096 lie within one lag.
        """
        from friction.kernel.automaton import automaton
        from friction.kernel.law import DONE, STALLED
        from friction.kernel.signals import Inputs
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
