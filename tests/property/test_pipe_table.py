"""A network whose pipes are columns of a file is the one whose pipes are tables, to the last bits."""

import csv
import runpy
from pathlib import Path

import numpy as np
import pytest

from tline.errors import InputError, SceneError
from tline.scene.pipe_table import PipeTable
from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.surge.operation import operate

grid = runpy.run_path(str(Path(__file__).parents[2] / "scenes" / "street_grid.py"))["grid"]
FRICTION = [
    {"kind": "darcy", "factor": 0.02, "minor_loss": 2.0},
    {"kind": "hazen-williams", "coefficient": 130.0},
    {"kind": "manning", "coefficient": 0.012, "length": 55.0},
    {"kind": "swamee-jain", "roughness": 1e-4, "viscosity": 1e-3},
    {},
]
SMALL = {"from": ["a", "b"], "to": ["b", "c"], "length [km]": [0.1, "0.2"], "diameter [mm]": [100, 200]}
SMALL |= {"wave_speed": [1000, 1000], "density [kg/L]": [1, 1], "friction.kind": ["darcy", ""]}
SMALL |= {"friction.factor": [0.02, ""]}


def town(side: int, start: str) -> tuple[dict, dict, dict]:
    """A town without its pipes, and these, with friction of all kinds and delays of 6 to 11 slabs, in two ways."""
    scene = grid(side, friction=False) | {"start": start, "t_end": "1.5 s", "solver": {"order": 1, "slab": "10 ms"}}
    pipes = {}
    for k, (name, pipe) in enumerate(scene.pop("lines").items()):
        sizes = {"length": 60.0 + 10 * (k % 4) + 3 * (k % 3), "diameter": 0.1 + 0.05 * (k % 5)}
        law = {"friction": FRICTION[k % 5]} if FRICTION[k % 5] else {}
        pipes[name] = {"nodes": pipe["nodes"], **sizes, "wave_speed": 1000.0, "density": 1000.0} | law
    keys = dict.fromkeys(key for law in FRICTION for key in law)
    columns = {"name": [*pipes], "from": [pipe["nodes"][0] for pipe in pipes.values()]}
    columns["to"] = [pipe["nodes"][1] for pipe in pipes.values()]
    columns |= {key: [pipe[key] for pipe in pipes.values()] for key in ("length", "diameter", "wave_speed", "density")}
    columns |= {f"friction.{key}": [pipe.get("friction", {}).get(key, "") for pipe in pipes.values()] for key in keys}
    return scene, pipes, columns


@pytest.mark.parametrize("start", ["steady", "rest"])
def test_columns_are_pipes(start):
    scene, pipes, columns = town(10, start)
    one, other = (simulate(Scene(**scene, lines=lines)).probes["hydrant"] for lines in (pipes, PipeTable("", columns)))
    t = np.linspace(0.0, 1.5, 200)
    for a, b in ((one.at(t).u, other.at(t).u), (one.at(t).y, other.at(t).y)):
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-12 * np.abs(a).max())
    assert {name: PipeTable("", columns)[name] for name in pipes} == dict(Scene(**scene, lines=pipes).lines)


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_files_are_columns(tmp_path, suffix):
    scene, _, columns = town(4, "rest")
    if suffix == "npz":
        words = {key: columns.pop(key) for key in ("name", "from", "to", "friction.kind")}
        columns = {key: [np.nan if cell == "" else cell for cell in cells] for key, cells in columns.items()} | words
        np.savez(tmp_path / "pipes.npz", **{key: np.array(cells) for key, cells in columns.items()})
    else:
        with (tmp_path / "pipes.csv").open("w", newline="") as file:
            csv.writer(file).writerows([[*columns], *zip(*columns.values(), strict=True)])
    read, given = Scene(str(tmp_path), **scene, lines=f"pipes.{suffix}"), PipeTable("", columns)
    assert dict(read.lines) == dict(given)
    assert read.table()["lines"] == f"pipes.{suffix}"
    assert read.change({"t_end": "1 s"}).lines == read.lines
    assert read.change({"lines.p1.diameter": 0.3}).lines["p1"].diameter == 0.3
    assert "p1" not in read.change({"lines.p1": None}).lines


