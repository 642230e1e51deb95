"""The surface of `tline warm-up`: it finds all units, compiles what is missing, and says where it is kept."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tline.cli.warm_up import found

ROOT = Path(__file__).parents[2]
HEAD = "from tline.compiled.unit import unit\n\n\n@unit\n"
UNITS = {
    "one": "def double(n: int) -> int:\n    return 2 * n\n",
    "two": "def triple(n: int) -> int:\n    return 3 * n\n",
}
CALL = """
import sys
from tline.cli import warm_up
from tline.cli.main import main
warm_up.WITH_UNITS = ("made",)
if __name__ == "__main__":
    main(["warm-up", *sys.argv[1:]])
"""


def _decorated(file: Path) -> list[str]:
    """Functions of a file that are units."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    marks = {"unit", "unit_of_long_loops"}
    return [f.name for f in functions if any(isinstance(d, ast.Name) and d.id in marks for d in f.decorator_list)]


def test_all_units_are_found():
    files = [file for package in ("tline", "friction", "drives") for file in (ROOT / package).rglob("*.py")]
    modules = {file: ".".join(file.relative_to(ROOT).with_suffix("").parts) for file in files}
    wanted = {f"{modules[file]}.{name}" for file in files for name in _decorated(file)}
    assert len(wanted) > 20
    assert {".".join(where) for where, _ in found()} == wanted


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A package with two units, and a program that warms them up."""
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "__init__.py").write_text("")
    for module, text in UNITS.items():
        (tmp_path / "made" / f"{module}.py").write_text(HEAD + text)
    (tmp_path / "call.py").write_text(CALL)
    return tmp_path


def warm_up(folder: Path, *arguments: str, kept: str = "kept") -> subprocess.CompletedProcess[str]:
    own = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)]), "NUMBA_CACHE_DIR": str(folder / kept)}
    call = [sys.executable, "call.py", *arguments]
    return subprocess.run(call, cwd=folder, env=own, capture_output=True, text=True, check=False)


def test_what_is_missing_is_compiled_once(folder: Path):
    first = warm_up(folder)
    assert (first.returncode, first.stderr) == (0, "")
    assert first.stdout.startswith("compiled 2 of 2 units in ")
    assert first.stdout.endswith(f" s, kept in {folder / 'kept'}\n")
    assert len(list((folder / "kept").iterdir())) == 2
    assert warm_up(folder).stdout == f"nothing to do: all 2 units are compiled, kept in {folder / 'kept'}\n"
    (folder / "made" / "two.py").write_text(HEAD + UNITS["two"].replace("3", "4"))
    told = json.loads(warm_up(folder, "--json").stdout)
    assert {key: told[key] for key in ("units", "compiled", "not_kept")} == {"units": 2, "compiled": 1, "not_kept": []}
    assert told["folders"] == [str(folder / "kept")]


def test_a_folder_of_others_is_named_in_one_line(folder: Path):
    (folder / "kept").mkdir()
    (folder / "kept").chmod(0o1777)
    done = warm_up(folder)
    assert done.returncode == 1
    assert done.stderr.startswith("note: compiled code is not ")
    assert done.stderr.endswith(
        f"other users may write to {folder / 'kept'}, expected a folder of your own to which nobody else may write\n"
    )
    assert done.stderr.count("\n") == 1
    assert list((folder / "kept").iterdir()) == []


def test_what_cannot_be_kept_is_named(folder: Path):
    (folder / "file").write_text("")
    done = warm_up(folder, kept="file/below")
    assert done.returncode == 1
    assert "\nnot kept: made.one.double\nnot kept: made.two.triple\n" in done.stdout
