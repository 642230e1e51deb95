"""A pipe in rthym-moc: one reservoir, one demand, friction as small as it allows."""

import time
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from tline.charts.clock import Run
from tline.charts.ngspice import corners
from tline.scene.scene import Scene

FOOT, G, DENSITY = 0.3048, 9.80665, 1000.0  # m, m/s², kg/m³
GPM = 3.785411784e-3 / 60  # m³/s
HEAD = 5000.0  # ft; high enough that nothing boils
SMOOTH = 1e9  # Hazen-Williams C; its friction cannot be switched off


def misfit(scene: Scene) -> str | None:
    """Why it cannot do a scene; None if it can."""
    if scene.medium != "hydraulic":
        return "for water only"
    return None if find_spec("rthym_moc") else "not installed: pip install 'tline[peers]'"


def run(scene: Scene, n: int) -> Run:
    """A run of n reaches; heads count from that of the reservoir."""
    rthym_moc: Any = import_module("rthym_moc")
    (line,), (draw,) = scene.lines.values(), scene.sources.values()
    pipe: Any = line.parameters
    solver, far = rthym_moc.MOCSolver(), str(draw.at)
    for name, kind in (("tank", "PressureBoundary"), (far, "Junction")):
        solver.add_node(_filled(rthym_moc.NodeInput(), id=name, type=kind, head=HEAD))
    size = {"length": pipe.length / FOOT, "diameter": 2 * pipe.radius / FOOT * 12, "roughness": SMOOTH}
    solver.add_pipe(_filled(rthym_moc.PipeInput(), id="pipe", from_node="tank", to_node=far, flow_gpm=0.0, **size))
    solver.set_demand_schedule(far, [(t, -flow / GPM) for t, flow in corners(draw.value, scene.t_end) or []])
    dt = pipe.delay / n
    begun = time.perf_counter()
    # a time constant of one step switches its unsteady friction off
    result = solver.run(total_time=scene.t_end, dt=dt, p_vapor_psi=-1e9, usf_tau=dt, k_bru=0.0)
    seconds = time.perf_counter() - begun
    u = (np.array(result["node_head"][far]) - HEAD) * FOOT * DENSITY * G
    return Run(np.array(result["time"]), dict.fromkeys(scene.probes, u), seconds, seconds)


def _filled(record: Any, **fields: Any) -> Any:
    for name, value in fields.items():
        setattr(record, name, value)
    return record
