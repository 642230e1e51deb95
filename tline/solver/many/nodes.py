"""The nodes of a scene in many copies: shares of waves, drives, loads with a state, and laws, as arrays over copies."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.changed import parts_of
from tline.scene.law import NonLinear
from tline.scene.load import Matched
from tline.scene.rational import Parallel, Series
from tline.solver.description.given import Scene
from tline.solver.description.nodes import UNIT, Node, lowered
from tline.solver.many.elements import LawOfCopies, Varying, for_each, varying

Floats = NDArray[np.float64]
ELEMENTS = ("resistance", "inductance", "capacitance")


class Load(NamedTuple):
    """dx/dt = A x + b w, u = c x + d w, from a node's Thévenin wave to its effort; n states, the copies last."""

    A: Floats  # (n, n, copies)
    b: Floats  # (n, copies)
    c: Floats  # (n, copies)
    d: Floats  # (copies,)


def parallel(z: Floats, inductance: Floats | None, capacitance: Floats | None) -> Load:
    """L and C side by side, R being part of z.

    Impedances, H and F are positive, shape (copies,); states are u, and z times the inductor's flow.

    Examples
    --------
    >>> parallel(np.array([50.0]), None, np.array([2e-3])).A.tolist()  # -1/(z C)
    [[[-10.0]]]
    """
    zero, one = np.zeros_like(z), np.ones_like(z)
    back = zero if inductance is None else z / inductance
    if capacitance is None:
        return _stacked([[-back]], [back], [-one], one)
    rate = 1 / (z * capacitance)
    if inductance is None:
        return _stacked([[-rate]], [rate], [one], zero)
    return _stacked([[-rate, -rate], [back, zero]], [rate, zero], [one, zero], zero)


def series(z: Floats, resistance: Floats | float, inductance: Floats | None, capacitance: Floats | None) -> Load:
    """R, L and C one after the other; states are z times the flow, and the capacitor's effort.

    Examples
    --------
    >>> series(np.array([50.0]), 30.0, np.array([4.0]), None).A.tolist()  # -(R + z)/L
    [[[-20.0]]]
    """
    zero, one, total = np.zeros_like(z), np.ones_like(z), resistance + z
    if inductance is None:
        assert capacitance is not None
        rate = 1 / (total * capacitance)
        return _stacked([[-rate]], [rate], [z / total], 1 - z / total)
    rate, back = total / inductance, z / inductance
    if capacitance is None:
        return _stacked([[-rate]], [back], [-one], one)
    return _stacked([[-rate, -back], [1 / (z * capacitance), zero]], [back, zero], [-one, zero], one)


def _stacked(A: list[list[Floats]], b: list[Floats], c: list[Floats], d: Floats) -> Load:
    return Load(np.array(A), np.array(b), np.array(c), d)


class NodeOfCopies(NamedTuple):
    """A node in all copies."""

    ends: list[int]
    weights: Floats  # (ends, copies) share of an arriving wave in the Thévenin wave
    drives: list[tuple[Varying, Floats]]  # waveforms, and their shares (copies,) of the Thévenin wave
    load: Load | None = None  # None where nothing has a state
    law: LawOfCopies | None = None
    conductance: Floats | None = None  # (copies,) of all but lines; None where the effort is held
    impedance: Floats = np.empty(0)  # (copies,) behind the Thévenin wave; none where the effort is held


def junction_of(node: Node, z0: Floats, numbers: Mapping[str, Floats], scenes: Sequence[Scene]) -> NodeOfCopies:
    """A node in all copies, without its law; `numbers` are those of lines, sources and linear loads, by place."""
    own = 1 / z0[np.array(node.ends) // 2]
    if node.held is not None:
        held = node.held
        for where, source in node.sources.items():
            if source.is_effort and source.conductance == inf:
                held = _prescribed(where, scenes, node.height.level)
        return NodeOfCopies(node.ends, 0.0 * own, [(held, np.ones(z0.shape[1]))])
    total, to_air = np.zeros(z0.shape[1]), np.zeros(z0.shape[1])
    flows: list[tuple[Varying, Floats | float]] = []
    dynamic: tuple[Series | Parallel, Floats | None, Floats | None, Floats | None] | None = None
    for where, load in node.loads.items():
        if isinstance(load, NonLinear):
            continue
        R, L, C = (numbers.get(f"{where}.{element}") for element in ELEMENTS)
        if L is not None or C is not None:
            assert isinstance(load, Series | Parallel)
            dynamic = load, R, L, C
        if isinstance(load, Matched):
            to_air = to_air + own[0]
        elif R is not None and not (isinstance(load, Series) and dynamic and dynamic[0] is load):
            to_air = to_air + 1 / R
    for where, source in node.sources.items():
        R = numbers.get(f"{where}.resistance")
        conductance = 0.0 if R is None else 1 / R
        if source.is_effort:
            total = total + conductance
            flows.append((_prescribed(where, scenes, node.height.level), conductance))
        else:
            to_air = to_air + conductance
            flows.append((_prescribed(where, scenes, 0.0), 1.0))
    if node.above_level and np.any(to_air):
        flows.append((UNIT, node.above_level * to_air))
    conducted = total + to_air
    z = 1 / (own.sum(axis=0) + conducted)
    drives = [(waveform, factor * z) for waveform, factor in flows]
    found = NodeOfCopies(node.ends, own * z, drives, conductance=conducted, impedance=z)
    if dynamic is None:
        return found
    load, R, L, C = dynamic
    through = parallel(z, L, C) if isinstance(load, Parallel) else series(z, 0.0 if R is None else R, L, C)
    return found._replace(load=through)


def _prescribed(where: str, scenes: Sequence[Scene], level: float) -> Varying:
    """What a source prescribes in each copy, less the level."""
    sources = [scene.sources[parts_of(where)[1]] for scene in scenes]
    return varying(for_each(sources, lambda source: lowered(source.value, level)))
