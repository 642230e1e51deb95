"""`tline drives`: the coupled drives, from the equations to Bode plot and controller."""

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import click

from tline.cli.columns import read_columns
from tline.cli.docstrings import arguments_of
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.cli.options import options_named
from tline.errors import InputError
from tline.scene.text_file import read_toml
from tline.units import to_si
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from drives import CoupledDrives, Torque
    from friction import Model

EXAMPLES = """\b
Examples:
  tline drives bode --plot bode.png
  tline drives step --t1 "0.1 N m" --t2 "0.1 N m" --plot step.png
  tline drives control --speed "1 m/s" --tension "5 N" --limit "2 N m"
"""
CONTROL, DESIGN = "drives.loop:simulate_control", "drives.control:design"
PASSED_ON = (
    "design",
    "drives",
    "belt_speed",
    "d1",
    "d2",
    "step",
    "initial",
    "friction",
)  # arguments that commands give themselves
FILES = {"csv": table("A table, SI, full precision"), "plot": picture("A picture")}
SAMPLES = {"step": 200, "control": 400}  # of a run
BARE = re.compile(r"\s*[+-]?[0-9.]+(e[+-]?[0-9]+)?\s*", re.IGNORECASE)
FROM_FILE = "Parameters by the names of these options, as texts with units, or pairs of texts."


class Parameter(NamedTuple):
    """A number of the mechanism: its unit, of which part, its name and class there, and the exercise's value."""

    unit: str
    part: str
    name: str
    kind: str
    default: str

    def option(self, key: str) -> click.Option:
        """The option that gives it, explained as the part explains it."""
        told = arguments_of(f"drives.parts:{self.kind}")[self.name].help.partition(". ")[0].rstrip(".")
        two = "" if self.part == "pulley" else " Two with a comma between: left, right."
        text = f"{told}; '{self.default}' if not given.{two}"
        return click.Option([f"--{key.replace('_', '-')}", key], metavar="VALUE", help=text)


class Asked(NamedTuple):
    """A number that a run under control is asked for: its unit, the value if none is given, and its help."""

    unit: str
    default: str | None = None
    help: str = ""


PARAMETERS = {
    "inertia": Parameter("kg m^2", "spool", "inertia", "Spool", "1e-3 kg m^2"),
    "friction": Parameter("N m s/rad", "spool", "friction", "Spool", "0.1 N m s"),
    "radius": Parameter("m", "spool", "radius", "Spool", "10 cm"),
    "belt_stiffness": Parameter("N/m", "belt", "stiffness", "Belt", "50 N/m"),
    "belt_damping": Parameter("N s/m", "belt", "damping", "Belt", "0.5 N s/m"),
    "pulley_stiffness": Parameter("N/m", "pulley", "stiffness", "Pulley", "200 N/m"),
    "angle": Parameter("rad", "pulley", "angle", "Pulley", "45 deg"),
}
MECHANISM = (
    click.Option(["--parameters"], metavar="FILE.toml", help=FROM_FILE),
    *(each.option(key) for key, each in PARAMETERS.items()),
)
ASKED = {
    "speed": Asked("m/s", "1 m/s", "Set point of the belt speed."),
    "tension": Asked("N", "5 N", "Set point of the tension."),
    "disturbance": Asked("N m", "0 N m", "Torque on spool 1 from half of the run on."),
    "speed_bandwidth": Asked("rad/s"),  # what these are, the design and the run say
    "tension_bandwidth": Asked("rad/s"),
    "limit": Asked("N m"),
    "period": Asked("s"),
    "delay": Asked("s"),
    "filter_time": Asked("s"),
}
SET_POINTS = tuple(
    click.Option([f"--{key}"], metavar=each.unit, default=each.default, show_default=True, help=each.help)
    for key, each in ASKED.items()
    if each.default
)


@click.group("drives", epilog=EXAMPLES)
def drives() -> None:
    """Two spools, an elastic belt and a spring-mounted pulley that measures its tension.

    All numbers are the exercise's unless given, as options or in a TOML file with the same names.
    """


