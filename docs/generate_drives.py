"""Writes the pictures of docs/drives.md. Run: python -m docs.generate drives."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drives import (
    Belt,
    CoupledDrives,
    Spool,
    Torque,
    design,
    draw_bode,
    draw_poles,
    draw_run,
    forward_difference,
    simulate,
    simulate_control,
)
from drives.linearise import LITERAL_STATES, literal_rates
from tline.style import COLOURS, save_figure, styled

PICTURES = Path(__file__).parent / "pictures"
EXERCISE = CoupledDrives()
OMEGA = np.logspace(-1, 4, 400)


@styled
def bode() -> Figure:
    """Draw x_k/T1 as given, and with friction and damping low enough for the tension to resonate."""
    figure = draw_bode([EXERCISE.transfer("x_k", "T1"), _lively().transfer("x_k", "T1")], OMEGA)
    size, _ = figure.axes
    for line, text in zip(size.lines, ("as given", "friction a 100th, belt damping a 10th"), strict=True):
        line.set_label(f"x_k/T1, {text}")
    size.legend(frameon=False)
    return figure


def _lively() -> CoupledDrives:
    spool, belt = Spool(1e-3, 1e-3, 0.1), Belt(50, 0.05)
    return CoupledDrives(spool, spool, belt, belt)


@styled
def poles() -> Figure:
    """Draw poles and zeros of the tension and of a spool's speed."""
    lively = _lively()
    return draw_poles([lively.transfer("tension", "T1"), lively.transfer("w1", "T1")])


@styled
def step() -> Figure:
    """Draw the response to a step of both torques, then to a further one of one of them."""
    torques = Torque.step(0.1), Torque.table([0.0, 1.0, 1.2], [0.1, 0.1, 0.3])
    run = simulate(EXERCISE, *torques, t_end=2.5, step=0.005)
    return draw_run(run)


@styled
def control() -> Figure:
    """Draw set points, a disturbance at 1 s, and torques at their limit."""
    made, points = design(EXERCISE), (Torque.step(1.0), Torque.step(5.0))
    run = simulate_control(made, *points, d1=Torque.step(0.3, 1.0), limit=2.0, t_end=2.0, step=0.005)
    return draw_run(run)


@styled
def artefact() -> Figure:
    """Draw the two eigenvalues that are exactly 0, as computed by forward differences."""
    random, found = np.random.default_rng(1), []
    for _ in range(400):
        torques = (random.uniform(-1, 1), random.uniform(-1, 1))
        at = random.uniform(-1, 1, len(LITERAL_STATES))
        values = np.linalg.eigvals(forward_difference(literal_rates(EXERCISE, torques), at))
        found.append(sorted(values, key=abs)[:2])
    real, number = np.real(found), np.arange(1, 401)[:, None] * np.ones(2)
    figure = Figure(figsize=(8, 3.6), dpi=150, layout="constrained")
    axes = figure.subplots()
    looks = (real <= 0, COLOURS[0], "o", "0 or less"), (real > 0, COLOURS[1], "^", "unstable")
    for side, colour, mark, name in looks:
        axes.plot(real[side], number[side], mark, color=colour, markersize=3.5, alpha=0.7, label=name)
    axes.axvline(0, color="#222222", linewidth=1.4, label="exact, twice")
    axes.set_xscale("symlog", linthresh=1e-16)
    axes.set_xticks([*(s * 10.0**k for s in (-1, 1) for k in (-5, -9, -13)), 0])
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set(xlabel="real part of the two eigenvalues near 0 [rad/s]", ylabel="linearisation")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


if __name__ == "__main__":
    for draw in (bode, poles, step, control, artefact):
        save_figure(draw(), PICTURES / f"drives_{draw.__name__}.png")
