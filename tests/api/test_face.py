"""One import: what the packages offer is there by name, complete, typed, and costs nothing until it is used."""

import importlib
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
