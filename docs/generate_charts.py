"""Measures the charts of speed against accuracy and draws them: python -m docs.generate_charts [NAME…].

Without arguments all; with names, those scenes or "growth" or "stability" only.
"""

import sys

from benchmarks.harness import DOCS
from tline.pictures.style import save_figure
from tline.study.charts import growth, stability
from tline.study.charts.peers import peers
from tline.study.charts.picture import draw
from tline.study.charts.scenes import NAMES
from tline.study.charts.table import ChartTable
from tline.study.charts.work_precision import work_precision

FOLDER = DOCS / "charts"
BESIDE_PEERS = ("rc", "rlc", "lossy", "y", "chain", "inductor", "hammer", "friction", "network")


def written(table: ChartTable, name: str) -> None:
    """Table and picture of one chart."""
    table.save(FOLDER / f"{name}.csv")
    save_figure(draw(table), FOLDER / f"{name}.png")


if __name__ == "__main__":
    wanted = sys.argv[1:] or [*NAMES, "growth", "stability"]
    FOLDER.mkdir(exist_ok=True)
    for name in wanted:
        if name in ("growth", "stability"):
            {"growth": growth, "stability": stability}[name].generate(FOLDER)
            continue
        written(work_precision(name, progress=True), f"work_precision_{name}")
        if name in BESIDE_PEERS:
            written(peers(name, progress=True), f"peers_{name}")
