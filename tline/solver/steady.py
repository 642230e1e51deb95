"""The steady state that constant sources imply: one effort on all lines that hang together, and a flow in each.

A lossless line keeps effort and flow the same at both ends. The effort of a connected part follows from the
sum of what its sources drive and its loads take. Where lines form loops, or several ideal efforts share a
part, the flows are not unique; taken is the one that a slow rise from rest leads to: no net inertia round any
loop, so that flow = difference of a potential over z0·T of the line.
"""

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.drive import just_before
from tline.solver.nodes import Node


def steady_state(scene: Scene, nodes: dict[str, Node]) -> tuple[NDArray, NDArray]:
    """Effort and flow of each line, immediately before t = 0, shapes (lines,).

    Raises
    ------
    InputError
        If there is none: different ideal efforts on connected lines, or a flow that nothing takes.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import spsolve

    number = {name: k for k, name in enumerate(nodes)}
    first, second = np.array([[number[node] for node in line.nodes] for line in scene.lines.values()]).T
    inertance = np.array([line.parameters.z0 * (line.parameters.delay or 0.0) for line in scene.lines.values()])
    n = len(nodes)
    _, part = connected_components(coo_array((np.ones(len(first)), (first, second)), shape=(n, n)), directed=False)
    effort, flow_in, tie = _node_balances(nodes, part)
    stiffness = 1 / inertance
    rows, columns = (
        np.concatenate([first, second, first, second]),
        np.concatenate([first, second, second, first]),
    )
    entries = np.concatenate([stiffness, stiffness, -stiffness, -stiffness])
    laplacian = coo_array((entries, (rows, columns)), shape=(n, n)).tocsr()
    free = tie < np.inf
    laplacian = laplacian + coo_array((np.where(free, tie, 0.0), (np.arange(n), np.arange(n))), shape=(n, n)).tocsr()
    potential = np.zeros(n)
    if free.any():
        potential[free] = np.ravel(np.asarray(spsolve(laplacian[free][:, free].tocsc(), flow_in[free])))
    return effort[first], stiffness * (potential[first] - potential[second])


def _node_balances(nodes: dict[str, Node], part: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Effort, flow into the lines, and tie to the reference (infinite: ideal) of each node."""
    n = len(nodes)
    given, conductance, driven, tie = np.full(n, np.nan), np.zeros(n), np.zeros(n), np.zeros(n)
    for k, node in enumerate(nodes.values()):
        driven[k], conductance[k] = node.flow_before(), node.conductance
        switched = node.switched(0.0)
        if node.held is not None:
            given[k], tie[k] = just_before(node.held), np.inf
            continue
        if switched == np.inf:
            given[k], tie[k] = 0.0, np.inf
            continue
        conductance[k] += switched
        if node.load is not None:
            resistance = float(node.load.at_zero())
            if resistance == 0:  # an inductor: at rest a short, with its inertia beside those of the lines
                given[k], tie[k] = 0.0, 1 / float(node.load.numerator[-2] / node.load.denominator[-1])
            else:
                conductance[k] += 1 / resistance
    names, effort = list(nodes), np.zeros(n)
    for one in np.unique(part):
        members = part == one
        held = members & ~np.isnan(given)
        level = _common_effort(names, members, held, given, conductance, driven)
        effort[members] = level
        if not held.any():
            tie[np.argmax(members)] = np.inf  # the potential's zero, anywhere
    return effort, driven - conductance * effort, tie


def _common_effort(
    names: list[str], members: NDArray, held: NDArray, given: NDArray, conductance: NDArray, driven: NDArray
) -> float:
    """The effort of one connected part."""
    if held.any():
        low, high = given[held].min(), given[held].max()
        if high - low > 1e-9 * max(abs(low), abs(high)):
            lowest, highest = (names[np.argmax(held & (given == level))] for level in (low, high))
            raise InputError(
                f"nodes '{lowest}' and '{highest}'",
                "no steady state: lossless lines join different ideal efforts",
                got=f"{low:g} and {high:g}",
            )
        return float(given[held][0])
    total, flow = conductance[members].sum(), driven[members].sum()
    if total == 0 and abs(flow) > 1e-12 * np.abs(driven[members]).sum():
        raise InputError(
            f"node '{names[np.argmax(members & (driven != 0))]}'",
            "no steady state: nothing takes the flow",
            got=f"{flow:g}",
        )
    return float(flow / total) if total else 0.0
