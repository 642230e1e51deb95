"""Maxwell slip: springs in parallel, each sliding at its own limit; a hysteresis with non-local memory."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from friction.motion import Motion, first_above
from friction.parameters import check_number
from tline.errors import InputError

GRID = 64  # instants of an interval at which onsets are looked for


@dataclass(frozen=True)
class MaxwellSlip:
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
    >>> float(prescribe(law, position=Sine(0.001, 1.0), times=[0.25]).F_f[0])
    0.9
    """

    stiffness: Sequence[float]
    limits: Sequence[float]
    peak: float = 1.0
    v_s: float = 0.1
    F_v: float = 0.0

    name = "maxwell-slip"

    def __post_init__(self):
        if len(self.stiffness) != len(self.limits) or not len(self.limits):
            raise InputError(
                "model.limits", "not one for each stiffness", f"{len(self.stiffness)}", f"{len(self.limits)}"
            )
        for name in ("stiffness", "limits"):
            for k, value in enumerate(getattr(self, name)):
                check_number(f"model.{name}[{k}]", value, above=0.0)
            object.__setattr__(self, name, tuple(getattr(self, name)))
        check_number("model.peak", self.peak, least=1.0)
        check_number("model.v_s", self.v_s, above=0.0)
        check_number("model.F_v", self.F_v, least=0.0)

    def limit(self, v: NDArray) -> NDArray:
        """Limits [N] of the elements at velocities of shape (n,), shape (n, elements)."""
        growth = 1.0 + (self.peak - 1.0) * np.exp(-((v / self.v_s) ** 2))
        return growth[:, None] * np.array(self.limits, float)

    def moved(self, motion: Motion, times: NDArray, t_end: float) -> NDArray:
        """F_f [N] at times, from no force on, from reversal to reversal."""
        course, stiffness = motion.course(t_end), np.array(self.stiffness, float)
        held, force, slides = np.zeros(stiffness.size), np.empty(times.size), np.zeros(stiffness.size, bool)
        way, row = 0, 0
        for begin, end, s in zip(course.edges[:-1], course.edges[1:], course.sign.tolist(), strict=True):
            stop = int(np.searchsorted(times, end, side="right"))
            at = np.concatenate([[begin], times[row:stop], [end]])
            slides &= s == way
            way, x = s, motion.place(at)
            bent = held + np.outer(x - x[0], stiffness)
            inside = np.minimum(at, end - 1e-15 * (end - begin))
            onset = self._onsets(motion, begin, end, s, held, slides)
            sliding = inside[:, None] >= onset
            found = np.where(sliding, s * self.limit(motion.velocity(inside)), bent)
            force[row:stop], held, slides = found[1:-1].sum(axis=1), found[-1], sliding[-1]
            row = stop
        return force + self.F_v * motion.velocity(times)

    def _onsets(self, motion: Motion, begin: float, end: float, s: int, held: NDArray, slides: NDArray) -> NDArray:
        """When each element begins to slide, inf if it does not.

        If limits are constant, the excess of an element over its own rises throughout, and its sign at the end
        decides. Where they change, the excess is evaluated at 64 instants.
        """
        onset = np.where(slides, begin, np.inf)
        if s == 0:
            return np.full(slides.size, np.inf)
        grid = np.linspace(begin, end, 2 if self.peak == 1.0 else GRID + 1)
        stiffness, x0 = np.array(self.stiffness, float), motion.place(np.array([begin]))[0]
        last = end - 1e-12 * (end - begin)

        def above(t: NDArray) -> NDArray:
            v = motion.velocity(np.minimum(t, last))
            return s * (held + np.outer(motion.place(t) - x0, stiffness)) - self.limit(v)

        for k in np.flatnonzero(~slides):
            onset[k] = first_above(lambda t, k=k: above(t)[:, k], grid)
        return onset
