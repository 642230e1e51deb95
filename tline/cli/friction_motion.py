"""Commands `tline friction motion` and `identify`: friction under a prescribed motion, and parameters from records."""

import re
from typing import TYPE_CHECKING, Annotated, Any

import click

from tline.cli.columns import read_columns
from tline.cli.friction import RECORDED, beside, columns_of, friction, models_of, numbers_told
from tline.cli.from_signature import Output, command, drawn, picture, table, tabled
from tline.cli.options import check_partners, options_named
from tline.errors import InputError
from tline.units import engineering, to_si
from tline.words.progress import Progress

if TYPE_CHECKING:
    from friction import Prescribed

EXAMPLES = """\b
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
    epilog=EXAMPLES,
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

    from friction import MODELS
    from friction import identify as fitted

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
