"""The surface of `tline chart`: numbers, files, mistakes."""

import csv
import json
import re
from pathlib import Path

import command_line
import pytest
from command_line import assert_refused

pytestmark = pytest.mark.usefixtures("folder")


def run(line):
    return command_line.run(f"chart {line}")


def test_stability_finds_courant_1(folder: Path) -> None:
    done = run("stability --quick --json --csv map.csv --plot map.png")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    found = {row["method"]: row for row in told["boundaries"]}
    for method in ("upwind", "Lax-Wendroff", "FDTD leapfrog"):
        assert found[method]["measured"] == pytest.approx(1.0, abs=1e-3)
    assert found["slabs, s = 5"]["measured"] is None
    assert found["slabs, s = 5"]["difference"] == 0.0
    with (folder / "map.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["growth_per_transit"]) for row in rows[:11]] == told["strips"]["upwind"]["rates"]
    assert (folder / "map.png").stat().st_size > 10_000


def test_growth_of_error(folder: Path) -> None:
    done = run("growth --quick --csv growth.csv --plot growth.png")
    assert done.exit_code == 0, done.output
    error = {row[: row.index("  ")]: float(row.split()[-4]) for row in done.stdout.splitlines()[1:-2]}
    assert error["slabs, s = 8"] < 1e-5 < 1e-2 < error["MOC, linear interpolation"] < error["upwind"]
    assert (folder / "growth.csv").read_text(encoding="utf-8").startswith("method,transits,error,damping,phase")
    assert (folder / "growth.png").stat().st_size > 10_000


@pytest.mark.parametrize("command", ["work-precision", "peers"])
def test_tables_of_error_against_time(command: str, folder: Path) -> None:
    done = run(f"{command} rc --quick --json --csv table.csv --plot table.png")
    assert done.exit_code == 0, done.output
    rows = json.loads(done.stdout)["rows"]
    assert min(row["error"] for row in rows if row["kind"] == "ours") < 1e-4
    assert all(row["seconds"] > 0 for row in rows)
    assert "table.csv" not in done.stdout
    assert (folder / "table.csv").stat().st_size > 200
    assert (folder / "table.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("stability curant", "map: unknown, expected "),
        ("work-precision rx", "scene: "),
        ("peers rx", "scene: "),
        ("growth --plot a.txt", "--plot: unknown kind of file, expected .png or .svg or .pdf, got 'a.txt'"),
        ("stability --csv a.png", "--csv: unknown kind of file, expected .csv, got 'a.png'"),
        ("growth --csv none/a.csv", "none/a.csv: "),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    assert_refused(f"chart {line}", sentence)


def test_the_help_names_every_map() -> None:
    from tline.study.charts.maps import MAPS

    assert re.findall(r"^ +([a-z_]+)   ?", run("stability --help").stdout, re.MULTILINE)[: len(MAPS)] == list(MAPS)
