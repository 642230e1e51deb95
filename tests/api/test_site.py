"""Pages of the site before Sphinx reads them: entrances lead somewhere, pages are listed once, names have pages."""

import importlib
import re
import runpy
from pathlib import Path

import pytest

import tline as tl
from tline.cli.main import COMMANDS
from tline.exercises.answer import letters

ROOT = Path(__file__).parents[2]
INDEX = (ROOT / "docs" / "site" / "index.md").read_text(encoding="utf-8")
ASSEMBLED = runpy.run_path(str(ROOT / "docs" / "site" / "assemble.py"))
MADE = {"gallery", "reference", "commands", *(f"exercise/{letter}" for letter in letters())}


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\(([^)#]+)\.md\)", INDEX))))
def test_entrances_lead_somewhere(target):
    assert target in MADE or (ROOT / f"{target}.md").exists()


def test_pages_are_listed_once():
    listed = [line for tree in re.findall(r"```{toctree}\n(.*?)```", INDEX, re.DOTALL) for line in tree.splitlines()]
    pages = [line for line in listed if not line.startswith(":")]
    assert len(pages) == len({*pages}) > 30
    assert all(page in MADE or (ROOT / f"{page}.md").exists() for page in pages)


def test_every_public_name_has_a_page_with_a_docstring():
    names, page = ASSEMBLED["public_names"](), ASSEMBLED["reference"]()
    assert {"simulate", "exercise", "Scene"} <= set(names["tline"])
    for package, inside in names.items():
        for name in inside:
            assert f"   {package}.{name}\n" in page
            assert getattr(importlib.import_module(package), name).__doc__, name


def test_commands_and_letters_have_pages():
    page = ASSEMBLED["commands"]()
    assert {f"## tline {name}" for name in COMMANDS} <= set(page.splitlines())
    assert page.count("Usage: tline") >= len(COMMANDS)
    letter = ASSEMBLED["letter_page"](tl.exercise("3b"))
    assert "# 3b The line in between" in letter
    assert "put in B2 = H2 A2 *(checked)*" in letter
    assert "![The line in between](3b.png)" in letter
