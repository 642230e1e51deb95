"""Copies before t = 0: at rest, or in the steady state that constant sources imply.

Lossless lines join nodes to parts with one effort each. One that is held is known; else a part is a Thévenin source to
the one element at it, whose law answers at once. Flows are those of a slow rise from rest, as in
`tline.solver.steady.steady_state`.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.groups import parts
from tline.solver.kernel.network import Crossing
from tline.solver.kernel.units import law_addresses
from tline.solver.many.nodes import WHAT, LawOfCopies, NodeOfCopies, value_before
from tline.solver.steady.steady_state import SAME_EFFORT

Floats = NDArray[np.float64]


def before(description: Description, junctions: Sequence[NodeOfCopies], z0: Floats, delays: Floats) -> Floats:
    """Efforts at line ends, counted from the level, and waves that arrive there, shape (2, 2 L, N)."""
    lines, count = z0.shape
    start = np.zeros((2, 2 * lines, count))
    if not description.steady:
        return start
    at = np.empty(2 * lines, int)
    for k, junction in enumerate(junctions):
        at[junction.ends] = k
    first, second = at[::2], at[1::2]
    part = parts(first, second, len(junctions))
    effort, flow_in = np.zeros((2, len(junctions), count))
    fixed: list[int] = []
    for number in range(part.max() + 1):
        here = np.flatnonzero(part == number).tolist()
        held = [k for k in here if junctions[k].conductance is None]
        effort[here], flow_in[here] = _at_part([junctions[k] for k in here], count)
        fixed += held or [here[0]]
    arriving = z0 * _along(first, second, 1 / (z0 * delays), flow_in, fixed)
    for side, node, sign in ((0, first, -1.0), (1, second, 1.0)):
        start[0, side::2] = effort[node]
        start[1, side::2] = effort[node] + sign * arriving
    return start


def _at_part(junctions: list[NodeOfCopies], count: int) -> tuple[Floats, Floats]:
    """Effort of nodes joined by lossless lines, (copies,), and the flow from each into its lines."""
    zero = np.zeros(count)
    waves = [sum((share * value_before(shape) for shape, share in each.drives), zero) for each in junctions]
    held = [wave for each, wave in zip(junctions, waves, strict=True) if each.conductance is None]
    conducted = [zero if each.conductance is None else each.conductance for each in junctions]
    pairs = zip(junctions, waves, strict=True)
    driven = [zero if each.conductance is None else wave / each.impedance for each, wave in pairs]
    if held:
        u, z = held[0], zero
        if any((np.abs(other - u) > SAME_EFFORT * np.maximum(np.abs(other), np.abs(u))).any() for other in held):
            raise InputError("start", "its lines join different efforts", WHAT)
    else:
        total = np.sum(conducted, axis=0)
        if sum(each.law is not None for each in junctions) > 1 or not (total > 0).all():
            raise InputError("start", "its steady state is that of several elements, or of none that conducts", WHAT)
        u, z = np.sum(driven, axis=0) / total, 1 / total
    flows = [zero if each.law is None else _through(each.law, u, z) for each in junctions]
    u = u - z * np.sum(flows, axis=0)
    return u, np.array(driven) - np.array(conducted) * u - np.array(flows)


def _through(law: LawOfCopies, v: Floats, z: Floats) -> Floats:
    """Flow out of a node through an element, behind an effort and an impedance."""
    from tline.solver.kernel.laws.through import Through, through

    across = law.sign * (v - (0.0 if law.beyond is None else value_before(law.beyond)))
    control, flow, slope = np.empty((3, len(v)))
    control[:] = value_before(law.control)
    at = law.constants.shape[1] * np.arange(len(v))
    crossing = Crossing(law.constants.ravel(), *np.empty((4, 1)))
    unit = np.full(len(v), law_addresses([law.unit])[0])
    through(pack(Through(unit, at, control, across, z, flow, slope, crossing)))
    return law.sign * flow


def _along(first: NDArray, second: NDArray, stiffness: Floats, flow_in: Floats, fixed: list[int]) -> Floats:
    """Flows along lines (L, copies) that balance the inflow: differences of a potential, zero at fixed nodes."""
    n, count = flow_in.shape
    matrix, lines = np.zeros((n, n, count)), zip(first, second, stiffness, strict=True)
    for a, b, k in lines:
        matrix[a, a] += k
        matrix[b, b] += k
        matrix[a, b] -= k
        matrix[b, a] -= k
    free, potential = np.setdiff1d(np.arange(n), fixed), np.zeros((n, count))
    own = matrix[np.ix_(free, free)].transpose(2, 0, 1)
    potential[free] = np.linalg.solve(own, flow_in[free].T[..., None])[..., 0].T
    return stiffness * (potential[first] - potential[second])
