"""Gathers the pages of the site in a folder, as Sphinx reads them: ``python docs/site/assemble.py FOLDER``.

Beside the pages of `docs` these are the gallery, a page for each letter of the exercise, the reference of all public
names and the help of all commands. Pages with Python come as notebooks, too.
"""

import importlib
import re
import shutil
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
from click.testing import CliRunner

import tline as tl
from tline.cli.main import COMMANDS, main
from tline.exercises.answer import Answer, letters
from tline.style import save_figure

ROOT = Path(__file__).parents[2]
PACKAGES = (
    "tline", "tline.scene", "tline.frequency", "tline.signal", "tline.loss", "tline.design", "tline.interchange",
    "tline.pictures", "tline.study", "passivity", "friction", "drives",
)  # fmt: skip
FENCE = "```"
CODE = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SHOWN = re.compile(r"!\[(.+)\]\((pictures/(?!circuit_)\w+\.png|charts/\w+\.png)\)")
PICTURE = re.compile(r"^!\[.*?\]\(.*?\)\n+", re.MULTILINE)  # files that a notebook does not bring; its cells draw
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}
CHECKED = {True: " *(checked)*", False: " **(does not hold)**", None: ""}


def letter_page(answer: Answer) -> str:
    """The page of a letter, in Markdown; its code gives the same in a notebook."""
    parts = [f"# {answer.letter} {answer.title}", f"> {answer.question}"]
    if answer.steps:
        parts.append("\n".join(f"1. `{each.text}`: {each.reason}{CHECKED[each.holds]}" for each in answer.steps))
    parts += answer.paragraphs
    if answer.has_figure:
        parts.append(f"![{answer.title}]({answer.letter}.png)")
    parts += [f"**A remark on the text.** {remark}" for remark in answer.remarks]
    if answer.modelica:
        parts.append(f"{FENCE}modelica\n{answer.modelica.rstrip()}\n{FENCE}")
    parts.append(f'{FENCE}python\nimport tline as tl\n\ntl.exercise("{answer.letter}")\n{FENCE}')
    return "\n\n".join(parts) + "\n"


def public_names() -> dict[str, list[str]]:
    """Public names of each package, once, without packages within it."""
    found, seen = {}, set[int]()
    for package in PACKAGES:
        module = importlib.import_module(package)
        offered = {name: getattr(module, name) for name in module.__all__}
        names = [name for name, each in offered.items() if not isinstance(each, type(sys)) and id(each) not in seen]
        found[package] = sorted(names, key=str.lower)
        seen |= {id(each) for each in offered.values()}
    return found


def reference() -> str:
    """The page from which Sphinx makes one for each public name."""
    parts = ["# Python"]
    for package, names in public_names().items():
        about = (importlib.import_module(package).__doc__ or "").partition("\n")[0]
        listed = "\n".join(f"   {package}.{name}" for name in names)
        directive = f".. autosummary::\n   :toctree: api\n\n{listed}"
        parts.append(f"## {package}\n\n{about}\n\n{FENCE}{{eval-rst}}\n{directive}\n{FENCE}")
    return "\n\n".join(parts) + "\n"


def commands() -> str:
    """The help of all commands and of those within them."""
    return "\n\n".join(["# Commands", *(f"## {name}\n\n{FENCE}text\n{text}{FENCE}" for name, text in _helps())]) + "\n"


def _helps() -> Iterator[tuple[str, str]]:
    for name in COMMANDS:
        command = main.get_command(None, name)  # pyright: ignore[reportArgumentType]
        for inner in ("", *getattr(command, "commands", {})):
            words = [name, inner] if inner else [name]
            shown = CliRunner().invoke(main, [*words, "--help"], prog_name="tline", terminal_width=100)
            yield " ".join(["tline", *words]), shown.output


def scene_page(name: str) -> str:
    """The page of a scene: its picture, how to run it, its file."""
    text = tl.examples.path(name).read_text(encoding="utf-8")
    command, code = f"tline run {name}.toml --plot {name}.png", f'tl.simulate(tl.examples["{name}"]).plot()'
    parts = [
        f"# {tl.examples[name].title or name}",
        f"![What its probes see]({name}.png)",
        f"{FENCE}sh\ntline examples {name}\n{command}\n{FENCE}",
        f"{FENCE}python\nimport tline as tl\n\n{code}\n{FENCE}",
        f"{FENCE}toml\n{text.rstrip()}\n{FENCE}",
    ]
    return "\n\n".join(parts) + "\n"


