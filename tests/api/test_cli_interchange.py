"""The surface of `tline import` and `tline export`: files, texts, mistakes."""

from pathlib import Path

import pytest
from command_line import assert_refused, run

from tline.scene.file import read_scene

NET = "a cable\nV1 s 0 PULSE(0 1 0.5n 1n 1n 5n)\nR1 s a 25\nT1 a 0 b 0 Z0=50 TD=1n\nR2 b 0 100\n.tran 1p 9n uic\n.end\n"


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    (folder / "cable.cir").write_text(NET, encoding="utf-8")
    return folder


def test_there_and_back(folder: Path) -> None:
    assert run("import cable.cir -o cable.toml").stdout == "wrote cable.toml\n"
    printed = run("import cable.cir").stdout
    assert printed == (folder / "cable.toml").read_text(encoding="utf-8")
    assert run("export cable.toml -o again.cir").stdout == "wrote again.cir\n"
    assert run("export cable.toml").stdout == (folder / "again.cir").read_text(encoding="utf-8")
    assert run("import again.cir -o again.toml").exit_code == 0
    first, second = read_scene("cable.toml"), read_scene("again.toml")
    assert list(second.lines.values()) == list(first.lines.values())
    assert [p.at for p in second.probes.values()] == [p.at for p in first.probes.values()]
    assert run("run again.toml").exit_code == 0


def test_jumps_take_the_time_that_is_given(folder: Path) -> None:
    run("import cable.cir -o cable.toml")
    text = (folder / "cable.toml").read_text(encoding="utf-8").replace("rise = 1e-09", "rise = 0")
    (folder / "cable.toml").write_text(text, encoding="utf-8")
    done = run("export cable.toml")
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith("sources.V1.value: jumps at ")
    assert "PWL(0.0 0.0 5e-10 0.0 5.01e-10 1.0 " in run("export cable.toml --rise '1 ps'").stdout


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("import none.cir", "none.cir: cannot be read"),
        ("import cable.txt", "cable.txt: unknown kind of file, expected .cir"),
        ("import bad.cir", "bad.cir, line 3, J1: a transistor, and there are none here"),
        ("export none.toml", "none.toml: cannot be read"),
        ("export cable.toml -o cable.net", "--output: unknown kind of file, expected .cir, got 'cable.net'"),
        ("export cable.toml --rise 3V", "--rise: this unit measures something else"),
        ("export cable.toml --rise 0", "--rise: not above zero"),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str, folder: Path) -> None:
    (folder / "bad.cir").write_text(NET.replace("R1 s a 25", "J1 a b c fet"), encoding="utf-8")
    assert_refused(line, sentence)


@pytest.mark.parametrize("line", ["run {} --csv {}.csv", "frequency {} --csv {}.csv", "export {} -o {}.cir"])
def test_commands_that_take_scenes_take_netlists(line: str) -> None:
    run("import cable.cir -o cable.toml")
    files = "cable.cir", "cable.toml"
    for file in files:
        assert run(line.replace("{}", file)).exit_code == 0
    own, imported = (Path(file + line.rpartition("}")[2]).read_text(encoding="utf-8") for file in files)
    assert own == imported


def test_what_is_left_out_of_a_netlist_is_noted_in_a_line(folder: Path) -> None:
    (folder / "noted.cir").write_text(NET.replace(".end", ".options post\n.end"), encoding="utf-8")
    assert run("run noted.cir").stderr == "note: noted.cir, line 7, .options: skipped\n"
