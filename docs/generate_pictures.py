"""Draws the pictures of README and docs: ``python -m docs.generate_pictures``."""

import re
import warnings
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import tline as tl
from benchmarks.harness import DOCS
from tline.signal.crosstalk import crosstalk
from tline.solver.simulate import UnresolvedWarning
from tline.style import INK, styled

TRACES = {"crosstalk": "coupled_pair", "overhead_line": "overhead_line"} | {
    name: name for name in ("hydraulic_hose", "brake_line", "injection_pipe")
}
MEASURED = (1015e3 - 101_325) / 1e5  # bar, the highest pressure behind the column's separation


def separation() -> Figure:
    """Draw column separation in a pipe, with the highest pressure measured."""
    picture = tl.simulate(tl.examples["column_separation"]).plot()
    axes = picture.axes[0]
    axes.axhline(MEASURED, color=INK, linestyle=":", linewidth=1.4)
    axes.annotate("highest measured", (0.99, MEASURED), (0, 3), ("axes fraction", "data"), "offset points", ha="right")
    return picture


def waves() -> dict[str, Any]:
    """Pictures of a pipe, and of a town."""
    town, closure = tl.examples["town"], tl.examples["valve_closure"]
    result, whole = tl.simulate(tl.examples["water_pipe"]), tl.simulate(town, record=town.lines, envelope=True)
    pumped = tl.examples["air_vessel"].with_changes(t_end=40)
    return {
        "pressure": result.plot(),
        "space_time": result.plot_space_time(),
        "lattice": result.plot_lattice(),
        "waves": result.plot_waves(line="pipe"),
        "network": town.plot(),
        "profile": whole.plot_profile("lake", "tower"),
        "map": whole.plot_map(),
        "sweep": tl.sweep(closure, {"loads.valve.opening.duration": "0.5 s:3 s:26"}).plot(),
        "vessel": tl.design.vessel(pumped, "vessel", path=("pump", "tank"), lowest="2 bar", highest="7 bar").plot(),
        "column_separation": separation(),
    }


@styled
def signals() -> dict[str, Any]:
    """Pictures of cables: crosstalk, reflections, eyes, load lines, a measured load; and two verdicts."""
    parts = np.eye(2), np.eye(2) / 5, np.eye(2) / 10
    pulse = tl.signal.pulse_response(tl.examples["stripline_eye"], "receiver", "100 ps", "20 ps", tol=1e-4)
    found = {
        "tdr": tl.signal.reflectometry(tl.examples["tdr"], "near", "100 ps"),
        "eye": tl.signal.eye(tl.examples["tdr"], "far", "0.8 ns", "0.2 ns"),
        "statistical_eye": tl.signal.statistical_eye(pulse, dfe=2, noise=2e-3),
        "load_lines": tl.signal.bergeron(tl.examples["load_lines"]),
        "skin_pair": crosstalk(tl.examples["skin_pair"]),
        "coax_fault": tl.signal.reflectometry(tl.examples["coax_fault"], "near", "5 ns"),
        "ddr_eye": tl.signal.eye(tl.examples["ddr_ibis"], "die", "1 ns"),
        "bode": tl.frequency.respond(tl.examples["cable_rlc"], 2j * np.pi * np.geomspace(1e6, 1e9, 1001)),
        "passivity": tl.passivity.check_positive_real("(s + 2)/(s^2 + s + 1)"),
        "passivity_discrete": tl.passivity.is_bounded_real(([[0.5, 0.7], [-0.6, 0.5]], *parts, True)),
    } | {f"exercise_{letter}": tl.exercise(letter) for letter in ("1d", "1e", "2a", "3c")}
    misfit = tl.pictures.plot_misfit(tl.examples["antenna"].loads["antenna"].model, "antenna.s1p")
    return {name: each.plot() for name, each in found.items()} | {"fit": misfit}


if __name__ == "__main__":
    warnings.simplefilter("ignore", UnresolvedWarning)
    pages = "".join(path.read_text(encoding="utf-8") for path in sorted(DOCS.glob("*.md")))
    circuits = {f"circuit_{name}": name for name in re.findall(r"\(pictures/circuit_(\w+)\.png\)", pages)}
    traces = {picture: tl.simulate(tl.examples[name]).plot() for picture, name in (TRACES | circuits).items()}
    for name, picture in (waves() | signals() | traces).items():
        tl.pictures.save_figure(picture, DOCS / "pictures" / f"{name}.png")
