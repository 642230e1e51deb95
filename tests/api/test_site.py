"""Pages of the site before Sphinx reads them: entrances and questions lead somewhere, and names have pages."""

import importlib
import re
import runpy
from functools import cache
from pathlib import Path

import nbformat
import pytest

import tline as tl
from tline.cli.main import COMMANDS
from tline.exercises.answer import letters

ROOT = Path(__file__).parents[2]
HOME = ROOT / "docs" / "site" / "index.md"
INDEX = HOME.read_text(encoding="utf-8")
ASSEMBLED = runpy.run_path(str(ROOT / "docs" / "site" / "assemble.py"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
CODE = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MADE = {"gallery", "reference", "commands", *(f"exercise/{letter}" for letter in letters())}


TREE = re.compile(r"```{toctree}\n(.*?)```", re.DOTALL)


def pages_from(page):
    """Pages that a page leads to, by links and by what the index lists beside all of them."""
    text = page.read_text(encoding="utf-8")
    listed = [f"{line}.md" for tree in TREE.findall(text) for line in tree.splitlines() if line[:1] != ":"]
    folder = ROOT if page == HOME else page.parent
    found = {(folder / target).resolve() for target in (*re.findall(r"\]\(([^)#\s]+\.md)", text), *listed)}
    return {each for each in found if each.exists()}


def test_every_page_is_two_clicks_from_the_index():
    once = pages_from(HOME)
    reached = once.union(*map(pages_from, once))
    pages = [*(ROOT / "docs").glob("*.md"), *(ROOT / "benchmarks" / "pages").glob("*.md")]
    assert [page.name for page in pages if page not in reached] == []


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\(([^)#]+)\.md\)", INDEX))))
def test_entrances_lead_somewhere(target):
    assert target in MADE or (ROOT / f"{target}.md").exists()


def test_pages_are_listed_once():
    listed = [line for tree in TREE.findall(INDEX) for line in tree.splitlines()]
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


def test_every_scene_has_a_page_in_the_gallery():
    page = ASSEMBLED["gallery"]()
    for name in tl.examples:
        assert f"(gallery/{name}.png)" in page
        assert f"\ngallery/{name}\n" in page
    assert 'tl.simulate(tl.examples["water_pipe"]).plot()\n' in ASSEMBLED["scene_page"]("water_pipe")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_notebook_has_all_of_its_page(page):
    text = page.read_text(encoding="utf-8")
    made = ASSEMBLED["notebook"](text)
    nbformat.validate(made)
    assert [cell.source + "\n" for cell in made.cells if cell.cell_type == "code"] == CODE.findall(text)
    kept = "".join(cell.source for cell in made.cells)
    assert [line for line in text.splitlines() if line not in kept and "```" not in line and line[:2] != "!["] == []


def test_the_notebook_of_a_letter_runs():
    made = ASSEMBLED["notebook"](ASSEMBLED["letter_page"](tl.exercise("2b")))
    (code,) = [cell.source for cell in made.cells if cell.cell_type == "code"]
    statements, _, shown = code.rpartition("\n")
    exec(statements, names := {})
    assert "= 11.1 pF/m and L = " in repr(eval(shown, names))


def test_what_is_to_be_read_is_no_book():
    """Words of the pages that are written by hand, without code, addresses and figures."""
    written = [page.read_text(encoding="utf-8") for page in PAGES if page.stem != "scene-reference"]
    prose = re.sub(r"```.*?```|`[^`]*`|\]\([^)]*\)|<!--.*?-->", "", "\n".join(written), flags=re.DOTALL)
    assert 20_000 < len(re.findall(r"[^\W\d_]{2,}", prose)) < 40_000


LANDING = "docs/site/index.md"
ANSWERED = {"gallery.md", "reference.md", "commands.md", *(f"exercise/{letter}.md" for letter in letters())}
PAGE = (ROOT / "docs" / "questions.md").read_text(encoding="utf-8")
SECTIONS = re.findall(r"^## (.*)\n((?:(?!^## ).*\n?)*)", PAGE, re.MULTILINE)
LINK = re.compile(r"\]\(([^)#\s]*)(#[^)]*)?\)")
CLICKS = 3


def links(page):
    """Files that a page leads to, from the root."""
    if page in ANSWERED or not page.endswith(".md"):
        return set()
    folder = ROOT if page == LANDING else (ROOT / page).parent  # the site has its first page at the root
    targets = {target for target, _ in LINK.findall((ROOT / page).read_text(encoding="utf-8")) if target}
    made = targets & ANSWERED if page == LANDING else set()
    return made | {str((folder / each).resolve().relative_to(ROOT)) for each in targets - made if ":" not in each}


@cache
def clicks(landing):
    """How many clicks each page is away."""
    found, last = {landing: 0}, {landing}
    for count in range(1, CLICKS + 1):
        last = {target for page in last for target in links(page)} - found.keys()
        found |= dict.fromkeys(last, count)
    return found


def anchors(page):
    heads = re.findall(r"^#+ (.*)", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE)
    return {"#" + re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_there_are_twenty():
    assert len({head for head, _ in SECTIONS}) == len(SECTIONS) == 20
    assert all(head.endswith("?") for head, _ in SECTIONS)


@pytest.mark.parametrize(("head", "text"), SECTIONS, ids=[head for head, _ in SECTIONS])
def test_an_answer_is_short_and_its_page_near(head, text):
    ((language, code),) = re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL)
    lines = [line for line in code.splitlines() if line]
    assert len(lines) == 1 if language == "sh" else len(lines) <= 5
    assert language in ("sh", "python")
    assert lines[0].startswith("tline " if language == "sh" else "import tline as tl")
    places = LINK.findall(text)
    assert places
    for target, anchor in places:
        page = str((ROOT / "docs" / target).resolve().relative_to(ROOT))
        for landing in (LANDING, "README.md"):
            assert clicks(landing).get(page, CLICKS + 1) <= CLICKS
            assert clicks(landing)["docs/questions.md"] == 1
        assert not anchor or anchor in anchors(page)
