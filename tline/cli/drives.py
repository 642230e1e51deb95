"""Command `tline drives`: the coupled drives, from the equations to Bode plot and controller."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, NamedTuple

import click

from tline.cli.drives_parts import LOOSE, MECHANISM, loosely, mechanism, quantity, torques
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.errors import InputError
from tline.words.wording import aligned

EXAMPLES = """\b
Examples:
  tline drives bode --plot bode.png
  tline drives step --t1 "0.1 N m" --t2 "0.1 N m" --plot step.png
  tline drives control --speed "1 m/s" --tension "5 N" --limit "2 N m"
"""
CONTROL, DESIGN = "drives.loop:simulate_control", "drives.control:design"
# arguments that commands give themselves
PASSED_ON = "design", "drives", "belt_speed", "d1", "d2", "step", "initial", "friction", "winding"
FILES = {"csv": table("A table, SI, full precision"), "plot": picture("A picture")}
SAMPLES = {"step": 200, "control": 400}  # of a run


class Asked(NamedTuple):
    """Option of a run under control: its unit, the value if none is given, and its help."""

    unit: str
    default: str | None = None
    help: str = ""


ASKED = {
    "speed": Asked("m/s", "1 m/s", "Set point of the belt speed."),
    "tension": Asked("N", "5 N", "Set point of the tension."),
    "disturbance": Asked("N m", "0 N m", "Torque on spool 1 from half of the run on."),
    "speed_bandwidth": Asked("rad/s"),  # described by the design and the run
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
        Number of frequencies.
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
    omit=("drives", "T1", "T2", "initial", "friction", "winding"),
    more=(*LOOSE, *MECHANISM),
    files=FILES,
    group=drives,
    epilog="""\b
Examples:
  tline drives step
  tline drives step --t1 "0.1 N m" --t2 "0.3 N m" --rise "0.2 s" --plot step.png
  tline drives step --table torques.csv --t-end "5 s" --step "1 ms" --csv run.csv
  tline drives step --t2 "-0.1 N m" --slack --json
  tline drives step --t2 "1 N m" --thickness "1 mm" --line-density "0.01 kg/m"
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
    t_end: str = "2 s",
    step: str | None = None,
    **given: Any,
) -> Output:
    """Response of the mechanism at rest to torques: exact at the samples, with the balance of energy.

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
        Let the belt go slack, as it cannot push.
    step : TIME
        Time between samples, a 200th of the run if not given; it causes no error.
    """
    from drives import simulate

    rubs = loosely(given)
    applied, last = torques(t1, t2, rise, table, hold), quantity("--t-end", t_end, "s")
    h = quantity("--step", step, "s") if step else last / SAMPLES["step"]
    run = simulate(mechanism(given), *applied, t_end=last, step=h, slack=slack, **rubs)
    return step_.shown(run, exit_code=int(bool(run.verdicts)))


@command(
    CONTROL,
    DESIGN,
    omit=PASSED_ON,
    more=(*SET_POINTS, *LOOSE, *MECHANISM),
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
def control(*, t_end: str = "2 s", sensitivities: bool = False, **given: Any) -> Output:
    """Design PI controllers for belt speed and tension behind a decoupler, and run them.

    Unequal spools are made equal by an inner feedback. Set points step at t = 0. At the limit the tension has
    priority. A bandwidth without good margins, or set points beyond the limit, are reported with feasible ones; exit 1.

    Parameters
    ----------
    sensitivities
        Print the effect of 1 % more of each parameter on poles and overshoots of the linear, continuous loop.
    """
    from drives import Torque, design, sensitivities as sensitivities_of, simulate_control

    rubs, flags = loosely(given), {}
    found, end = mechanism(given), quantity("--t-end", t_end, "s")
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
        **rubs,
        t_end=end,
        step=end / SAMPLES["control"],
    )
    verdicts = (*made.verdicts, *run.verdicts)
    told: dict[str, Any] = {"design": made.to_dict(), "verdicts": verdicts}
    lines = [*made.verdicts]
    if sensitivities:
        more = sensitivities_of(made, numbers.get("filter_time", 0.0))
        told["sensitivities"], lines = more.to_dict(), [*more.text_lines(), *lines]
    output = control.shown(run, *lines, told=told, exit_code=int(bool(verdicts)))
    return output._replace(text=[*made.text_lines(), *output.text])


def numbers_of(given: Mapping[str, str]) -> dict[str, float]:
    """Numbers given for a run under control, in SI."""
    texts = {key: given.get(key, each.default) for key, each in ASKED.items()}
    return {key: quantity(f"--{key.replace('_', '-')}", text, ASKED[key].unit) for key, text in texts.items() if text}
