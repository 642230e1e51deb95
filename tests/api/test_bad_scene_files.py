"""Bad files and tables get one clear sentence a mistake."""

import time

import pytest
from scene_mistakes import CABLE, agree, mistakes_of

from tline.errors import InputError
from tline.scene.file import read_scene
from tline.scene.mistakes import MOST_MISTAKES

NOTHING = ["medium: is missing", "t_end: is missing", "lines: is missing", "probes: is missing"]


DEEP = ".".join("a" * 2000)


FILES = {
    "empty": ("", NOTHING),
    "many comments": ("# x\n" * 10**5, NOTHING),
    "a million lines of junk": ("no scene at all\n" * 10**6, ["…scene.toml: is not valid TOML: Expected '='"]),
    "binary": (bytes(range(256)) * 4000, ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "zeros": (bytes(10**6), ["…scene.toml: is not valid TOML: Invalid statement (at line 1, column 1)"]),
    "utf-16": (CABLE.encode("utf-16"), ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "twice": (CABLE + CABLE, ["…scene.toml: is not valid TOML: Cannot declare"]),
    "deep lists": (CABLE + "x = " + "[" * 10**5, ["…scene.toml: is nested too deeply, expected a scene in TOML"]),
    "deep tables": (CABLE.replace("z0 =", f"z0.{DEEP} ="), ["lines.cable.z0: not a number, …got {'a'"]),
    "deep keys": (CABLE + f"[{DEEP}]", ["a: unknown key, expected one of 'title'"]),
    "5000 digits": (CABLE.replace('"40 ns"', "9" * 5000), ["…scene.toml: is not valid TOML: Exceeds the limit"]),
}  # fmt: skip


@pytest.mark.parametrize("what", FILES)
def test_files(what, tmp_path):
    text, begins = FILES[what]
    agree(mistakes_of(text, tmp_path), begins)


@pytest.mark.parametrize(
    ("what", "text"),
    [
        ("keys", "".join(f"x{k} = 1\n" for k in range(3 * 10**4)) + CABLE),
        ("loads", CABLE + "".join(f"[loads.l{k}]\nat = 'no{k}'\nkind = 'open'\n" for k in range(5000))),
        ("lines", CABLE + "".join(f"[lines.l{k}]\nfoo = 1\n" for k in range(5000))),
    ],
)
def test_useless_lines_are_told_of_quickly(what, text, tmp_path):
    """Not with the square of their number: some 0.5 s each, and the bound is for machines that do other things too."""
    started = time.process_time()
    assert len(mistakes_of(text, tmp_path)) == MOST_MISTAKES + 1
    assert time.process_time() - started < 20.0


def test_no_file(tmp_path):
    for path, got in ((tmp_path / "none.toml", "No such file or directory"), (tmp_path, "Is a directory")):
        with pytest.raises(InputError) as caught:
            read_scene(path)
        assert str(caught.value) == f"{path}: cannot be read, got {got}"


POINT = "line {} of '…t.csv' is not a point, expected two finite numbers with a comma between"


TABLES = {
    "0,1\n1,nan\n": POINT.format(2),
    "0,1\n1,1e400\n": POINT.format(2),
    "0,1,2\n1,2,3\n": POINT.format(1),
    "t,u\ns,V\n0,1\n": POINT.format(2),
    "0;1\n1;2\n": POINT.format(1),
    "t,1\n0,1\n1,2\n": POINT.format(1),
    "0,1\n2,1\n1,3\n": "point 3 lies before the one in front of it, expected times in order, got 1 s",
    "0,1\n1,2\n1,3\n1,4\n": "point 4 is the third at one time, expected at most two, for a jump, got 1 s",
    "t,u\n0,1\n": "too few points in '…t.csv', expected at least two lines 'time, level', got 1",
    "": "too few points in '…t.csv', expected at least two lines 'time, level', got 0",
    "0," + "1" * 200_000: "line 1 of '…t.csv' cannot be read: field larger than field limit",
    "0,\xff": "'…t.csv' is not a text file, expected text in UTF-8",
}


@pytest.mark.parametrize("table", TABLES, ids=[problem[:40] for problem in TABLES.values()])
def test_tables(table, tmp_path):
    (tmp_path / "t.csv").write_bytes(table.encode("latin-1"))
    text = CABLE.replace('"1 V"', '{shape = "table", file = "t.csv"}')
    agree(found := mistakes_of(text, tmp_path), ["sources.gen.value.file: " + TABLES[table]])
    assert not any(line in str(sentence) for sentence in found for line in table.splitlines() if line)
