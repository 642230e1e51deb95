"""Questions of new users: each is answered in a line or five, and within three clicks of the landing page.

That the answers run is a matter of `test_documents.py`, which runs what all pages show.
"""

import re
from functools import cache
from pathlib import Path

import pytest

from tline.exercises.answer import letters

ROOT = Path(__file__).parents[2]
LANDING = "docs/site/index.md"
MADE = {"gallery.md", "reference.md", "commands.md", *(f"exercise/{letter}.md" for letter in letters())}
PAGE = (ROOT / "docs" / "questions.md").read_text(encoding="utf-8")
SECTIONS = re.findall(r"^## (.*)\n((?:(?!^## ).*\n?)*)", PAGE, re.MULTILINE)
LINK = re.compile(r"\]\(([^)#\s]*)(#[^)]*)?\)")
CLICKS = 3


def links(page):
    """Files that a page leads to, from the root."""
    if page in MADE or not page.endswith(".md"):
        return set()
    folder = ROOT if page == LANDING else (ROOT / page).parent  # the site has its first page at the root
    targets = {target for target, _ in LINK.findall((ROOT / page).read_text(encoding="utf-8")) if target}
    made = targets & MADE if page == LANDING else set()
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
