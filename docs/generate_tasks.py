"""Count what ten tasks take in five programs: python -m docs.generate tasks."""

import ast

from benchmarks.harness import DOCS, table, write

PROGRAMS = "tline", "scikit-rf", "python-control", "wntr", "pybamm"
MARK = "# task: "
HEAD = """\
# The same tasks in five programs

Written by `python -m docs.generate tasks`, which counts the lines of code and the import statements of
[docs/tasks](tasks); tests run each file where its program is installed. The programs do different things: a
cable with a receiver in tline and python-control (with Padé's approximation of the delay), over frequency in
scikit-rf, a water network over a day in wntr, a battery in PyBaMM. What is compared is what a session takes:
lines, and in brackets the import statements among them. "–" is what a program does not do.

"""


def tasks(program: str) -> dict[str, str]:
    """Code of each task."""
    text = (DOCS / "tasks" / f"session_{program.replace('-', '_')}.py").read_text(encoding="utf-8")
    parts = (part.partition("\n") for part in text.split(MARK)[1:])
    return {task: code for task, _, code in parts}


def counted(code: str) -> tuple[int, int]:
    """Lines of code, and import statements among them."""
    imports = [node for node in ast.parse(code).body if isinstance(node, ast.Import | ast.ImportFrom)]
    return sum(bool(line.strip()) for line in code.splitlines()), len(imports)


def page() -> str:
    """The table: lines, and imports in brackets."""
    all_tasks = {program: tasks(program) for program in PROGRAMS}
    rows = []
    for task in all_tasks["tline"]:
        cells = [_cell(found[task]) if task in found else "–" for found in all_tasks.values()]
        rows.append((task, *cells))
    totals = []
    for found in all_tasks.values():
        lines, imports = (sum(each) for each in zip(*map(counted, found.values()), strict=True))
        totals.append(f"{lines} ({imports}), {len(found)} tasks")
    rows.append(("all: lines (imports)", *totals))
    return HEAD + table("<|" + "|".join(PROGRAMS), rows) + "\n"


def _cell(code: str) -> str:
    lines, imports = counted(code)
    return f"{lines} ({imports})" if imports else f"{lines}"


if __name__ == "__main__":
    write("tasks.md", page())
