"""Files of results: that other programs read the same numbers back, and that a failed write does no harm."""

import csv
import os
import tomllib
from pathlib import Path

import numpy as np
import pytest
from one_line import one_line

from tline import InputError, Result, Scene, simulate
from tline.atomic import check_writable, replacing
from tline.scene.file import scene_from
from tline.solver.result import export
from tline.solver.result.export import save_csv, save_npz

FAR = 'far, "open"\u00e9'  # a name that a careless table would break


@pytest.fixture(scope="module")
def surge() -> Result:
    return simulate(
        Scene(
            title="surge",
            medium="hydraulic",
            t_end="1 s",
            start="steady",
            lines={"pipe": {"nodes": ["tank", "valve"], "length": "300 m", "wave_speed": 1500, "z0": 4.7e7}},
            loads={
                "tank": {"at": "tank", "kind": "reservoir", "pressure": "6 bar"},
                "valve": {"at": "valve", "kind": "valve", "before": 6e7, "after": float("inf"), "time": "0.1 s"},
            },
            probes={"valve": {"at": "valve"}, "middle": {"line": "pipe", "position": "100 m"}},
        )
    )


@pytest.fixture(scope="module")
def pulse() -> Result:
    sine = {"shape": "sine", "amplitude": "1 V", "frequency": "100 MHz"}
    probes = {"near": {"at": "near"}, FAR: {"at": "far"}}
    return simulate(one_line("40 ns", {"z0": "50 ohm", "delay": "5 ns"}, sine, "20 ohm", probes=probes))


def rows(path: Path) -> list[list[str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def test_csv_loads_as_the_very_same_floats(surge: Result, tmp_path: Path) -> None:
    save_csv(surge, tmp_path / "out.csv")
    table = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)
    valve, middle = surge.probes["valve"], surge.probes["middle"]
    columns = [surge.t, valve.u, valve.y, valve.a, valve.b, middle.u, middle.y, middle.a, middle.b]
    np.testing.assert_array_equal(table, np.stack(columns, axis=1))
    assert np.ptp(valve.u) > 8e5  # there is something in it


def test_csv_header_has_names_and_units(surge: Result, pulse: Result, tmp_path: Path) -> None:
    save_csv(surge, tmp_path / "surge.csv")
    assert rows(tmp_path / "surge.csv")[0][:5] == [
        "time [s]",
        "valve pressure [Pa]",
        "valve flow [m^3/s]",
        "valve a [Pa]",
        "valve b [Pa]",
    ]
    save_csv(pulse, tmp_path / "pulse.csv")
    head = rows(tmp_path / "pulse.csv")[0]
    assert head[1:3] == ["near voltage [V]", "near current [A]"]
    assert head[5] == f"{FAR} voltage [V]"


def test_csv_does_not_depend_on_how_many_rows_are_written_at_a_time(
    pulse: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_csv(pulse, tmp_path / "one.csv")
    monkeypatch.setattr(export, "ROWS", 7)
    save_csv(pulse, tmp_path / "many.csv")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "many.csv").read_bytes()
    assert len(rows(tmp_path / "many.csv")) == len(pulse.t) + 1


def test_npz_holds_arrays_and_the_scene(surge: Result, pulse: Result, tmp_path: Path) -> None:
    for result in (surge, pulse):
        save_npz(result, tmp_path / "out.npz")
        with np.load(tmp_path / "out.npz") as data:
            expected = {f"{name}/{letter}" for name in result.probes for letter in "uyab"}
            assert set(data) == expected | {"t", "scene", "version", "order", "slab"}
            np.testing.assert_array_equal(data["t"], result.t)
            for name, probe in result.probes.items():
                np.testing.assert_array_equal(data[f"{name}/u"], probe.u)
                np.testing.assert_array_equal(data[f"{name}/y"], probe.y)
                np.testing.assert_array_equal(data[f"{name}/a"], probe.a)
                np.testing.assert_array_equal(data[f"{name}/b"], probe.b)
            assert scene_from(tomllib.loads(str(data["scene"]))) == result.scene
            assert (int(data["order"]), float(data["slab"])) == (result.resolution.s, result.resolution.h)
            assert str(data["version"]).count(".") >= 2


@pytest.mark.parametrize("write", [save_csv, save_npz])
def test_what_cannot_be_written_is_said_and_leaves_nothing(write, pulse: Result, tmp_path: Path) -> None:
    for path, why in ((tmp_path / "none" / "x", "no such file or directory"), (tmp_path, "a folder")):
        with pytest.raises(InputError, match=f"{path}: cannot be written, got {why}"):
            write(pulse, path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), RuntimeError("x"), KeyboardInterrupt()])
def test_a_failed_write_leaves_the_old_file(error: BaseException, tmp_path: Path) -> None:
    path = tmp_path / "old.txt"
    path.write_text("old")
    with pytest.raises(InputError if isinstance(error, OSError) else type(error)) as raised, replacing(path) as new:  # noqa: PT012
        new.write_text("half of it")
        raise error
    if isinstance(error, OSError):
        assert str(raised.value) == f"{path}: cannot be written, got no space left on device"
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    path, link = tmp_path / "real.txt", tmp_path / "link.txt"
    path.write_text("old")
    link.symlink_to(path)
    with replacing(link) as new:
        assert new.parent == tmp_path
        assert new.suffix == ".txt"
        new.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert link.is_symlink()
    plain = tmp_path / "plain.txt"
    plain.touch()
    assert path.stat().st_mode == plain.stat().st_mode  # not more private than any other file


def test_devices_are_not_replaced(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="/dev/null: cannot be written, got not an ordinary file"):
        check_writable("/dev/null")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="not an ordinary file"):
        check_writable(tmp_path / "pipe")


def test_a_check_leaves_no_trace(tmp_path: Path) -> None:
    check_writable(tmp_path / "new.csv")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="cannot be written, got no such file or directory"):
        check_writable(tmp_path / "none" / "new.csv")
