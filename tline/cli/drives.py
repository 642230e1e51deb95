"""`tline drives`: the coupled drives, from the equations to Bode plot, controller and animation."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from tline.cli.drives_input import PARAMETERS, build, quantity, torques
from tline.cli.drives_output import (
    check_files,
    print_json,
    run_data,
    run_text,
    save_picture,
    save_table,
    say_notes,
    say_verdicts,
)
from tline.errors import InputError

if TYPE_CHECKING:
    from drives import CoupledDrives


@click.group(
    "drives",
    epilog="""\b
Examples:
  tline drives exercise
  tline drives bode --plot bode.png
  tline drives step --t1 "0.1 N m" --t2 "0.1 N m" --plot step.png
  tline drives control --speed "1 m/s" --tension "5 N" --limit "2 N m"
  tline drives animate mechanism.html
""",
)
def drives() -> None:
    """Two spools, an elastic belt and a spring-mounted pulley that measures its tension.

    All numbers are the exercise's unless given, as options or in a TOML file with the same names.
    """


def parameters(command: Callable) -> Callable:
    """Give a command the options for the mechanism; it gets the drives as its first argument."""

    @wraps(command)
    def with_drives(parameter_file: str | None, **given: Any) -> None:
        values = {name: given.pop(name) for name in PARAMETERS}
        with _errors_of_drives():
            command(build(parameter_file, values), **given)

    for name, (_, part, _, text) in reversed(PARAMETERS.items()):
        note = "" if part == "pulley" else " Two with a comma between: left, right."
        with_drives = click.option(f"--{name.replace('_', '-')}", name, metavar="VALUE", help=text + note)(with_drives)
    text = "Parameters by the names of these options, as texts with units, or pairs of texts."
    return click.option("--parameters", "parameter_file", metavar="FILE.toml", help=text)(with_drives)


as_json_option = click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
csv_option = click.option("--csv", "table_file", metavar="FILE.csv", help="Write a table, SI, full precision.")
plot_option = click.option("--plot", metavar="FILE", help="Write a picture; .png, .svg or .pdf.")
end_option = click.option("--end", metavar="TIME", default="2 s", show_default=True, help="Length of the run.")


@drives.command(
    "exercise",
    epilog="""\b
Examples:
  tline drives exercise
  tline drives exercise --part d
  tline drives exercise --friction "0.01 N m s" --plot bode.png
  tline drives exercise --json
""",
)
@parameters
@click.option("--part", type=click.Choice(list("abcdefgh")), help="Only this part.")
@plot_option
@as_json_option
def exercise(found: "CoupledDrives", part: str | None, plot: str | None, as_json: bool) -> None:
    """Go through the exercise, (a) to (h): from the balances to Bode plot and control.

    Also says which claims of its text hold for the exact model, and shows where its unstable eigenvalues come from.
    """
    from drives import draw_bode
    from drives.answers import OMEGA, exercise

    check_files(plot)
    answers = [one for one in exercise(found) if part in (None, one.letter)]
    if as_json:
        print_json({one.letter: {"title": one.title, "lines": list(one.lines), **one.data} for one in answers})
    else:
        for one in answers:
            click.echo("\n".join([f"({one.letter}) {one.title}", *(f"    {line}" for line in one.lines), ""]))
    both = [found.transfer("x_k", source) for source in ("T1", "T2")]
    save_picture(plot, as_json, lambda: draw_bode(both, OMEGA))


@drives.command(
    "bode",
    epilog="""\b
Examples:
  tline drives bode
  tline drives bode --output tension --from "1 rad/s" --to "1000 rad/s" --points 7
  tline drives bode --angle "30 deg" --plot bode.png --poles poles.png
