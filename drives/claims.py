"""What the exercise text claims of resonance, phase and stability, beside what is so."""

import math
from typing import Any

from drives.coupled import CoupledDrives
from drives.number import written
from drives.report import finite
from drives.resonance import largest_friction_with_peak, peak, undamped_frequency
from tline.errors import InputError

SLOW = 1e-6  # of the slowest pole or zero: there the phase is that at its start


def claims(drives: CoupledDrives) -> tuple[dict[str, Any], list[str]]:
    """What the exercise text says of the Bode plot, beside what is so: as numbers, and as lines.

    Examples
    --------
    >>> data, lines = claims(CoupledDrives())
    >>> round(data["resonance_claimed"], 3), data["peak"], data["phase_starts"]
    (22.361, None, -180.0)
    """
    h, (m, _) = drives.transfer("x_k", "T1"), drives.mobility(drives.left)
    claimed, natural = math.sqrt(drives.left_belt.stiffness / m), undamped_frequency(drives)
    reached = h.dc_gain != 0  # else this torque holds no tension: the other spool turns freely
    found = peak(h) if reached else None
    seen = "no peak" if reached else "no tension at rest, so no peak above it"
    if found:
        size = f"{found.ratio:.4g} times the DC gain" if math.isfinite(found.ratio) else "without bound"
        seen = f"a peak at {found.frequency:.4g} rad/s, {size}"
    lines = [
        f"claim: a resonance at √(K/(J/r²)) = {claimed:.4g} rad/s. With these numbers there is {seen}.",
        f"  undamped the tension swings at √(K_eff (1/M1 + 1/M2)) = {natural:.4g} rad/s,",
        "  1/K_eff = 1/K1 + 1/K2 + 1/k_p;",
        "  the claim is the limit k → ∞ (rigid pulley) of equal spools and belts, without friction and damping.",
    ]
    start = math.degrees(float(h.phase(SLOW * min(abs(z) for z in (*h.poles, *h.zeros) if z))))
    data = {
        "resonance_claimed": claimed,
        "undamped_frequency": natural,
        "peak": vars(found) | {"ratio": finite(found.ratio)} if found else None,
        "phase_starts": round(start, 3),
    }
    try:
        limit = largest_friction_with_peak(drives)
    except InputError:
        limit = None  # there is a formula for equal parts only
    if limit is not None and drives.left.friction == drives.right.friction:
        data["largest_friction_with_peak"] = limit
        lines.append(f"  a peak exists only for a friction of each spool below {limit:.6g} N m s/rad.")
    if all(pole.imag == 0 for pole in h.poles):
        lines.append(
            f"  all poles are real: {', '.join(written(z) for z in h.poles)} rad/s; none is 0, so no integrator."
        )
    holds = "So it does, because x_k is negative under tension;" if start < -179 else f"Here at {round(start, 2):g}°;"
    return data, [
        *lines,
        f"claim: the phase starts at −180°. {holds}",
        f"  that of the tension starts at {round(start + 180, 2):g}°.",
        "claim: slightly unstable eigenvalues. The exact ones are not; see (f).",
    ]
