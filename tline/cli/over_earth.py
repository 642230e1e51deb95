"""What earth and metal take from an overhead line over frequency, for `tline line electrical`."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from tline.errors import InputError
from tline.line import ElectricalLine
from tline.line.electrical import in_air
from tline.line.parameters import LineQuantity, read
from tline.units import engineering
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from tline.loss import LossyLine

OPTIONS = (
    LineQuantity(
        "earth", "ρ", "ohm m", "ohm m", "resistivity of the earth below a wire over ground, to know its losses"
    ),
    LineQuantity(
        "wire_resistance", "R", "ohm/m", "ohm/m", "with --earth: of the wire to steady current, if not perfect"
    ),
)
FREQUENCIES = (50.0, 1e3, 1e4, 1e5, 1e6)  # Hz
DECIBELS = 20 / math.log(10)  # of a neper


def over_earth(
    given: Mapping[str, str | None], asked: Mapping[str, str | None]
) -> tuple[ElectricalLine, list[dict[str, float]]]:
    """The lossless line, in air if its speed is not given, and at some frequencies what it is with its losses."""
    from tline.loss import ConstantLoss, EarthReturn, LossyLine, RoundWire

    values = read(OPTIONS, asked).values
    known = {name: value for name, value in given.items() if value is not None}
    line = ElectricalLine(**known, **in_air(known))
    if "earth" not in values:
        raise InputError("wire_resistance", "is of a wire over earth", "--earth, too")
    if line.height is None or line.wire_diameter is None:
        raise InputError("earth", "is below a wire over ground", "--height and --wire-diameter, too")
    series = EarthReturn(line.height, values["earth"]) + ConstantLoss(0.0, line.inductance or 0.0)
    if "wire_resistance" in values:
        series += RoundWire.of_resistance(line.wire_diameter / 2, values["wire_resistance"])
    metre = LossyLine(series, ConstantLoss(0.0, line.capacitance or 0.0), 1.0)
    return line, [_at(f, metre) for f in FREQUENCIES]


def _at(f: float, line: "LossyLine") -> dict[str, float]:
    """Series impedance and propagation, per metre."""
    omega = 2 * math.pi * f
    z, gamma = complex(line.series.at(1j * omega)), complex(line.gamma(1j * omega))
    return {
        "frequency": f,
        "resistance": z.real,
        "inductance": z.imag / omega,
        "attenuation": gamma.real * DECIBELS,
        "wave_speed": omega / gamma.imag,
    }


def as_table(rows: list[dict[str, float]]) -> str:
    """Resistance, inductance, attenuation and speed of waves over frequency."""
    told = [
        [
            engineering(row["frequency"], "Hz"),
            engineering(row["resistance"], "ohm/km"),
            engineering(row["inductance"], "H/m"),
            f"{row['attenuation'] * 1e3:.4g} dB/km",
            engineering(row["wave_speed"], "km/s"),
        ]
        for row in rows
    ]
    return "\n".join(aligned([["over earth", "R", "L", "attenuation", "speed"], *told], 1))
