"""The steady state of a scene against the heads that EPANET finds for the network."""

from collections.abc import Iterator

from tline.errors import InputError
from tline.interchange.water_network import LISTED, WaterNetwork
from tline.scene.scene import Scene
from tline.scene.site import GRAVITY
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state

ACCURATE, RELATIVE = 1e-3, 1e-5  # m, and share of the head: what EPANET's own solution is good for


def differences(network: WaterNetwork, scene: Scene) -> Iterator[str]:
    """Notes on what of the scene's steady state differs from the network's.

    Parameters
    ----------
    network : WaterNetwork
    scene : Scene
        What was made of it.

    Returns
    -------
    iterator of str
        A note that lists the nodes with the largest differences, or one that says why there is no steady state.
    """
    weight = network.density * GRAVITY
    try:
        effort, _ = steady_state(describe(scene))
    except InputError as error:
        yield f"the scene has no steady state of its own: {error}"
        return
    off = {name: effort[name] / weight - node.head for name, node in network.nodes.items() if name in effort}
    bad = {name: by for name, by in off.items() if abs(by) > ACCURATE + RELATIVE * abs(network.nodes[name].head)}
    if bad:
        worst = sorted(bad, key=lambda name: -abs(bad[name]))
        listed = ", ".join(f"'{name}' by {bad[name]:+.3g} m" for name in worst[:LISTED])
        more = f" and {len(bad) - LISTED} more" * (len(bad) > LISTED)
        yield f"the steady state of the scene differs from EPANET's heads: {listed}{more}"
