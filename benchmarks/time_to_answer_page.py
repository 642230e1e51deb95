"""The page that `benchmarks.time_to_answer` writes."""

from collections.abc import Mapping
from typing import Any, NamedTuple

KINDS = {
    "plain cable": "scenes/cable_rc.toml",
    "Y with fronts": "scenes/y_junction.toml",
    "pipe with friction": "scenes/pipe_friction.toml",
}
PRESENT = "now"


class Answers(NamedTuple):
    """What was measured of one tline; empty where it lacks the function.

    Parameters
    ----------
    cpu : mapping
        CPU seconds to compile, by scene.
    cable, valve : mapping
        Seconds of `simulate` in a process that has run it, and the share of compiled code.
    prepared : mapping
        The same of a prepared scene.
    pipe : mapping
        Least seconds of stepping to a true error of 1e-3, "ours" and of the "peer".
    """

    cpu: Mapping[str, float]
    cable: Mapping[str, float]
    valve: Mapping[str, float]
    prepared: Mapping[str, float]
    pipe: Mapping[str, Any]


def page(found: Mapping[str, Answers], processes: Mapping[str, tuple[float, float]], runs: int) -> str:
    """The page in markdown; the column of the older tline only if there is one."""
    columns = [name for name in ("before", PRESENT) if name in found]
    told = {name: _rows(found[name], processes[name]) for name in columns}
    rows = [
        "# Time to an answer",
        "",
        f"Written by `python -m benchmarks.time_to_answer`; in one run, medians of at least {runs}. *CPU to compile*",
        "is what a process with an empty cache takes more than the next one, user and system time of all its threads;",
        "where it exceeds 20 s it is measured once. *Again* means a process that has run the scene already, and",
        "*compiled code* all between a call from Python into it and the return.",
        *(["*Before* is the older checkout that was named."] if "before" in found else []),
        "",
        f"| what the user waits for | {' | '.join(columns)} |",
        "|---|" + "---:|" * len(columns),
        *(f"| {what} | {' | '.join(told[name][what] for name in columns)} |" for what in told[PRESENT]),
        "",
        "## Whole processes",
        "",
        "| process | seconds | ratio to `import numba` |",
        "|---|---:|---:|",
        *(f"| {_process(name)} | {seconds:.3f} | {ratio:.2f} |" for name, (seconds, ratio) in processes.items()),
        *_absent(processes),
        "",
        "## CPU seconds to compile what a scene needs",
        "",
        f"| scene | {' | '.join(columns)} |",
        "|---|" + "---:|" * len(columns),
        *(_compiled(scene, [found[name].cpu for name in columns]) for scene in found[PRESENT].cpu),
        "",
    ]
    return "\n".join(rows)


def _rows(answers: Answers, process: tuple[float, float]) -> dict[str, str]:
    """Each figure of the first table, by what it is."""
    most = max(answers.cpu, key=lambda scene: answers.cpu[scene])
    pipe, ratio = answers.pipe, "rthym-moc is not installed"
    if "peer" in pipe and "ours" in pipe:
        ratio = f"rthym-moc {1e3 * pipe['peer']:.3g} ms, {pipe['peer'] / pipe['ours']:.1f} times as long"
    return {
        **{f"CPU to compile, {kind}": f"{answers.cpu[scene]:.1f} s" for kind, scene in KINDS.items()},
        "CPU to compile, the slowest of the scenes below": f"{answers.cpu[most]:.1f} s ({most.rpartition('/')[2]})",
        "`tline run scenes/cable_rc.toml`, cache filled, over `import numba`": f"{process[1]:.2f}",
        "`simulate(cable_rc)` to 1e-6 again": _milliseconds(answers.cable),
        "of that, in compiled code": f"{100 * answers.cable['share']:.0f} %",
        "the same prepared, other values": _milliseconds(answers.prepared),
        "`simulate(valve_closure)` to 1e-6 again": _milliseconds(answers.valve),
        "the pipe of the friction chart to 1e-3, stepping": f"{1e3 * pipe['ours']:.3g} ms; {ratio}",
    }


def _milliseconds(answer: Mapping[str, float]) -> str:
    return f"{1e3 * answer['seconds']:.3g} ms" if answer else "–"


def _process(name: str) -> str:
    told = {
        "numba": "`python -c 'import numba'`",
        "now": "`tline run scenes/cable_rc.toml`",
        "before": "the same, before",
        "ngspice": "ngspice on `tline export scenes/cable_rc.toml`",
        "rthym-moc": "rthym-moc on the pipe of the friction chart, 16 steps per transit",
    }
    return told[name]


def _absent(processes: Mapping[str, object]) -> list[str]:
    missing = [name for name in ("ngspice", "rthym-moc") if name not in processes]
    return ["", f"Not installed, so not measured: {', '.join(missing)}."] if missing else []


def _compiled(scene: str, columns: list[Mapping[str, float]]) -> str:
    told = [f"{cpu[scene]:.1f}" if scene in cpu else "–" for cpu in columns]
    return f"| {scene.rpartition('/')[2]} | {' | '.join(told)} |"
