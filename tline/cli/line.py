"""Command `tline line`: the parameters of a pipe or a cable, and the losses of an overhead line in earth and metal."""

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import click

from tline.cli.from_signature import Output, command
from tline.cli.main import COMMANDS
from tline.cli.options import options_named
from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine, electrical, hydraulic
from tline.line.electrical import in_air
from tline.line.parameters import LineParameters, LineQuantity, read
from tline.units import engineering
from tline.words.wording import aligned

if TYPE_CHECKING:
    from tline.loss import LossyLine

MATERIALS = {
    "fluid": "'water' or 'hydraulic oil': gives density and bulk modulus",
    "temperature": "of the water, '20 degC' if not given",
    "wall": "such as 'steel' or 'pvc': gives Young's modulus of an elastic wall",
}
EARTH = (
    LineQuantity(
        "earth", "ρ", "ohm m", "ohm m", "resistivity of the earth below a wire over ground, to know its losses"
    ),
    LineQuantity(
        "wire_resistance", "R", "ohm/m", "ohm/m", "with --earth: of the wire to steady current, if not perfect"
    ),
)
FREQUENCIES = (50.0, 1e3, 1e4, 1e5, 1e6)  # Hz
Rows = list[dict[str, float]]
DECIBELS = 20 / math.log(10)  # per neper


def over_earth(
    given: Mapping[str, str], asked: Mapping[str, str | None]
) -> tuple[ElectricalLine, list[dict[str, float]]]:
    """Return the lossless line, in air if no speed is given, and its quantities with losses at some frequencies."""
    from tline.loss import ConstantLoss, EarthReturn, LossyLine, RoundWire

    values = read(EARTH, asked).values
    line = ElectricalLine(**given, **in_air(given))
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


def losses_as_table(rows: Rows) -> list[str]:
    """Format resistance, inductance, attenuation and speed of waves over frequency."""
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
    return ["", *aligned([["over earth", "R", "L", "attenuation", "speed"], *told], 1)]


line = click.Group(
    "line",
    help=COMMANDS["line"][1],
    epilog="""\b
Examples:
  tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
  tline line electrical --wave-speed 3e8 --z0 300
""",
)


def _options(quantities: Iterable[LineQuantity]) -> list[click.Option]:
    """One option for each quantity."""
    return [_option(item.name, f"{item.symbol}: {item.help}", item.unit or "number") for item in quantities]


def _option(name: str, text: str, metavar: str = "text") -> click.Option:
    return click.Option([f"--{name.replace('_', '-')}"], metavar=metavar, help=f"{text}.")


def _told(parameters: LineParameters, *units: str, losses: Rows | None = None) -> Output:
    """All known quantities, and the names of effort and flow."""
    text = [*parameters.text_lines(), "", *units, *(losses_as_table(losses) if losses else ())]
    more = {"over_earth": losses} if losses else {}
    return Output(text, lambda: parameters.to_dict() | more, notes=parameters.remarks)


@command(
    more=[*_options(hydraulic.QUANTITIES), *(_option(*each) for each in MATERIALS.items())],
    group=line,
    epilog="""\b
Examples:
  tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
  tline line hydraulic --diameter "200 mm" --fluid water --temperature "12 degC"
  tline line hydraulic --diameter "6.4 in" --fluid water --wall "ductile iron" \\
      --wall-thickness "0.25 in" --length "1 km"
""",
)
def hydraulic_(**given: Any) -> Output:
    """Parameters of a lossless hydraulic line.

    Give any sufficient set, in SI or with units. The rest follows, or the answer says what is missing or which values
    clash.
    """
    with options_named({"": "hydraulic line"}):
        return _told(HydraulicLine(**given), "effort: pressure in Pa", "flow:   volume flow in m^3/s")


@command(
    more=_options((*electrical.QUANTITIES, *EARTH)),
    group=line,
    epilog="""\b
Examples:
  tline line electrical --wave-speed 3e8 --z0 300
  tline line electrical --capacitance "101 pF/m" --z0 50 --length "10 m"
  tline line electrical --inner-diameter "0.9 mm" --outer-diameter "2.95 mm" \\
      --permittivity 2.25
  tline line electrical --height "10 m" --wire-diameter "2 cm" --earth "100 ohm m"
""",
)
def electrical_(**given: Any) -> Output:
    """Parameters of a lossless electrical line.

    Give any sufficient set, in SI or with units. The rest follows, or the answer says what is missing or which values
    clash.
    """
    asked = {item.name: given.pop(item.name, None) for item in EARTH}
    with options_named({"": "electrical line"}):
        known = any(value is not None for value in asked.values())
        parameters, losses = over_earth(given, asked) if known else (ElectricalLine(**given), None)
        return _told(parameters, "effort: voltage in V", "flow:   current in A", losses=losses)
