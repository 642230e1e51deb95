"""Writes the tables and pictures of docs/losses.md. Run: python -m docs.generate losses."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.harness import DOCS, ROOT, table, write
from tline.loss import (
    ConstantLoss,
    DielectricLoss,
    EarthReturn,
    LaminarFriction,
    Law,
    LossyLine,
    RoundWire,
    SkinEffect,
    TurbulentFriction,
    hagen_poiseuille,
    realise,
)
from tline.loss.law import Arithmetic
from tline.pictures.traces import plot
from tline.scene.file import read_scene
from tline.solver.simulate import simulate
from tline.study.charts.picture import RAISED
from tline.study.reference.lossy import lossy_response
from tline.style import COLOURS, DASHES, figure, save_figure, styled

SCENE = ROOT / "scenes" / "pipe_friction.toml"
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)

PIPE = {"density": 878.0, "viscosity": 0.0347, "radius": 12.7e-3}  # Holmboe and Rouleau (1967): oil, copper tube
LAMINAR = LaminarFriction(**PIPE)
COMPLIANCE = math.pi * PIPE["radius"] ** 2 / (PIPE["density"] * 1324.0**2)
LENGTH = 36.09
WIRE = RoundWire(0.5e-3, 5.8e7)
FIELD = ConstantLoss(0, 250e-9)
EARTH = EarthReturn(10, 100)
INSULATION = DielectricLoss(100e-12, 0.02, 1e9, (1e4, 1e12))


class Alone(Law):
    """Law without its storage."""

    def __init__(self, law: Law):
        super().__init__(law.loss, 0.0)
        self.law = law

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return all of the law without its storage."""
        return self.law.beyond(s, arithmetic)


CASES = {  # law, its part without storage, lowest frequency of five decades
    "laminar friction (Zielke)": (LAMINAR, Alone(LAMINAR), 0.1),
    "turbulent friction, Re = 10⁵": (law := TurbulentFriction(1000, 1e-3, 0.01, 1e5), Alone(law), 0.1),
    "round wire of 1 mm": (WIRE + FIELD, WIRE, 1e4),
    "skin effect √(R² + k²s), from the corner": (SkinEffect(1, 1e-3) + FIELD, SkinEffect(1, 1e-3), 1.6e5),
    "skin effect k√s": (SkinEffect(0, 1e-3) + FIELD, SkinEffect(0, 1e-3), 1.6e5),
    "earth below a wire, 10 m and 100 Ω·m": (EARTH + ConstantLoss(0, 1.5e-6), EARTH, 10),
    "dielectric, tan δ = 0.02": (INSULATION, Alone(INSULATION), 1e6),
}


def terms() -> str:
    """Number of terms for each tolerance over five decades, of the law and of its part without storage."""
    rows = []
    for name, (law, alone, low) in CASES.items():
        counts = []
        for tolerance in TOLERANCES:
            both = (realise(each, (low, 1e5 * low), tolerance) for each in (law, alone))
            counts.append(" / ".join(str(len(found.circuit.rates)) for found in both))
        rows.append((name, *counts))
    return table("<over five decades|<" + "|<".join(f"{tolerance:.0e}" for tolerance in TOLERANCES), rows)


def responses() -> str:
    """Error of a realisation in time: the step response with the circuits against that with the laws."""
    tolerances = TOLERANCES[:3]
    rows = []
    pipe = LossyLine(LAMINAR, ConstantLoss(0, COMPLIANCE), LENGTH)
    cable = LossyLine(WIRE + FIELD, INSULATION, 0.2)
    for name, line, source, load in (
        ("pipe of Holmboe and Rouleau, closed end", pipe, 0.0, math.inf),
        ("0.2 m of the cable above, 25 ohm into 75 ohm", cable, 25.0, 75.0),
    ):
        times = (np.arange(1, 10) + 0.3) * line.delay
        exact = lossy_response(line, times, line.length, source=source, load=load, digits=12).efforts
        errors = []
        for tolerance in tolerances:
            band = (1e-3 / line.delay, 1e2 / line.delay)
            series, shunt = (realise(law, band, tolerance).circuit for law in (line.series, line.shunt))
            near = LossyLine(series, shunt, line.length)
            found = lossy_response(near, times, line.length, source=source, load=load, digits=12).efforts
            errors.append(f"{np.abs(found - exact).max():.0e}")
        rows.append((name, *errors))
    head = "<step response over 10 delays|<" + "|<".join(f"{tolerance:.0e}" for tolerance in tolerances)
    return table(head, rows)


@styled
def ripples() -> Figure:
    """Draw the error of the circuits for laminar friction over frequency."""
    picture = figure(7.5, 4.2, "Circuits for laminar friction, tolerances 10⁻² to 10⁻⁸")
    axes = picture.subplots()
    f = np.geomspace(1e-3, 1e6, 3000)
    for k, tolerance in enumerate(TOLERANCES):
        found = realise(LAMINAR, (0.1, 1e4), tolerance)
        label = f"{len(found.circuit.rates)} terms"
        axes.loglog(f, found.errors(f), color=COLOURS[k], linestyle=DASHES[k], label=label, linewidth=1.3)
    axes.axvspan(0.1, 1e4, color="#F0F0F0", zorder=0)
    axes.set(xlabel="frequency / Hz", ylabel="|circuit − law| / |law|", ylim=(1e-12, 1), xlim=(f[0], f[-1]))
    axes.text(31, 0.2, "band", ha="center")
    for axis, decades in ((axes.xaxis, range(-3, 7)), (axes.yaxis, range(-12, 1, 2))):
        axis.set_ticks([10.0**k for k in decades], [f"10{str(k).translate(RAISED)}" for k in decades])
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return picture


@styled
def closing() -> Figure:
    """Draw the pressure at a valve after a step, with friction of two kinds and without."""
    picture = figure(7.5, 4.2, "Frequency-dependent friction rounds fronts and damps faster")
    axes = picture.subplots()
    steady = hagen_poiseuille(**PIPE)
    kinds = {"no friction": ConstantLoss(0, LAMINAR.storage), "constant": steady, "frequency-dependent": LAMINAR}
    for k, (name, law) in enumerate(kinds.items()):
        line = LossyLine(law, ConstantLoss(0, COMPLIANCE), LENGTH)
        times = (np.arange(1, 480) + 0.5) / 480 * 14 * line.delay
        u = lossy_response(line, times, LENGTH, source=0, load=math.inf, digits=6).efforts
        axes.plot(times * 1e3, u, color=COLOURS[k], linestyle=DASHES[k], label=name, linewidth=1.4)
    axes.set(xlabel="time / ms", ylabel="pressure at the closed end / step at the other", xlim=(0, None))
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return picture


if __name__ == "__main__":
    write("docs/losses.md", terms(), "terms")
    write("docs/losses.md", responses(), "responses")
    pictures = {"ripples": ripples(), "step": closing(), "pipe": plot(simulate(read_scene(SCENE)))}
    for name, picture in pictures.items():
        save_figure(picture, DOCS / "pictures" / f"losses_{name}.png")
