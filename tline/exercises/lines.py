"""Problem 2: models of a pipe and a cable, and their waves."""

from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drives.picture import draw_bode as draw_bode, draw_run as draw_run
from friction.pictures import draw_panels as draw_panels
from passivity.exact.picture import draw_smith
from tline.exercises.answer import Found
from tline.exercises.passive_line import example
from tline.line import ElectricalLine, HydraulicLine
from tline.style import COLOURS, DASHES, FAINT, UP, cells_of, styled
from tline.units import handy

PIPE: dict[str, Any] = {"radius": 0.1, "wave_speed": 1500, "density": 980}
CABLE: dict[str, Any] = {"wave_speed": 3e8, "z0": 300}
LENGTH, PLACES = 3000.0, 400  # m; points of a curve
SNAPSHOTS = (0.6, 1.4, 2.2)  # in delays of the line


def pipe() -> Found:
    """Answer 2a: the hydraulic line."""
    line = HydraulicLine(**PIPE)
    assert line.bulk_modulus is not None
    assert line.area is not None
    numbers = {
        "bulk_modulus": line.bulk_modulus,
        "bulk_bar": line.bulk_modulus / 1e5,
        "z0": line.z0,
        "z0_bar": line.z0 / 1e5,
        "area": line.area,
        "per_litre": line.z0 * 1e-3 / 1e5,
    }
    return Found(numbers, draw=("draw_snapshots", "hydraulic"))


def cable() -> Found:
    """Answer 2b: the electrical line."""
    line = ElectricalLine(**CABLE)
    assert line.capacitance is not None
    assert line.inductance is not None
    numbers = {"capacitance": line.capacitance, "inductance": line.inductance}
    numbers |= {"capacitance_pf": line.capacitance * 1e12, "inductance_uh": line.inductance * 1e6}
    return Found(numbers, draw=("draw_snapshots", "electrical"))


@cache
def snapshots(medium: str) -> tuple[Any, ...]:
    """Places [m], and for each snapshot its time [s] and both waves, relative to the largest effort sent."""
    import tline as tl
    from tline.solver.result.dense_output import inside

    line = HydraulicLine(**PIPE) if medium == "hydraulic" else ElectricalLine(**CABLE)
    delay = LENGTH / (line.wave_speed or 0.0)
    sent = {"shape": "sine", "amplitude": 1.0, "frequency": 1 / delay}
    scene = {
        "medium": medium,
        "t_end": 2.5 * delay,
        "lines": {"line": {"nodes": ["near", "far"], "z0": line.z0, "delay": delay}},
        "probes": {"far": {"at": "far"}},
        "sources": {"s": {"at": "near", "kind": "pressure" if medium == "hydraulic" else "voltage", "value": sent}},
    }
    scene["sources"]["s"]["resistance"] = line.z0
    result = tl.simulate(scene, record=["line"])
    shares, seen = np.linspace(0.0, 1.0, PLACES), inside(result, "line")
    times = [part * delay for part in SNAPSHOTS]
    waves = [np.array([seen.waves(np.array([t]), float(x)) for x in shares])[..., 0].T for t in times]
    return LENGTH * shares, times, waves


FOUND = {"2a": pipe, "2b": cable}


@styled
def draw_snapshots(medium: str, ax: Axes | None = None) -> Figure | Axes:
    """Draw waves a and b and the effort along 3 km of line at three instants, or at the first of them."""
    x, times, waves = snapshots(medium)
    second, unit = handy(times[-1], "s")
    drawn, cells = cells_of(ax, 11.0, 3.4, columns=len(times), sharey=True)
    for axes, t, (a, b) in zip(cells, times, waves, strict=False):
        curves = (a, "a, toward the far end"), (b, "b, back"), ((a + b) / 2, "u = (a + b)/2")
        for n, (values, label) in enumerate(curves):
            axes.plot(x / 1e3, values, color=COLOURS[n], linestyle=DASHES[n], label=label)
        axes.set_title(f"t = {t / second:.3g} {unit}", loc="left")
        axes.set(xlabel="x [km]", xlim=(0, LENGTH / 1e3))
        axes.grid(True)
    cells[0].set_ylabel("effort over that sent")
    if isinstance(drawn, Figure):
        drawn.legend(*cells[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    else:
        drawn.legend()
    return drawn


@styled
def draw_curves(names: tuple[str, ...], ax: Axes | None = None) -> Figure | Axes:
    """Draw Nyquist curves of G, and reflections H in a Smith chart, or the first of them."""
    title = "25 Ω, then 100 Ω beside 4 pF, at the end of 50 Ω, 0.1 ns"
    drawn, cells = cells_of(ax, 9.6, 4.8, columns=len(names), title=title)
    for axes, name in zip(cells, names, strict=False):
        z = getattr(example(), name.lower())
        if name.startswith("H"):
            draw_smith(axes, z)
        else:
            axes.axvspan(-0.4, 0, color=UP, alpha=0.12, linewidth=0, label="Re < 0: not passive")
            axes.plot(z.real, z.imag, color=COLOURS[0], label=f"{name}(jω), ω > 0")
            axes.axhline(0, color=FAINT, linewidth=0.8)
            axes.set(xlim=(-0.4, 1.06 * z.real.max()), aspect="equal", adjustable="datalim")
            axes.legend(loc="upper right", fontsize=8)
            axes.grid(True)
        axes.set(xlabel=f"Re {name}", ylabel=f"Im {name}")
        axes.set_title(f"{name}(jω)", loc="left")
    return drawn