def test_elevations_need_one_liquid():
    nodes = {"a": {"elevation": "10 m"}}
    scene = {"medium": "hydraulic", "t_end": "1 s", "nodes": nodes, "probes": {"c": {"at": "c"}}}
    assert Scene(**scene, lines=PipeTable("", SMALL)).heights["c"].elevation == 0.0
    with pytest.raises(SceneError, match=r"lines.p2.density"):
        Scene(**scene, lines=PipeTable("", SMALL | {"density [kg/L]": [1, 2]}))


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        ({"length [km]": [0.1, -2]}, r"lines.p2.length: length out of range, expected more than 0, got '-2 km'"),
        ({"length [km]": [0.1, "long"]}, r"lines.p2.length: "),
        ({"length [kg]": [0.1, 2]}, r"lines.length: "),
        ({"wave_speed": np.array([1e3, 1e3j])}, r"lines.wave_speed: not a column, expected .*, got complex128"),
        ({"wave_speed": [1000]}, r"lines.wave_speed: a column too short or too long, expected 2, got 1"),
        ({"name": ["one", "one"]}, r"lines: a name that two pipes have"),
        ({"name": ["one", " "]}, r"lines.name: row 2 has no name"),
        ({"lenght": [1, 2]}, r"lines: an unknown column, expected 'length'"),
        ({"delay": [1, 2]}, r"lines: columns say a quantity in two ways"),
        ({"friction.kind": ["darcy", "zielke"]}, r"lines.p2.friction.kind: unknown in a table"),
        ({"friction.factor": [0.02, ""], "friction.kind": ["darcy", "darcy"]}, r"lines.p2.friction.factor: "),
        ({"friction.kind": ["darcy", "manning"]}, r"lines: a column is missing, expected .*friction.coefficient"),
    ],
)
def test_one_sentence_names_what_is_wrong(columns, sentence):
    anew = {key.split(" ")[0] for key in columns}
    kept = {key: cells for key, cells in SMALL.items() if key.split(" ")[0] not in anew}
    with pytest.raises(InputError, match=sentence):
        PipeTable("", kept | columns)


def test_scenes_tell_what_is_wrong_with_their_file(tmp_path, monkeypatch):
    scene = {"t_end": "1 s", "probes": {"c": {"at": "c"}}}
    (tmp_path / "pipes.csv").write_text("from,to,z0,delay\na,b,1e6\n")
    (tmp_path / "text.npz").write_text("from,to,z0,delay\na,b,1e6,1\n")
    np.savez_compressed(tmp_path / "bomb.npz", z0=np.zeros(10_000))
    monkeypatch.setattr("tline.scene.pipe_table.LARGEST_UNPACKED", 10_000)
    for medium, file, sentence in (
        ("hydraulic", "pipes.csv", "lines: not as many cells as 'pipes.csv' has headings, expected 4, got 3 in row 1"),
        ("hydraulic", "none.csv", "lines: 'none.csv' cannot be read"),
        ("hydraulic", "text.npz", "lines: 'text.npz' is not a file of arrays"),
        ("hydraulic", "bomb.npz", "lines: 'bomb.npz' is too large"),
        ("electrical", "pipes.csv", "lines: a table of pipes is for hydraulic scenes"),
    ):
        with pytest.raises(SceneError, match=sentence):
            Scene(str(tmp_path), **scene, medium=medium, lines=file)
    with pytest.raises(SceneError, match=r"probes.d.at: no line ends at this node"):
        Scene(**scene | {"probes": {"d": {"at": "d"}}}, medium="hydraulic", lines=PipeTable("", SMALL))


def test_pipes_of_a_table_are_operated_one_by_one():
    """Cavities are laid inside one, another is shut, as where all pipes are tables."""
    tap = {"at": "c", "kind": "orifice", "flow": 0.005, "pressure_drop": 3e5}
    scene = {"medium": "hydraulic", "t_end": "1 s", "start": "steady", "probes": {"c": {"at": "c"}}}
    scene |= {"loads": {"lake": {"at": "a", "kind": "reservoir", "pressure": "4 bar"}, "tap": tap}}
    columns = PipeTable("", SMALL)
    found = []
    for lines in (columns, dict(columns)):
        closed = operate(Scene(**scene, lines=lines), close=["tap@0.1s+0.01s", "p1@0.5s"], t_end="1 s", seconds=600)
        assert closed.columns is not None
        found.append(closed.to_dict()["highest"])
    assert found[0] == found[1]
