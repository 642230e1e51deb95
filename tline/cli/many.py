"""`tline many`: a scene in many runs, with numbers drawn from distributions."""

import json
import sys
import warnings
from typing import TYPE_CHECKING, Any

import click

from tline.cli.aligned import aligned
from tline.cli.options import PICTURE, check_files, confined_option, options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.scene.medium import Medium
    from tline.solver.many import Many

QUANTILES = (0.05, 0.5, 0.95)
EXAMPLES = """\b
Examples:
  tline many cable.toml --vary "lines.cable.z0=normal(50 ohm, 2 ohm)" --runs 10000
  tline many cable.toml --vary "lines.cable.z0=normal(50, 2)" \\
      --vary "loads.end.capacitance=uniform(3.5 pF, 4.5 pF)" --seed 7 \\
      --csv runs.csv --plot runs.png
"""


@click.command("many", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--vary", metavar="PLACE=DISTRIBUTION", multiple=True, help="A number that varies; may be repeated.")
@click.option("--runs", metavar="NUMBER", default="10000", show_default=True, help="How many.")
@click.option("--seed", metavar="NUMBER", default="0", show_default=True, help="Another one draws other numbers.")
@click.option("--tol", metavar="NUMBER", help="Largest error, relative to a run's amplitude; the scene's, or 1e-6.")
@click.option("--csv", metavar="FILE.csv", help="Numbers drawn and extremes of every run, SI, full precision.")
@click.option("--npz", metavar="FILE.npz", help="The same as NumPy arrays, with the scene.")
@click.option("--plot", metavar="FILE", help="Histograms of the extremes; .png, .svg or .pdf.")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def many(
    scene: str,
    vary: tuple[str, ...],
    runs: str,
    seed: str,
    tol: str | None,
    confined: bool,
    as_json: bool,
    **files: str | None,
) -> None:
    """Run a scene many times with numbers that vary, and print how the extremes at its probes are spread.

    PLACE is lines.NAME.z0 or lines.NAME.delay, sources.NAME.resistance, or resistance, inductance or capacitance of
    loads.NAME. DISTRIBUTION is uniform(LOW, HIGH) or normal(MEAN, DEVIATION), with units; plain numbers are SI. Numbers
    are drawn independently of each other, and all have to be above zero.

    Lines have no losses here, and their delays a common measure; docs/many-runs.md says what else a scene may hold.
    Where the tolerance is not met, a note says what was reached, and the exit status is 1.
    """
    csv, npz, plot = files["csv"], files["npz"], files["plot"]
    check_files({"--csv": (csv, (".csv",)), "--npz": (npz, (".npz",)), "--plot": (plot, PICTURE)})
    wanted = _wanted(vary)
    from tline.scene.file import read_scene
    from tline.scene.heights import words
    from tline.solver.many import many as run
    from tline.solver.many.draws import draw
    from tline.solver.simulate import UnresolvedWarning

    read = read_scene(scene, confined=confined)
    with (
        options_named({"runs": "--runs", "seed": "--seed", "tol": "--tol"}),
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always", UnresolvedWarning)
        numbers = draw(read, wanted, runs, seed)
        seen = run(read, numbers, tol=tol)
    if csv or npz:
        from tline.solver.many.save import save_csv, save_npz

        for save, file in ((save_csv, csv), (save_npz, npz)):
            if file:
                save(read, numbers, seen, file)
    if plot:
        from tline.pictures.histograms import plot_extremes
        from tline.pictures.style import save_figure

        save_figure(plot_extremes(seen, words(read, "gauge pressure"), read.title), plot)
    for note in said:
        click.echo(f"note: {note.message}", err=True)
    written = [file for file in files.values() if file]
    told = _summary(seen, words(read, "gauge pressure"), len(next(iter(numbers.values()))))
    if as_json:
        click.echo(json.dumps(told | {"files": written}, indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join([*([read.title] if read.title else []), *_table(told, words(read, "gauge pressure"))]))
        for file in written:
            click.echo(f"wrote {file}")
    if any(issubclass(note.category, UnresolvedWarning) for note in said):
        sys.exit(1)


def _wanted(vary: tuple[str, ...]) -> dict[str, str]:
    """Distributions by place."""
    wanted = {}
    for each in vary:
        where, equals, text = each.rpartition("=")
        if not equals:
            raise InputError("--vary", "no distribution", "PLACE=DISTRIBUTION", f"'{each:.60}'")
        if where.strip() in wanted:
            raise InputError("--vary", f"{where.strip()} varies twice", "each place once")
        wanted[where.strip()] = text
    if not wanted:
        raise InputError("--vary", "nothing varies", 'such as --vary "lines.NAME.z0=normal(50 ohm, 2 ohm)"')
    return wanted


def _summary(seen: "Many", medium: "Medium", count: int) -> dict[str, Any]:
    """What was done, and quantiles of the extremes at every probe, in SI."""
    import numpy as np

    probes = {
        name: {
            word: np.quantile(getattr(probe, word) - seen.heights[name].weight, QUANTILES).tolist()
            for word in ("lowest", "highest")
        }
        for name, probe in seen.probes.items()
    }
    how = {"order": seen.order, "slabs": seen.slabs, "estimate": seen.estimate, "seconds": seen.seconds}
    return {"runs": count, **how, "unit": medium.units["effort"], "quantiles": QUANTILES, "probes": probes}


def _table(told: dict[str, Any], medium: "Medium") -> list[str]:
    """The same for the eye, in handy units."""
    from tline.pictures.handy import handy

    head = f"{told['runs']:,} runs of order {told['order']} in {told['seconds']:.2g} s"
    rows = [["probe", medium.effort, *(f"{100 * share:g} %" for share in told["quantiles"])]]
    for name, probe in told["probes"].items():
        largest = max(abs(value) for values in probe.values() for value in values)
        size, unit = handy(largest, medium.shown["effort"])
        error = told["estimate"] * largest
        for k, (word, values) in enumerate(probe.items()):
            rows.append(
                [
                    "" if k else name,
                    f"{word} [{unit}]",
                    *(f"{value / size if abs(value) > error else 0:.4g}" for value in values),
                ]
            )
    return [f"{head}, estimated error {told['estimate']:.1g} of the amplitude", "", *aligned(rows, 2)]
