"""What an .inp file may try: it is read, or refused in one sentence; nothing else is read and nothing written."""

import os
from pathlib import Path

import pytest
from command_line import run
from networks import RING, ring

from tline.errors import InputError
from tline.interchange import confined, epanet_run
from tline.interchange.confined import parse
from tline.interchange.epanet import read_epanet

pytest.importorskip("wntr")
TEXT = RING.format(units="LPS", law="H-W", rough=120, exponent=0.5)
KEEPSAKE = "keep this\n"


pytestmark = pytest.mark.usefixtures("folder")


@pytest.mark.parametrize(
    "lines",
    [
        "[OPTIONS]\nHYDRAULICS SAVE {path}",
        "[OPTIONS]\nhydraul SAVE {path}",
        "[opt]\nHYDRAULICS SAVE {path}",
        ",[OPTIONS]\nHYDRAULICS SAVE {path}",
        '"[OPTIONS]"\nHYDRAULICS SAVE {path}',
        "[OPTIONS]\n, ,HYDRAULICS,SAVE,{path}",
        "[OPTIONS]\nHYDRAULICS USE {path}",
        "[OPTIONS]\nMAP {path}",
        "[OPTIONS]\nQUALITY CHEMICAL {path}",
        "[REPORT]\nFILE {path}\nSTATUS FULL\nNODES ALL",
        "[BACKDROP]\nFILE {path}",
        "[TITLE]\n" + "x" * 1023 + "[OPTIONS]\nHYDRAULICS SAVE {path}",
        "[TAGS]\nNODE a " + "x" * 1011 + "[OPTIONS]\n[TAGS]\nHYDRAULICS SAVE {path}",
        "[TITLE]\rhello\r[OPTIONS]\rHYDRAULICS SAVE {path}",
        "[JUNCTIONS]\n\x0c[OPTIONS] 1 2\n[OPTIONS]\nHYDRAULICS SAVE {path}",
    ],
)
def test_no_file_is_written_or_read(folder: Path, lines: str) -> None:
    kept = folder / "kept.txt"
    kept.write_text(KEEPSAKE)
    before = kept.stat()
    (folder / "town.inp").write_bytes(TEXT.replace("[END]", lines.format(path=kept) + "\n[END]").encode())
    os.utime(kept, ns=(1, 1))
    done = run("import town.inp --wave-speed 1000 -o town.toml")
    assert done.exit_code in (0, 2)
    assert (kept.read_text(), kept.stat().st_ino) == (KEEPSAKE, before.st_ino)
    assert {path.name for path in folder.iterdir()} <= {"kept.txt", "town.inp", "town.toml"}
    if done.exit_code:
        assert done.stderr.count("\n") == 1
        assert not (folder / "town.toml").exists()


def test_what_epanet_is_given_names_no_file() -> None:
    hostile = "[OPTIONS]\nHYDRAULICS SAVE a\nHYDR USE b\nMAP c\n[REPORT]\nFILE d\n[BACKDROP]\nFILE e\n[TIMES]\n"
    given = parse(TEXT.replace("[END]", hostile), "x.inp").network
    assert not any(word in given.upper().split() for word in ("SAVE", "USE", "FILE", "MAP", "HYDRAULICS", "HYDR"))


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "EPANET"),
        (bytes(range(256)) * 10, "control characters"),
        (TEXT.encode().replace(b" a 20 30", b" a nan 30"), "a number that is none"),
        (TEXT.encode().replace(b" a 20 30", b" a 1e308 30"), "beyond all numbers"),
        (TEXT.encode().replace(b"900 250", b"1e400 250"), "no steady flow"),
        (TEXT.encode().replace(b"900 250", b"900 1e-300"), "no steady flow"),
        (TEXT.encode().replace(b"900 250", b"900 1e100"), "beyond all numbers"),
        (TEXT.encode().replace(b" lake 10", b" lake inf"), "a number that is none"),
        (TEXT.encode().replace(b" main lift a", b" main lift lift"), "main"),
        (TEXT.encode().replace(b" main lift", b' "ma in" lift'), "quotes or spaces"),
        (TEXT.encode().replace(b" main lift", b' ma"in lift'), "quotes or spaces"),
        (TEXT.encode().replace(b" main lift", b" " + b"m" * 2000 + b" lift"), "too long"),
        (TEXT.encode().replace(b" main lift", b" " + b"m" * 40 + b" lift"), "invalid ID name"),
        (TEXT.encode().replace(b"[PIPES]", b"[PIPE DREAMS]"), "line 13: unknown section.*PIPE DREAMS"),
        (TEXT.encode().replace(b"UNITS LPS", b"COLOUR BLUE"), "unknown option.*COLOUR"),
        (TEXT.encode().replace(b" lake 0 0", b" lake nan 0"), "not a place on a map"),
        (TEXT.encode().replace(b"lifting 90 75", b"lifting 90 75\n lifting 100 80"), "duty"),
        (TEXT.encode().replace(b" a 20 30", b" a 20 30\n lone 20 0"), "got Error 233: unconnected node lone"),
        (b"x" * 5000, "a section such as"),
    ],
)
def test_a_broken_file_is_one_sentence(folder: Path, data: bytes, said: str) -> None:
    (folder / "bad.inp").write_bytes(data)
    done = run("import bad.inp --wave-speed 1000 -o out.toml")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert not (folder / "out.toml").exists()
    with pytest.raises(InputError, match=said):
        read_epanet("bad.inp")