@command(
    names={"output": "output", "low": "from", "high": "to"},  # no -o, which is for files
    more=MECHANISM,
    files={"poles": picture("Picture of poles and zeros"), **FILES},
    group=drives,
    epilog="""\b
Examples:
  tline drives bode
  tline drives bode --output tension --from "1 rad/s" --to "1000 rad/s" --points 7
  tline drives bode --angle "30 deg" --plot bode.png --poles poles.png
""",
)
def bode(
    *,
    output: str = "x_k",
    low: str = "0.1 rad/s",
    high: str = "1e4 rad/s",
    points: Annotated[int, click.IntRange(2, 10_000)] = 50,
    **given: Any,
) -> Output:
    """Frequency response from both torques to an output.

    The phase has no jumps: it starts at 0° or −180°, by the sign of the DC gain, and is continuous from there.

    Parameters
    ----------
    output : NAME
        x_k, tension, belt_speed, w1, w2, phi1 or phi2.
    low : ω
        Smallest angular frequency.
    high : ω
        Largest angular frequency.
    points
        How many.
    """
    import numpy as np

    from drives import hidden_modes
    from tline.presentation import plain

    found = mechanism(given)
    first, last = quantity("--from", low, "rad/s"), quantity("--to", high, "rad/s")
    if not 0 < first < last:
        raise InputError("--from", "no range", f"more than 0 and less than {high}", low)
    omega = np.logspace(np.log10(first), np.log10(last), points)
    seen = {source: found.transfer(output, source) for source in ("T1", "T2")}
    answers = {h.name: plain(h.response(omega)) for h in seen.values()}

    def data() -> dict[str, Any]:
        hidden = {source: plain(hidden_modes(found, output, source)) for source in seen}
        told = {h.name: h.to_dict() | answers[h.name] | {"hidden": hidden[key]} for key, h in seen.items()}
        return {"omega": omega.tolist(), **told}

    columns = {f"{n} {key}": np.array(values) for n, answer in answers.items() for key, values in answer.items()}
    smooth, both = np.logspace(np.log10(first), np.log10(last), 400), list(seen.values())
    files = {
        "csv": tabled({"omega": omega} | columns),
        "plot": drawn("drives.picture:draw_bode", both, smooth),
        "poles": drawn("drives.picture:draw_poles", both),
    }
    return Output(_response(both, omega.tolist(), answers), data, files)


def _response(transfers: list, omega: list[float], answers: dict[str, dict[str, list[float]]]) -> Iterator[str]:
    for h in transfers:
        yield from h.text_lines()
    head = ["ω [rad/s]", *(word for name in answers for word in (f"{name} [dB]", "phase [°]"))]
    rows = []
    for k, w in enumerate(omega):
        numbers = [answer[key][k] for answer in answers.values() for key in ("decibel", "degrees")]
        rows.append([f"{w:.5g}", *(f"{number:.6g}" for number in numbers)])
    yield from ["", *aligned([head, *rows], 0)]


@command(
    "drives.simulation:simulate",
    omit=("drives", "T1", "T2", "initial"),
    more=MECHANISM,
    files=FILES,
    group=drives,
    epilog="""\b
Examples:
  tline drives step
  tline drives step --t1 "0.1 N m" --t2 "0.3 N m" --rise "0.2 s" --plot step.png
  tline drives step --table torques.csv --t-end "5 s" --step "1 ms" --csv run.csv
  tline drives step --t2 "-0.1 N m" --slack --json
  tline drives step --t1 "0.2 N m" --rise "1 s" --coulomb "0.04 N m" --break-away "0.06 N m" --stribeck "2 rad/s"
\b
A table is a CSV file with columns t, T1, T2, in SI or in units of the heading, later times below earlier ones:
  t,T1,T2
  0,0.1,0.1
  0.5,0.1,0.3
""",
)
def step_(
    *,
    t1: str | None = None,
    t2: str | None = None,
    rise: str | None = None,
    table: str | None = None,
    hold: bool = False,
    slack: bool = False,
    coulomb: str | None = None,
    break_away: str | None = None,
    stribeck: str | None = None,
    t_end: str = "2 s",
    step: str | None = None,
    **given: Any,
) -> Output:
    """What torques do to the mechanism at rest: exact at the samples, with the balance of energy.

    Parameters
    ----------
    t1 : TORQUE
        Torque that brakes spool 1, '0.1 N m' if neither is given.
    t2 : TORQUE
        Torque that drives spool 2.
    rise : TIME
        Let the torques rise in a straight line for this time.
    table : FILE.csv
        Torques over time instead, straight lines between.
    hold
        Hold each row of the table until the next, instead of straight lines.
    slack
        A belt that cannot push.
    coulomb : TORQUE
        Dry friction in the bearings, beside the viscous one. Two with a comma between: left, right.
    break_away : TORQUE
        What it takes to leave rest, as much if not given. Two with a comma between: left, right.
    stribeck : ω
        Angular speed over which friction falls from that; two with a comma between: left, right.
    step : TIME
        Time between samples, a 200th of the run if not given; it causes no error.
    """
    from drives import simulate, simulate_slack

    laws = dry_friction(coulomb, break_away, stribeck)
    applied, last = torques(t1, t2, rise, table, hold), quantity("--t-end", t_end, "s")
    h = quantity("--step", step, "s") if step else last / SAMPLES["step"]
    found = mechanism(given)
    if slack or any(laws):
        run = simulate_slack(found, *applied, t_end=last, step=h, slack=slack, friction=laws)
    else:
        run = simulate(found, *applied, t_end=last, step=h)
    return step_.shown(run, exit_code=int(bool(run.verdicts)), csv=tabled({"t": run.t} | run.outputs))


