"""`tline friction`: single runs, and curves."""

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from tline.cli.columns import read_columns
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.cli.options import options_named
from tline.errors import InputError
from tline.units import to_si

if TYPE_CHECKING:
    from friction import Force, Model, Spring

EXAMPLES = """\b
Examples:
  tline friction run lugre --set sigma0=1e5 --slope "2 N/s" --plot lugre.png
  tline friction run coulomb --method euler --step "10 ms" --v0 -1
  tline friction run karnopp --spring "20 N/m" --pull "5 cm/s" --t-end "1 min"
  tline friction run elasto-plastic --sine "0.6 N" --frequency "1 Hz" --json
  tline friction curve lugre dahl --plot curves.png
Models: coulomb, karnopp, lugre, dahl, elasto-plastic, tanh.
"""
RECORDED = {"t": "s", "x": "m", "v": "m/s", "F": "N"}  # columns of records, and their units
NAMED = {  # options by the package's names
    "bench.mass": "--mass",
    "bench.v0": "--v0",
    "times": "--t-end",
    "spring.stiffness": "--spring",
    "spring.speed": "--pull",
    "force.slope": "--slope",
    "force.amplitude": "--sine",
    "force.frequency": "--frequency",
}


@click.group("friction", epilog=EXAMPLES)
def friction() -> None:
    """Friction models on a testbench: exact where they can be, and how methods fail."""


@command(
    "friction.simulate:simulate",
    "friction.testbench:Testbench",
    names={"parameters": "set", "h": "step"},
    omit=("model", "bench", "times", "budget", "force"),
    files={"csv": table("Table of the run, SI, full precision"), "plot": picture("v, F_f and x over time")},
    group=friction,
    epilog=EXAMPLES,
)
def run(
    model: str,
    *,
    parameters: tuple[str, ...] = (),
    slope: str | None = None,
    sine: str | None = None,
    frequency: str | None = None,
    table: str | None = None,
    spring: str | None = None,
    pull: str | None = None,
    **given: Any,
) -> Output:
    """Run one model on the testbench and say what happened: events, final state, energy.

    Parameters
    ----------
    parameters : NAME=VALUE
        A parameter, such as F_s='1.2 N'.
    slope : N/s
        Ramp [N/s], 0.5 N/s if no force is given.
    sine : N
        Amplitude of a sine [N], with --frequency.
    frequency : HZ
        Of the sine [Hz].
    table : FILE.csv
        Force over time: columns t and F, with units in the heading or in s and N, joined by straight lines.
    spring : N/m
        Stiffness of a spring that pulls [N/m], with --pull.
    pull : m/s
        Speed of the spring's far end [m/s].
    """
    from friction import Status, Testbench, simulate
    from friction.result import COLUMNS

    shape = {"slope": slope, "sine": sine, "frequency": frequency, "spring": spring, "pull": pull}
    si = run.in_si(shape | given)
    method, tol = given.get("method"), given.get("tol")
    tol = None if tol is None else to_si(tol, None, "--tol")
    bench, law = {key: si[key] for key in ("mass", "v0") if key in si}, model_of(model, parameters)
    with run.named(**NAMED):
        pulled = _spring(si)
        loaded = Testbench(_force(si, table, pulled is not None), spring=pulled, **bench)
        steps: dict[str, Any] = {key: si[key] for key in ("t_end", "h") if key in si}
        result = simulate(law, loaded, method=method, tol=tol, **steps)
    files = {
        "csv": tabled({name: getattr(result, name) for name in COLUMNS}),
        "plot": drawn("friction.pictures:draw_run", result),
    }
    return Output(result.text_lines(), result.to_dict, files, exit_code=int(result.status is not Status.DONE))


@command(
    names={"parameters": "set"},
    files={
        "plot": picture("Curves and hysteresis loops"),
        "csv": table("Steady friction over velocity, SI, full precision"),
    },
    group=friction,
    epilog=EXAMPLES,
)
def curve(models: tuple[str, ...], *, parameters: tuple[str, ...] = (), velocity: str = "0.5") -> Output:
    """Steady friction over velocity, and hysteresis loops, of one or more models.

    Parameters
    ----------
    parameters : NAME=VALUE
        A parameter, for the models that have it.
    velocity : m/s
        Largest velocity, 0.5 m/s if not given.
    """
    from tline.solver.result.atomic import write_table
    from tline.words.aligned import aligned

    largest = to_si(velocity, "m/s", "--velocity")
    if not largest > 0.0:
        raise InputError("--velocity", "not positive", "more than 0 m/s", velocity)
    chosen = {name: model_of(name, parameters, shared=len(models) > 1) for name in models}
    speeds = [largest * (k - 10) / 10 for k in range(21)]
    forces = {name: [float(one.steady_force(v)) for v in speeds] for name, one in chosen.items()}
    rows = list(zip(speeds, *forces.values(), strict=True))
    head = ["v [m/s]", *(f"{name} [N]" for name in chosen)]
    return Output(
        aligned([head, *([f"{number:.6g}" for number in row] for row in rows)], 0),
        lambda: {"v": speeds} | forces,
        {
            "csv": lambda file: write_table(file, ["v", *chosen], rows),
            "plot": drawn("friction.pictures:draw_curves", chosen, largest),
        },
    )


def model_of(name: str, parameters: tuple[str, ...], *, shared: bool = False) -> "Model":
    """The model of that name; `shared` parameters need not be its own."""
    from friction import MODELS
    from friction.models import UNITS

    if name not in MODELS:
        raise InputError("MODEL", "unknown", " or ".join(MODELS), f"'{name}'")
    names = {field.name for field in fields(MODELS[name])}
    given = {}
    for text in parameters:
        key, equals, number = (part.strip() for part in text.partition("="))
        if not equals or key not in UNITS:
            raise InputError(
                "--set", "no parameter", f"NAME=VALUE, NAME one of {', '.join(sorted(names))}", f"'{text}'"
            )
        if key in names:
            given[key] = to_si(number, UNITS[key], f"--set {key}")
        elif not shared:
            raise InputError("--set", f"the {name} model has no {key}", " or ".join(sorted(names)))
    with options_named({f"model.{key}": f"--set {key}" for key in UNITS}):
        return MODELS[name](**given)


def _spring(si: dict[str, float]) -> "Spring | None":
    from friction import Spring

    if ("spring" in si) != ("pull" in si):
        raise InputError("--spring", "needs its partner", "--spring and --pull together")
    return Spring(si["spring"], si["pull"]) if "spring" in si else None


def _force(si: dict[str, float], file: str | None, pulled: bool) -> "Force":
    from friction import Ramp, Sine, Table

    asked = [name for name in ("slope", "sine") if name in si] + ["table"] * (file is not None)
    if len(asked) > 1:
        raise InputError(f"--{asked[1]}", f"another force than --{asked[0]}", "one force")
    if ("sine" in si) != ("frequency" in si):
        raise InputError("--sine", "needs its partner", "--sine and --frequency together")
    if "sine" in si:
        return Sine(si["sine"], si["frequency"])
    if file is None:
        return Ramp(si.get("slope", 0.0 if pulled else 0.5))
    return Table(*columns_of(file, "--table", "t", "F"))


def columns_of(file: str, where: str, *names: str) -> list[list[float]]:
    """These columns of a file, which may be without heading."""
    found = read_columns(file, where, RECORDED, names)
    if not found.keys() >= {*names}:
        raise InputError(where, "a column is missing", " and ".join(names), " and ".join(found))
    return [found[name] for name in names]