def gallery() -> str:
    """Pictures of all scenes, each of which leads to its page, and those of all other pages, which lead to these."""
    parts = [
        "# Gallery",
        "Each scene comes with tline and has a page with its file; other pictures lead to the page that makes them.",
    ]
    for title, medium in (("Pipes", "hydraulic"), ("Cables", "electrical")):
        titles = {name: tl.examples[name].title or name for name in tl.examples if tl.examples[name].medium == medium}
        parts += _cells(title, [(f"gallery/{name}.png", told, f"gallery/{name}.md") for name, told in titles.items()])
    pages = {page: page.read_text(encoding="utf-8") for page in sorted((ROOT / "docs").glob("*.md"))}
    shown = [
        (f"docs/{at}", told, f"docs/{page.name}") for page, text in pages.items() for told, at in SHOWN.findall(text)
    ]
    parts += _cells("All else", shown)
    listed = "\n".join(f"gallery/{name}" for name in tl.examples)
    return "\n\n".join([*parts, f"{FENCE}{{toctree}}\n:hidden:\n{listed}\n{FENCE}"]) + "\n"


def _cells(title: str, pictures: list[tuple[str, str, str]]) -> list[str]:
    """A section of pictures with their words and the pages behind them."""
    cells = [f"[![{told}]({picture}) {told}]({page})" for picture, told, page in pictures]
    return [f"## {title}", f"{FENCE}`{{container}} gallery", *cells, f"{FENCE}`"]


def draw(name: str, file: Path) -> None:
    """Draw what the probes of a scene see."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # said as notes of the result
        save_figure(tl.simulate(tl.examples[name]).plot(), file)


def notebook(page: str) -> Any:
    """A page in Markdown as a notebook.

    Examples
    --------
    >>> [cell.source for cell in notebook("# Sum\\n\\n```python\\n1 + 1\\n```\\nTwo.\\n").cells]
    ['# Sum', '1 + 1', 'Two.']
    """
    parts = [part.strip() for part in CODE.split(PICTURE.sub("", page))]
    makers = (nbformat.v4.new_markdown_cell, nbformat.v4.new_code_cell)
    cells = [makers[k % 2](part, id=f"cell-{k}") for k, part in enumerate(parts) if part]
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": KERNEL})


def assemble(folder: Path) -> None:
    """Write all pages into a folder, which is emptied first."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("gallery", "exercise"):
        (folder / name).mkdir(parents=True)
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=shutil.ignore_patterns("*.py", "__pycache__", "site"))
    for name in ("scenes", "benchmarks/pages"):
        shutil.copytree(ROOT / name, folder / name)
    for name in ("templates", "style"):
        shutil.copytree(ROOT / "docs" / "site" / name, folder / name)
    for name in ("CHANGELOG.md", "CONTRIBUTING.md", "CITATION.cff", "docs/site/index.md", "docs/site/conf.py"):
        shutil.copy(ROOT / name, folder)
    for letter in letters():
        answer = tl.exercise(letter)
        (folder / "exercise" / f"{letter}.md").write_text(letter_page(answer), encoding="utf-8")
        if answer.has_figure:
            save_figure(answer.plot(), folder / "exercise" / f"{letter}.png")
    tl.simulate(tl.examples["water_pipe"]).animate().save(folder / "style" / "waves.html")
    for name in tl.examples:
        draw(name, folder / "gallery" / f"{name}.png")
        (folder / "gallery" / f"{name}.md").write_text(scene_page(name), encoding="utf-8")
    pages = {"reference": reference(), "commands": commands(), "gallery": gallery()}
    with (folder / "docs" / "exercise.md").open("a", encoding="utf-8") as page:
        listed = "\n".join(f"../exercise/{letter}" for letter in letters())
        page.write(f"\n{FENCE}{{toctree}}\n:caption: Letters\n{listed}\n{FENCE}\n")
    for name, text in pages.items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")
    for page in (page for each in ("docs", "exercise", "gallery") for page in (folder / each).glob("*.md")):
        text = page.read_text(encoding="utf-8")
        if CODE.search(text):
            nbformat.write(notebook(text), page.with_suffix(".ipynb"))
            page.write_text(f"{text}\n[This page as a notebook]({page.stem}.ipynb)\n", encoding="utf-8")


if __name__ == "__main__":
    assemble(Path(sys.argv[1]))