""",
)
@parameters
@click.option("--output", default="x_k", show_default=True, help="x_k, tension, belt_speed, w1, w2, phi1 or phi2.")
@click.option("--from", "low", metavar="ω", default="0.1 rad/s", show_default=True, help="Smallest angular frequency.")
@click.option("--to", "high", metavar="ω", default="1e4 rad/s", show_default=True, help="Largest angular frequency.")
@click.option("--points", type=click.IntRange(2, 10_000), default=50, show_default=True, help="How many.")
@click.option("--poles", metavar="FILE", help="Picture of poles and zeros.")
@csv_option
@plot_option
@as_json_option
def bode(
    found: "CoupledDrives",
    output: str,
    low: str,
    high: str,
    points: int,
    table_file: str | None,
    plot: str | None,
    poles: str | None,
    as_json: bool,
) -> None:
    """Frequency response from both torques to an output.

    The phase has no jumps: it starts at 0° or −180°, by the sign of the DC gain, and is continuous from there.
    """
    import numpy as np

    from drives import draw_bode, draw_poles, hidden_modes
    from drives.report import mode_data, response_data, transfer_data, transfer_text

    check_files(plot, table_file)
    check_files(poles)
    first, last = quantity("--from", low, "rad/s"), quantity("--to", high, "rad/s")
    if not 0 < first < last:
        raise InputError("--from", "no range", f"more than 0 and less than {high}", low)
    omega = np.logspace(np.log10(first), np.log10(last), points)
    seen = {source: found.transfer(output, source) for source in ("T1", "T2")}
    answers = {h.name: response_data(h, omega) for h in seen.values()}
    if as_json:
        told: dict[str, Any] = {"omega": omega.tolist()}
        for source, h in seen.items():
            hidden = [mode_data(mode) for mode in hidden_modes(found, output, source)]
            told[h.name] = transfer_data(h) | answers[h.name] | {"hidden": hidden}
        print_json(told)
    else:
        for h in seen.values():
            click.echo(transfer_text(h))
        click.echo("\n" + "ω [rad/s]".rjust(12) + "".join(f"{f'{n} [dB]':>16}{'phase [°]':>16}" for n in answers))
        for k, w in enumerate(omega):
            both = ((answer["decibel"][k], answer["degrees"][k]) for answer in answers.values())
            click.echo(f"{w:12.5g}" + "".join(f"{size:16.6g}{phase:16.6g}" for size, phase in both))
    columns = {f"{n} {key}": np.array(values) for n, answer in answers.items() for key, values in answer.items()}
    save_table(table_file, as_json, {"omega": omega} | columns)
    smooth = np.logspace(np.log10(first), np.log10(last), 400)
    save_picture(plot, as_json, lambda: draw_bode(list(seen.values()), smooth))
    save_picture(poles, as_json, lambda: draw_poles(list(seen.values())))


@drives.command(
    "step",
    epilog="""\b
Examples:
  tline drives step
  tline drives step --t1 "0.1 N m" --t2 "0.3 N m" --rise "0.2 s" --plot step.png
  tline drives step --table torques.csv --end "5 s" --step "1 ms" --csv run.csv
  tline drives step --t2 "-0.1 N m" --slack --json
\b
A table is a CSV file with the header t,T1,T2 and SI values, later times below earlier ones:
  t,T1,T2
  0,0.1,0.1
  0.5,0.1,0.3
""",
)
@parameters
@click.option("--t1", metavar="TORQUE", help="Torque that brakes spool 1, '0.1 N m' if neither is given.")
@click.option("--t2", metavar="TORQUE", help="Torque that drives spool 2.")
@click.option("--rise", metavar="TIME", help="Let the torques rise in a straight line for this time.")
@click.option("--table", metavar="FILE.csv", help="Torques over time instead, straight lines between.")
@click.option("--hold", is_flag=True, help="Hold each row of the table until the next, instead of straight lines.")
@click.option("--slack", is_flag=True, help="A belt that cannot push.")
@end_option
@click.option(
    "--step", metavar="TIME", help="Time between samples, a 200th of the run if not given; it causes no error."
)
@csv_option
@plot_option
@as_json_option
def step(
    found: "CoupledDrives",
    t1: str | None,
    t2: str | None,
    rise: str | None,
    table: str | None,
    hold: bool,
    slack: bool,
    end: str,
    step: str | None,
    table_file: str | None,
    plot: str | None,
    as_json: bool,
) -> None:
    """What torques do to the mechanism at rest: exact at the samples, with the balance of energy."""
    from drives import draw_run, simulate, simulate_slack

    check_files(plot, table_file)
    given = torques(t1, t2, rise, table, hold)
    last = quantity("--end", end, "s")
    h = quantity("--step", step, "s") if step else last / 200
    run = (simulate_slack if slack else simulate)(found, *given, end=last, step=h)
    if as_json:
        print_json(run_data(run))
    else:
        click.echo(run_text(run))
    say_notes(run)
    save_table(table_file, as_json, {"t": run.t} | run.outputs)
    save_picture(plot, as_json, lambda: draw_run(run.t, run.outputs, ("x_k", "tension", "belt_speed")))
    say_verdicts(run.verdicts, as_json)


CONTROL_OPTIONS = [
    click.option("--speed", metavar="SPEED", default="1 m/s", show_default=True, help="Set point of the belt speed."),
    click.option("--tension", metavar="FORCE", default="5 N", show_default=True, help="Set point of the tension."),
    click.option("--speed-bandwidth", metavar="ω", help="Of the speed loop, such as '20 rad/s'."),
    click.option("--tension-bandwidth", metavar="ω", help="Of the tension loop."),
    click.option("--disturbance", metavar="TORQUE", default="0 N m", help="On spool 1 from half of the run on."),
    click.option("--limit", metavar="TORQUE", help="Largest torque of each motor."),
    click.option("--no-antiwindup", is_flag=True, help="Let the integrals wind up at the limit."),
    end_option,
]


def control_options(command: Callable) -> Callable:
    """Give a command the options of a controlled run."""
    for option in reversed(CONTROL_OPTIONS):
        command = option(command)
    return command


@drives.command(
    "control",
    epilog="""\b
