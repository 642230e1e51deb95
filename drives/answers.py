"""The exercise, answered: parts (a) to (h) for the given numbers or any others."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from drives.claims import claims
from drives.control import decoupler, design, relative_gain_array
from drives.coupled import CoupledDrives
from drives.derivation import STEPS, check_pulley, wrong_sign
from drives.linearise import artefact
from drives.loop import simulate_control
from drives.modelica import ASSEMBLY, DRIVE, FLANGE, PULLEY
from drives.modelica import BELT as BELT_MODEL
from drives.modes import hidden_modes
from drives.number import written
from drives.report import design_data, design_text, mode_data, pair, response_data, transfer_data
from drives.simulation import simulate, steady_state
from drives.symbolic import INPUTS, OUTPUTS
from drives.torque import Torque
from tline.errors import InputError

OMEGA = np.logspace(-1, 4, 50)
TORQUE, SPEED, TENSION, END, STEP = 0.1, 1.0, 5.0, 2.0, 0.01  # of the runs in (h): N m, m/s, N, s, s
SPEEDS_ONLY = "it binds the speeds v1 and v2, not the belt's positions: see (f) for what that costs"
BALANCES = (
    "J1 dω1/dt = −T1 − B1 ω1 + r1 F    T1 > 0 brakes spool 1; the belt pulls it forward",
    "J2 dω2/dt = +T2 − B2 ω2 − r2 F    T2 > 0 drives spool 2; the belt holds it back",
)
BELT = (
    "F = K1 e1 + B1 de1/dt, de1/dt = v1 − r1 ω1    from spool 1 to the pulley",
    "F = K2 e2 + B2 de2/dt, de2/dt = r2 ω2 − v2    from the pulley to spool 2",
    "massless, so the tension F is the same from end to end",
)
LOOP = (
    "the massless pulley makes an algebraic loop: v1 and v2 follow from F, and F from them.",
    "Positions bind it: e1 + e2 + e_p = r2 φ2 − r1 φ1, and with F = k_p e_p as the unknown all is explicit:",
    "de_i/dt = (F − K_i e_i)/B_i, de_p/dt = r2 ω2 − r1 ω1 − de1/dt − de2/dt",
)


@dataclass(frozen=True)
class Answer:
    """One part of the exercise."""

    letter: str
    title: str
    lines: tuple[str, ...]  # for the eye
    data: dict[str, Any]  # the same as numbers, fit for JSON


def exercise(drives: CoupledDrives | None = None) -> list[Answer]:
    """All answers.

    Examples
    --------
    >>> for answer in exercise():
    ...     print(answer.letter, answer.title)
    a torque balances of the spools
    b drive as a component
    c belt
    d pulley, from the balances of forces
    e pulley as code
    f assembly: state space and eigenvalues
    g Bode plot from both torques to x_k
    h simulation and control
    """
    drives = drives or CoupledDrives()
    return [
        Answer("a", "torque balances of the spools", BALANCES, {}),
        Answer("b", "drive as a component", _code(FLANGE, DRIVE), {}),
        Answer("c", "belt", BELT + _code(BELT_MODEL), {}),
        _pulley(drives),
        Answer("e", "pulley as code", (*_code(PULLEY), SPEEDS_ONLY), {}),
        _assembly(drives),
        _bode(drives),
        _control(drives),
    ]


def _code(*models: str) -> tuple[str, ...]:
    return tuple(line for model in models for line in model.splitlines())


def _pulley(drives: CoupledDrives) -> Answer:
    k_p, runaway, seen = float(drives.pulley.belt_stiffness), wrong_sign(drives), check_pulley(drives.pulley)
    lines = (
        *STEPS,
        f"here k_p = {k_p:.6g} N/m. Check at x_k = {seen.x_k:g} m: the balances of 2, solved for the forces, give",
        f"  F1 = {seen.F1:.9g} N, F2 = {seen.F2:.9g} N; the model's pulley {seen.by_model:.9g} N, "
        f"k_p e_p {seen.by_stiffness:.9g} N",
        f"with F_k = +k x_k the pulley would be a negative spring: a pole at {written(runaway)} rad/s"
        + (", it runs away" if runaway.real > 0 else ""),
    )
    data = {"k_p": k_p, "check": vars(seen), "pole_of_the_wrong_sign": pair(runaway)}
    return Answer("d", "pulley, from the balances of forces", lines, data)


def _assembly(drives: CoupledDrives) -> Answer:
    """The parts connected, as code and as state space, and its eigenvalues."""
    model = drives.state_space()
    rows = [
        f"d{name}/dt: " + "  ".join(f"{x:.6g}" for x in (*a, *b))
        for name, a, b in zip(model.states, model.A, model.B, strict=True)
    ]
    head = f"columns: {', '.join((*model.states, *model.inputs))}"
    found = model.poles
    lines = [*_code(ASSEMBLY), *LOOP, head, *rows]
    lines += ["eigenvalues: " + ", ".join(written(z) for z in found) + " rad/s: none has a positive real part"]
    data: dict[str, Any] = {"states": list(model.states), "A": model.A.tolist(), "B": model.B.tolist()}
    data |= {"C": model.C.tolist(), "eigenvalues": [pair(z) for z in found]}
    if len(drives.damped) == 2:
        seen = artefact(drives)
        data["artefact"] = vars(seen)
        lines += [
            f"the text of (e) written literally binds speeds only: {seen.exact_zeros} eigenvalues are exactly 0",
            f"forward differences at {seen.runs} operating points: {seen.unstable} look unstable, up to "
            f"+{seen.largest:.1g} rad/s",
            "rounding moves each 0 to a random side; with two of them 3 of 4 linearisations show a positive one:",
            f"{seen.by_difference} by the difference quotient, the rest by the eigenvalue algorithm itself",
        ]
    return Answer("f", "assembly: state space and eigenvalues", tuple(lines), data)


def _bode(drives: CoupledDrives) -> Answer:
    data: dict[str, Any] = {"omega": OMEGA.tolist(), "transfer_functions": {}}
    lines = []
    for output in OUTPUTS[:5]:
        for source in INPUTS:
            h = drives.transfer(output, source)
            lines.append(str(h))
            data["transfer_functions"][h.name] = transfer_data(h)
    lines.append("hidden in x_k/T1:")
    hidden = hidden_modes(drives, "x_k", "T1")
    data["hidden in x_k/T1"] = [mode_data(mode) for mode in hidden]
    for mode in hidden:
        for name, why in zip(mode.names, mode.reasons, strict=True):
            lines.append(f"  {', '.join(written(z) for z in mode.poles)} rad/s, {name}: {why}")
    lines.append("phase: from its value at ω → 0, which is −180° if the DC gain is negative, without jumps")
    for source in INPUTS:
        h = drives.transfer("x_k", source)
        data[h.name] = told = response_data(h, OMEGA)
        size, phase = told["magnitude"][0], told["degrees"]
        lines.append(
            f"|{h.name}| = {size:.6g} m/(N m) at ω = 0.1 rad/s, phase {phase[0]:.4g}° there, {phase[-1]:.4g}° at 10⁴"
        )
    data["claims"], said = claims(drives)
    lines += said
    return Answer("g", "Bode plot from both torques to x_k", tuple(lines), data)


def _control(drives: CoupledDrives) -> Answer:
    share = relative_gain_array(drives, [0.0, 1.0, 100.0]).real[0, 0]
    data: dict[str, Any] = {"relative_gain": share.tolist()}
    lines = []
    try:
        rest = steady_state(drives, TORQUE, TORQUE)
    except InputError:
        lines.append("simulation: without friction nothing settles under constant torques")
    else:
        run = simulate(drives, Torque.step(TORQUE), Torque.step(TORQUE), t_end=END, step=STEP)
        last, settled = run.outputs["tension"][-1], float(drives.spring) * rest["e_p"]
        data["simulation"] = {"torque": TORQUE, "t": END, "tension": float(last), "settled": settled}
        lines.append(
            f"simulation: T1 = T2 = {TORQUE:g} N m bring the tension to {last:.5g} N at {END:g} s, "
            f"in the end to {settled:.5g} N"
        )
    lines += [
        "control: relative gain array, first entry, at 0, 1 and 100 rad/s: " + ", ".join(f"{x:.4g}" for x in share),
        "so decouple: " + _decoupler(drives),
    ]
    try:
        found = design(drives)
    except InputError as error:
        return Answer("h", "simulation and control", (*lines, str(error)), data)
    run = simulate_control(found, Torque.step(SPEED), Torque.step(TENSION), t_end=END, step=STEP)
    speed, tension = (float(run.outputs[name][-1]) for name in ("belt_speed", "tension"))
    data |= design_data(found) | {"controlled": {"t": END, "belt_speed": speed, "tension": tension}}
    lines += design_text(found)
    lines.append(f"set points {SPEED:g} m/s and {TENSION:g} N: at {END:g} s {speed:.6g} m/s and {tension:.6g} N")
    return Answer("h", "simulation and control", tuple(lines), data)


def _decoupler(drives: CoupledDrives) -> str:
    """The decoupler as formulas; what is 0 or 1 for spools alike is left out."""
    texts = []
    for k, (one, sign) in enumerate(zip(decoupler(drives), "−+", strict=True), 1):
        text = f"{'' if one.share == 1 else f'{float(one.share):.6g} '}(τ_f {sign} τ_v)/2"
        for factor, what in ((one.per_speed, f"ω{k}"), (one.per_tension, "F")):
            text += f" {'+' if factor > 0 else '−'} {abs(float(factor)):.6g} {what}" if factor else ""
        texts.append(f"T{k} = {text}")
    return ", ".join(texts)
