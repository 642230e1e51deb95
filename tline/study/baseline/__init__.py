"""Baseline methods, small and faithful to the literature, for charts and for teaching.

All see the scene as `nodes_of` does. Those that step in time are compiled loops (`advance_*`); lumped chains and Padé
sections are sparse linear systems, vectorised, integrated by scipy's `solve_ivp`.

| family | treatment of a wave |
|---|---|
| characteristics (MOC) | delayed by whole steps, with adjusted wave speed, or interpolated |
| characteristics on a grid | carried from reach to reach, with friction by the trapezoidal rule; extrapolated |
| upwind, Lax-Wendroff | carried from cell to cell |
| FDTD | leapfrog of effort and flow on staggered grids |
| lumped, Padé | line replaced by an ordinary differential equation |
| slabs, pointwise | as the production method, but with interpolation in place of projection |

References
----------
E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapters 3 and 8: MOC, friction, interpolation,
wave-speed adjustment. H. W. Dommel, IEEE Trans. PAS-88 (1969) 388, doi:10.1109/TPAS.1969.292459: lines by their
history, loads by the trapezoid. K. S. Yee, IEEE Trans. AP-14 (1966) 302, doi:10.1109/TAP.1966.1138693: leapfrog.
P. Lax, B. Wendroff, Comm. Pure Appl. Math. 13 (1960) 217, doi:10.1002/cpa.3160130205.
"""

from functools import partial

from tline.study.baseline.explicit import (
    cubic,
    fdtd,
    lax_wendroff,
    linear,
    moc,
    moc_extrapolated,
    moc_grid,
    no_friction,
    slabs_pointwise,
    upwind,
)
from tline.study.baseline.method import HALF, Baseline, backward_euler, forward_euler
from tline.study.baseline.sections import lumped_pi, lumped_t, pade, pushes_inductors

BASELINES: dict[str, Baseline] = {
    "moc_trapezoid": Baseline("MOC, Courant 1", 1, 2, moc),
    "moc_forward_euler": Baseline("MOC, loads by forward Euler", 1, 1, partial(moc, rule=forward_euler)),
    "moc_backward_euler": Baseline("MOC, loads by backward Euler", 1, 1, partial(moc, rule=backward_euler)),
    "moc_linear": Baseline("MOC, linear interpolation", 2, 2, partial(moc, weights=linear, offset=HALF)),
    "moc_cubic": Baseline("MOC, cubic interpolation", 4, 2, partial(moc, weights=cubic, offset=HALF)),
    "moc_grid": Baseline("MOC on a staggered grid", 2, 2, moc_grid, no_friction, "friction"),
    "upwind": Baseline("upwind", 1, 1, upwind),
    "lax_wendroff": Baseline("Lax-Wendroff", 2, 2, lax_wendroff),
    "fdtd": Baseline("FDTD leapfrog", 2, 2, fdtd),
    "lumped_t": Baseline("T sections", 2, 2, lumped_t, pushes_inductors),
    "lumped_pi": Baseline("π sections", 2, 2, lumped_pi, knows="resistance"),
    "pade": Baseline("Padé sections", 3, 3, pade),
    "slabs_pointwise": Baseline("slabs, pointwise, s = 4", 4, 4, slabs_pointwise),
    "moc_extrapolated": Baseline("… extrapolated", 4, 2, moc_extrapolated, no_friction, "friction"),
}
