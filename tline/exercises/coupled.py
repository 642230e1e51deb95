"""Problem 4: the coupled drives, with the exercise's numbers or any others."""

import math
import re
from importlib.resources import files
from typing import Any

import numpy as np

from drives import CoupledDrives, Design, Torque, design, hidden_modes, simulate, simulate_control
from drives.decoupling import decoupler, relative_gain_array
from drives.derivation import check_pulley, wrong_sign
from drives.linearise import artefact
from drives.number import written
from drives.resonance import largest_friction_with_peak, peak, undamped_frequency
from drives.simulation import steady_state
from drives.symbolic import INPUTS, OUTPUTS
from drives.transfer import TransferFunction
from tline.errors import InputError
from tline.exercises.answer import Found

MODELS = {  # models of the package for each letter
    "4b": ("Drive",),
    "4c": ("Belt",),
    "4e": ("Pulley",),
    "4f": ("Drive", "Belt", "Pulley", "Assembly"),
    "4g": ("Drive", "Belt", "Pulley", "Assembly", "WithPorts"),
    "4h": ("Drive", "Belt", "Pulley", "Assembly", "Controlled"),
}
MODEL = re.compile(r"  (?:partial )?model (\w+).*?  end \1;\n\n?", re.DOTALL)
OMEGA = np.logspace(-1, 4, 50)
TORQUE, SPEED, TENSION, END, STEP = 0.1, 1.0, 5.0, 2.0, 0.01  # of the runs in (h): N m, m/s, N, s, s
FAST = 1e5  # rad/s, a bandwidth out of reach of any loop
SLOW = 1e-6  # of the slowest pole or zero: there the phase equals its initial value


def package(
    letter: str, drives: CoupledDrives, made: Design | None = None, speed: float = 0, tension: float = 0
) -> str:
    """Compose the part of the package that a letter asks for."""
    text = files("tline.exercises").joinpath("coupled_drives.mo").read_text(encoding="utf-8")
    text = MODEL.sub(lambda found: found[0] if found[1] in MODELS[letter] else "", text).replace("\n\nend", "\nend")
    values = {"k": drives.pulley.stiffness, "theta": drives.pulley.angle, "speed": speed, "tension": tension}
    for side, spool, belt in ((1, drives.left, drives.left_belt), (2, drives.right, drives.right_belt)):
        values |= {f"J{side}": spool.inertia, f"B{side}": spool.friction, f"r{side}": spool.radius}
        values |= {f"K{side}": belt.stiffness, f"D{side}": belt.damping}
    for name, controller in () if made is None else (("speed", made.speed), ("tension", made.tension)):
        values |= {f"{name}_gain": controller.gain, f"{name}_time": controller.integral_time}
    return re.sub(r"\{(\w+)\}", lambda found: _number(float(values[found[1]])), text)


def _number(value: float) -> str:
    """Format a number as short as possible; an angle of 45 degrees as a fraction of pi."""
    return "Modelica.Constants.pi/4" if value == math.pi / 4 else f"{value!r}"


def balances(_: CoupledDrives) -> Found:
    """Answer 4a: torque balances of the spools."""
    return Found({})


def drive(drives: CoupledDrives) -> Found:
    """Answer 4b: model of a spool's drive."""
    pairs = {"J": "inertia", "B": "friction", "r": "radius"}
    numbers = {key: _both(getattr(drives.left, name), getattr(drives.right, name)) for key, name in pairs.items()}
    return Found(numbers, modelica=package("4b", drives))


def belt(drives: CoupledDrives) -> Found:
    """Answer 4c: model of the belt."""
    left, right = drives.left_belt, drives.right_belt
    numbers = {"K": _both(left.stiffness, right.stiffness), "B": _both(left.damping, right.damping)}
    return Found(numbers, modelica=package("4c", drives))


def _both(left: Any, right: Any) -> str:
    return f"{float(left):g}" if left == right else f"{float(left):g} and {float(right):g}"


def pulley(drives: CoupledDrives) -> Found:
    """Answer 4d: balances of forces at the pulley."""
    seen, runaway = check_pulley(drives.pulley), wrong_sign(drives)
    numbers = {"k_p": float(drives.pulley.belt_stiffness), "runaway": written(runaway), **vars(seen)}
    return Found(numbers, details={"pole_of_the_wrong_sign": runaway})


def pulley_model(drives: CoupledDrives) -> Found:
    """Answer 4e: model of the pulley."""
    numbers = {"k": float(drives.pulley.stiffness), "theta": drives.pulley.angle}
    return Found(numbers, modelica=package("4e", drives))


def assembly(drives: CoupledDrives) -> Found:
    """Answer 4f: assembly of the drives."""
    model = drives.state_space()
    numbers = {"eigenvalues": ", ".join(map(written, model.poles))}
    details: dict[str, Any] = {"states": model.states, "A": model.A, "B": model.B, "C": model.C, "poles": model.poles}
    return Found(numbers, modelica=package("4f", drives), details=details)


def bode(drives: CoupledDrives) -> Found:
    """Answer 4g: Bode plot, resonance and eigenvalues."""
    all_of_them = [drives.transfer(output, source) for output in OUTPUTS[:5] for source in INPUTS]
    h, both = drives.transfer("x_k", "T1"), [drives.transfer("x_k", source) for source in INPUTS]
    hidden = hidden_modes(drives, "x_k", "T1")
    degrees = np.degrees(h.phase(OMEGA))
    names = [f"{', '.join(map(written, mode.poles))} rad/s ({', '.join(mode.names)})" for mode in hidden]
    numbers = {
        "transfers": "; ".join(map(str, both)),
        "size": float(h.magnitude(OMEGA)[0]),
        "phase_first": float(degrees[0]),
        "phase_last": float(degrees[-1]),
        "hidden": "; ".join(names) or "none",
        **_resonance(drives, h),
        **_phase(h),
        "artefact": _artefact(drives),
    }
    details = {"transfer_functions": {each.name: each.to_dict() for each in all_of_them}, "omega": OMEGA}
    return Found(numbers, modelica=package("4g", drives), draw=("draw_bode", both, OMEGA), details=details)