@command(
    CONTROL,
    DESIGN,
    omit=PASSED_ON,
    more=(*SET_POINTS, *MECHANISM),
    files=FILES,
    group=drives,
    epilog="""\b
Examples:
  tline drives control
  tline drives control --speed-bandwidth "50 rad/s" --tension-bandwidth "20 rad/s"
  tline drives control --disturbance "0.05 N m" --limit "2 N m" --plot loop.png
  tline drives control --period "10 ms" --delay "4 ms" --filter-time "3 ms"
  tline drives control --speed "0.1 m/s" --coulomb "0.04 N m" --break-away "0.06 N m" --stribeck "2 rad/s"
""",
)
def control(
    *,
    coulomb: str | None = None,
    break_away: str | None = None,
    stribeck: str | None = None,
    t_end: str = "2 s",
    **given: Any,
) -> Output:
    """Design PI controllers for belt speed and tension behind a decoupler, and run them.

    Spools that differ are made alike by an inner feedback. Set points step at t = 0. At the limit the tension comes
    first. What cannot be had, a bandwidth with good margins or set points at the limit, is said with what can; exit 1.

    Parameters
    ----------
    coulomb : TORQUE
        Dry friction in the bearings, as of `tline drives step`.
    break_away : TORQUE
        What it takes to leave rest.
    stribeck : ω
        Angular speed over which friction falls from that.
    """
    from drives import Torque, design, simulate_control

    laws = dry_friction(coulomb, break_away, stribeck)
    found, end, flags = mechanism(given), quantity("--t-end", t_end, "s"), {}
    for name in ("antiwindup", "slack"):
        flags |= {name: given.pop(name)} if name in given else {}
    numbers = numbers_of(given)
    bands = {key: numbers.get(key) for key in ("speed_bandwidth", "tension_bandwidth")}
    made = design(found, **bands)
    run = simulate_control(
        made,
        Torque.step(numbers["speed"]),
        Torque.step(numbers["tension"]),
        d1=Torque.step(numbers["disturbance"], end / 2),
        **{name: numbers[name] for name in ("limit", "period", "delay", "filter_time") if name in numbers},
        **flags,
        friction=laws,
        t_end=end,
        step=end / SAMPLES["control"],
    )
    verdicts = (*made.verdicts, *run.verdicts)
    told = {"design": made.to_dict(), "verdicts": verdicts}
    output = control.shown(
        run, *made.verdicts, told=told, exit_code=int(bool(verdicts)), csv=tabled({"t": run.t} | run.outputs)
    )
    return output._replace(text=[*made.text_lines(), *output.text])


def numbers_of(given: Mapping[str, str]) -> dict[str, float]:
    """What a run under control is asked for, in SI."""
    texts = {key: given.get(key, each.default) for key, each in ASKED.items()}
    return {key: quantity(f"--{key.replace('_', '-')}", text, ASKED[key].unit) for key, text in texts.items() if text}


def mechanism(given: dict[str, Any]) -> "CoupledDrives":
    """The mechanism, whose parameters are taken out of what is given: options over the file over the exercise."""
    from drives import Belt, CoupledDrives, Pulley, Spool

    file = given.pop("parameters", None)
    table = _read_parameters(file) if file else {}
    sides: dict[str, list[dict[str, Any]]] = {"spool": [{}, {}], "belt": [{}, {}], "pulley": [{}]}
    for name, each in PARAMETERS.items():
        where, value = f"--{name.replace('_', '-')}", given.pop(name, None)
        if value is None:
            where, value = f"{file}: {name}", table.get(name, each.default)
        texts = value.split(",") if isinstance(value, str) else value if isinstance(value, list) else [value]
        if len(texts) not in (1, len(sides[each.part])):
            expected = "one value" if each.part == "pulley" else "one value, or two: left, right"
            raise InputError(where, "the wrong number of values", expected, f"{len(texts)}")
        for side, text in zip(sides[each.part], texts * 2, strict=False):
            side[each.name] = where, quantity(where, text, each.unit)
    left, right = (_part(Spool, side) for side in sides["spool"])
    left_belt, right_belt = (_part(Belt, side) for side in sides["belt"])
    return CoupledDrives(left, right, left_belt, right_belt, _part(Pulley, sides["pulley"][0]))


