"""What contributors read names what there is: folders, files, classes, functions."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
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