def test_an_emitter_beyond_all_numbers(folder: Path) -> None:
    pipe = "[JUNCTIONS]\na 20 30\n[RESERVOIRS]\nlake 50\n[PIPES]\nintake lake a 80 300 120 0.5 Open\n"
    (folder / "bad.inp").write_text(
        f"{pipe}[EMITTERS]\na 0.4\n[OPTIONS]\nUNITS LPS\nHEADLOSS H-W\nEMITTER EXPONENT 9e18\n[END]\n"
    )
    with pytest.raises(InputError, match="a: its demand is beyond all numbers"):
        read_epanet("bad.inp")


def test_pipes_folders_and_devices_are_no_files(folder: Path) -> None:
    os.mkfifo("pipe.inp")
    (folder / "folder.inp").mkdir()
    os.symlink("/dev/zero", "zero.inp")
    for name in ("pipe.inp", "folder.inp", "zero.inp"):
        done = run(f"import {name} --wave-speed 1000")
        assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
        assert "cannot be read" in done.stderr


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1", "utf-8"])
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends(folder: Path, encoding: str, newline: str) -> None:
    text = "[TITLE]\nVille d'été\n" + TEXT.replace(" tower", " château")
    (folder / "town.inp").write_bytes(text.replace("\n", newline).encode(encoding))
    network = read_epanet("town.inp")
    assert network.title == "Ville d'été"
    assert network.basins["château"].head == pytest.approx(44.0, rel=1e-12)
    plain = read_epanet(ring(folder))
    assert [node.head for node in network.nodes.values()] == [node.head for node in plain.nodes.values()]


def test_many_controls_take_a_moment() -> None:
    controls = "[CONTROLS]\n" + "LINK spare OPEN AT TIME 5\n" * 30_000
    Path("many.inp").write_text(TEXT.replace("[END]", controls + "[END]"))
    assert read_epanet("many.inp").notes[-1].startswith("patterns, controls and rules")


@pytest.mark.parametrize(
    ("program", "said"),
    [
        ("while True: pass", "takes too long over it, expected at most 1 s"),
        ("import os; os.abort()", "breaks down over it"),
        ("import ctypes; ctypes.string_at(0)", "breaks down over it"),
        ("x = []\nwhile True: x.append(bytes(1 << 24))", "breaks down over it"),
    ],
)
def test_a_library_that_hangs_or_breaks_down(monkeypatch, tmp_path: Path, program: str, said: str) -> None:
    limits = Path(epanet_run.__file__).read_text().partition('if __name__ == "__main__":')
    (tmp_path / "broken.py").write_text(f"{limits[0]}{limits[1]}\n    limit(*map(int, map(float, sys.argv[2:5])))\n")
    with (tmp_path / "broken.py").open("a") as file:
        file.write("\n".join(f"    {line}" for line in program.splitlines()))
    monkeypatch.setattr(epanet_run, "__file__", str(tmp_path / "broken.py"))
    monkeypatch.setattr(confined, "SECONDS", 1.0)
    monkeypatch.setattr(confined, "EACH", 0.0)
    monkeypatch.setattr(confined, "MEMORY", 1 << 30)
    with pytest.raises(InputError, match=said):
        read_epanet(ring(tmp_path))


def test_an_output_is_whole_or_not_there(folder: Path) -> None:
    ring(folder)
    (folder / "out.toml").write_text(KEEPSAKE)
    assert run("import ring.inp --wave-speed -3 -o out.toml").exit_code == 2
    assert (folder / "out.toml").read_text() == KEEPSAKE
    assert run("import ring.inp --wave-speed 1000 -o nowhere/out.toml").exit_code == 2
    assert {path.name for path in folder.iterdir()} == {"out.toml", "ring.inp"}
