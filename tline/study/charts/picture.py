"""Work-precision tables as pictures: run time to the right, error downwards, so that better is lower left."""

import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from tline.study.charts.measure import ChartTable, Row
from tline.style import COLOURS, DASHES, FAINT, INK, figure, styled

LOWEST, HIGHEST = 1e-16, 10.0  # errors; diverging and exact results are drawn at the edge
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*")
OURS = ("#9ECAE1", "#6BAED6", "#4292C6", "#08519C", "#08306B")  # one hue, darker with the order


SIDES = (  # quantities drawn of a row: the time, the error, and their names
    ("seconds", "error", "What you wait for, and get", "time from call to answer [s]", "at any instant"),
    ("stepping", "error_at_own", "The arithmetic alone", "time stepping [s]", "at the method's own instants"),
)


@styled
def draw(table: ChartTable) -> Figure:
    """Draw error against run time, one curve for each method; all axes logarithmic.

    To the left the time of the whole call, and the error at any instant; to the right those of the method itself.
    """
    from tline.study.baseline import BASELINES

    picture = figure(12.0, 5.8, table.title)
    sides = picture.subplots(1, 2, sharey=True)
    ranks = {method.label: k for k, method in enumerate(BASELINES.values())}  # the same look in all charts
    for axes, (time, error, title, waited, where) in zip(sides, SIDES, strict=True):
        for method, rows in table.curves():
            kind = rows[0].kind
            x, y = ([getattr(row, name) for row in rows] for name in (time, error))
            if kind == "tolerance":
                _tolerances(axes, rows, x, [_shown(each) for each in y], whole=error == "error")
                continue
            others = [name for name, curve in table.curves() if curve[0].kind == kind]
            look = _look(kind, ranks.get(method, others.index(method)))
            axes.plot(x, [_shown(each) for each in y], label=method, **look)
        axes.set(xscale="log", yscale="log", xlabel=waited, ylabel=f"largest error / largest effort, {where}")
        axes.set_title(title, fontsize=10, loc="left")
        least = min(_shown(getattr(row, name)) for row in table.rows for name in ("error", "error_at_own"))
        axes.set_ylim(max(LOWEST, least / 10), HIGHEST)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(numticks=20))
            axis.set_minor_locator(NullLocator())
            axis.set_major_formatter(_power)
        axes.grid(True, which="major")
    picture.legend(*sides[0].get_legend_handles_labels(), loc="outside right upper", fontsize=8.5)
    notes = [textwrap.fill(note, 160) for note in table.notes if not note.startswith("absent")]
    picture.supxlabel("\n".join(notes), x=0.02, ha="left", fontsize=8.5, color=INK)
    return picture


def _power(value: float, _: float) -> str:
    return "10" + str(round(np.log10(value))).translate(RAISED)


def _shown(error: float) -> float:
    return min(max(error, LOWEST), HIGHEST)


def _look(kind: str, rank: int) -> dict[str, Any]:
    if kind == "ours":
        return {"color": OURS[rank], "linewidth": 2.2, "marker": "o", "markersize": 4}
    colours = COLOURS[1:]
    return {
        "color": colours[rank % len(colours)],
        "linestyle": DASHES[1:][rank % 3] if kind == "baseline" else "-",
        "linewidth": 1.2,
        "marker": MARKS[1:][rank % (len(MARKS) - 1)],
        "markersize": 4.5,
        "markerfacecolor": "white" if kind == "baseline" else None,
    }


def _tolerances(axes: Any, rows: list[Row], x: list[float], y: list[float], whole: bool) -> None:
    """Draw true errors as filled stars; for whole runs also estimated ones as hollow stars and tolerances as dashes."""
    axes.plot(x, y, color=INK, marker="*", markersize=9, label="to a tolerance: true")
    if not whole:
        return
    look = {"color": INK, "linestyle": "none", "markersize": 9}
    axes.plot(x, [_shown(r.estimated) for r in rows], marker="*", markerfacecolor="white", **look, label="… estimated")
    axes.plot(x, [r.asked for r in rows], marker="_", **look, markeredgewidth=1.5, label="… asked")
    for row in rows:
        axes.plot([row.seconds] * 2, [_shown(row.error), row.asked], color=FAINT, linewidth=0.6)
