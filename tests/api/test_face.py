"""One import: what is offered is there by name, complete, typed, told by its docstring, and costs nothing unused."""

import ast
import enum
import importlib
import inspect
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import tline as tl

LAZY = ["tline", "passivity", "drives", *(f"tline.{name}" for name in
        ("frequency", "interchange", "pictures", "scene", "signal", "study"))]  # fmt: skip
HEAVY = {"numba", "scipy", "matplotlib", "numpy", "pydantic", "llvmlite", "sympy"}


def python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_the_import_costs_nothing():
    assert python(f"import tline as tl, sys; dir(tl); print(*({HEAVY} & {{*sys.modules}}))") == ""
    assert python(f"import drives, passivity, sys; print(*({HEAVY} & {{*sys.modules}}))") == ""


@pytest.mark.parametrize("package", LAZY)
def test_every_name_is_there(package):
    module = importlib.import_module(package)
    assert {*module.__all__} <= {*dir(module)}
    for name in module.__all__:
        found = getattr(module, name)
        assert found is getattr(module, name)
        assert found.__doc__, f"{package}.{name}"


@pytest.mark.parametrize("package", LAZY)
def test_no_name_is_that_of_a_module_inside(package):
    """Which name counts would depend on what was imported first."""
    module = importlib.import_module(package)
    inside = {each.name for each in pkgutil.iter_modules(module.__path__)}
    modules = {name for name in module.__all__ if is_module(getattr(module, name))}
    assert inside & {*module.__all__} == modules & inside


def is_module(value: object) -> bool:
    return isinstance(value, type(sys))


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(AttributeError, match="module 'tline' has no attribute 'simulat'"):
        tl.simulat  # noqa: B018 # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ImportError):
        exec("from tline import simulat")


def test_a_star_imports_what_is_public():
    names: dict = {}
    exec("from tline import *", names)
    assert names["simulate"] is tl.simulate
    assert {*tl.__all__} <= {*names}  # pyright: ignore[reportAttributeAccessIssue]


def test_a_scene_may_be_a_path_or_tables(tmp_path, monkeypatch):
    tl.examples.copy("cable_mismatch", tmp_path)
    path = tmp_path / "cable_mismatch.toml"
    scene = tl.read(path)
    ends = {simulated.probes["far"].u[-1] for simulated in map(tl.simulate, (path, str(path), scene, scene.table()))}
    assert len(ends) == 1
    assert tl.prepare(path).run().probes["far"].u[-1] in ends
    with pytest.raises(tl.InputError, match="scene: not a scene, expected a Scene, the path of a file, or a dict"):
        tl.simulate(42)  # pyright: ignore[reportArgumentType]


def test_files_of_other_programs_are_simulated_and_prepared_as_they_are_read():
    scenes = Path(__file__).parents[2] / "scenes"
    deck = scenes / "cable_rc.cir"
    assert tl.simulate(deck).probes["far"].u[-1] == tl.simulate(tl.read(deck)).probes["far"].u[-1]
    assert tl.prepare(str(deck)).scene == tl.read(deck)
    with pytest.raises(tl.InputError, match=r"nothing\.inp: cannot be read"):
        tl.prepare("nothing.inp")


def test_the_version_is_told():
    assert re.fullmatch(r"\d+\.\d+\.\d+", tl.__version__)


def test_reads_whatever_a_scene_is_in(monkeypatch):
    scenes = Path(__file__).parents[2] / "scenes"
    assert tl.read(scenes / "cable_rc.cir").medium == "electrical"
    with pytest.raises(tl.InputError, match=r"wave_speed: is for \.inp files"):
        tl.read(scenes / "loop.toml", wave_speed=1000)
    monkeypatch.chdir(scenes.parent)
    assert tl.read("water_pipe").title == tl.examples["water_pipe"].title
    with pytest.raises(tl.InputError, match=r"waterpipe: neither a file nor a scene .*, expected 'water_pipe'"):
        tl.simulate("waterpipe")


