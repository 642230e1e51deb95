"""Transfer functions from a source to all probes of a scene, at any complex s."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.stability.lossy_line import inside
from tline.solver.stability.scattering import Scattering, answers
from tline.words.wording import nearest, place


@dataclass(frozen=True, eq=False)
class Response:
    """Effort, flow and waves at one probe per unit of the source, each of the shape of s."""

    u: NDArray
    y: NDArray
    a: NDArray
    b: NDArray


def respond(scene: Scene, s: ArrayLike, source: str | None = None) -> dict[str, Response]:
    """Transfer functions from one source of a scene to its probes.

    All other sources are silent: only their resistances count. Switches stand as they do after they have moved.

    Parameters
    ----------
    scene : Scene
        Linear lines between linear nodes.
    s : array_like of complex
        Laplace variable, 1/s; ``2j*pi*f`` for a frequency f in Hz. Any shape.
    source : str, optional
        Name of the source; not needed if there is one only.

    Returns
    -------
    dict of str to Response
        By probe. Units: of the probe's quantity over that of the source.

    Raises
    ------
    InputError
        The source is not named and there are several or none, or s is not finite.

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, chapters 2 and 4.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ... )
    >>> bool(abs(respond(scene, 2j * np.pi * 0.25e9)["far"].u + 1j) < 1e-12)  # open end, a quarter wave: delayed by it
    True
    """
    s = np.asarray(s, complex)
    if not np.isfinite(s).all():
        raise InputError("s", "not finite", "finite complex numbers", f"{s.ravel()[~np.isfinite(s.ravel())][0]}")
    name = source_named(scene, source)
    given, network = scene.sources[name], Scattering(describe(scene))
    held, flows = np.zeros(len(network.names)), np.zeros(len(network.names))
    if given.is_effort and given.nodes is not None:
        held[network.names.index(place("sources", name))] = 1.0  # behind which its branch stands
    elif np.isinf(given.conductance):
        held[network.names.index(given.terminals[0])] = 1.0
    else:
        for node, sign in zip(given.terminals, (1.0, -1.0), strict=True):
            if node is not None:
                flows[network.names.index(node)] = sign * (given.conductance if given.is_effort else 1.0)
    arriving, efforts = answers(network, s.ravel() * network.second, held, flows)
    return {probe: _seen(scene, network, probe, arriving, efforts, s) for probe in scene.probes}


def _seen(scene: Scene, network: Scattering, probe: str, arriving: NDArray, efforts: NDArray, s: NDArray) -> Response:
    """What a probe sees: the two waves on its line, each delayed by its way."""
    line = scene.probed_line(probe)
    if line is None:
        u = efforts[:, network.names.index(scene.probes[probe].at or "")].reshape(s.shape)
        return Response(u, 0 * u, u, u)
    k, share = list(scene.lines).index(line), scene.probes[probe].fraction(scene.lines[line])
    nodes = [network.names.index(node) for node in scene.lines[line].nodes]
    (b1, a2), (u1, u2) = arriving[:, 2 * k : 2 * k + 2].T, efforts[:, nodes].T
    if share in (0.0, 1.0):
        a, b = (2 * u1 - b1, b1) if share == 0.0 else (a2, 2 * u2 - a2)
    elif k in network.lossy:
        u, y = inside(network.lossy[k], s.ravel(), share, u1, u2)
        a, b = u + network.z0[k] * y, u - network.z0[k] * y
    else:
        way = s.ravel() * network.second * network.delays[k]
        a, b = (2 * u1 - b1) * np.exp(-way * share), (2 * u2 - a2) * np.exp(-way * (1 - share))
    parts = ((a + b) / 2, (a - b) / (2 * network.z0[k]), a, b)
    return Response(*(part.reshape(s.shape) for part in parts))


def source_named(scene: Scene, name: str | None) -> str:
    """The name, or that of the only source.

    Raises
    ------
    InputError
        There is no such source, or several and none is named.
    """
    sources = {key: each for key, each in scene.sources.items() if ("sources", key) not in scene.parts}
    if name is None:
        if len(sources) != 1:
            problem = "there is no source" if not sources else "there are several, and none is named"
            raise InputError("source", problem, nearest("", list(sources)) if sources else "a source in the scene")
        return next(iter(sources))
    if name not in sources:
        raise InputError("source", "no such source", nearest(name, list(sources)), f"'{name}'")
    return name
