"""S-parameters and impedances seen at nodes of a scene."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.stability.scattering import Scattering, answers
from tline.units import to_si
from tline.words.wording import nearest, shown


def scattering_parameters(
    scene: Scene, ports: Sequence[str], s: ArrayLike, z0: float | str | Sequence[float | str] = 50.0
) -> NDArray:
    """S-parameters of a scene between nodes and the reference.

    Sources at the ports are taken away with their resistances; all others are silent.

    Parameters
    ----------
    scene : Scene
    ports : sequence of str
        Nodes, p of them.
    s : array_like of complex, shape (n,)
        Laplace variable, 1/s.
    z0 : float or str, or one for each port
        Reference resistance, above zero, ohm or Pa s/m³.

    Returns
    -------
    ndarray of complex, shape (n, p, p)
        S[:, i, j]: the power wave out of port i per power wave into port j.

    Raises
    ------
    InputError
        A port is no node, is named twice, or its effort is held by a load; or a bad z0.

    References
    ----------
    K. Kurokawa, "Power waves and the scattering matrix", IEEE Trans. Microwave Theory and Techniques 13 (1965) 194-202,
    doi:10.1109/TMTT.1965.1125964.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "a"}},
    ...     lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    ... )
    >>> abs(scattering_parameters(scene, ["a", "b"], [2j * np.pi * 1e8])[0]).round(9)
    array([[0., 1.],
           [1., 0.]])
    """
    R = _references(ports, z0)
    bare = _without_sources(scene, ports)
    network = Scattering(describe(bare), dict(zip(ports, 1 / R, strict=True)))
    at = _indices(network, ports)
    points = np.asarray(s, complex) * network.second
    S = np.empty((len(points), len(ports), len(ports)), complex)
    for j, node in enumerate(at):
        flows = np.zeros(len(network.names))
        flows[node] = 2 / np.sqrt(R[j])  # a unit power wave: 2 sqrt(R) behind R
        _, efforts = answers(network, points, np.zeros(len(network.names)), flows)
        S[:, :, j] = efforts[:, at] / np.sqrt(R) - np.eye(len(ports))[j]
    return S


def impedance(scene: Scene, node: str, s: ArrayLike) -> NDArray:
    """Impedance between a node and the reference, of all that is attached there but sources; shape of s.

    Raises
    ------
    InputError
        As `scattering_parameters`.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "a"}},
    ...     lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    ...     loads={"end": {"at": "b", "kind": "resistor", "resistance": 100}},
    ... )
    >>> impedance(scene, "a", [2j * np.pi * 0.25e9])[0].real.round(9)  # a quarter wave inverts: 50²/100
    np.float64(25.0)
    """
    s = np.asarray(s, complex)
    lines = [line for line in scene.lines.values() if node in line.nodes]
    reference = lines[0].parameters.z0 if lines else 1.0
    h = scattering_parameters(scene, [node], s.ravel(), reference)[:, 0, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        z = reference * (1 + h) / (1 - h)
    return np.where(h == 1, np.inf, z).reshape(s.shape)


def _references(ports: Sequence[str], z0: float | str | Sequence[float | str]) -> NDArray:
    each = [z0] * len(ports) if isinstance(z0, str | float | int) else list(z0)
    if len(each) != len(ports):
        raise InputError("z0", "not one for each port", str(len(ports)), str(len(each)))
    R = np.array([to_si(given, None, "z0") for given in each], float)
    for value, given in zip(R, each, strict=True):
        if not 0 < value < np.inf:
            raise InputError("z0", "not positive", "more than 0", shown(given))
    return R


def _without_sources(scene: Scene, ports: Sequence[str]) -> Scene:
    kept = {name: source for name, source in scene.table().get("sources", {}).items() if source.get("at") not in ports}
    return scene.with_changes(sources=kept)


def _indices(network: Scattering, ports: Sequence[str]) -> list[int]:
    if not ports:
        raise InputError("ports", "none is named", "nodes of the scene")
    for k, port in enumerate(ports):
        if port not in network.names:
            raise InputError("ports", "no such node", nearest(port, network.names), f"'{port}'")
        if port in ports[:k]:
            raise InputError("ports", "named twice", "each node once", f"'{port}'")
        if network.held[network.names.index(port)]:
            raise InputError("ports", "a load or switch holds the effort there", "another node", f"'{port}'")
    return [network.names.index(port) for port in ports]
