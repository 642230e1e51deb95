"""What a chart is drawn from: one row per run, written as CSV with the figures in full."""

import csv
from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass, field, fields
from itertools import groupby
from math import inf
from pathlib import Path

from tline.solver.result.atomic import replacing


@dataclass(frozen=True)
class Row:
    """One method at one refinement."""

    method: str  # label of the curve
    kind: str  # "ours", "tolerance", "baseline" or "peer"
    setting: str  # what was refined, such as "8 slabs per shortest delay"
    error: float  # largest error of the efforts at any instant, relative to the largest effort
    error_at_own: float  # the same at the instants that the method itself computes
    seconds: float  # median time from the call to its answer, compiled code at hand
    stepping: float  # median time of stepping alone (peers: as `peers` says)
    # asked, estimated: for a run to a tolerance: what was asked, and what the solver thinks it reached; else infinite
    asked: float = inf
    estimated: float = inf


@dataclass
class ChartTable:
    """The rows of one chart."""

    name: str  # name, title: of the scene
    title: str
    rows: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what is absent and why, and what stands beside the clock

    def curves(self) -> Iterator[tuple[str, list[Row]]]:
        """Methods and their rows, in the order in which they were measured."""
        for method, rows in groupby(self.rows, key=lambda row: row.method):
            yield method, list(rows)

    def save(self, path: str | Path) -> None:
        """Write as CSV; the notes are comments before the heading."""
        head = [column.name for column in fields(Row)]
        write_csv(path, head, (astuple(row) for row in self.rows), (self.title, *self.notes))


def write_csv(
    path: str | Path, head: Iterable[str], rows: Iterable[Iterable[object]], notes: Iterable[str] = ()
) -> None:
    """Write numbers in full below a heading; notes are comments above it."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in notes)
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows(rows)
