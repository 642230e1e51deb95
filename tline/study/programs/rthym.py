"""Pipes in rthym-moc: held pressures and demands, from a given steady state.

It turns the Hazen-Williams C of a pipe into a Darcy factor, at the pipe's initial flow, and keeps that
factor; so a C is found that gives the factor of the scene. Friction cannot be switched off: without an initial
flow the factor is 0.02, for any C. Its instants are one step late, and are taken as one step earlier.
"""

import time
from importlib import import_module
from importlib.util import find_spec
from math import pi
from typing import Any

import numpy as np

from tline.scene.friction import FOOT, darcy
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import rest, steady_state
from tline.study.charts.measure import TimedRun
from tline.study.programs.ngspice import corners

DENSITY = 1000.0  # kg/m³
HEAD = 5000.0  # ft; high enough that nothing boils
SMOOTH = 1e9  # Hazen-Williams C


def incompatibility(scene: Scene) -> str | None:
    """Reason why rthym-moc is not applicable to a scene; None if it is."""
    if scene.medium != "hydraulic":
        return "for water only"
    return None if find_spec("rthym_moc") else "not installed: pip install 'tline[peers]'"


def run(scene: Scene, n: int) -> TimedRun:
    """Run n reaches in the shortest pipe; heads count from that of the reservoir."""
    moc: Any = import_module("rthym_moc")
    unit = moc.GPM_TO_CFS * FOOT**3  # of flow, m³/s, as it has it
    head = DENSITY * moc.G_FT_S2 * FOOT**2  # of a foot, Pa, as it has it
    description = describe(scene)
    efforts, flows = steady_state(description) if description.steady else rest(description)[:2]
    solver = moc.MOCSolver()
    for name, node in description.nodes.items():
        kind = "PressureBoundary" if node.held else "Junction"
        solver.add_node(_filled(moc.NodeInput(), id=name, type=kind, head=HEAD + efforts[name] / head))
    for (name, line), flow in zip(scene.single_lines.items(), flows[:, 0].tolist(), strict=True):
        pipe: Any = line.parameters
        size = {"length": pipe.length / FOOT, "diameter": 2 * pipe.radius / FOOT * 12, "flow_gpm": flow / unit}
        factor = line.losses.quadratic / darcy(1.0, DENSITY, pipe.area) if line.losses else 0.0
        ends = dict(zip(("from_node", "to_node"), line.nodes, strict=True))
        solver.add_pipe(_filled(moc.PipeInput(), id=name, roughness=roughness(factor, moc=moc, **size), **ends, **size))
    for draw in scene.sources.values():
        demand = [(t, -flow / unit) for t, flow in corners(draw.value, scene.t_end) or []]
        solver.set_demand_schedule(str(draw.at), demand)
    dt = min(line.parameters.delay or 0.0 for line in scene.single_lines.values()) / n
    begun = time.process_time()
    # a time constant of one step switches its unsteady friction off
    result = solver.run(total_time=scene.t_end, dt=dt, p_vapor_psi=-1e9, usf_tau=dt, k_bru=0.0)
    seconds = time.process_time() - begun
    heads = {name: np.array(result["node_head"][str(probe.at)], float) for name, probe in scene.probes.items()}
    u = {name: (heads[name] - HEAD) * head for name in heads}
    return TimedRun(np.array(result["time"]) - dt, u, seconds, seconds)


def roughness(factor: float, length: float, diameter: float, flow_gpm: float, moc: Any) -> float:
    """Hazen-Williams C that gives a Darcy factor in rthym-moc; length in ft, diameter in inches.

    The program's head loss is 10.44 L Q^1.852/(C^1.852 d^4.871), and the factor that of f L v²/(2 g D).
    """
    if not factor * flow_gpm:
        return SMOOTH
    speed = flow_gpm * moc.GPM_TO_CFS / (pi / 4 * (diameter / 12) ** 2)
    lost = factor * length / (diameter / 12) * speed**2 / (2 * moc.G_FT_S2)
    return (10.44 * length * abs(flow_gpm) ** 1.852 / (lost * diameter**4.871)) ** (1 / 1.852)


def _filled(record: Any, **fields: Any) -> Any:
    for name, value in fields.items():
        setattr(record, name, value)
    return record
