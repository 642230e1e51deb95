"""Measures the charts of speed against accuracy and draws them: python -m docs.generate_charts [NAME…].

Without arguments all; with names, those scenes or "growth" or "stability" only.
"""

import sys

from benchmarks.harness import DOCS
from tline.study.charts import growth, stability
from tline.study.charts.measure import ChartTable
from tline.study.charts.picture import draw
from tline.study.charts.scenes import NAMES
from tline.study.charts.work_precision import peers, work_precision
from tline.style import save_figure

FOLDER = DOCS / "charts"
BESIDE_PEERS = ("rc", "rlc", "lossy", "y", "chain", "inductor", "hammer", "friction", "network")


def written(table: ChartTable, name: str) -> None:
    """Write table and picture of one chart."""
    table.save(FOLDER / f"{name}.csv")
    save_figure(draw(table), FOLDER / f"{name}.png")


def written_growth() -> None:
    """Write growth.png and growth.csv."""
    curves = growth.error_growth(progress=True)
    growth.save(curves, FOLDER / "growth.csv")
    save_figure(growth.draw(curves), FOLDER / "growth.png")


def written_maps() -> None:
    """Write stability_*.png, stability.csv and stability_boundaries.csv."""
    found = [stability.stability(name, progress=True) for name in stability.MAPS]
    for one in found:
        save_figure(stability.draw(one), FOLDER / f"stability_{one.map.name}.png")
    stability.save(found, FOLDER / "stability.csv")
    stability.save_boundaries(found, FOLDER / "stability_boundaries.csv")


if __name__ == "__main__":
    others = {"growth": written_growth, "stability": written_maps}
    for name in sys.argv[1:] or [*NAMES, *others]:
        if name in others:
            others[name]()
            continue
        written(work_precision(name, progress=True), f"work_precision_{name}")
        if name in BESIDE_PEERS:
            written(peers(name, progress=True), f"peers_{name}")
