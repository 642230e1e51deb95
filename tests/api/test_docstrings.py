"""Every public name says what it takes, in which units, what it refuses, and shows itself in an example that runs."""

import ast
import enum
import importlib
import inspect
import re
from pathlib import Path

import pytest

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
