"""The exercise, answered: parts (a) to (h) for the given numbers or any others."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from drives.control import design, relative_gain_array
from drives.coupled import CoupledDrives
from drives.linearise import artefact
from drives.modes import hidden_modes
from drives.report import design_data, design_text, finite, mode_data, number, pair, response_data, transfer_data
from drives.resonance import largest_friction_with_peak, peak, undamped_frequency
from drives.symbolic import INPUTS, OUTPUTS, transfer
from tline.errors import InputError

OMEGA = np.logspace(-1, 4, 50)
BALANCES = (
    "J1 dω1/dt = −T1 − B1 ω1 + r1 F    T1 > 0 brakes spool 1; the belt pulls it forward",
    "J2 dω2/dt = +T2 − B2 ω2 − r2 F    T2 > 0 drives spool 2; the belt holds it back",
)
BELT = (
    "F = K1 e1 + B1 de1/dt, de1/dt = v1 − r1 ω1    from spool 1 to the pulley",
    "F = K2 e2 + B2 de2/dt, de2/dt = r2 ω2 − v2    from the pulley to spool 2",
)
PULLEY = (
    "v1 − v2 = 2 v_k cos θ, F1 = F2 = F = F_k/(2 cos θ), F_k = −k x_k",
    "seen from the belt: a spring k_p = k/(4 cos²θ) with e_p = −2 x_k cos θ; x_k < 0 under tension",
    "power: F1 v1 − F2 v2 = F_k v_k = −d(k x_k²/2)/dt: what leaves the belts is stored, so the signs are passive",
)
LOOP = (
    "v1 and v2 follow from F, and F from them: the massless pulley makes an algebraic loop",
    "positions bind it: e1 + e2 + e_p = r2 φ2 − r1 φ1, and with F = k_p e_p as the unknown all is explicit:",
    "de_i/dt = (F − K_i e_i)/B_i, de_p/dt = r2 ω2 − r1 ω1 − de1/dt − de2/dt",
)


@dataclass(frozen=True)
class Answer:
    """One part of the exercise.

    Attributes
    ----------
    letter, title : str
    lines : tuple of str
        For the eye.
    data : dict
        The same as numbers, fit for JSON.
    """

    letter: str
    title: str
    lines: tuple[str, ...]
    data: dict[str, Any]


def exercise(drives: CoupledDrives | None = None) -> list[Answer]:
    """All answers.

    Examples
    --------
    >>> for answer in exercise():
    ...     print(answer.letter, answer.title)
    a torque balances
    b belt
    c pulley
    d algebraic loop and state space
    e eigenvalues
    f transfer functions
    g Bode plot from both torques to x_k
    h control
    """
    drives = drives or CoupledDrives()
    return [
        Answer("a", "torque balances", BALANCES, {}),
        Answer("b", "belt", BELT, {}),
        _pulley(drives),
        _state_space(drives),
        _eigenvalues(drives),
        _transfer_functions(drives),
        _bode(drives),
        _control(drives),
    ]


def _pulley(drives: CoupledDrives) -> Answer:
    k_p, wrong = float(drives.pulley.belt_stiffness), drives.parameters | {"k": -drives.pulley.stiffness}
    runaway = max(transfer(wrong, "tension", "T1").poles, key=lambda z: z.real)
    lines = (
        *PULLEY,
        f"k_p = {k_p:.6g} N/m",
        f"with F_k = +k x_k the pulley would be a negative spring: a pole at {number(runaway)} rad/s"
        + (", it runs away" if runaway.real > 0 else ""),
    )
    return Answer("c", "pulley", lines, {"k_p": k_p, "pole_of_the_wrong_sign": pair(runaway)})


def _state_space(drives: CoupledDrives) -> Answer:
    model = drives.state_space()
    rows = [
        f"d{name}/dt: " + "  ".join(f"{x:.6g}" for x in (*a, *b))
        for name, a, b in zip(model.states, model.A, model.B, strict=True)
    ]
    head = f"columns: {', '.join((*model.states, *model.inputs))}"
    data = {"states": list(model.states), "A": model.A.tolist(), "B": model.B.tolist(), "C": model.C.tolist()}
    return Answer("d", "algebraic loop and state space", (*LOOP, head, *rows), data)


def _eigenvalues(drives: CoupledDrives) -> Answer:
    found = drives.state_space().poles
    lines = ["exact: " + ", ".join(number(z) for z in found) + " rad/s: none has a positive real part"]
    data: dict[str, Any] = {"eigenvalues": [pair(z) for z in found]}
    if len(drives.damped) == 2:
        seen = artefact(drives)
        data["artefact"] = vars(seen)
        lines += [
            f"the Modelica text written literally binds speeds only: {seen.exact_zeros} eigenvalues are exactly 0",
            f"forward differences at {seen.runs} operating points: {seen.unstable} look unstable, up to "
            f"+{seen.largest:.1g} rad/s",
            "rounding moves each 0 to a random side; with two of them 3 of 4 linearisations show a positive one:",
            f"{seen.by_difference} by the difference quotient, the rest by the eigenvalue algorithm itself",
        ]
    return Answer("e", "eigenvalues", tuple(lines), data)


def _transfer_functions(drives: CoupledDrives) -> Answer:
    lines, data = [], {}
    for output in OUTPUTS[:5]:
        for source in INPUTS:
            h = drives.transfer(output, source)
            lines.append(str(h))
            data[h.name] = transfer_data(h)
    lines.append("hidden in x_k/T1:")
    hidden = hidden_modes(drives, "x_k", "T1")
    data["hidden in x_k/T1"] = [mode_data(mode) for mode in hidden]
    for mode in hidden:
        for name, why in zip(mode.names, mode.reasons, strict=True):
            lines.append(f"  {', '.join(number(z) for z in mode.poles)} rad/s, {name}: {why}")
    return Answer("f", "transfer functions", tuple(lines), data)


def _bode(drives: CoupledDrives) -> Answer:
    data: dict[str, Any] = {"omega": OMEGA.tolist()}
    lines = ["phase: from its value at ω → 0, which is −180° if the DC gain is negative, without jumps"]
    for source in INPUTS:
        h = drives.transfer("x_k", source)
        data[h.name] = told = response_data(h, OMEGA)
        size, phase = told["magnitude"][0], told["degrees"]
        lines.append(
            f"|{h.name}| = {size:.6g} m/(N m) at ω = 0.1 rad/s, phase {phase[0]:.4g}° there, {phase[-1]:.4g}° at 10⁴"
        )
    lines += _claims(drives, data)
    return Answer("g", "Bode plot from both torques to x_k", tuple(lines), data)


def _claims(drives: CoupledDrives, data: dict[str, Any]) -> list[str]:
    """What the exercise text says of the Bode plot, beside what is so."""
    h, (m, _) = drives.transfer("x_k", "T1"), drives.mobility(drives.left)
    claimed, natural = math.sqrt(drives.left_belt.stiffness / m), undamped_frequency(drives)
    found = peak(h)
    seen = "no peak"
    if found:
        size = f"{found.ratio:.4g} times the DC gain" if math.isfinite(found.ratio) else "without bound"
        seen = f"a peak at {found.frequency:.4g} rad/s, {size}"
    lines = [
        f"claim: a resonance at √(K/(J/r²)) = {claimed:.4g} rad/s. With these numbers there is {seen}.",
        f"  undamped the tension swings at √(K_eff (1/M1 + 1/M2)) = {natural:.4g} rad/s,",
        "  1/K_eff = 1/K1 + 1/K2 + 1/k_p;",
        "  the claim is the limit k → ∞ (rigid pulley) of equal spools and belts, without friction and damping.",
    ]
    data["claims"] = {
        "resonance_claimed": claimed,
        "undamped_frequency": natural,
        "peak": vars(found) | {"ratio": finite(found.ratio)} if found else None,
    }
    try:
        limit = largest_friction_with_peak(drives)
    except InputError:
        limit = None  # there is a formula for equal parts only
    if limit is not None:
        data["claims"]["largest_friction_with_peak"] = limit
        lines.append(f"  a peak exists only for a friction of each spool below {limit:.6g} N m s/rad.")
    if all(pole.imag == 0 for pole in h.poles):
        lines.append(
            f"  all poles are real: {', '.join(number(z) for z in h.poles)} rad/s; none is 0, so no integrator."
        )
    return [
        *lines,
        "claim: the phase starts at −180°. So it does, because x_k is negative under tension;",
        "  that of the tension starts at 0°.",
        "claim: slightly unstable eigenvalues. The exact ones are not; see (e).",
    ]


def _control(drives: CoupledDrives) -> Answer:
    share = relative_gain_array(drives, [0.0, 1.0, 100.0]).real[0, 0]
    try:
        found = design(drives)
        text, data = design_text(found), design_data(found)
    except InputError as error:
        text, data = [str(error)], {}
    lines = [
        "relative gain array, first entry, at 0, 1 and 100 rad/s: " + ", ".join(f"{x:.4g}" for x in share),
        "so decouple: T1 = (τ_f − τ_v)/2, T2 = (τ_f + τ_v)/2",
        *text,
    ]
    return Answer("h", "control", tuple(lines), data | {"relative_gain": share.tolist()})
