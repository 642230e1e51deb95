"""Arguments of functions and their descriptions in numpydoc docstrings, from source text: nothing is imported."""

import ast
import inspect
import re
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

REQUIRED = ...  # in place of a default
Given = tuple[str, ast.expr | None, ast.expr | None]  # name, annotation, default of an argument


class Argument(NamedTuple):
    """Argument of a function: annotation, default, help and type in words."""

    annotation: Any
    default: Any
    help: str = ""
    kind: str = ""


UNKNOWN = Argument("", None)


@lru_cache
def arguments_of(source: str) -> dict[str, Argument]:
    """Arguments of a function, or fields of a dataclass, by name.

    Parameters
    ----------
    source : str
        Module and name, as ``"tline.signal.tdr:reflectometry"``.

    Examples
    --------
    >>> arguments_of("tline.signal.tdr:reflectometry")["rise"].help
    'Time that the step takes, a straight ramp, s, above zero.'
    """
    module, _, name = source.partition(":")
    tree = ast.parse(_folder(module).with_suffix(".py").read_text(encoding="utf-8"))
    found = next(each for each in tree.body if isinstance(each, ast.FunctionDef | ast.ClassDef) and each.name == name)
    documented = documented_in(inspect.cleandoc(ast.get_docstring(found) or ""))
    named = [each for each in tree.body if isinstance(each, ast.Assign) and isinstance(each.targets[0], ast.Name)]
    constants = {each.targets[0].id: each.value for each in named if isinstance(each.targets[0], ast.Name)}
    told = {}
    for argument, annotation, default in _fields(found) if isinstance(found, ast.ClassDef) else _signature(found):
        node = constants.get(default.id) if isinstance(default, ast.Name) else default
        value = REQUIRED if node is None else ast.literal_eval(node)
        words = ast.unparse(annotation) if annotation else ""
        told[argument] = documented.get(argument, UNKNOWN)._replace(annotation=words, default=value)
    return told


def _signature(function: ast.FunctionDef) -> list[Given]:
    given = function.args
    defaults = [*[None] * (len(given.args) - len(given.defaults)), *given.defaults, *given.kw_defaults]
    together = zip([*given.args, *given.kwonlyargs], defaults, strict=True)
    return [(each.arg, each.annotation, default) for each, default in together]


def _fields(record: ast.ClassDef) -> list[Given]:
    """Fields of a dataclass, with defaults that are constants."""
    found = [each for each in record.body if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name)]
    return [
        (each.target.id, each.annotation, each.value if isinstance(each.value, ast.Constant) else None)
        for each in found
        if isinstance(each.target, ast.Name)
    ]


def documented_in(text: str) -> dict[str, Argument]:
    """Help and type in words by argument, from the section of parameters of a docstring.

    A reference "As of" another function of the package is replaced by the description there.
    """
    section = re.split(r"\n\n\S+\n-+\n", text.partition("Parameters\n----------\n")[2])[0]
    entries = re.findall(r"^(\w.*?)(?: : (.*))?\n((?:[ ]+.*\n?|\n)*)", f"{section}\n", re.MULTILINE)
    told = {}
    for names, kind, lines in entries:
        words = " ".join(lines.split())
        elsewhere = re.search(r"\bas of `(\w+(?:\.\w+)*)\.(\w+)`", words, re.IGNORECASE)
        others = arguments_of(_public(*elsewhere.groups())) if elsewhere else {}
        for name in names.split(", "):
            told[name] = others.get(name) or Argument("", None, words.replace("`", ""), kind)
    return told


def without_sections(text: str) -> str:
    """First paragraphs of a docstring, with the quotes of a terminal."""
    return re.split(r"^[A-Z]\w+\n-+$", text, maxsplit=1, flags=re.MULTILINE)[0].strip().replace("`", "'")


def _public(package: str, name: str) -> str:
    """Source of a public name of a package, as its stub refers to it, or of a name in a module."""
    if not _folder(package).is_dir():
        return f"{package}:{name}"
    stub = _folder(package).joinpath("__init__.pyi").read_text(encoding="utf-8")
    found = [each for each in ast.parse(stub).body if isinstance(each, ast.ImportFrom)]
    home = next(each.module for each in found if name in (alias.name for alias in each.names))
    return f"{home}:{name}"


def _folder(module: str) -> Path:
    root, *inner = module.split(".")
    spec = find_spec(root)  # of a package only: what is in it is not imported
    assert spec is not None
    assert spec.submodule_search_locations
    return Path(spec.submodule_search_locations[0], *inner)
