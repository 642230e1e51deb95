"""Cables known by name, with the source of each number."""

from typing import NamedTuple

from tline.errors import InputError
from tline.words.wording import nearest, shown


class CableType(NamedTuple):
    """A cable as its data sheet or standard has it."""

    z0: str  # characteristic impedance
    velocity_factor: str  # of a front
    unit: str  # of the attenuation
    points: tuple[tuple[str, float], ...]  # frequencies with their attenuation
    source: str  # of these numbers
    resistance: float = 0.0  # to steady current, of both conductors together, ohm/m; 0 where none is published


TIA = "limits of ANSI/TIA-568-C.2 for horizontal cable at 20 degC"
TYPES = {
    "RG-58": CableType(
        "50 ohm", "66 %", "dB/100ft",
        (("1 MHz", 0.44), ("10 MHz", 1.4), ("50 MHz", 3.3), ("100 MHz", 4.9), ("200 MHz", 7.4)),
        "RG-58C/U in the usual table of RG/U cables",
    ),
    "RG-213": CableType(
        "50 ohm", "66 %", "dB/100ft",
        (("1 MHz", 0.17), ("10 MHz", 0.55), ("50 MHz", 1.3), ("100 MHz", 1.9), ("200 MHz", 2.7)),
        "RG-213/U in the usual table of RG/U cables, as Belden 8267",
    ),
    "LMR-400": CableType(
        "50 ohm", "85 %", "dB/100ft",
        (("30 MHz", 0.68), ("50 MHz", 0.88), ("150 MHz", 1.54), ("450 MHz", 2.71), ("900 MHz", 3.9)),
        "Times Microwave: 0.12229 sqrt(f/MHz) + 0.00026 f/MHz; 1.39 and 1.65 ohm/1000ft",
        resistance=(1.39 + 1.65) / 304.8,
    ),
    "Cat 5e": CableType(
        "100 ohm", "62.46 %", "dB/100m",
        (("1 MHz", 2.04), ("4 MHz", 4.05), ("10 MHz", 6.47), ("16 MHz", 8.25), ("31.25 MHz", 11.72),
         ("62.5 MHz", 16.99), ("100 MHz", 21.98)),
        f"{TIA}: 1.967 sqrt(f/MHz) + 0.023 f/MHz + 0.05/sqrt(f/MHz), 534 ns per 100 m",
    ),
    "Cat 6": CableType(
        "100 ohm", "62.46 %", "dB/100m",
        (("4 MHz", 3.78), ("10 MHz", 5.95), ("16 MHz", 7.55), ("31.25 MHz", 10.67), ("62.5 MHz", 15.38),
         ("100 MHz", 19.8), ("200 MHz", 28.98), ("250 MHz", 32.85)),
        f"{TIA}: 1.808 sqrt(f/MHz) + 0.017 f/MHz + 0.2/sqrt(f/MHz), 534 ns per 100 m",
    ),
}  # fmt: skip


def cable_type(name: str) -> CableType:
    """A cable by its name.

    Examples
    --------
    >>> cable_type("RG-58").z0
    '50 ohm'
    """
    if name not in TYPES:
        raise InputError("cable", "not known here", nearest(name, list(TYPES)), shown(name))
    return TYPES[name]
