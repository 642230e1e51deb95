"""Each statement of docs/trust.md: what input may read and run, and how it is shown."""

import json
import os
import re
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import click
import pytest
from command_line import call, tline

from tline.cli.main import COMMANDS, main
from tline.errors import SceneError
from tline.scene.file import read_scene
from tline.words.wording import CONTROL

CABLE = """
medium = "electrical"
t_end = "8 ns"
title = "TITLE"
[lines.cable]
nodes = ["near", "far"]
z0 = 50
delay = "5 ns"
[sources.gen]
at = "near"
kind = "voltage"
resistance = 50
value = {shape = "table", file = "FILE"}
[probes.seen]
at = "far"
"""
HOSTILE = "<script>alert(1)</script></title><!-- $x$ DATA TITLE \\u001b[2J"
READ_SCENES = {
    "run": [], "sweep": ["--vary", "lines.cable.z0=40:60:3"], "frequency": ["--points", "5"], "export": [],
    "tdr": ["--port", "near", "--rise", "1 ns"], "eye": ["--probe", "seen", "--bit", "1 ns", "--rise", "0.1 ns"],
    "passivity": [], "crosstalk": [], "live": ["--no-browser"],
}  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scene in it that names a table outside, which is there."""
    inside = tmp_path / "scenes"
    inside.mkdir()
    monkeypatch.chdir(inside)
    monkeypatch.setattr("tline.live.desk.IDLE", 0.0)
    (tmp_path / "secret.csv").write_text("0,0\n1e-9,1\n")
    (inside / "table.csv").write_text("0,0\n1e-9,1\n")
    (inside / "out.toml").write_text(CABLE.replace("FILE", "../secret.csv"))
    (inside / "in.toml").write_text(CABLE.replace("FILE", "table.csv"))
    return inside


# run code


@pytest.mark.parametrize(
    ("args", "text"),
    [
        (["passivity", "__import__('os').system('touch x')"], ""),
        (["passivity", "s + 1", "--param", "s=__import__('os').system('touch x')"], ""),
        (["import", "net.cir"], "t\n.control\nshell touch x\n.endc\n.include table.csv\nR1 a 0 {system('touch x')}\n"),
        (["run", "net.cir"], "t_end = __import__('os').system('touch x')"),
        (["line", "hydraulic", "--radius", "$(touch x)"], ""),
    ],
)
def test_text_is_parsed_and_never_run(args, text, folder):
    (folder / "net.cir").write_text(text)
    assert call(*args).exit_code == 2
    assert not (folder / "x").exists()


# read files


def test_a_confined_scene_reads_its_folder_and_what_lies_below(folder):
    (folder / "deep").mkdir()
    (folder / "deep" / "table.csv").write_text("0,0\n1e-9,1\n")
    for file in ("table.csv", "deep/table.csv", "deep/../table.csv", str(folder / "table.csv")):
        (folder / "in.toml").write_text(CABLE.replace("FILE", file))
        assert read_scene("in.toml", confined=True).sources


@pytest.mark.parametrize("where", ["..", "link", "root", "deep link"])
def test_a_confined_scene_reads_nothing_else(where, folder):
    (folder / "link.csv").symlink_to("../secret.csv")
    (folder / "deep").symlink_to("..")
    secret = str(folder.parent / "secret.csv")
    file = {"..": "../secret.csv", "link": "link.csv", "root": secret, "deep link": "deep/secret.csv"}[where]
    (folder / "out.toml").write_text(CABLE.replace("FILE", file))
    assert read_scene("out.toml").sources
    with pytest.raises(SceneError, match=r"sources\.gen\.value\.file: '.*' lies outside of the scene's folder"):
        read_scene("out.toml", confined=True)


@pytest.mark.parametrize("table", ["lines", "loads", "links"])
def test_confined_holds_for_every_file_that_a_scene_names(table, folder):
    more = {
        "lines": "[lines.other]\nnodes = ['near', 'x']\nlength = 1\ntabulated = {file = '../secret.csv'}\n",
        "loads": "[loads.m]\nat = 'far'\nkind = 'touchstone'\nfile = '../secret.s1p'\n",
        "links": "[links.m]\nnodes = ['near', 'far']\nkind = 'touchstone'\nfile = '../secret.s2p'\n",
    }
    (folder / "out.toml").write_text(CABLE.replace("FILE", "table.csv") + more[table])
    with pytest.raises(SceneError, match=r"secret.* lies outside of the scene's folder"):
        read_scene("out.toml", confined=True)


@pytest.mark.parametrize("command", READ_SCENES)
def test_the_switch_is_on_every_command_that_reads_scenes(command):
    refused = call(command, "out.toml", *READ_SCENES[command], "--confined")
    assert (refused.exit_code, refused.stderr) == (
        2,
        "sources.gen.value.file: '../secret.csv' lies outside of the scene's folder, expected a file in it\n",
    )
    assert call(command, "out.toml", *READ_SCENES[command]).exit_code in (0, 1, 2)


def test_no_command_that_reads_scenes_is_missing_above():
    found = {name for name in COMMANDS for p in main.get_command(click.Context(main), name).params if p.name == "scene"}
    assert found | {"passivity"} == set(READ_SCENES)


def test_changes_of_a_confined_scene_are_confined(folder):
    scene = read_scene("in.toml", confined=True)
    value = {"shape": "table", "file": "../secret.csv"}
    sources = {"gen": {"at": "near", "kind": "voltage", "resistance": 50, "value": value}}
    with pytest.raises(SceneError, match="outside of the scene's folder"):
        scene.with_changes(sources=sources)


@pytest.mark.parametrize("name", ["secret.csv", "secret.s1p", "secret.s2p"])
def test_no_line_of_a_file_that_a_scene_names_is_quoted(name, folder):
    (folder / name).write_text("root:x:0:0:pass word:/root\n# 12 S RI R 50\n1,x-secret\n")
    more = f"[loads.m]\nat = 'far'\nkind = 'touchstone'\nfile = '{name}'\n"
    more = (
        more if name.endswith("1p") else more.replace("loads", "links").replace("at = 'far'", "nodes = ['near', 'far']")
    )
    text = CABLE.replace("FILE", name) if name.endswith("csv") else CABLE.replace("FILE", "table.csv") + more
    (folder / "in.toml").write_text(text)
    with pytest.raises(SceneError) as caught:
        read_scene("in.toml")
    assert name in str(caught.value)
    assert not re.search("root|word|x-sec|12", str(caught.value))


@pytest.mark.parametrize("args", [("run", "{}"), ("passivity", "{}.csv"), ("fit", "{}.s1p"), ("import", "{}.cir")])
def test_a_pipe_with_a_name_is_refused_and_not_waited_for(args, folder):
    file = args[1].format("pipe")
    os.mkfifo(folder / file)
    assert re.match(f"{re.escape(file)}: cannot be read, got a pipe with a name", call(args[0], file).stderr)


@pytest.mark.parametrize(
    "args",
    [
        "friction run coulomb --table FILE", "drives step --table FILE", "drives bode --parameters FILE", "run FILE",
    ],
)  # fmt: skip
def test_what_could_be_read_for_ever_is_refused_wherever_a_file_is_read(args, folder):
    os.mkfifo(folder / "pipe")
    for file, kind in (("pipe", "a pipe with a name"), ("/dev/zero", "a device, not a file")):
        result = call(*args.replace("FILE", file).split())
        assert result.exit_code == 2
        assert result.stderr.endswith(f"cannot be read, got {kind}\n")


def test_tables_and_parameters_that_break_a_reader_are_refused(folder):
    (folder / "long.csv").write_text('t,T1,T2\n0,1,"' + "1" * 200_000 + '"\n')
    (folder / "deep.toml").write_text("radius = " + "[" * 5000)
    (folder / "digits.toml").write_text("radius = " + "1" * 5000)
    for args in (
        ["step", "--table", "long.csv"],
        ["bode", "--parameters", "deep.toml"],
        ["bode", "--parameters", "digits.toml"],
    ):
        result = call("drives", *args)
        assert (result.exit_code, len(result.stderr.splitlines())) == (2, 1), result.stderr


def test_a_scene_names_no_device(folder):
    (folder / "in.toml").write_text(CABLE.replace("FILE", "/dev/zero"))
    with pytest.raises(SceneError, match="'/dev/zero' cannot be read, got a device, not a file"):
        read_scene("in.toml")
    assert call("run", "/dev/zero").stderr == "/dev/zero: cannot be read, got a device, not a file\n"


def test_a_pipe_of_a_shell_is_read(folder):
    text = (folder / "in.toml").read_text().replace('{shape = "table", file = "table.csv"}', "1")
    done = tline("passivity", "/dev/stdin.toml", input=text, stdout=subprocess.PIPE)
    assert done.returncode == 2  # no such file
    done = tline("export", "/dev/stdin", "--rise", "1 ps", input=text, stdout=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, "")


# show text


def test_nothing_printed_steers_a_terminal(folder):
    text = CABLE.replace("FILE", "table.csv").replace("TITLE", "\\u001b]0;x\\u0007 \\u009b2J\\r\\nnext \\u202e")
    (folder / "in.toml").write_text(text)
    shown = call("run", "in.toml")
    assert shown.stdout.startswith("]0;x 2J next\norder")
    told = json.loads(call("run", "in.toml", "--json").stdout)
    assert told["title"] == "]0;x 2J next"
    for args in (["run", "\x1b[2J\x9b.toml"], ["run", "in.toml", "--\x1b[2Jx"], ["\x1b[2J"], ["passivity", "\x1b[2J"]):
        refused = call(*args)
        assert refused.exit_code == 2
        assert not CONTROL.search(refused.output)


def test_colours_in_a_name_are_shown_in_a_pipe_too(folder):
    (folder / "in.toml").write_text(CABLE.replace("FILE", "table.csv"))
    assert call("run", "a\x1b[31mb.toml").stderr.startswith("a\\u001b[31mb.toml: cannot be read")
    assert "wrote a\\u001b[31mb.csv\n" in call("run", "in.toml", "--csv", "a\x1b[31mb.csv").output


def test_control_characters_in_json_mean_what_they_meant(folder):
    (folder / "in.toml").write_text(CABLE.replace("FILE", "table.csv"))
    name = "o\x9bt.csv"
    result = call("run", "in.toml", "--csv", name, "--json")
    assert not CONTROL.search(result.stdout)
    assert json.loads(result.stdout)["files"] == [name]


class Page(HTMLParser):
    """The elements of a web page, with the text in each title."""

    def __init__(self, text: str):
        super().__init__()
        self.tags, self.title = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)

    def handle_data(self, data):
        self.title += data if self.tags[-1:] == ["title"] else ""


def test_titles_and_names_are_text_in_web_pages_and_pictures(folder):
    text = CABLE.replace("FILE", "table.csv").replace("TITLE", HOSTILE)
    for file in ("plain", "hostile"):
        given = text if file == "hostile" else CABLE.replace("FILE", "table.csv")
        (folder / f"{file}.toml").write_text(
            given.replace('"far"', '"<b>$x^$</b>\'</script>"' if file == "hostile" else '"b"')
        )
        result = call(
            "run", f"{file}.toml", "--animate", f"{file}.html", "--plot", f"{file}.svg", "--profile", f"{file}2.svg"
        )
        assert result.exit_code == 0, result.output
    plain, hostile = (Page((folder / f"{file}.html").read_text()) for file in ("plain", "hostile"))
    assert hostile.tags == plain.tags
    assert "<script>alert(1)</script></title><!-- $x$ DATA TITLE [2J" in hostile.title
    from xml.etree import ElementTree

    for picture in ("hostile.svg", "hostile2.svg"):
        tags = {element.tag.rpartition("}")[2] for element in ElementTree.parse(folder / picture).iter()}
        assert "script" not in tags


def test_the_page_is_found():
    assert "docs/trust.md" in (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