def _part(kind: Callable, side: dict[str, tuple[str, float]]) -> Any:
    """A part, whose mistakes are named by the option or the key they come from."""
    with options_named({key: where for key, (where, _) in side.items()}):
        return kind(**{key: value for key, (_, value) in side.items()})


def _read_parameters(file: str) -> dict[str, Any]:
    table = read_toml(Path(file), "parameters in TOML")
    for name in table:
        if name not in PARAMETERS:
            raise InputError(f"{file}: {name:.60}", "unknown parameter", ", ".join(PARAMETERS))
    return table


def quantity(where: str, given: Any, unit: str) -> float:
    """Value in SI; a text without a unit, or a number, is refused."""
    example = "a quantity such as '45 deg'" if unit == "rad" else f"a quantity such as '1 {unit}'"
    if not isinstance(given, str):
        raise InputError(where, "not a text with a unit", example, repr(given)[:40])
    if BARE.fullmatch(given) or (unit == "rad" and not re.search(r"deg|°|rad", given)):
        raise InputError(where, "the unit is missing", example, repr(given)[:40])
    return to_si(given, unit, where)


def dry_friction(coulomb: str | None, break_away: str | None, stribeck: str | None) -> "list[Model | None]":
    """Laws of the left and the right bearing, None where friction is viscous alone."""
    from friction import Coulomb, Karnopp

    given = {
        "coulomb": (coulomb, "N m", "F_c"),
        "break_away": (break_away, "N m", "F_s"),
        "stribeck": (stribeck, "rad/s", "v_s"),
    }
    sides: list[dict[str, float]] = [{}, {}]
    for name, (text, unit, symbol) in given.items():
        where, parts = f"--{name.replace('_', '-')}", (text or "").split(",")
        if text is not None and (coulomb is None or (name == "stribeck" and break_away is None)):
            raise InputError(where, "needs its partner", "--break-away beside it" if coulomb else "--coulomb beside it")
        if len(parts) > 2:
            raise InputError(where, "the wrong number of values", "one value, or two: left, right", f"{len(parts)}")
        for side, part in zip(sides, parts * 2, strict=False):
            side |= {symbol: quantity(where, part, unit)} if text is not None else {}
    laws: list[Model | None] = []
    with options_named({"model.F_c": "--coulomb", "model.F_s": "--break-away", "model.v_s": "--stribeck"}):
        for side in sides:
            dry = side.get("F_c", 0.0) or side.get("F_s", 0.0)
            laws.append((Karnopp(F_v=0.0, **side) if "F_s" in side else Coulomb(**side)) if dry else None)
    return laws


def torques(t1: str | None, t2: str | None, rise: str | None, table: str | None, hold: bool) -> "tuple[Torque, Torque]":
    """T1 and T2 from the options of `tline drives step`."""
    from drives import Torque

    if table is not None:
        if t1 or t2 or rise:
            raise InputError("--table", "the torques are given twice", "either a table, or --t1, --t2 and --rise")
        found = read_columns(table, table, {"t": "s", "T1": "N m", "T2": "N m"})
        if len(found) < 3:
            raise InputError(table, "a column is missing", "t, T1, T2", ", ".join(found))
        with options_named({"times": table, "torque table": table}):
            first, second = (Torque.table(found["t"], found[name], held=hold) for name in ("T1", "T2"))
        return first, second
    if hold:
        raise InputError("--hold", "nothing to hold", "--table beside it")
    if t1 is None and t2 is None:
        t1 = t2 = "0.1 N m"
    heights = [quantity(where, text or "0 N m", "N m") for where, text in (("--t1", t1), ("--t2", t2))]
    if rise is None:
        return Torque.step(heights[0]), Torque.step(heights[1])
    length = quantity("--rise", rise, "s")
    if not length > 0:
        raise InputError("--rise", "not a time", "more than 0 s", repr(rise))
    return Torque.ramp(heights[0], 0.0, length), Torque.ramp(heights[1], 0.0, length)