Examples:
  tline drives control
  tline drives control --speed-bandwidth "50 rad/s" --tension-bandwidth "20 rad/s"
  tline drives control --disturbance "0.05 N m" --limit "2 N m" --plot loop.png
""",
)
@parameters
@control_options
@csv_option
@plot_option
@as_json_option
def control(found: "CoupledDrives", table_file: str | None, plot: str | None, as_json: bool, **given: Any) -> None:
    """Design PI controllers for belt speed and tension behind a decoupler, and run them.

    Spools that differ are made alike by an inner feedback. Set points step at t = 0. At the limit the tension comes
    first. What cannot be had, a bandwidth with good margins or set points at the limit, is said with what can; exit 1.
    """
    import numpy as np

    from drives import draw_closed_loop
    from drives.report import design_data, design_text

    check_files(plot, table_file)
    made, run, limit = _controlled(found, **given)
    verdicts = (*made.verdicts, *run.verdicts)
    if as_json:
        print_json({"design": design_data(made)} | run_data(run) | {"verdicts": verdicts})
    else:
        click.echo("\n".join(design_text(made)))
        click.echo(run_text(run))
    say_notes(run)
    save_table(table_file, as_json, {"t": run.t} | run.outputs)
    points = {"belt_speed": quantity("--speed", given["speed"], "m/s")}
    points["tension"] = quantity("--tension", given["tension"], "N")
    lines = {name: np.full(len(run.t), point) for name, point in points.items()}
    save_picture(plot, as_json, lambda: draw_closed_loop(run.t, run.outputs, lines, limit))
    say_verdicts(verdicts, as_json)


@drives.command(
    "animate",
    epilog="""\b
Examples:
  tline drives animate mechanism.html
  tline drives animate mechanism.gif --speed "0.5 m/s" --tension "4 N" --end "1 s"
""",
)
@click.argument("file")
@parameters
@control_options
def animate(found: "CoupledDrives", file: str, **given: Any) -> None:
    """Write an animation of the mechanism under control: FILE.html, a page of its own, or FILE.gif."""
    from drives.animation import SUFFIXES, animate
    from tline.solver.result.atomic import check_writable, replacing

    if not file.lower().endswith(SUFFIXES):
        raise InputError(file, "unknown kind of animation", " or ".join(SUFFIXES))
    check_writable(file)
    made, run, _ = _controlled(found, **given)
    with replacing(file) as temporary:
        animate(found, run.t, run.outputs, temporary)
    click.echo(f"wrote {file}")
    say_notes(run)
    say_verdicts((*made.verdicts, *run.verdicts), quiet=False)


def _controlled(found: "CoupledDrives", **given: Any) -> tuple[Any, Any, float | None]:
    """Design, run and limit, from the options."""
    from drives import Torque, design, simulate_control

    bands = [
        quantity(f"--{name.replace('_', '-')}", given[name], "rad/s") if given[name] else None
        for name in ("speed_bandwidth", "tension_bandwidth")
    ]
    made = design(found, *bands)
    end = quantity("--end", given["end"], "s")
    limit = quantity("--limit", given["limit"], "N m") if given["limit"] else None
    run = simulate_control(
        made,
        Torque.step(quantity("--speed", given["speed"], "m/s")),
        Torque.step(quantity("--tension", given["tension"], "N")),
        d1=Torque.step(quantity("--disturbance", given["disturbance"], "N m"), end / 2),
        limit=limit,
        antiwindup=not given["no_antiwindup"],
        end=end,
        step=end / 400,
    )
    return made, run, limit


@contextmanager
def _errors_of_drives() -> Iterator[None]:
    """Say the errors of the package as errors of the command, by the names of its options."""
    from drives import InputError as DrivesError

    options = {"end": "--end", "step": "--step", "limit": "--limit", "output": "--output"}
    options |= {"speed_bandwidth": "--speed-bandwidth", "tension_bandwidth": "--tension-bandwidth"}
    try:
        yield
    except DrivesError as error:
        raise InputError(options.get(error.where, error.where), error.problem, error.expected, error.got) from error
