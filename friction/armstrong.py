"""Armstrong's law of seven parameters: stiction that grows with the time of rest, friction that lags velocity."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from friction.motion import Motion, first_above
from friction.parameters import Parameters
from tline.errors import InputError

GRID = 64  # instants of an interval at which break-away is looked for


class _Rest(NamedTuple):
    """A contact that sticks: since when, at which place and force, and its Stribeck friction when it came to rest."""

    since: float
    place: float
    force: float
    peak: float


@dataclass(frozen=True)
class Armstrong(Parameters, example=("Armstrong(F_c=0.9).F_s", "1.2")):
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
    place = "model"
    name = "armstrong"

    def __post_init__(self):
        super().__post_init__()
        if self.F_s < self.F_c:
            raise InputError("model.F_s", "below F_c", f"at least F_c = {self.F_c:g}", f"{self.F_s:g}")

    def moved(self, motion: Motion, times: NDArray, t_end: float) -> NDArray:
        """F_f [N] at times, from no force on, from reversal to reversal."""
        course, force, row = motion.course(t_end), np.empty(times.size), 0
        rest: _Rest | None = _Rest(-np.inf, float(motion.place(np.zeros(1))[0]), 0.0, self.F_s - self.F_c)
        way, peak, left = 0, 0.0, 0.0
        for begin, end, s in zip(course.edges[:-1], course.edges[1:], course.sign.tolist(), strict=True):
            stop = int(np.searchsorted(times, end, side="right"))
            at, last = times[row:stop], np.array([end - 1e-15 * (end - begin)])
            if rest is None and s != way:
                rest = _Rest(begin, float(motion.place(np.array([begin]))[0]), way * (self.F_c + left), left)
            onset = begin if rest is None else self._break_away(motion, begin, end, s, rest)
            if rest is not None:
                held = at < onset
                force[row:stop][held] = rest.force + self.sigma0 * (motion.place(at[held]) - rest.place)
            if onset < end:
                peak, way, rest = (peak if rest is None else float(self._peak(np.array([onset]), rest)[0])), s, None
            slides = at >= onset
            inside = np.minimum(at[slides], last)
            found = s * (self.F_c + peak * self._share(motion, inside))
            force[row:stop][slides] = found + self.F_v * motion.velocity(inside)
            row, left = stop, peak * float(self._share(motion, last)[0])
        return force

    def _share(self, motion: Motion, t: NDArray) -> NDArray:
        """Fraction of the peak left by the velocity one lag earlier, which is 0 before t = 0."""
        v = np.where(t >= self.lag, motion.velocity(np.maximum(t - self.lag, 0.0)), 0.0)
        return 1.0 / (1.0 + (v / self.v_s) ** 2)

    def _peak(self, t: NDArray, rest: _Rest) -> NDArray:
        """P after a rest [N]."""
        waited = t - rest.since
        share = np.ones_like(t) if self.dwell == 0.0 or rest.since == -np.inf else waited / (waited + self.dwell)
        return rest.peak + (self.F_s - self.F_c - rest.peak) * share

    def _break_away(self, motion: Motion, begin: float, end: float, s: int, rest: _Rest) -> float:
        """When the spring has the force that the contact holds; inf if it does not within an interval."""

        def above(t: NDArray) -> NDArray:
            pulled = rest.force + self.sigma0 * (motion.place(t) - rest.place)
            return s * pulled - (self.F_c + self._peak(t, rest))

        return first_above(above, np.linspace(begin, end, GRID + 1)) if s else np.inf
