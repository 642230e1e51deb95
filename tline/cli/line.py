"""`tline line`: the parameters of a pipe or a cable, printed."""

import json
from collections.abc import Callable
from typing import NamedTuple

import click

from tline.cli import over_earth
from tline.cli.main import COMMANDS
from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine, electrical, hydraulic
from tline.line.parameters import LineParameters, LineQuantity
from tline.units import engineering


class LineMedium(NamedTuple):
    """Medium of a line, as the command knows it."""

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
    over_earth.OPTIONS,
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
    """The subcommand of a medium, with one option per quantity."""

    def show(json: bool, **given: str | None) -> None:
        asked = {item.name: given.pop(item.name) for item in medium.losses}
        losses = []
        try:
            if any(value is not None for value in asked.values()):
                parameters, losses = over_earth.over_earth(given, asked)
            else:
                parameters = medium.build(**given)
        except InputError as error:
            where = _option(error.where) if error.where else f"{medium.name} line"
            raise InputError(where, error.problem, error.expected, error.got) from error
        for remark in parameters.remarks:
            click.echo(f"note: {remark}", err=True)
        click.echo(as_json(medium, parameters, losses) if json else as_table(medium, parameters))
        if losses and not json:
            click.echo(f"\n{over_earth.as_table(losses)}")

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
    """What is known of a line, for the eye: name, symbol, SI value, handy value."""
    rows = [("quantity", "symbol", "SI", "handy")]
    for item in medium.quantities:
        value = getattr(parameters, item.name)
        if value is not None:
            exact = f"{value:.6g} {item.unit}".rstrip()
            handy = engineering(value, item.handy) if item.handy else ""
            rows.append((item.name, item.symbol, exact, "" if handy == exact else handy))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
    return "\n".join([*lines, "", f"effort: {medium.effort}", f"flow:   {medium.flow}"])


def as_json(medium: LineMedium, parameters: LineParameters, losses: list[dict[str, float]]) -> str:
    """All quantities of a line in SI, what is odd about them, and its losses over frequency if they are known."""
    told = {item.name: getattr(parameters, item.name) for item in medium.quantities}
    told |= {"notes": list(parameters.remarks)} | ({"over_earth": losses} if losses else {})
    return json.dumps(told, indent=2, ensure_ascii=False)


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
