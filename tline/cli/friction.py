"""Commands `tline friction run`, `motion` and `identify`: laws on the testbench, under a given motion, from records."""

import re
from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Annotated, Any

import click

from friction.parameters import TOLD
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.cli.options import check_partners, options_named, read_columns
from tline.errors import InputError
from tline.units import engineering, to_si
from tline.words.progress import Progress

if TYPE_CHECKING:
    from friction import PID, Force, Prescribed, Result, Spring


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


MOTIONS = """\b
Examples:
  tline friction motion lugre --velocity "5 cm/s" --frequency "1 Hz" --plot loops.png
  tline friction motion dahl lugre --position "0.5 mm, 2 mm, 10 mm" --frequency "1 Hz" --plot presliding.png
  tline friction motion maxwell-slip --set stiffness=1000,500 --set limits=0.4,0.6 --position 2mm --frequency 1Hz
  tline friction motion karnopp --velocity "2 mm/s" --json
  tline friction motion lugre --velocity "0.05*sin(2*pi*t)*exp(-t)" --t-end "5 s"
  tline friction motion elasto-plastic --position moved.csv --csv force.csv
"""
RECORDS = """\b
Examples:
  tline friction identify data.csv --plot fit.png
  tline friction identify data.csv --model lugre --model dahl --json
A file begins with the names of its columns: t [ms], x [um] or v [mm/s], F [N]; SI without units.
"""
TIME = 1.0  # s, of a steady velocity or a formula
SWUNG = ("phase", "offset")  # of a sine
PLAIN = {"velocity": "m/s", "position": "m"}
FORMULA = re.compile(r"\bt\b")  # a formula contains t


@command(
    names={"parameters": "set"},
    more=numbers_told("frequency", "phase", "z0"),
    files={"csv": table("Motion and forces, SI, full precision"), "plot": picture("F_f over x, v and t")},
    group=friction,
    epilog=MOTIONS,
)
def motion(
    models: tuple[str, ...],
    *,
    velocity: str | None = None,
    position: str | None = None,
    offset: str | None = None,
    t_end: str | None = None,
    hold: bool = False,
    samples: Annotated[int | None, click.IntRange(1, 199_999)] = None,
    parameters: tuple[str, ...] = (),
    **given: Any,
) -> Output:
    """Friction under a prescribed motion, for one or more models: hysteresis, presliding loops.

    Parameters
    ----------
    velocity : m/s
        Amplitude of a sine, with --frequency, or a steady velocity; several with commas between; or FILE.csv with
        columns t and v, joined by straight lines; or a formula of t in SI.
    position : m
        Amplitude of a sine, with --frequency; several with commas between; or FILE.csv with columns t and x; or a
        formula of t in SI.
    offset : NUMBER
        Velocity or place about which the sine swings, in the unit of its amplitude.
    t_end : TIME
        End [s]; two periods, or the end of the file, or 1 s, if not given.
    hold
        Hold each velocity of a file until the next, instead of straight lines.
    samples : NUMBER
        Equal steps from sample to sample, 1000 if not given.
    parameters : NAME=VALUE
        A parameter, for the models that have it; of maxwell-slip stiffness and limits, with commas between elements.
    """
    import numpy as np

    from friction import prescribe
    from friction.prescribed import LAWS

    if (velocity is None) == (position is None):
        raise InputError("--velocity", "not one motion", "--velocity or --position")
    check_partners(given | {"offset": offset}, dict.fromkeys(SWUNG, "frequency"))
    chosen = models_of(models, parameters, LAWS)
    si = motion.in_si(given | {"t_end": t_end})
    kind, text = ("velocity", velocity) if velocity is not None else ("position", position)
    if offset is not None:
        si["offset"] = to_si(offset, PLAIN[kind], "--offset")
    runs: dict[str, Prescribed] = {}
    sine = {name: si[name] for name in ("frequency", *SWUNG) if name in si}
    with options_named({f"force.{name}": f"--{name}" for name in sine}):
        moves = _motions(kind, str(text), sine, hold)
    for amplitude, moved, end in moves:
        last: Any = si.get("t_end", end)
        times = None if samples is None else np.linspace(0.0, last, samples + 1)
        for name, model in chosen.items():
            label = f"{name}, {amplitude}" if amplitude else name
            with motion.named(motion=f"--{kind}", times="--samples"):
                runs[label] = prescribe(model, **{kind: moved}, t_end=last, times=times, z0=si.get("z0", 0.0))  # type: ignore[arg-type]
    files = {"csv": tabled(beside(runs)), "plot": drawn("friction.pictures:draw_moved", runs)}
    text = [line.replace(run.model.name, label, 1) for label, run in runs.items() for line in run.text_lines()]
    return Output(text, lambda: {label: run.to_dict() for label, run in runs.items()}, files)


@command(
    names={"models": "model"},
    files={"csv": table("Motion, measured and fitted force, SI"), "plot": picture("Fit and residual")},
    group=friction,
    epilog=RECORDS,
)
def identify(file: str, *, models: tuple[str, ...] = (), folds: int = 5) -> Output:
    """Fit friction laws to measured motion and force, and choose one by cross-validation.

    Parameters
    ----------
    models : NAME
        A law to try; all if not given.
    folds : NUMBER
        Blocks that are left out of the fit in turn, 2 to 20.
    """
    import sys

    from friction import MODELS, identify as fitted

    record = read_columns(file, file, RECORDED)
    moved = [name for name in ("v", "x") if name in record]
    if not {"t", "F"} <= record.keys() or not moved:
        raise InputError(file, "a column is missing", "t, F and x or v", ", ".join(record))
    chosen: Any = models or tuple(MODELS)
    motion = {"velocity" if moved[0] == "v" else "position": record[moved[0]]}
    names = {"t": file, "force": file, "velocity": file, "position": file}
    with identify.named(**names), Progress(2 * len(chosen), "fit", sys.stderr.isatty()) as bar:
        found = fitted(record["t"], record["F"], **motion, models=chosen, folds=folds, progress=bar.update)
    return identify.shown(found)


def _motions(kind: str, text: str, sine: dict[str, float], hold: bool) -> list[tuple[str, Any, float]]:
    """Label, motion and default end time of each motion."""
    from friction import Ramp, Sine, Steps, Table

    option, is_file = f"--{kind}", text.strip().lower().endswith(".csv")
    if hold and not is_file:
        raise InputError("--hold", "nothing to hold", f"{option} FILE.csv beside it")
    if sine and (is_file or FORMULA.search(text)):
        given = "file" if is_file else "formula"
        raise InputError("--frequency", f"of a {given}", f"an amplitude as {option}, or no frequency")
    if is_file:
        times, values = columns_of(text.strip(), option, "t", "v" if kind == "velocity" else "x")
        return [("", (Steps if hold else Table)(times, values), times[-1])]
    if FORMULA.search(text):
        from tline.interchange.spice_expression import computed

        return [("", lambda times: [computed(text, {"t": t}, option) for t in times.tolist()], TIME)]
    unit, parts = PLAIN[kind], text.split(",")
    sizes = [to_si(part, unit, option) for part in parts]
    labels = [engineering(size, unit) if len(sizes) > 1 else "" for size in sizes]
    if sine:
        waves = [Sine(size, **sine) for size in sizes]
        return [(label, wave, 2.0 / wave.frequency) for label, wave in zip(labels, waves, strict=True)]
    if kind == "position":
        raise InputError("--position", "needs its partner", "--position and --frequency together, or FILE.csv")
    return [(label, Ramp(0.0, size), TIME) for label, size in zip(labels, sizes, strict=True)]
