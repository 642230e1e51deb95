"""What the documents show works: commands, Python snippets, scenes, and the generated pages are up to date."""

import ast
import re
import runpy
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner

from tline.cli.main import main
from tline.scene.file import read_scene, scene_from
from tline.solver.simulate import simulate

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
MEASURED = sorted((ROOT / "benchmarks" / "pages").glob("*.md"))
SCENES = sorted((ROOT / "scenes").glob("*.toml"))


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def commands() -> list[str]:
    shown = "\n".join(block for page in PAGES for block in blocks(page, "sh"))
    demo = (ROOT / "Makefile").read_text(encoding="utf-8").replace("\\\n", " ").replace("$(BIN)/", "")
    lines = [line.split("#")[0].strip() for line in [*shown.splitlines(), *demo.splitlines()]]
    return sorted({line for line in lines if line.startswith("tline ")})


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A folder that looks like a clone to commands that read scenes and write files."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tline.live.server.IDLE", 0.0)
    monkeypatch.setattr("webbrowser.open", bool)
    return tmp_path


@pytest.mark.parametrize("command", commands())
def test_commands_run(command, workplace):
    words = shlex.split(command)[1:]
    done = CliRunner().invoke(main, words, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    pictures = ("--plot", "--profile", "--map", "--space-time", "--lattice", "--animate")
    for option in (*pictures, "--csv", "--envelope", "-o"):
        if option in words:
            assert (workplace / words[words.index(option) + 1]).stat().st_size > 200


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.stem)
def test_python_snippets_run(page, workplace, capsys):
    for k, block in enumerate(blocks(page, "python")):
        (workplace / f"snippet{k}.py").write_text(block, encoding="utf-8")
        runpy.run_path(str(workplace / f"snippet{k}.py"))
    assert capsys.readouterr().out


OTHERS = {
    "tline",
    "passivity",
    "friction",
    "drives",
    "numpy",
    "scipy",
    "skrf",
    "distributed",
}  # what snippets import beside the standard library


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.stem)
def test_snippets_import_whole_packages(page):
    """Nobody has to know in which module a name lives."""
    for block in blocks(page, "python"):
        for statement in ast.walk(ast.parse(block)):
            if isinstance(statement, ast.Import):
                names = [alias.name for alias in statement.names]
            elif isinstance(statement, ast.ImportFrom):
                names = [statement.module or ""]
            else:
                continue
            for name in names:
                package, _, inside = name.partition(".")
                assert package in OTHERS | sys.stdlib_module_names, name
                assert not inside or package in ("scipy", *sys.stdlib_module_names), name


@pytest.mark.parametrize("page", [*PAGES, *MEASURED], ids=lambda page: page.stem)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\((?!https:)([^)#]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_the_scene_shown_is_a_scene():
    (block,) = blocks(ROOT / "docs" / "quick-start.md", "toml")
    import tomllib

    scene_from(tomllib.loads(block))


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_run(path):
    result = simulate(read_scene(path))
    for probe in result.probes.values():
        assert np.isfinite(probe.u).all()
        assert np.ptp(probe.u) > 0


def test_the_random_network_of_a_thousand_lines_runs(tmp_path):
    network = runpy.run_path(str(ROOT / "scenes" / "random_network.py"))["network"]()
    file = tmp_path / "network.toml"
    file.write_text(tomli_w.dumps(network | {"t_end": "1 us"}), encoding="utf-8")
    scene = read_scene(file)
    assert len(scene.lines) == 1000
    last = simulate(scene).probes["last"]
    assert 0 < np.abs(last.u).max() < 2


def test_the_scene_reference_is_up_to_date(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["generate.py"])
    page = runpy.run_path(str(ROOT / "docs" / "generate.py"))["reference"]()
    assert (ROOT / "docs" / "scene-reference.md").read_text(encoding="utf-8") == page, "run: make docs"
