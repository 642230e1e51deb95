"""Measures the charts of speed against accuracy and draws them: python -m docs.generate_charts [NAME…].

Without arguments all that docs/charts.md shows; with names, those scenes or "growth" or "stability" only.
"""

import sys

from benchmarks.harness import DOCS, table, write
from tline.study.charts import growth, stability
from tline.study.charts.measure import ChartTable
from tline.study.charts.picture import draw
from tline.study.charts.work_precision import peers, work_precision
from tline.style import save_figure

FOLDER = DOCS / "charts"
SHOWN = {"rc": (work_precision, peers), "lossy": (work_precision, peers), "friction": (peers,), "network": (peers,)}
AT_EQUAL_ERROR = "friction", "network"
LEVELS = 1e-3, 1e-4, 1e-5, 1e-6
CURVES = {"ours": "slabs, the best", "tolerance": "to a tolerance"}  # that stand as one in tables


def written(name: str) -> None:
    """Write the charts of a scene as tables and pictures, and its table at equal error."""
    for measure in SHOWN[name]:
        chart = measure(name, progress=True)
        chart.save(FOLDER / f"{measure.__name__}_{name}.csv")
        save_figure(draw(chart), FOLDER / f"{measure.__name__}_{name}.png")
        if name in AT_EQUAL_ERROR:
            write("docs/charts.md", at_equal_error(chart), name)


def at_equal_error(chart: ChartTable) -> str:
    """Table of the least milliseconds of each method for errors no larger than some: whole calls, stepping alone."""
    found: dict[str, list[str]] = {CURVES.get(row.kind, row.method): [] for row in chart.rows}
    for time, error in (("seconds", "error"), ("stepping", "error_at_own")):
        for level in LEVELS:
            for method, cells in found.items():
                own = (row for row in chart.rows if CURVES.get(row.kind, row.method) == method)
                enough = [getattr(row, time) for row in own if getattr(row, error) <= level]
                cells.append(f"{1e3 * min(enough):.2g}" if enough else "")
    head = "|".join(f"{part} {level:.0e}" for part in ("call", "stepping") for level in LEVELS)
    return table(f"<ms for an error of|{head}", ([method, *cells] for method, cells in found.items()))


def written_growth() -> None:
    """Write growth.png and growth.csv."""
    curves = growth.error_growth(progress=True)
    growth.save(curves, FOLDER / "growth.csv")
    save_figure(growth.draw(curves), FOLDER / "growth.png")


def written_maps() -> None:
    """Write stability_*.png and stability_boundaries.csv."""
    found = [stability.stability(name, progress=True) for name in stability.MAPS]
    for one in found:
        save_figure(stability.draw(one), FOLDER / f"stability_{one.map.name}.png")
    stability.save_boundaries(found, FOLDER / "stability_boundaries.csv")


if __name__ == "__main__":
    others = {"growth": written_growth, "stability": written_maps}
    for asked in sys.argv[1:] or [*SHOWN, *others]:
        others[asked]() if asked in others else written(asked)
