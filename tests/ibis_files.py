"""A fictional driver by its equations, and the IBIS file that its maker would publish of it.

Currents of its transistors saturate like tanh, clamps rise like a soft ramp, and its transistors turn on and off
like smooth steps, the upper one a little later than the lower one.
"""

import numpy as np
from scipy.integrate import solve_ivp

SUPPLY, CAPACITANCE = {"typ": 1.2, "min": 1.14, "max": 1.26}, {"typ": 1.3e-12, "min": 1.1e-12, "max": 1.5e-12}
STRENGTH, SLOWNESS = {"typ": 1.0, "min": 0.8, "max": 1.2}, {"typ": 1.0, "min": 1.3, "max": 0.8}
CORNERS = ("typ", "min", "max")
UP, DOWN = (0.12e-9, 0.37e-9), (0.05e-9, 0.30e-9)  # when transistors begin to turn, and have turned
LAST, STEPS = 0.8e-9, 80  # of a waveform


def transistor(v):
    """Current at a voltage across it."""
    return 0.03 * np.tanh(v / 1.02)


def clamp(v):
    """Current of a clamp over the voltage beyond its rail, outwards."""
    return 0.04 * 0.04 * np.logaddexp(0.0, (v - 0.55) / 0.04)


def smooth(t, begin, end):
    """A step from 0 to 1 without a corner."""
    x = np.clip((t - begin) / (end - begin), 0.0, 1.0)
    return x * x * (3 - 2 * x)


def shares(t, rises, corner):
    """Of pull-up and pull-down, t after an edge."""
    slow = SLOWNESS[corner]
    up, down = smooth(t / slow, *UP), 1 - smooth(t / slow, *DOWN)
    return (up, down) if rises else (1 - up, 1 - down)


def current(u, up, down, corner):
    """Into the die at its voltage."""
    k, supply = STRENGTH[corner], SUPPLY[corner]
    return k * (down * transistor(u) - up * transistor(supply - u)) + clamp(u - supply) - clamp(-u)


def fixture(rises, corner, R, toward):
    """Voltage of the die after an edge into R toward a voltage, by DOP853."""

    def rate(t, u):
        return ((toward - u) / R - current(u, *shares(t, rises, corner), corner)) / CAPACITANCE[corner]

    settled = solve_ivp(lambda t, u: rate(0.0, u), (0, 1e-8), [toward / 2], method="LSODA", rtol=1e-11, atol=1e-13)
    t = np.linspace(0, LAST, STEPS + 1)
    seen = solve_ivp(rate, (0, LAST), settled.y[:, -1], t_eval=t, rtol=1e-10, atol=1e-12, max_step=1e-11)
    return t, seen.y[0]


def file_text():
    """The whole file."""
    rows = [
        "[IBIS Ver] 4.2",
        "[File Name] memory.ibs",
        "[File Rev] 1.0",
        "[Source] written by tests/ibis_files.py from equations: no such part exists",
        "[Component] MEMORY",
        "[Manufacturer] none",
        "[Package]",
        "R_pkg 120m 100m 150m",
        "L_pkg 0.9nH 0.7nH 1.1nH",
        "C_pkg 0.35pF 0.3pF 0.4pF",
        "[Pin] signal_name model_name R_pin L_pin C_pin",
        "A1 DQ0 DQ 130m 1.0nH 0.38pF",
        "A2 DQ1 DQ NA NA NA",
        "B1 CK CLOCK",
        "[Model] DQ",
        "Model_type I/O",
        "Polarity Non-Inverting",
        "Vinl = 0.5V",
        "Vinh = 0.7V",
        _row("C_comp", CAPACITANCE),
        _row("[Voltage Range]", SUPPLY),
    ]
    volts = np.linspace(-1.2, 2.4, 37)
    rows += _table("[Pulldown]", volts, lambda v, c: STRENGTH[c] * transistor(v))
    rows += _table("[Pullup]", volts, lambda v, c: -STRENGTH[c] * transistor(v))
    rows += _table("[GND Clamp]", np.linspace(-1.2, 0, 25), lambda v, _: -clamp(-v))
    rows += _table("[POWER Clamp]", np.linspace(-1.2, 0, 25), lambda v, _: clamp(-v))
    rows += ["[Ramp]", _ramp(True), _ramp(False), "R_load = 50"]
    for rises, word in ((True, "Rising"), (False, "Falling")):
        for high in (False, True):
            rows += _waveform(f"[{word} Waveform]", rises, high)
    rows += ["[Model] CLOCK", "Model_type Input", _row("C_comp", CAPACITANCE), _row("[Voltage Range]", SUPPLY)]
    rows += _table("[GND Clamp]", np.linspace(-1.2, 0, 25), lambda v, _: -clamp(-v))
    return "\n".join([*rows, "[End]", ""])


def _row(word, values):
    return f"{word} " + " ".join(f"{values[corner]:.6g}" for corner in CORNERS)


def _table(word, volts, law):
    return [word, *(f"{v:.3f} " + " ".join(f"{law(v, c):.6e}" for c in CORNERS) for v in volts)]


def _ramp(rises):
    told = []
    for corner in CORNERS:
        t, u = fixture(rises, corner, 50.0, 0.0 if rises else SUPPLY[corner])
        low, high = (u[0] + share * (u[-1] - u[0]) for share in (0.2, 0.8))
        order = np.argsort(u)
        told.append(f"{abs(high - low):.4f}/{abs(np.subtract(*np.interp([high, low], u[order], t[order]))):.4e}")
    return f"dV/dt_{'r' if rises else 'f'} " + " ".join(told)


def _waveform(word, rises, high):
    seen = {corner: fixture(rises, corner, 50.0, SUPPLY[corner] if high else 0.0) for corner in CORNERS}
    toward = [
        f"V_fixture{end} = {SUPPLY[corner] if high else 0}"
        for end, corner in (("", "typ"), ("_min", "min"), ("_max", "max"))
    ]
    t = seen["typ"][0]
    return [
        word,
        "R_fixture = 50",
        *toward,
        *(f"{at:.4e} " + " ".join(f"{seen[c][1][k]:.6f}" for c in CORNERS) for k, at in enumerate(t)),
    ]
