"""Numbers of laws and of the testbench: unit, meaning and range of each, stated once for checks and docstrings."""

from collections.abc import Iterable, Sequence
from dataclasses import fields
from inspect import cleandoc
from math import inf
from typing import Any, ClassVar, NamedTuple

import numpy as np

from tline.errors import InputError

LARGEST = 1e12  # of any number in SI; its powers are still numbers


class Told(NamedTuple):
    """Description of a number: unit, meaning and range."""

    unit: str
    meaning: str
    above: float = -inf
    least: float = -inf
    kind: str = "float"

    @property
    def sentence(self) -> str:
        """Meaning, bound and unit."""
        bound = ", positive" if self.above == 0.0 else ", 0 or more" if self.least == 0.0 else ""
        return f"{self.meaning}{bound} [{self.unit}]."


TOLD = {
    "F_c": Told("N", "Coulomb friction", above=0.0),
    "F_s": Told("N", "Break-away force, at least F_c", above=0.0),
    "F_v": Told("N s/m", "Viscous friction", least=0.0),
    "v_s": Told("m/s", "Stribeck velocity", above=0.0),
    "delta": Told("m/s", "Half width of the dead zone", least=0.0),
    "sigma0": Told("N/m", "Stiffness of the bristles", above=0.0),
    "sigma1": Told("N s/m", "Damping of the bristles", least=0.0),
    "sigma2": Told("N s/m", "Viscous friction", least=0.0),
    "z_ba": Told("m", "Deflection below which bristles do not slip, less than F_c/sigma0", least=0.0),
    "lag": Told("s", "Time by which friction is late behind its velocity", least=0.0),
    "dwell": Told("s", "Time of rest after which half of the stiction that is to come has come", least=0.0),
    "epsilon": Told("m/s", "Velocity scale of tanh", above=0.0),
    "slope": Told("N/s", "Slope of a ramp, or of the line below a sine"),
    "offset": Told("N", "Value of that line at t = 0"),
    "amplitude": Told("N", "Largest value of the sine"),
    "frequency": Told("Hz", "Frequency of the sine", above=0.0),
    "phase": Told("rad", "Phase of the sine at t = 0"),
    "times": Told("s", "Rising", least=0.0, kind="sequence of float"),
    "values": Told("N", "As many", kind="sequence of float"),
    "stiffness": Told("N/m", "Stiffness of the spring", above=0.0),
    "limits": Told("N", "Force at which each element slides", above=0.0),
    "peak": Told("", "Ratio F_s/F_c", least=1.0),
    "speed": Told("m/s", "Speed of the spring's far end, or of the target"),
    "play": Told("m", "Free way of the spring, either way", least=0.0),
    "proportional": Told("N/m", "Gain of the error", least=0.0),
    "integral": Told("N/(m s)", "Gain of its integral", least=0.0),
    "derivative": Told("N s/m", "Gain of its rate", least=0.0),
    "target": Told("m", "Where the mass ought to be at t = 0"),
    "limit": Told("N", "Largest force, either way", above=0.0),
    "period": Told("s", "Time between two looks, 0 for a continuous controller", least=0.0),
    "delay": Told("s", "From a look to the force that it leads to", least=0.0),
    "mass": Told("kg", "Mass", above=0.0),
    "v0": Told("m/s", "Velocity at t = 0"),
    "x0": Told("m", "Place at t = 0"),
    "z0": Told("m", "Deflection of the bristles at t = 0"),
}


class Parameters:
    """Base of dataclasses of such numbers: checks them, and adds their descriptions to the docstring.

    A subclass gives its example as an expression and its printed value.
    """

    place: ClassVar[str]  # where an error points at

    def __init_subclass__(cls, example: tuple[str, str] = ("", "")):
        named = [name for each in cls.__mro__[::-1] for name in vars(each).get("__annotations__", {}) if name in TOLD]
        if not example[0]:
            return
        told = []
        for name in dict.fromkeys(named):
            each, default = TOLD[name], ", optional" if hasattr(cls, name) else ""
            told.append(f"{name} : {each.kind}{default}\n    {each.sentence}")
        cls.__doc__ = "\n".join([
            f"{cleandoc(cls.__doc__ or '')}\n", "Parameters", "----------", *told, "\nRaises", "------", "InputError",
            "    A number is out of range.\n", "Examples", "--------", f">>> from friction import {cls.__name__}",
            f">>> {example[0]}", f"{example[1]}\n",
        ])  # fmt: skip

    def __post_init__(self):
        for field in fields(self):  # pyright: ignore[reportArgumentType] (subclasses are dataclasses)
            told, given = TOLD.get(field.name), vars(self)[field.name]
            if told and not (given is None and field.default is None):
                check = numbers if field.type == Sequence[float] else check_number
                found = check(f"{self.place}.{field.name}", given, above=told.above, least=told.least)
                object.__setattr__(self, field.name, found)
        least, most = getattr(self, "F_c", -inf), getattr(self, "F_s", inf)
        if most < least:
            raise InputError(f"{self.place}.F_s", "below F_c", f"at least F_c = {least:g}", f"{most:g}")


def check_number(where: str, value: Any, *, above: float = -inf, least: float = -inf) -> Any:
    """Return a finite number, more than `above` and at least `least`; raise an error for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating) or not abs(value) < inf:
        raise InputError(where, "not a finite number", "a number", repr(value)[:30])
    if abs(value) > LARGEST:
        raise InputError(where, "too large", f"at most {LARGEST:g}", repr(value)[:30])
    if value <= above:
        raise InputError(where, "too small", f"more than {above:g}", f"{float(value):g}")
    if value < least:
        raise InputError(where, "too small", f"at least {least:g}", f"{float(value):g}")
    return value


def numbers(where: str, values: Any, *, above: float = -inf, least: float = -inf) -> tuple[float, ...]:
    """Return numbers as floats; raise an error unless each is one that `check_number` lets pass."""
    if not isinstance(values, Iterable) or (isinstance(values, np.ndarray) and values.ndim != 1):
        raise InputError(where, "not a sequence", "numbers in a row", repr(values)[:30])
    return tuple(float(check_number(f"{where}[{k}]", x, above=above, least=least)) for k, x in enumerate(values))
