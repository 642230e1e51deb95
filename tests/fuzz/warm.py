"""What makes a million cases short: code compiled and imported first, and lower limits at which runs are refused."""

import contextlib
import io
import os
import tempfile
from importlib import import_module
from pathlib import Path

from fuzz.case import SCENES
from fuzz.scenes import RARE, SMALL

COMMANDS = (
    ["passivity", "1/(1+s)"], ["passivity", "tanh(s)"], ["passivity", "R + s", "--param", "R>0"], ["passivity",
    "[1, 0; 0, s]"],
    ["exercise", "1a"], ["friction", "run", "lugre"], ["friction", "run", "dahl"], ["friction", "run",
    "elasto-plastic"],
    ["friction", "run", "karnopp"], ["friction", "run", "tanh"], ["friction", "curve", "lugre"], ["exercise", "4h"],
    ["drives", "control"], ["drives", "step", "--slack"], ["drives", "bode"], ["line", "hydraulic", "--radius", "1"],
    ["fit", "antenna.s1p"], ["passivity", "antenna.s1p"], ["schema"], ["chart", "growth", "--csv", "x"],
    ["import", "town.inp", "--wave-speed", "1000 m/s"], ["import", "cable_rc.cir"], ["export", "cable_rc.toml"],
    ["tdr", "cable_rc.toml", "--port", "near", "--rise", "1 ns"], ["frequency", "cable_rc.toml", "--points", "5"],
    ["eye", "cable_rc.toml", "--probe", "far", "--bit", "2 ns", "--rise", "0.2 ns", "--bits", "5"],
    ["sweep", "cable_rc.toml", "--vary", "lines.cable.z0=uniform(40, 60)", "--sample", "random:20"],
)  # fmt: skip

LOWER = {
    ("tline.solver.description.resolution", "MOST_SLABS"): 2e4,
    ("tline.solver.description.resolution", "LARGEST"): 1e6,
    ("tline.solver.description.slab", "CHEAP"): 1e5,
    ("tline.solver.description.slab", "CHEAP_IN_BLOCKS"): 1e6,
    ("tline.solver.description.slab", "MOST_KEPT"): 1e5,
    ("tline.solver.tolerance.ladder", "MOST_SECONDS"): 0.3,
    ("friction.simulation", "MOST_STEPS"): 20_000,
    ("drives.simulation", "MOST_STEPS"): 5_000,
    ("tline.live.desk", "IDLE"): 0.0,
    ("webbrowser", "open"): bool,
}


def warm_up() -> None:
    """Run the example scenes and every command once, in a folder that is thrown away."""
    from tline.cli.main import main

    here = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        for file in SCENES.iterdir():
            Path(folder, file.name).write_bytes(file.read_bytes())
        os.chdir(folder)
        scenes = [["run", f"{name}.toml", "--ledger"] for name in SMALL]
        pictures = [[*words[:1], "y_junction.toml", *words[1:]] for words in RARE]
        for args in (*scenes, *pictures, *COMMANDS):
            with (
                contextlib.redirect_stdout(io.StringIO()),
                contextlib.redirect_stderr(io.StringIO()),
                contextlib.suppress(SystemExit),
            ):
                main(args, prog_name="tline")
        os.chdir(here)


def lower_limits() -> None:
    """Refuse runs that would legitimately take minutes: sizes that are limits of the program, and only these change."""
    for (module, name), limit in LOWER.items():
        setattr(import_module(module), name, limit)
