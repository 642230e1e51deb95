"""Command `tline line`: the parameters of a pipe or a cable, and the losses of an overhead line in earth and metal."""

import json
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import click

from tline.cli.main import COMMANDS
from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine, electrical, hydraulic
from tline.line.electrical import in_air
from tline.line.parameters import LineParameters, LineQuantity, read
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
DECIBELS = 20 / math.log(10)  # per neper


def over_earth(
    given: Mapping[str, str | None], asked: Mapping[str, str | None]
) -> tuple[ElectricalLine, list[dict[str, float]]]:
    """Return the lossless line, in air if no speed is given, and its quantities with losses at some frequencies."""
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


def losses_as_table(rows: list[dict[str, float]]) -> str:
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
    return "\n".join(aligned([["over earth", "R", "L", "attenuation", "speed"], *told], 1))


class LineMedium(NamedTuple):
    """Medium of a line, as the command uses it."""

    name: str
    build: Callable[..., LineParameters]
    quantities: tuple[LineQuantity, ...]
    names: dict[str, str]  # options that are no quantities, with their help
    losses: tuple[LineQuantity, ...]  # options beside the lossless line's
    effort: str
    flow: str
    examples: str


HYDRAULIC = LineMedium(
    "hydraulic",
    HydraulicLine,
    hydraulic.QUANTITIES,
    {
        "fluid": "'water' or 'hydraulic oil': gives density and bulk modulus",
        "temperature": "of the water, '20 degC' if not given",
        "wall": "such as 'steel' or 'pvc': gives Young's modulus of an elastic wall",
    },
    (),
    "pressure in Pa",
    "volume flow in m^3/s",
    """\b
Examples:
  tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
  tline line hydraulic --diameter "200 mm" --fluid water --temperature "12 degC"
  tline line hydraulic --diameter "6.4 in" --fluid water --wall "ductile iron" \\
      --wall-thickness "0.25 in" --length "1 km"
""",
)
ELECTRICAL = LineMedium(
    "electrical",
    ElectricalLine,
    electrical.QUANTITIES,
    {},
    OPTIONS,
    "voltage in V",
    "current in A",
    """\b
Examples:
  tline line electrical --wave-speed 3e8 --z0 300
  tline line electrical --capacitance "101 pF/m" --z0 50 --length "10 m"
  tline line electrical --inner-diameter "0.9 mm" --outer-diameter "2.95 mm" \\
      --permittivity 2.25
  tline line electrical --height "10 m" --wire-diameter "2 cm" --earth "100 ohm m"
""",
)


def command(medium: LineMedium) -> click.Command:
    """Create the subcommand of a medium, with one option per quantity."""

    def show(json: bool, **given: str | None) -> None:
        asked = {item.name: given.pop(item.name) for item in medium.losses}
        losses = []
        try:
            if any(value is not None for value in asked.values()):
                parameters, losses = over_earth(given, asked)
            else:
                parameters = medium.build(**given)
        except InputError as error:
            where = _option(error.where) if error.where else f"{medium.name} line"
            raise InputError(where, error.problem, error.expected, error.got) from error
        for remark in parameters.remarks:
            click.echo(f"note: {remark}", err=True)
        click.echo(as_json(parameters, losses) if json else as_table(medium, parameters))
        if losses and not json:
            click.echo(f"\n{losses_as_table(losses)}")

    helps = {item.name: f"{item.symbol}: {item.help}" for item in medium.quantities} | medium.names
    helps |= {item.name: f"{item.symbol}: {item.help}" for item in medium.losses}
    units = {item.name: item.unit or "number" for item in (*medium.quantities, *medium.losses)}
    options = [
        click.Option([_option(name)], metavar=units.get(name, "text"), help=f"{text}.") for name, text in helps.items()
    ]
    options.append(click.Option(["--json"], is_flag=True, help="SI values in full precision."))
    text = (
        f"Parameters of a lossless {medium.name} line.\n\nGive any sufficient set, in SI or with units. "
        "The rest follows, or the answer says what is missing or which values clash."
    )
    return click.Command(medium.name, params=list(options), callback=show, help=text, epilog=medium.examples)


def as_table(medium: LineMedium, parameters: LineParameters) -> str:
    """Format all known quantities of a line, and the names of effort and flow."""
    return "\n".join([*parameters.text_lines(), "", f"effort: {medium.effort}", f"flow:   {medium.flow}"])


def as_json(parameters: LineParameters, losses: list[dict[str, float]]) -> str:
    """Format all quantities of a line in SI, remarks on them, and its losses over frequency if they are known."""
    return json.dumps(parameters.to_dict() | ({"over_earth": losses} if losses else {}), indent=2, ensure_ascii=False)


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


line = click.Group(
    "line",
    commands=[command(HYDRAULIC), command(ELECTRICAL)],
    help=COMMANDS["line"][1],
    epilog="""\b
Examples:
  tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
  tline line electrical --wave-speed 3e8 --z0 300
""",
)
