"""What documents and help pages show works: commands, snippets, scenes, names; generated pages are up to date."""

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
from run_scenes import driven_cable

from tline.cli.main import main
from tline.loss import realise
from tline.scene.file import read_scene, scene_from
from tline.solver.simulate import simulate
from tline.surge.scenarios import read_plan

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


def unnamed(command: str) -> str:
    """A command without the names of files that it writes."""
    return re.sub(r" (out/)?\w+\.(png|csv)\b", "", command.strip())


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A folder that looks like a clone to commands that read scenes and write files; studies are of two scenarios."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tline.live.desk.IDLE", 0.0)
    monkeypatch.setattr("webbrowser.open", bool)
    monkeypatch.setattr(
        "tline.surge.study.read_plan", lambda given: (plan := read_plan(given))._replace(scenarios=plan.scenarios[:2])
    )
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
    assert (ROOT / "docs" / "scene-reference.md").read_text(encoding="utf-8") == page, (
        "run: python -m docs.generate reference"
    )


def test_the_numbers_of_terms_shown_for_1e_4_are_those_found():
    page = (ROOT / "docs" / "losses.md").read_text(encoding="utf-8")
    cases = runpy.run_path(str(ROOT / "docs" / "generate_losses.py"))["CASES"]
    for name, (law, _, low) in cases.items():
        (shown,) = re.findall(rf"^\| {re.escape(name)} \| [^|]+ \| (\d+) /", page, re.MULTILINE)
        assert len(realise(law, (low, 1e5 * low), 1e-4).circuit.rates) == int(shown), name


PACKAGES = ("tline", "passivity", "friction", "drives")
NAMED = re.findall(r"`([^`\n]+)`", (ROOT / "docs" / "add-a-node.md").read_text(encoding="utf-8"))
SOURCE = "\n".join(path.read_text(encoding="utf-8") for name in PACKAGES for path in (ROOT / name).rglob("*.py"))


def test_the_map_lists_every_folder():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    listed = re.findall(
        r"^ {4}((?:\w+/)+) ", text.partition("## Where things live")[2].partition("\n## ")[0], re.MULTILINE
    )
    inner = {f"tline/{each.parent.name}/" for each in (ROOT / "tline").glob("*/__init__.py")}
    assert sorted(listed) == sorted(inner | {f"{name}/" for name in PACKAGES[1:]})


@pytest.mark.parametrize("name", NAMED)
def test_what_add_a_node_names_is_there(name):
    """A path from the root or beside the last one named; a class, constant, attribute; a method with its parameters."""
    if "/" in name or name.endswith(".py"):
        assert (ROOT / name).exists() or (ROOT / "tline" / "scene" / name).exists()
    elif "(" in name:
        method, given = re.fullmatch(r"self\.(\w+)\((.*)\)", name).groups()
        parameters = re.search(rf"def {method}\(self, (.*)\) ->", SOURCE)[1]
        assert [each.split(":")[0] for each in parameters.split(", ")][: given.count(",") + 1] == given.split(", ")
    else:
        last = name.rpartition(".")[2]
        assert re.search(rf"^ *(?:class|def) {last}\b|^(?: {{4}})?{last} *[=:]", SOURCE, re.MULTILINE)


LOAD = '[loads.end]\nat = "far"\nkind = "parallel"\nresistance = 100\ncapacitance = "4 pF"'
CABLE = driven_cable(LOAD, "20 ns", source="pump")
FILES = {
    "cable.toml": CABLE,
    "network.toml": CABLE,
    "scene.toml": CABLE,
    "cable.cir": "V1 s 0 PULSE(0 1 0 1n 1n 5n)\nR1 s a 25\nT1 a 0 b 0 Z0=50 TD=1n\nR2 b 0 100\n.tran 1p 9n uic\n",
    "measured.csv": "f,re,im\n" + "".join(f"{k},{0.9 + 0.2 * (k == 3)},{0.01 * k}\n" for k in range(1, 30)),
    "measured.s2p": "# Hz S RI R 50\n1 0 0 0.5 0 0.5 0 0 0\n2 0 0 1.1 0 0.5 0 0 0\n",
    "moved.csv": "t [ms]; x [mm]\n# a stroke\n0;0\n500;1,5\n1000;0\n",
    "torques.csv": "t,T1,T2\n0,0.1,0\n0.5,0.1,0.3\n",
}
REFUTED = ("R real", "(s + 2)/(s^2 + s + 1)", "measured.s2p")
WRITTEN = {"--plot", "--csv", "--save", "--poles", "--certificate", "--nearest", "--resume", "-o"}
HELP_PAGES = (
    "line", "line electrical", "line hydraulic", "sweep", "frequency", "tdr", "eye", "crosstalk", "passivity",
    "friction", "friction motion", "drives", "drives bode", "drives control", "drives step", "import", "export",
)  # fmt: skip


@pytest.mark.parametrize("page", HELP_PAGES)
def test_examples_run(page: str, folder: Path) -> None:
    (folder / "scenes").symlink_to(ROOT / "scenes")
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    if page in ("tdr", "eye"):  # of an end that keeps the eye open
        open_eye = CABLE.replace('"parallel"', '"resistor"').replace('capacitance = "4 pF"\n', "")
        (folder / "cable.toml").write_text(open_eye, encoding="utf-8")
    shown = CliRunner().invoke(main, [*page.split(), "--help"]).stdout
    examples = re.findall(r"^ +tline ([^|\n]*)", re.sub(r"\\\n\s*", "", shown), re.MULTILINE)
    assert len(examples) > 1
    for example in examples:
        if "town.inp" in example or unnamed(f"tline {example}") in map(unnamed, commands()):  # other tests run these
            continue
        words = shlex.split(example)
        done = CliRunner().invoke(main, words, catch_exceptions=False)
        assert done.exit_code == any(each in example for each in REFUTED), done.output
        for option in WRITTEN.intersection(words):
            assert (folder / words[words.index(option) + 1]).stat().st_size > 0
