"""Command `tline friction run`: models on the testbench."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Annotated, Any

import click

from friction.parameters import TOLD
from tline.cli.columns import read_columns
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.cli.options import check_partners, options_named
from tline.errors import InputError
from tline.units import to_si

if TYPE_CHECKING:
    from friction import PID, Force, Result, Spring

EXAMPLES = """\b
Examples:
  tline friction run lugre --set sigma0=1e5 --slope "2 N/s" --plot lugre.png
  tline friction run coulomb --method euler --step "10 ms" --v0 -1
  tline friction run karnopp --spring "20 N/m" --pull "5 cm/s" --t-end "1 min"
  tline friction run karnopp --pid "100 N/m, 200 N/(m s), 5 N s/m" --target "1 cm" --t-end "1 min"
  tline friction run karnopp --pid "100 N/m, 200 N/(m s), 5 N s/m" --target "1 cm" --period "10 ms" --delay "4 ms"
  tline friction run elasto-plastic lugre --sine "0.6 N" --frequency "1 Hz" --plot both.png
  tline friction run maxwell-slip --set stiffness=1000,500 --set limits=0.4,0.6 --spring "20 N/m" --pull "5 cm/s"
Models: coulomb, karnopp, lugre, dahl, elasto-plastic, tanh, maxwell-slip, armstrong.
"""
GAINS = ("proportional", "integral", "derivative")
PARTNERS = {  # options, and the one that each requires
    "sine": "frequency", "frequency": "sine", "phase": "sine", "hold": "table", "spring": "pull", "play": "spring",
    "target": "pid", "limit": "pid", "period": "pid", "delay": "pid",
}  # fmt: skip
SEVERAL = ("stiffness", "limits")  # of MaxwellSlip
RECORDED = {"t": "s", "x": "m", "v": "m/s", "F": "N"}  # columns of records, and their units
NAMES = {"sine": "amplitude", "spring": "stiffness", "pull": "speed"}  # of options in the package, where they differ
PLACES = ("bench", "force", "spring", "controller")  # of the package's errors
START = ("x0", "v0", "z0", "mass")


def numbers_told(*flags: str) -> list[click.Option]:
    """Options for numbers that the package explains."""
    told = {flag: TOLD[NAMES.get(flag, flag)] for flag in flags}
    return [click.Option([f"--{flag}"], metavar=one.unit, help=one.sentence) for flag, one in told.items()]


@click.group("friction", epilog=EXAMPLES)
def friction() -> None:
    """Friction models on a testbench: exact where possible, and failures of numerical methods."""


@command(
    "friction.simulation:simulate",
    names={"parameters": "set", "h": "step"},
    omit=("model", "bench", "times"),
    more=numbers_told(
        *("slope", "sine", "frequency", "phase", "offset", "spring", "play", "pull"),
        *("target", "limit", "period", "delay", *START),
    ),
    files={"csv": table("Table of the runs, SI, full precision"), "plot": picture("v, F_f and x over time")},
    group=friction,
    epilog=EXAMPLES,
)
def run(
    models: tuple[str, ...],
    *,
    parameters: tuple[str, ...] = (),
    table: str | None = None,
    hold: bool = False,
    pid: str | None = None,
    samples: Annotated[int | None, click.IntRange(1, 199_999)] = None,
    budget: Annotated[int | None, click.IntRange(1)] = None,
    **given: Any,
) -> Output:
    """Run models on the testbench and print events, cycles, final state and energy.

    Parameters
    ----------
    parameters : NAME=VALUE
        A parameter, such as F_s='1.2 N', for the models that have it; of maxwell-slip stiffness and limits, with
        commas between elements.
    table : FILE.csv
        Force over time: columns t and F, with units in the heading or in s and N, joined by straight lines.
    hold
        Hold each row of the table until the next, instead of straight lines.
    pid : P,I,D
        Gains of a controller of the place, such as '100 N/m, 200 N/(m s), 5 N s/m'; later ones are 0 if not given.
    samples : NUMBER
        Equal steps from sample to sample, 1000 if not given; errors and events do not depend on them.
    """
    import numpy as np

    from friction import Result, Status, Testbench, simulate
    from friction.prescribed import LAWS

    if "spring" in given and pid is not None:
        raise InputError("--pid", "beside a spring", "one of both")
    check_partners(given | {"pid": pid, "table": table, "hold": hold}, PARTNERS)
    si = run.in_si(given)
    tol = None if given.get("tol") is None else to_si(given["tol"], None, "--tol")
    steps: dict[str, Any] = {key: si[key] for key in ("t_end", "h") if key in si}
    laws = models_of(models, parameters, LAWS)
    runs: dict[str, Result] = {}
    flags = {NAMES.get(str(each.name), str(each.name)): each.opts[-1] for each in run.params}
    with run.named(times="--samples", **{f"{place}.{name}": flag for place in PLACES for name, flag in flags.items()}):
        start = {key: si[key] for key in START if key in si}
        forced = _force(si, table, hold, pid is not None or "spring" in si)
        loaded = Testbench(forced, spring=_spring(si, pid), controller=_controller(si, pid), **start)
        if samples is not None:
            steps["times"] = np.linspace(0.0, steps.get("t_end", 10.0), samples + 1)
        for name, law in laws.items():
            runs[name] = simulate(law, loaded, method=given.get("method"), tol=tol, budget=budget, **steps)
    found = next(iter(runs.values()))
    return Output(
        [line for each in runs.values() for line in [*each.text_lines(), *_balanced(each)]],
        found.to_dict if len(runs) == 1 else lambda: {name: each.to_dict() for name, each in runs.items()},
        {"csv": tabled(beside(runs)), "plot": drawn("friction.pictures:draw_run", runs)},
        exit_code=int(any(each.status is not Status.DONE for each in runs.values())),
    )


def _balanced(found: "Result") -> list[str]:
    """Limit cycles by harmonic balance, for a position controller with a static friction law."""
    from friction import Coulomb, Karnopp, swings

    pid, lines = found.bench.controller, list[str]()
    if not pid or not pid.proportional or not isinstance(found.model, Coulomb | Karnopp):
        return lines
    for one in swings(found.model, found.bench):
        what = "swings near it come to it" if one.attracts else "smaller swings die out, larger ones grow"
        size = f"± {one.amplitude:.4g} m at a period of {one.period:.4g} s"
        lines.append(f"harmonic balance, without sticking: {size} holds itself; {what}")
    return lines or ["harmonic balance, without sticking: no swing holds itself"]


def models_of(names: tuple[str, ...], parameters: tuple[str, ...], known: Mapping[str, type]) -> dict[str, Any]:
    """Build the models of those names; each takes the parameters that it has."""
    for name in names:
        if name not in known:
            raise InputError("MODEL", "unknown", " or ".join(known), f"'{name}'")
    have = {name: {field.name for field in fields(known[name])} for name in names}
    every, given = set[str]().union(*have.values()), dict[str, Any]()
    for text in parameters:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or key not in TOLD:
            raise InputError(
                "--set", "no parameter", f"NAME=VALUE, NAME one of {', '.join(sorted(every))}", f"'{text}'"
            )
        if key not in every:
            raise InputError("--set", f"the {' or '.join(names)} model has no {key}", " or ".join(sorted(every)))
        parts = value.split(",") if key in SEVERAL else [value]
        numbers = [to_si(part, TOLD[key].unit or None, f"--set {key}") for part in parts]
        given[key] = numbers if key in SEVERAL else numbers[0]
    for name in names:
        if needed := [
            field.name for field in fields(known[name]) if field.default is MISSING and field.name not in given
        ]:
            raise InputError("--set", f"the {name} model needs {' and '.join(needed)}", "NAME=VALUE")
    with options_named({f"model.{key}": f"--set {key}" for key in every}):
        return {
            name: known[name](**{key: value for key, value in given.items() if key in have[name]}) for name in names
        }


def beside(runs: Mapping[str, Any]) -> dict[str, Any]:
    """Columns of several runs in one table, with their labels if there are several."""
    several = len(runs) > 1
    return {f"{label}: {n}" if several else n: x for label, run in runs.items() for n, x in run.columns.items()}


def _spring(si: dict[str, float], pid: str | None) -> "Spring | None":
    from friction import Spring

    if pid is None and "pull" in si and "spring" not in si:
        raise InputError("--pull", "needs its partner", "--spring or --pid beside it")
    return Spring(si["spring"], si["pull"], si.get("play", 0.0)) if "spring" in si else None


def _controller(si: dict[str, float], pid: str | None) -> "PID | None":
    from friction import PID

    asked = [name for name in ("target", "limit", "period", "delay") if name in si]
    if pid is None:
        return None
    parts = pid.split(",")
    if len(parts) > len(GAINS):
        raise InputError("--pid", "too many gains", "at most three", f"{len(parts)}")
    gains = {name: to_si(part, TOLD[name].unit, "--pid") for name, part in zip(GAINS, parts, strict=False)}
    with options_named({f"controller.{name}": "--pid" for name in GAINS}):
        return PID(**gains, speed=si.get("pull", 0.0), **{name: si[name] for name in asked})


def _force(si: dict[str, float], file: str | None, hold: bool, pulled: bool) -> "Force":
    from friction import Ramp, Sine, Steps, Table

    shaped = [name for name in ("slope", "sine", "offset") if name in si]
    if file is not None and shaped:
        raise InputError("--table", f"another force than --{shaped[0]}", "one force")
    if file is not None:
        return (Steps if hold else Table)(*columns_of(file, "--table", "t", "F"))
    if "sine" in si:
        below = si.get("offset", 0.0), si.get("phase", 0.0), si.get("slope", 0.0)
        return Sine(si["sine"], si["frequency"], *below)
    return Ramp(si.get("slope", 0.0 if pulled or "offset" in si else 0.5), si.get("offset", 0.0))


def columns_of(file: str, where: str, *names: str) -> list[list[float]]:
    """Read these columns of a file, which may have no heading."""
    found = read_columns(file, where, RECORDED, names)
    if not found.keys() >= {*names}:
        raise InputError(where, "a column is missing", " and ".join(names), " and ".join(found))
    return [found[name] for name in names]
