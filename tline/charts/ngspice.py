"""A scene in ngspice: T elements, sources of straight pieces, the largest step refined."""

import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.charts.clock import Run
from tline.errors import InputError
from tline.reference.network import decimal
from tline.reference.waveforms import level, straight
from tline.scene.load import Resistor
from tline.scene.lossless import refuse_losses
from tline.scene.rational_load import Parallel, Series
from tline.scene.scene import Scene
from tline.scene.waveform import Shape

HALF_TICK = 5e-4  # s; ngspice counts time in milliseconds
PATIENCE = 60.0  # s, after which it is stopped


def misfit(scene: Scene) -> str | None:
    """Why it cannot do a scene; None if it can."""
    if shutil.which("ngspice") is None:
        return "not installed: apt install ngspice"
    if scene.medium != "electrical" or not all(
        isinstance(x, Resistor | Series | Parallel) for x in (*scene.loads.values(), *scene.links.values())
    ):
        return "not made of lines, R, L and C"
    return misfit_of_sources(scene)


def misfit_of_sources(scene: Scene) -> str | None:
    """Why PWL sources cannot drive a scene; None if they can."""
    if any(corners(source.value, scene.t_end) is None for source in scene.sources.values()):
        return "a PWL source neither jumps nor curves"
    return None


def corners(waveform: Shape, t_end: float) -> list[tuple[float, float]] | None:
    """Corners of a waveform of straight pieces without jumps, and its point at the end."""
    pieces, end = straight(waveform, decimal(t_end)), decimal(t_end)
    if pieces is None:
        return None
    instants = [start for start, *_ in pieces if start is not None and 0 < start < end]
    after = [first for start, first, _ in pieces if start is not None and 0 < start < end]
    if any(level(pieces, t) != first for t, first in zip(instants, after, strict=True)):
        return None
    return [(0.0, 0.0), *((float(t), float(level(pieces, t))) for t in (*instants, end))]


def netlist(scene: Scene, longest: float) -> str:
    """The scene in SPICE, its steps no longer than so many seconds.

    Examples
    --------
    >>> from tline.charts.scenes import chart_scene
    >>> netlist(chart_scene("rc").scene, 1e-12).splitlines()[1]
    'T0 near 0 far 0 Z0=50.0 TD=1e-09'
    """
    refuse_losses(scene, "no netlist")
    cards = [f"* {scene.title}"]
    for k, line in enumerate(scene.lines.values()):
        i, j = line.nodes
        cards.append(f"T{k} {i} 0 {j} 0 Z0={line.parameters.z0!r} TD={float(line.parameters.delay or 0)!r}")
    for k, source in enumerate(scene.sources.values()):
        points = " ".join(f"{t!r} {u!r}" for t, u in corners(source.value, scene.t_end) or [])
        if source.is_effort:
            cards += [f"V{k} s{k} 0 PWL({points})", f"RG{k} s{k} {source.at} {float(source.resistance or 0)!r}"]
        else:
            cards.append(f"I{k} 0 {source.at} PWL({points})")
    for k, load in enumerate(scene.loads.values()):
        if isinstance(load, Resistor):
            cards.append(f"RL{k} {load.at} 0 {float(load.resistance)!r}")
        elif isinstance(load, Series | Parallel):
            cards += _elements(load, k)
    probed = " ".join(f"v({probe.at})" for probe in scene.probes.values())
    cards += [f".save {probed}", ".options acct", f".tran {longest!r} {float(scene.t_end)!r} 0 {longest!r} uic", ".end"]
    return "\n".join(cards) + "\n"


def _elements(load: Series | Parallel, k: int) -> list[str]:
    given = [("R", load.resistance), ("L", load.inductance), ("C", load.capacitance)]
    parts = [(letter, float(value)) for letter, value in given if value is not None]
    if isinstance(load, Parallel):
        return [f"{letter}P{k} {load.at} 0 {value!r}" for letter, value in parts]
    nodes = [load.at, *(f"x{k}_{n}" for n in range(1, len(parts))), "0"]
    return [f"{letter}S{k} {i} {j} {value!r}" for (letter, value), i, j in zip(parts, nodes, nodes[1:], strict=False)]


def run(scene: Scene, n: int) -> Run:
    """A run with steps no longer than an n-th of the shortest delay.

    Raises
    ------
    InputError
        It fails, or takes too long.
    """
    shortest = min(float(line.parameters.delay or 0) for line in scene.lines.values())
    with tempfile.TemporaryDirectory() as folder:
        deck, raw = Path(folder, "scene.cir"), Path(folder, "scene.raw")
        deck.write_text(netlist(scene, shortest / n), encoding="utf-8")
        begun = time.perf_counter()
        call = ["ngspice", "-b", "-r", str(raw), str(deck)]
        try:
            said = subprocess.run(call, capture_output=True, text=True, timeout=PATIENCE, check=False).stdout
        except subprocess.TimeoutExpired:
            raise InputError("ngspice", f"not done within {PATIENCE:g} s") from None
        first = time.perf_counter() - begun
        figure = re.search(r"Transient analysis time = ([0-9.]+)", said)
        if figure is None or not raw.exists():
            raise InputError("ngspice", "gave no result")
        columns = columns_of(raw.read_bytes())
    u = {name: columns[f"v({str(probe.at).lower()})"] for name, probe in scene.probes.items()}
    return Run(columns["time"], u, max(float(figure[1]), HALF_TICK), first)


def columns_of(content: bytes) -> dict[str, NDArray]:
    """Variables of a binary raw file by name."""
    head, data = content.split(b"Binary:\n", 1)
    names = re.findall(r"^\t\d+\t(\S+)\t", head.decode(), re.MULTILINE)
    return dict(zip(names, np.frombuffer(data).reshape(-1, len(names)).T, strict=True))
