"""The package of problem 4 in Modelica, with parameters inserted; parts of it by the letter that asks for them."""

import math
import re
from importlib.resources import files

from drives import CoupledDrives, Design

MODELS = {  # of the package, by letter: each with the models that it is made of
    "4b": ("Drive",),
    "4c": ("Belt",),
    "4e": ("Pulley",),
    "4f": ("Drive", "Belt", "Pulley", "Assembly"),
    "4g": ("Drive", "Belt", "Pulley", "Assembly", "WithPorts"),
    "4h": ("Drive", "Belt", "Pulley", "Assembly", "Controlled"),
}
MODEL = re.compile(r"  (?:partial )?model (\w+).*?  end \1;\n\n?", re.DOTALL)


def package(
    letter: str, drives: CoupledDrives, made: Design | None = None, speed: float = 0, tension: float = 0
) -> str:
    """The package as far as a letter asks for it."""
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
    """As short as it can be; an angle of 45 degrees as a fraction of pi."""
    return "Modelica.Constants.pi/4" if value == math.pi / 4 else f"{value!r}"
