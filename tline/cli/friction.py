"""`tline friction`: the exercise, single runs, and curves."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from tline.errors import InputError
from tline.units import to_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from friction import Force, Model, Result, Testbench

PICTURE = (".png", ".svg", ".pdf")
UNITS = {
    "F_c": "N", "F_s": "N", "F_v": "N s/m", "v_s": "m/s", "delta": "m/s", "sigma0": "N/m", "sigma1": "N s/m",
    "sigma2": "N s/m", "z_ba": "m", "epsilon": "m/s",
}  # fmt: skip
EXAMPLES = """\b
Examples:
  tline friction exercise --plot exercise.png
  tline friction exercise --part c
  tline friction run lugre --set sigma0=1e5 --slope "2 N/s" --plot lugre.png
  tline friction run coulomb --method euler --step "10 ms" --v0 -1
  tline friction run karnopp --spring "20 N/m" --pull "5 cm/s" --time "1 min"
  tline friction run elasto-plastic --sine "0.6 N" --frequency "1 Hz" --json
  tline friction curve lugre dahl --plot curves.png
Models: coulomb, karnopp, lugre, dahl, elasto-plastic, tanh.
"""


@click.group("friction", epilog=EXAMPLES)
def friction() -> None:
    """Friction models on a testbench: exact where they can be, and how methods fail."""


@friction.command("exercise", epilog=EXAMPLES)
@click.option("--part", metavar="a…e", help="One part only.")
@click.option("--plot", metavar="FILE", help="Picture of all parts; .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def exercise(part: str | None, plot: str | None, as_json: bool) -> None:
    """Answer the exercise, part by part: a box of 1 kg on a table, pushed by a ramp of 0.5 or 2 N/s."""
    from friction import PARTS

    _check_file("--plot", plot, PICTURE)
    if part is not None and part not in PARTS:
        raise InputError("--part", "unknown", " or ".join(PARTS), f"'{part}'")
    answers = {letter: PARTS[letter]() for letter in (PARTS if part is None else part)}
    if plot:
        from friction.pictures import draw_exercise

        _save(lambda: draw_exercise(answers), plot)
    if as_json:
        told = {
            letter: {
                "title": answer.title,
                "text": answer.text,
                "runs": {k: _told(run) for k, run in answer.runs.items()},
            }
            for letter, answer in answers.items()
        }
        click.echo(json.dumps(told, indent=2, ensure_ascii=False))
        return
    for letter, answer in answers.items():
        click.echo(click.wrap_text(f"({letter}) {answer.title}. {answer.text}", width=100, subsequent_indent="    "))
        click.echo("")
    if plot:
        click.echo(f"wrote {plot}")


@friction.command("run", epilog=EXAMPLES)
@click.argument("model")
@click.option("--set", "parameters", metavar="NAME=VALUE", multiple=True, help="A parameter, such as F_s='1.2 N'.")
@click.option("--method", metavar="NAME", help="Instead of the model's default, such as euler or bdf-events.")
@click.option("--step", metavar="TIME", help="Step of a method with fixed steps.")
@click.option("--tol", metavar="NUMBER", help="Tolerance of a method that chooses its steps; exit code 1 if not met.")
@click.option("--slope", metavar="N/s", help="Ramp, 0.5 N/s if no force is given.")
@click.option("--sine", metavar="N", help="Amplitude of a sine, with --frequency.")
@click.option("--frequency", metavar="HZ", help="Of the sine.")
@click.option("--table", metavar="FILE.csv", help="Force over time: lines of t,F in s and N, joined by straight lines.")
@click.option("--spring", metavar="N/m", help="A spring that pulls, with --pull.")
@click.option("--pull", metavar="m/s", help="Speed of the spring's far end.")
@click.option("--mass", metavar="KG", default="1", help="1 kg if not given.")
@click.option("--v0", metavar="m/s", default="0", help="Velocity at the start.")
@click.option("--time", "t_end", metavar="S", default="10", help="How long, 10 s if not given.")
@click.option("--csv", metavar="FILE.csv", help="Table of the run, SI, full precision.")
@click.option("--plot", metavar="FILE", help="v, F_f and x over time; .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def run(
    model: str,
    parameters: tuple[str, ...],
    method: str | None,
    csv: str | None,
    plot: str | None,
    as_json: bool,
    **given: Any,
) -> None:
    """Run one model on the testbench and say what happened: events, final state, energy."""
    from friction import simulate

    _check_file("--plot", plot, PICTURE)
    _check_file("--csv", csv, (".csv",))
    step, tol = _number(given, "step", "s"), _number(given, "tol", None)
    with _named({"h": "--step", "tol": "--tol", "method": "--method", "t_end": "--time", "times": "--time"}):
        result = simulate(
            _model(model, parameters), _bench(given), to_si(given["t_end"], "s", "--time"), method, h=step, tol=tol
        )
    if csv:
        _write_csv(result, csv)
    if plot:
        from friction.pictures import draw_runs

        _save(lambda: draw_runs({f"{model}, {result.method.name}": result}), plot)
    click.echo(json.dumps(_told(result), indent=2, ensure_ascii=False) if as_json else _text(result))
    if not as_json:
        for file in filter(None, (csv, plot)):
            click.echo(f"wrote {file}")
    from friction import Status

    if result.status is not Status.DONE:
        click.get_current_context().exit(1)


@friction.command("curve", epilog=EXAMPLES)
@click.argument("models", nargs=-1, required=True)
@click.option(
    "--set", "parameters", metavar="NAME=VALUE", multiple=True, help="A parameter, for the models that have it."
)
@click.option("--velocity", metavar="m/s", default="0.5", help="Largest velocity, 0.5 m/s if not given.")
@click.option("--plot", metavar="FILE", help="Curves and hysteresis loops; .png, .svg or .pdf.")
@click.option("--csv", metavar="FILE.csv", help="Steady friction over velocity, SI, full precision.")
@click.option("--json", "as_json", is_flag=True, help="Print the curve in SI and full precision.")
def curve(
    models: tuple[str, ...],
    parameters: tuple[str, ...],
    velocity: str,
    plot: str | None,
    csv: str | None,
    as_json: bool,
) -> None:
    """Steady friction over velocity, and hysteresis loops, of one or more models."""
    _check_file("--plot", plot, PICTURE)
    _check_file("--csv", csv, (".csv",))
    largest = to_si(velocity, "m/s", "--velocity")
    if not largest > 0.0:
        raise InputError("--velocity", "not positive", "more than 0 m/s", velocity)
    chosen = {name: _model(name, parameters, shared=len(models) > 1) for name in models}
    speeds = [largest * (k - 10) / 10 for k in range(21)]
    rows = [[v, *(float(one.steady_force(v)) for one in chosen.values())] for v in speeds]
    if csv:
        _write_rows(csv, ["v", *chosen], rows)
    if plot:
        from friction.pictures import draw_curves

        _save(lambda: draw_curves(chosen, largest), plot)
    if as_json:
        told = {"v": speeds} | {name: [row[k + 1] for row in rows] for k, name in enumerate(chosen)}
        click.echo(json.dumps(told, indent=2))
        return
    click.echo("  ".join(f"{head:>14}" for head in ("v [m/s]", *(f"{name} [N]" for name in chosen))))
    for row in rows:
        click.echo("  ".join(f"{number:14.6g}" for number in row))
    for file in filter(None, (csv, plot)):
        click.echo(f"wrote {file}")


@contextmanager
def _named(options: dict[str, str]) -> Iterator[None]:
    """Turn the package's errors into the command's, with options for arguments."""
    from friction import InputError as FrictionError

    try:
        yield
    except FrictionError as error:
        where = error.where.removeprefix("bench.")
        where = options.get(error.where, f"--set {where[6:]}" if where.startswith("model.") else where)
        raise InputError(where, error.problem, error.expected, error.got) from error


def _model(name: str, parameters: tuple[str, ...], *, shared: bool = False) -> "Model":
    from friction import MODELS

    if name not in MODELS:
        raise InputError("MODEL", "unknown", " or ".join(MODELS), f"'{name}'")
    names = {field.name for field in fields(MODELS[name])}
    given = {}
    for text in parameters:
        key, equals, number = text.partition("=")
        if not equals or key.strip() not in UNITS:
            raise InputError(
                "--set", "no parameter", f"NAME=VALUE, NAME one of {', '.join(sorted(names))}", f"'{text}'"
            )
        if key.strip() in names:
            given[key.strip()] = to_si(number.strip(), UNITS[key.strip()], f"--set {key.strip()}")
        elif not shared:
            raise InputError("--set", f"the {name} model has no {key.strip()}", " or ".join(sorted(names)))
    with _named({}):
        return MODELS[name](**given)


def _number(given: dict[str, Any], name: str, unit: str | None) -> float | None:
    return None if given[name] is None else to_si(given[name], unit, f"--{name}")


def _bench(given: dict[str, Any]) -> "Testbench":
    from friction import Spring, Testbench

    stiffness, speed = _number(given, "spring", "N/m"), _number(given, "pull", "m/s")
    if (stiffness is None) != (speed is None):
        raise InputError("--spring", "needs its partner", "--spring and --pull together")
    names = {"spring.stiffness": "--spring", "spring.speed": "--pull", "bench.mass": "--mass", "bench.v0": "--v0"}
    with _named(names | {"force.slope": "--slope", "force.amplitude": "--sine", "force.frequency": "--frequency"}):
        spring = None if stiffness is None or speed is None else Spring(stiffness, speed)
        mass, v0 = to_si(given["mass"], "kg", "--mass"), to_si(given["v0"], "m/s", "--v0")
        return Testbench(_force(given, spring is not None), mass, v0, spring)


def _force(given: dict[str, Any], pulled: bool) -> "Force":
    from friction import Ramp, Sine

    asked = [name for name in ("slope", "sine", "table") if given[name] is not None]
    if len(asked) > 1:
        raise InputError(f"--{asked[1]}", f"another force than --{asked[0]}", "one force")
    if (given["sine"] is None) != (given["frequency"] is None):
        raise InputError("--sine", "needs its partner", "--sine and --frequency together")
    if given["sine"] is not None:
        return Sine(to_si(given["sine"], "N", "--sine"), to_si(given["frequency"], "Hz", "--frequency"))
    if given["table"] is not None:
        return _table(given["table"])
    slope = _number(given, "slope", "N/s")
    return Ramp((0.0 if pulled else 0.5) if slope is None else slope)


def _table(file: str) -> "Force":
    import csv
    from pathlib import Path

    from friction import Table
    from tline.scene.text_file import read_text

    text = read_text(Path(file), "--table")
    try:
        lines = list(csv.reader(text.splitlines()))
        points = [(float(t), float(f)) for t, f in lines if t.strip() not in ("", "t")]
    except (ValueError, csv.Error) as error:
        raise InputError("--table", "not a table of t,F", "two numbers a line", str(error)[:60]) from error
    with _named({}):
        return Table([t for t, _ in points], [f for _, f in points])


def _told(result: "Result") -> dict[str, Any]:
    from friction.result import COLUMNS

    ledger = result.ledger._asdict()
    return {
        "model": result.model.name,
        "method": result.method.name,
        "order": result.method.order,
        "status": str(result.status),
        "steps": result.steps,
        "end": {name: float(getattr(result, name)[-1]) for name in COLUMNS},
        "events": [{"kind": str(event.kind), "t": event.t, "x": event.x} for event in result.events[:1000]],
        "event_count": result.event_count,
        "energy": ledger,
        "tol": result.tol,
        "errors": result.errors or None,
        "doubt": result.doubt,
    }


def _text(result: "Result") -> str:
    end, ledger = {name: getattr(result, name)[-1] for name in ("t", "x", "v", "F_f")}, result.ledger
    shown = [f"  {event.kind} at {event.t:.10g} s, x = {event.x:.6g} m" for event in result.events[:12]]
    more = result.event_count - len(shown)
    return "\n".join(
        [
            f"{result.model.name} by {result.method.name} (order {result.method.order}): {result.status}, "
            f"{result.steps:,} steps",
            *shown,
            *([f"  and {more:,} more events"] if more else []),
            f"t = {end['t']:.6g} s: x = {end['x']:.10g} m, v = {end['v']:.10g} m/s, F_f = {end['F_f']:.10g} N",
            f"work in {ledger.applied:.6g} J = friction {ledger.friction:.6g} J + kinetic {ledger.kinetic_gain:.6g} J, "
            f"residual {ledger.residual:.1e}; {ledger.bristle_gain:.3g} J in bristles",
            f"NOT met: {result.doubt}" if result.doubt else _errors(result),
        ]
    )


def _errors(result: "Result") -> str:
    """Say how good the numbers are."""
    if result.worst is None:
        exact = result.method.step == "events"
        return "errors: those of rounding" if exact else f"errors: not estimated by {result.method.name}"
    told = [f"{name} {error:.0e}" for name, error in result.errors.items() if name != "t"]
    asked = "" if result.tol is None else f"; tolerance {result.tol:g}"
    events = f", events {result.errors['t']:.0e}·t_end" if result.event_count else ""
    worst = "events" if result.worst[0] == "t" else result.worst[0]
    return f"errors, of each column's largest value: {', '.join(told)}{events}; worst: {worst}{asked}"


def _check_file(option: str, path: str | None, known: tuple[str, ...]) -> None:
    from tline.solver.result.atomic import check_writable

    if path is not None:
        if not path.lower().endswith(known):
            raise InputError(option, "unknown kind of file", " or ".join(known), f"'{path}'")
        check_writable(path)


def _save(draw: Callable[[], "Figure"], path: str) -> None:
    from tline.pictures.style import save_figure

    save_figure(draw(), path)


def _write_csv(result: "Result", path: str) -> None:
    from friction.result import COLUMNS

    rows = zip(*(getattr(result, name).tolist() for name in COLUMNS), strict=True)
    _write_rows(path, list(COLUMNS), [list(row) for row in rows])


def _write_rows(path: str, head: list[str], rows: list[list[float]]) -> None:
    from tline.solver.result.atomic import replacing

    with replacing(path) as temporary:
        temporary.write_text(
            "\n".join([",".join(head), *(",".join(map(repr, row)) for row in rows)]) + "\n", encoding="utf-8"
        )
