"""Scene in ngspice: T and O elements, sources of straight pieces, the largest step refined."""

import re
import shutil
import subprocess
import tempfile
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.interchange.netlist_text import spice_text
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.study.charts.measure import TimedRun
from tline.study.reference.network import decimal, level, straight

HALF_TICK = 5e-4  # s; ngspice counts time in milliseconds
PATIENCE = 60.0  # s, after which the program is stopped


def incompatibility(scene: Scene) -> str | None:
    """Reason why ngspice is not applicable to a scene; None if it is."""
    if shutil.which("ngspice") is None:
        return "not installed: apt install ngspice"
    if scene.medium != "electrical":
        return "for cables only"
    return incompatible_sources(scene)


def incompatible_sources(scene: Scene) -> str | None:
    """Reason why PWL sources cannot drive a scene; None if they can."""
    if any(corners(source.value, scene.t_end) is None for source in scene.sources.values()):
        return "a PWL source neither jumps nor curves"
    return None


def corners(waveform: Shape, t_end: float) -> list[tuple[float, float]] | None:
    """Corners of a waveform of straight pieces without jumps, and its points at the start and the end."""
    pieces, end = straight(waveform, decimal(t_end)), decimal(t_end)
    if pieces is None:
        return None
    instants = [start for start, *_ in pieces if start is not None and 0 < start < end]
    after = [first for start, first, _ in pieces if start is not None and 0 < start < end]
    if any(level(pieces, t) != first for t, first in zip(instants, after, strict=True)):
        return None
    return [(0.0, float(level(pieces, Fraction(0)))), *((float(t), float(level(pieces, t))) for t in (*instants, end))]


def netlist(scene: Scene, longest: float) -> str:
    """Format the scene in SPICE, with a largest step in s."""
    cards, tran, end = spice_text(scene, step=longest).rpartition("\n.tran")
    return f"{cards}\n.options acct{tran}{end}"


def run(scene: Scene, n: int) -> TimedRun:
    """Run with steps no longer than an n-th of the shortest delay."""
    shortest = min(float(line.parameters.delay or 0) for line in scene.lines.values())
    columns, stepping, seconds = transient(netlist(scene, shortest / n))
    u = {name: columns[f"v({str(probe.at).lower()})"] for name, probe in scene.probes.items()}
    return TimedRun(columns["time"], u, max(stepping, HALF_TICK), seconds)


def transient(text: str) -> tuple[dict[str, NDArray], float, float]:
    """Run a netlist with ``.options acct``; return the saved variables, and the seconds of the transient and of all."""
    with tempfile.TemporaryDirectory() as folder:
        deck, raw = Path(folder, "scene.cir"), Path(folder, "scene.raw")
        deck.write_text(text, encoding="utf-8")
        begun = time.perf_counter()
        call = ["ngspice", "-b", "-r", str(raw), str(deck)]
        try:
            said = subprocess.run(call, capture_output=True, text=True, timeout=PATIENCE, check=False).stdout
        except subprocess.TimeoutExpired:
            raise InputError("ngspice", f"not done within {PATIENCE:g} s") from None
        seconds = time.perf_counter() - begun
        figure = re.search(r"Transient analysis time = ([0-9.]+)", said)
        if figure is None or not raw.exists():
            raise InputError("ngspice", "gave no result")
        return columns_of(raw.read_bytes()), float(figure[1]), seconds


def columns_of(content: bytes) -> dict[str, NDArray]:
    """Parse the variables of a binary raw file by name."""
    head, data = content.split(b"Binary:\n", 1)
    names = re.findall(r"^\t\d+\t(\S+)\t", head.decode(), re.MULTILINE)
    return dict(zip(names, np.frombuffer(data).reshape(-1, len(names)).T, strict=True))
