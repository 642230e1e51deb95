"""`tline chart`: speed against accuracy, error growth, and where methods blow up; measured while you wait."""

import json
import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from tline.errors import InputError
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from tline.study.charts.table import ChartTable

PICTURE = (".png", ".svg", ".pdf")
EXAMPLES = """\b
Examples:
  tline chart work-precision rc --quick
  tline chart peers rc --quick --csv peers.csv
  tline chart peers friction --quick
  tline chart growth --quick --plot growth.png
  tline chart stability courant --quick --plot courant.png
Without --quick a chart takes minutes; docs/charts.md shows and explains them all.
"""


@click.group("chart", epilog=EXAMPLES)
def chart() -> None:
    """Charts that are measured, never typed: error against run time, error growth, stability maps.

    Baseline methods stand beside the production method: characteristics with and without interpolation, upwind,
    Lax-Wendroff, leapfrog FDTD, lumped sections, Padé sections, slabs without projection.
    """


def _options(command: Callable[..., None]) -> Callable[..., None]:
    for option in (
        click.option("--json", "as_json", is_flag=True, help="Print all numbers in full precision."),
        click.option("--quick", is_flag=True, help="A look of seconds, not a measurement: coarse, short, run once."),
        click.option("--csv", metavar="FILE.csv", help="All numbers as a table."),
        click.option("--plot", metavar="FILE", help="The chart; .png, .svg or .pdf."),
    ):
        command = option(command)
    return command


@chart.command("work-precision", epilog=EXAMPLES)
@click.argument("scene", default="rc")
@_options
def work_precision(scene: str, plot: str | None, csv: str | None, quick: bool, as_json: bool) -> None:
    """Error against run time of the production method, of runs to a tolerance, and of all baseline methods.

    SCENE is one of the scenes made for charts, rc if not given; a wrong name lists them. Errors are against exact
    solutions that owe nothing to any of the methods, at any instant and at those that a method computes. Times are of
    the whole call, and of stepping alone.
    """
    from tline.study.charts.work_precision import work_precision as measure

    _check_files(plot, csv)
    _tell_table(measure(scene, quick=quick, progress=sys.stderr.isatty()), plot, csv, as_json)


@chart.command("peers", epilog=EXAMPLES)
@click.argument("scene", default="rc")
@_options
def peers(scene: str, plot: str | None, csv: str | None, quick: bool, as_json: bool) -> None:
    """Error against run time of other programs on the same scene, each measured now if it is installed.

    ngspice is looked for on the PATH; scikit-rf and rthym-moc among the installed packages; TSNet where the variable
    TSNET_PYTHON names an interpreter that has it. What is absent is named.
    """
    from tline.study.charts.peers import peers as measure

    _check_files(plot, csv)
    _tell_table(measure(scene, quick=quick, progress=sys.stderr.isatty()), plot, csv, as_json)


@chart.command("growth", epilog=EXAMPLES)
@_options
def growth(plot: str | None, csv: str | None, quick: bool, as_json: bool) -> None:
    """What ten thousand passes along a lightly damped line leave of a pulse: damping, phase and dispersion.

    Damping is the amplitude lost (negative: won), phase the delay in transits, dispersion the change of shape that no
    shift and scale explains. --quick makes 40 passes.
    """
    from tline.study.charts.growth import KINDS, draw, error_growth, save

    _check_files(plot, csv)
    curves = error_growth(quick=quick, progress=sys.stderr.isatty())
    if csv:
        save(curves, csv)
    if plot:
        _save(draw(curves), plot)
    if as_json:
        _print_json({label: {k: _plain(v) for k, v in asdict(curve).items()} for label, curve in curves.items()})
        return
    last = [
        (label, f"{c.transits[-1]:.0f}", *(f"{getattr(c, kind)[-1]:.1e}" for kind in KINDS))
        for label, c in curves.items()
    ]
    _print_table([("method", "transits", *KINDS), *last], (plot, csv))


@chart.command("stability", epilog=EXAMPLES)
@click.argument("name", metavar="MAP", default="courant")
@_options
def stability(name: str, plot: str | None, csv: str | None, quick: bool, as_json: bool) -> None:
    """Growth rates measured from runs, and the boundaries that theory predicts.

    \b
    MAP is one of
      courant          grid methods beyond Courant 1
      load_rate        integrators of a load, by step times rate
      fraction         interpolation and extrapolation of what arrives
      order_pointwise  slabs of order 1 to 8, the delayed wave read off
      order_projected  the same, the delayed wave projected: the production method
      loop_gain        an active load, whose growth is real and must be reproduced
    """
    from tline.study.charts import stability as maps

    _check_files(plot, csv)
    found = maps.stability(name, quick=quick, progress=sys.stderr.isatty())
    if csv:
        maps.save([found], csv)
    if plot:
        _save(maps.draw(found), plot)
    rows = found.differences()
    if as_json:
        strips = {s.label: {k: _plain(v) for k, v in asdict(s).items() if k != "label"} for s in found.strips}
        heads = ("method", "predicted", "measured", "difference")
        boundaries = [dict(zip(heads, map(_plain, row), strict=True)) for row in rows]
        _print_json({"map": name, "boundaries": boundaries, "strips": strips})
        return
    cells = [(label, _number(by_theory), _number(of_runs), _share(off)) for label, by_theory, of_runs, off in rows]
    _print_table([("method", "boundary by theory", "of the runs", "off by (of the axis)"), *cells], (plot, csv))


def _check_files(plot: str | None, csv: str | None) -> None:
    from tline.solver.result.atomic import check_writable

    for option, file, suffixes in (("--plot", plot, PICTURE), ("--csv", csv, (".csv",))):
        if file is not None:
            if not file.lower().endswith(suffixes):
                raise InputError(option, "unknown kind of file", " or ".join(suffixes), f"'{file}'")
            check_writable(file)


def _tell_table(table: "ChartTable", plot: str | None, csv: str | None, as_json: bool) -> None:
    if csv:
        table.save(csv)
    if plot:
        from tline.study.charts.picture import draw

        _save(draw(table), plot)
    if as_json:
        rows = [{k: _plain(v) for k, v in asdict(row).items()} for row in table.rows]
        _print_json({"scene": table.name, "title": table.title, "notes": table.notes, "rows": rows})
        return
    for note in table.notes:
        click.echo(f"note: {note}", err=True)
    rows = [
        (r.method, r.setting, f"{r.error:.1e}", f"{r.error_at_own:.1e}", f"{r.seconds:.1e}", f"{r.stepping:.1e}")
        for r in table.rows
    ]
    head = ("method", "setting", "error", "at own instants", "time [s]", "of that stepping")
    _print_table([head, *rows], (plot, csv))


def _save(picture: Any, path: str) -> None:
    from tline.pictures.style import save_figure

    save_figure(picture, path)


def _plain(value: Any) -> Any:
    """As JSON can say it: infinities as text, no number as null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else ("inf" if value > 0 else "-inf")
    return value


def _print_json(told: dict[str, Any]) -> None:
    click.echo(json.dumps(told, indent=2, ensure_ascii=False))


def _number(value: float) -> str:
    return "none" if math.isnan(value) else f"{value:.4f}"


def _share(value: float) -> str:
    return f"{value:.2%}" if math.isfinite(value) else "disagree"


def _print_table(rows: list[tuple[str, ...]], files: Iterable[str | None]) -> None:
    click.echo("\n".join(aligned(rows, 1)))
    for file in filter(None, files):
        click.echo(f"wrote {file}")
