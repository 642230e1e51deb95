"""Command `tline chart`: speed against accuracy, error growth, and instability of methods, measured at call."""

import math
import sys
from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from tline.cli.from_signature import Command, Output, command, drawn, picture, table
from tline.words.wording import aligned

if TYPE_CHECKING:
    from tline.study.charts.measure import ChartTable

FILES = {"csv": table("All numbers as a table"), "plot": picture("The chart")}
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
    """Charts from measurements at call: error against run time, error growth, stability maps.

    The production method is compared with baseline methods: characteristics with and without interpolation, upwind,
    Lax-Wendroff, leapfrog FDTD, lumped sections, Padé sections, slabs without projection.
    """


def _chart(source: str) -> Callable[[Callable[..., Output | None]], Command]:
    """Make a chart a command, with its options for the effort."""
    return command(f"tline.study.charts.{source}", files=FILES, omit=("name",), group=chart, epilog=EXAMPLES)


@_chart("work_precision:work_precision")
def work_precision(scene: str = "rc", **given: Any) -> Output:
    """Error against run time of the production method, of runs to a tolerance, and of all baseline methods.

    SCENE is one of the scenes made for charts, rc if not given; a wrong name lists them. Errors are against exact
    solutions independent of all methods, at any instant and at those that a method computes. Times are of
    the whole call, and of stepping alone.
    """
    from tline.study.charts.work_precision import work_precision as measure

    return _table(measure(scene, **given, progress=sys.stderr.isatty()))


@_chart("work_precision:peers")
def peers(scene: str = "rc", **given: Any) -> Output:
    """Error against run time of other programs on the same scene, each measured now if it is installed.

    ngspice is looked for on the PATH; scikit-rf and rthym-moc among the installed packages; TSNet where the variable
    TSNET_PYTHON names an interpreter that has it. Absent programs are named.
    """
    from tline.study.charts.work_precision import peers as measure

    return _table(measure(scene, **given, progress=sys.stderr.isatty()))


@_chart("growth:error_growth")
def growth(**given: Any) -> Output:
    """Change of a pulse in ten thousand passes along a lightly damped line: damping, phase and dispersion.

    Damping is the amplitude lost (negative: gained), phase the delay in transits, dispersion the change of shape beyond
    any shift and scale. --quick makes 40 passes.
    """
    from tline.study.charts.growth import KINDS, error_growth, save

    curves = error_growth(**given, progress=sys.stderr.isatty())
    last = [
        (label, f"{c.transits[-1]:.0f}", *(f"{getattr(c, kind)[-1]:.1e}" for kind in KINDS))
        for label, c in curves.items()
    ]
    return Output(
        aligned([("method", "transits", *KINDS), *last], 1),
        lambda: {label: {k: _plain(v) for k, v in asdict(curve).items()} for label, curve in curves.items()},
        {"csv": lambda file: save(curves, file), "plot": drawn("tline.study.charts.growth:draw", curves)},
    )


@_chart("stability:stability")
def stability(map: str = "courant", **given: Any) -> Output:
    """Growth rates measured from runs, and the boundaries that theory predicts.

    \b
    MAP is one of
      courant          grid methods beyond Courant 1
      load_rate        integrators of a load, by step times rate
        fraction         interpolation and extrapolation of arriving waves
        order_pointwise  slabs of order 1 to 8, the delayed wave interpolated
        order_projected  slabs of order 1 to 8, the delayed wave projected: the production method
      loop_gain        an active load, whose growth is real and must be reproduced
    """
    from tline.study.charts import stability as maps

    found = maps.stability(map, **given, progress=sys.stderr.isatty())
    rows = found.differences()

    def data() -> dict[str, Any]:
        strips = {s.label: {k: _plain(v) for k, v in asdict(s).items() if k != "label"} for s in found.strips}
        heads = ("method", "predicted", "measured", "difference")
        boundaries = [dict(zip(heads, _plain(row), strict=True)) for row in rows]
        return {"map": map, "boundaries": boundaries, "strips": strips}

    cells = [(label, _number(by_theory), _number(of_runs), _share(off)) for label, by_theory, of_runs, off in rows]
    return Output(
        aligned([("method", "boundary by theory", "of the runs", "off by (of the axis)"), *cells], 1),
        data,
        {
            "csv": lambda file: maps.save([found], file),
            "plot": drawn("tline.study.charts.stability:draw", found),
        },
    )


def _table(found: "ChartTable") -> Output:
    rows = [
        (r.method, r.setting, f"{r.error:.1e}", f"{r.error_at_own:.1e}", f"{r.seconds:.1e}", f"{r.stepping:.1e}")
        for r in found.rows
    ]
    head = ("method", "setting", "error", "at own instants", "time [s]", "of that stepping")
    told = {"scene": found.name, "title": found.title, "notes": found.notes}
    return Output(
        aligned([head, *rows], 1),
        lambda: told | {"rows": [{k: _plain(v) for k, v in asdict(row).items()} for row in found.rows]},
        {"csv": found.save, "plot": drawn("tline.study.charts.picture:draw", found)},
        found.notes,
    )


def _plain(value: Any) -> Any:
    """Convert to values for JSON: infinities as text, nan as null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else ("inf" if value > 0 else "-inf")
    return value


def _number(value: float) -> str:
    return "none" if math.isnan(value) else f"{value:.4f}"


def _share(value: float) -> str:
    return f"{value:.2%}" if math.isfinite(value) else "disagree"