def _resonance(drives: CoupledDrives, h: TransferFunction) -> dict[str, Any]:
    """Resonance and bound of the bandwidth claimed by the text, with the true ones."""
    claimed = math.sqrt(drives.left_belt.stiffness / drives.mobility(drives.left)[0])
    found = peak(h) if h.dc_gain else None  # without DC gain the other spool turns freely, and nothing peaks
    seen = "no peak" if h.dc_gain else "no tension at rest, so no peak above it"
    if found:
        size = f"{found.ratio:.4g} times the DC gain" if math.isfinite(found.ratio) else "without bound"
        seen = f"a peak at {found.frequency:.4g} rad/s, {size}"
    try:
        limit = f" (a peak takes a friction of each spool below {largest_friction_with_peak(drives):.6g} N·m·s/rad)"
    except InputError:
        limit = ""  # there is a formula for equal parts only
    limit = limit if drives.left.friction == drives.right.friction else ""
    try:
        reached = f"{design(drives, tension_bandwidth=FAST).bandwidths['tension'].reached:.4g} rad/s"
    except InputError:
        reached = "no bandwidth: no controller of its rule exists"
    natural = undamped_frequency(drives)
    return {"claimed": claimed, "seen": seen + limit, "natural": natural, "peak": found, "reached": reached}


def _phase(h: TransferFunction) -> dict[str, Any]:
    """Initial phase, degrees."""
    start = math.degrees(float(h.phase(SLOW * min(abs(z) for z in (*h.poles, *h.zeros) if z))))
    word = "It does, since x_k is negative under tension" if start < -179 else f"Here it starts at {start:.4g}°"
    return {"starts": round(start, 3), "starts_in_words": word, "of_tension": round(start + 180, 2) + 0.0}


def _artefact(drives: CoupledDrives) -> str:
    """Describe the error of forward differences at eigenvalues that are exactly 0."""
    if len(drives.damped) != 2:
        return "an undamped belt has no such model"
    seen = artefact(drives)
    return (
        f"{seen.exact_zeros} of its eigenvalues are exactly 0; of {seen.runs} linearisations by forward differences "
        f"{seen.unstable} look unstable, by up to {seen.largest:.1g} rad/s, {seen.by_difference} of them by the "
        "difference quotient and the rest by the eigenvalue algorithm. Rounding moves each 0 to a random side, so with "
        "two of them three of four linearisations have a positive one"
    )


def control(drives: CoupledDrives) -> Found:
    """Answer 4h: decoupled control of belt speed and tension."""
    share = relative_gain_array(drives, [0.0, 1.0, 100.0]).real[0, 0]
    run = simulate(drives, T2=Torque.step(TORQUE), t_end=END, step=STEP)
    last = {name: float(run.outputs[name][-1]) for name in ("tension", "belt_speed")}
    try:
        settled = f"; it settles at {float(drives.spring) * steady_state(drives, 0.0, TORQUE)['e_p']:.5g} N"
    except InputError:
        settled = "; without friction nothing settles"
    reached = f"{last['tension']:.5g} N and the belt to {last['belt_speed']:.5g} m/s at {END:g} s"
    numbers: dict[str, Any] = {
        "simulated": f"T2 = {TORQUE:g} N·m alone brings the tension to {reached}{settled}.",
        "gains": ", ".join(f"{x:.4g}" for x in share),
        "decoupled": _decoupler(drives),
    }
    details: dict[str, Any] = {"relative_gain": share, "simulation": {"torque": TORQUE, "t": END, **last}}
    try:
        made = design(drives)
    except InputError as error:
        return Found({**numbers, "controlled": f"PI controllers: {error}."}, details=details)
    run = simulate_control(made, Torque.step(SPEED), Torque.step(TENSION), t_end=END, step=STEP)
    speed, tension = (float(run.outputs[name][-1]) for name in ("belt_speed", "tension"))
    designed = "; ".join(line.strip() for line in made.text_lines())
    numbers["controlled"] = (
        f"PI controllers by the rule of `design`: {designed}. With set points {SPEED:g} m/s and {TENSION:g} N "
        f"the belt has {speed:.6g} m/s and {tension:.6g} N at {END:g} s."
    )
    details |= made.to_dict() | {"reached": {"t": END, "belt_speed": speed, "tension": tension}}
    text = package("4h", drives, made, SPEED, TENSION) if drives.symmetric else ""
    return Found(numbers, modelica=text, draw=("draw_run", run), details=details)


def _decoupler(drives: CoupledDrives) -> str:
    """Format the decoupler as formulas, without the factors 0 or 1 for equal spools."""
    texts = []
    for k, (one, sign) in enumerate(zip(decoupler(drives), "−+", strict=True), 1):
        text = f"{'' if one.share == 1 else f'{float(one.share):.6g}·'}(τ_f {sign} τ_v)/2"
        for factor, what in ((one.per_speed, f"ω{k}"), (one.per_tension, "F")):
            text += f" {'+' if factor > 0 else '−'} {abs(float(factor)):.6g}·{what}" if factor else ""
        texts.append(f"T{k} = {text}")
    return ", ".join(texts)


FOUND = {
    "4a": balances, "4b": drive, "4c": belt, "4d": pulley,
    "4e": pulley_model, "4f": assembly, "4g": bode, "4h": control,
}  # fmt: skip
