"""Draws the pictures of README and docs: ``python -m docs.generate_pictures``."""

import re
import warnings

import numpy as np
from matplotlib.figure import Figure

from benchmarks.harness import DOCS, ROOT
from passivity import RationalFunction, check_positive_real
from passivity.exact.picture import draw_verdict
from tline.design import vessel
from tline.frequency.oscillations import resonances
from tline.frequency.response import respond
from tline.pictures.bode import plot_bode, plot_misfit
from tline.pictures.lattice import plot_lattice
from tline.pictures.map import plot_map
from tline.pictures.network import plot_network
from tline.pictures.path import route
from tline.pictures.profile import plot_profile, plot_space_time
from tline.pictures.signals import plot_crosstalk, plot_eye, plot_load_lines, plot_reflections
from tline.pictures.style import INK, save_figure, styled
from tline.pictures.sweep import plot_sweep
from tline.pictures.traces import plot
from tline.pictures.waves import plot_line_waves
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.signal.crosstalk import crosstalk
from tline.signal.eye_diagram import eye
from tline.signal.load_line import bergeron
from tline.signal.tdr import reflectometry
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.sweeps import sweep

TRACES = {"crosstalk": "coupled_pair", "overhead_line": "overhead_line"} | {
    name: name for name in ("hydraulic_hose", "brake_line", "injection_pipe")
}
MEASURED = (1015e3 - 101_325) / 1e5  # bar, the highest pressure behind the column's separation


def scene_of(name: str) -> Scene:
    """A scene that comes with tline."""
    return read_scene(ROOT / "scenes" / f"{name}.toml")


def bode() -> Figure:
    """The transfer function of a cable."""
    cable, f = scene_of("cable_rlc"), np.geomspace(1e6, 1e9, 1001)
    seen = {name: probe.u for name, probe in respond(cable, 2j * np.pi * f).items()}
    return plot_bode(f, seen, "voltage / source", "V/V", resonances(cable, f[-1]), cable.title)


def separation() -> Figure:
    """Column separation in a pipe, with the highest pressure measured."""
    picture = plot(simulate(scene_of("column_separation")))
    axes = picture.axes[0]
    axes.axhline(MEASURED, color=INK, linestyle=":", linewidth=1.4)
    axes.annotate("highest measured", (0.99, MEASURED), (0, 3), ("axes fraction", "data"), "offset points", ha="right")
    return picture


def waves() -> dict[str, Figure]:
    """Of a pipe, and of a town."""
    pipe, town = (scene_of(name) for name in ("water_pipe", "town"))
    result, whole = simulate(pipe), simulate(town, record=town.lines, envelope=True)
    closure, pumped = scene_of("valve_closure"), scene_of("air_vessel").with_changes(t_end=40)
    sized = vessel(pumped, "vessel", path=("pump", "tank"), lowest="2 bar", highest="7 bar")
    return {
        "pressure": plot(result),
        "space_time": plot_space_time(result, route(pipe)),
        "lattice": plot_lattice(result),
        "waves": plot_line_waves(result, "pipe"),
        "network": plot_network(town),
        "profile": plot_profile(whole, route(town, "lake", "tower")),
        "map": plot_map(whole),
        "sweep": plot_sweep(sweep(closure, {"loads.valve.opening.duration": "0.5 s:3 s:26"})),
        "vessel": sized.plot(),
        "column_separation": separation(),
    }


def signals() -> dict[str, Figure]:
    """Of cables: crosstalk, reflections, eyes, load lines, a measured load; and a verdict."""
    cascade, ringing, coax, net, pair = map(scene_of, ("tdr", "load_lines", "coax_fault", "ddr_ibis", "skin_pair"))
    refuted = check_positive_real(RationalFunction.from_expression("(s + 2)/(s^2 + s + 1)"))
    return {
        "bode": bode(),
        "tdr": plot_reflections(reflectometry(cascade, "near", "100 ps")),
        "eye": plot_eye(eye(cascade, "far", "0.8 ns", "0.2 ns")),
        "load_lines": plot_load_lines(bergeron(ringing)),
        "fit": plot_misfit(scene_of("antenna").loads["antenna"].model, "antenna.s1p"),
        "skin_pair": plot_crosstalk(crosstalk(pair)),
        "coax_fault": plot_reflections(reflectometry(coax, "near", "5 ns")),
        "ddr_eye": plot_eye(eye(net, "die", "1 ns")),
        "passivity": styled(draw_verdict)(refuted, refuted.margins),
    }


if __name__ == "__main__":
    warnings.simplefilter("ignore", UnresolvedWarning)
    pages = "".join(path.read_text(encoding="utf-8") for path in sorted(DOCS.glob("*.md")))
    circuits = {f"circuit_{name}": name for name in re.findall(r"\(pictures/circuit_(\w+)\.png\)", pages)}
    traces = {picture: plot(simulate(scene_of(name))) for picture, name in (TRACES | circuits).items()}
    for name, picture in (waves() | signals() | traces).items():
        save_figure(picture, str(DOCS / "pictures" / f"{name}.png"))
