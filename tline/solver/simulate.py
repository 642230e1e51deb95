"""Run a scene: assemble it, step the kernel in chunks, and hand back what the probes saw."""

import warnings
from collections.abc import Iterable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.errors import ActiveError, InputError
from tline.scene.mistakes import nearest
from tline.scene.scene import Scene
from tline.solver.assemble import Assembly, assemble
from tline.solver.march import march
from tline.solver.remarks import ringing, unconnected, untouched
from tline.solver.result import LineRecord, ProbeResult, Result, Wave
from tline.solver.stability.growth import active_loads, growth_sentence

LARGEST_RECORD = 4e8  # samples


class UnresolvedWarning(UserWarning):
    """Something in the scene is faster than the slabs can follow."""


def simulate(scene: Scene, *, record: Iterable[str] = (), active: bool = False, progress: bool = False) -> Result:
    """Simulate a scene from t = 0 to its end time.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    record : iterable of str
        Lines whose end waves are kept in addition to those of the probes.
    active : bool
        Run even with a load that is not positive real. What it does to the scene is then the first of the notes.
    progress : bool
        Show a progress bar on stderr if the run takes more than two seconds.

    Returns
    -------
    Result
        Probes, recorded lines, and how it was computed.

    Raises
    ------
    ActiveError
        A load is refuted to be positive real, and `active` is not set. Says whether the waves grow, and how fast.
    InputError
        The scene cannot be assembled, or an active load drove the waves beyond all bounds.

    Warns
    -----
    UnresolvedWarning
        A load or waveform is faster than the slabs can follow. ``Result.notes`` has these and other remarks.

    References
    ----------
    docs/theory.md has the scheme and the proof that it cannot create energy.
    """
    warned = _active(scene, active)
    kept = {*record, *_probed(scene)}
    for name in sorted(kept - scene.lines.keys()):
        raise InputError("record", "no such line", nearest(name, list(scene.lines)), f"'{name}'")
    assembly = assemble(scene, kept)
    h, s = assembly.resolution.h, assembly.resolution.s
    n = max(ceil(scene.t_end / h - 1e-9), 1)
    if 4 * len(kept) * n * s > LARGEST_RECORD:
        problem = f"recording {len(kept)} lines over {n} slabs of order {s} needs {4 * len(kept) * n * s:.2g} samples"
        raise InputError("probes", problem, f"at most {LARGEST_RECORD:.0e}: fewer probes or a shorter run")
    waves, seconds = march(assembly, n, progress=progress)
    lines = {name: _record(assembly, name, waves) for name in assembly.recorded}
    ends = np.arange(n + 1) * h
    probes = {}
    for name, probe in scene.probes.items():
        line = probe.line or next(iter(_lines_at(scene, probe.at)))
        probes[name] = ProbeResult(name, line, probe.fraction(scene.lines[line]), lines[line], ends)
    unresolved = (*assembly.resolution.notes, *ringing(probes))
    for note in unresolved:
        warnings.warn(note, UnresolvedWarning, stacklevel=2)
    notes = (*warned, *unresolved, *untouched(probes), *unconnected(scene))
    return Result(scene, ends, probes, lines, assembly.resolution, notes, 2 * len(scene.lines) * n * s, seconds)


def _active(scene: Scene, allowed: bool) -> list[str]:
    """What there is to say of active loads, if they are allowed."""
    loads = active_loads(scene)
    if not loads:
        return []
    problem = growth_sentence(scene, loads)
    if not allowed:
        raise ActiveError("", problem, "passive loads, or active=True to run it all the same")
    return [problem]


def _lines_at(scene: Scene, node: str | None) -> Iterable[str]:
    return (name for name, line in scene.lines.items() if node in line.nodes)


def _probed(scene: Scene) -> set[str]:
    return {probe.line or next(iter(_lines_at(scene, probe.at))) for probe in scene.probes.values()}


def _record(assembly: Assembly, name: str, waves: NDArray) -> LineRecord:
    row, (a, b) = assembly.recorded[name], assembly.start[name]
    parameters = assembly.scene.lines[name].parameters
    s, h = assembly.resolution.s, assembly.resolution.h

    def wave(values: NDArray, before: float) -> Wave:
        return Wave(values.reshape(-1, s), before, assembly.basis, h)

    (b1, a1), (a2, b2) = waves[row], waves[row + 1]
    return LineRecord(parameters.z0, parameters.delay or 0.0, wave(a1, a), wave(b1, b), wave(a2, a), wave(b2, b))