def test_examples_are_a_mapping_of_scenes(tmp_path):
    assert "water_pipe" in tl.examples
    assert len(tl.examples) == len([*tl.examples]) > 30
    assert "Water pipe" in repr(tl.examples)
    assert tl.examples._ipython_key_completions_() == [*tl.examples]
    with pytest.raises(tl.InputError, match="examples: no such scene, expected 'water_pipe', got 'waterpipe'"):
        tl.examples["waterpipe"]
    assert [path.name for path in tl.examples.copy("antenna", tmp_path)] == ["antenna.toml", "antenna.s1p"]
    with pytest.raises(tl.InputError, match="is there already"):
        tl.examples.copy("antenna", tmp_path)
    with pytest.raises(tl.InputError, match="cannot be written"):
        tl.examples.copy("antenna", tmp_path / "missing")


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("tline exa", "plain,examples"), ("tline run --sp", "plain,--space-time"), ("tline r", "plain,run")],
)
def test_shells_complete_commands_and_options(typed, offered):
    environment = os.environ | {
        "_TLINE_COMPLETE": "bash_complete", "COMP_WORDS": typed, "COMP_CWORD": str(len(typed.split()) - 1)
    }  # fmt: skip
    command = [sys.executable, "-c", "from tline.cli.main import main; main(prog_name='tline')"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [offered]


PACKAGES = ("tline", "passivity", "friction", "drives")
SECTION = re.compile(r"^(\w[\w ]*)\n-+\n", re.MULTILINE)
ENTRY = re.compile(r"^(\*{0,2}\w.*?)(?: : (.*))?\n((?:[ ]+.*\n?|\n)*)", re.MULTILINE)
NUMBER = re.compile(r"(?!.*\b(?:text|str|bool|mapping|dict|callable)\b).*(?:float|array|number)")
UNIT = re.compile(
    r"\[[^\]]+\]|\b(?:s|m|m²|kg|N|J|W|V|A|Pa|Hz|K|rad|ohm|m/s|rad/s|N/m|N m)\b"
    r"|\bSI\b|unit|relative|share|ratio|factor|probability|dimensionless|number of|tolerance|as of `",
    re.IGNORECASE,
)
WITHOUT_SUBJECT = re.compile(r"(The same|It|They|Its|Their|Of|What|Whatever|Those|That)\b|.*\b(so many|so much)\b")
ROOT = Path(__file__).parents[2]
REFUSES = re.compile(r"raise \w*Error\(|check_number\(|known_names\(|\bpositive\(|\bexact\(|\bfinite\(")


def public():
    for package in PACKAGES:
        module = importlib.import_module(package)
        for name in module.__all__:
            found = getattr(module, name)
            if callable(found):  # not modules, tables and mappings
                yield pytest.param(found, id=f"{package}.{name}")


def sections(text):
    parts = SECTION.split(f"{text}\n")
    return {name: part.partition("\n\n\n")[0] for name, part in zip(parts[1::2], parts[2::2], strict=True)}


def entries(text):
    """Kind and words by name."""
    return {
        name.lstrip("*"): (kind or "", " ".join(words.split()))
        for names, kind, words in ENTRY.findall(f"{text}\n")
        for name in names.split(", ")
    }


def is_word(found):
    """Values of an enumeration, and errors, are words: they take nothing."""
    return inspect.isclass(found) and issubclass(found, enum.Enum | BaseException)


@pytest.mark.parametrize("found", [*public()])
def test_a_public_name_is_documented_whole(found):
    text = inspect.getdoc(found) or ""
    assert text
    if is_word(found) or getattr(found, "_is_protocol", False):
        return
    told = sections(text)
    fields = entries(told.get("Parameters", "") + "\n" + told.get("Attributes", ""))
    signature = inspect.signature(found)
    taken = [name for name, each in signature.parameters.items() if name[0] != "_" and each.kind < each.VAR_KEYWORD]
    assert [name for name in taken if name not in fields] == []
    bare = [name for name, (kind, words) in fields.items() if NUMBER.match(kind) and not UNIT.search(f"{kind} {words}")]
    assert bare == [] or found.__module__.startswith("passivity.")  # where z0 and delay may have any consistent units
    made = not inspect.isclass(found) or "Raises" in told  # what is given out shows itself where it is given
    assert not made or ">>>" in text
    if inspect.isfunction(found) and REFUSES.search(inspect.getsource(found)):
        assert "Raises" in told


@pytest.mark.parametrize("package", PACKAGES)
def test_docstrings_name_their_subject(package):
    """First lines are read alone, in lists of what a module has: none begins with a word that stands for another."""
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef
    trees = (ast.parse(path.read_text(encoding="utf-8")) for path in (ROOT / package).rglob("*.py"))
    told = [ast.get_docstring(node) or "" for tree in trees for node in ast.walk(tree) if isinstance(node, kinds)]
    assert [line for text in told if WITHOUT_SUBJECT.match(line := text.partition("\n")[0])] == []
