"""What a scene answers in s to what its sources hold and drive at its nodes."""

import numpy as np
from numpy.typing import NDArray

from tline.solver.stability.scattering import Scattering

CHUNK = 2e6  # complex entries held at once


def answers(
    network: Scattering, s: NDArray, held: NDArray, flows: NDArray, late: NDArray | float = 0.0
) -> tuple[NDArray, NDArray]:
    """Waves that arrive at the ends of lines, and efforts of the nodes.

    Parameters
    ----------
    network : Scattering
    s : ndarray of complex, shape (n,)
        In the unit of the network.
    held, flows : ndarray, shape (nodes,) or (n, nodes)
        Efforts that sources hold, and flows that they drive.
    late : ndarray of complex, shape (n, lines), optional
        What delays are beyond sT.

    Returns
    -------
    ndarray of complex, shape (n, ends)
    ndarray of complex, shape (n, nodes)
    """
    number = int(len(s) * network.size**2 / CHUNK) + 1
    nodes, lines = ((len(s), len(each)) for each in (network.names, network.delays))
    given = (np.broadcast_to(each, shape) for each, shape in ((held, nodes), (flows, nodes), (late, lines)))
    parts = zip(*(np.array_split(each, number) for each in (s, *given)), strict=True)
    arriving, efforts = zip(*(_answers(network, *part) for part in parts), strict=True)
    return np.concatenate(arriving), np.concatenate(efforts)


def _answers(network: Scattering, s: NDArray, held: NDArray, flows: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
    responses = list(network.answered(network.balances(s)))
    efforts, sent = np.empty((len(s), len(network.names)), complex), np.zeros((len(s), network.size), complex)
    for nodes, p, W in responses:
        efforts[:, nodes] = (W @ (held[:, nodes] + p * flows[:, nodes])[:, :, None])[:, :, 0]
        for node in nodes:
            sent[:, network.ends[node]] = 2 * efforts[:, node, None]
    across, back = network.carried(s, late)
    coming = (across * sent)[:, np.arange(network.size) ^ 1] + back * sent
    arriving = np.linalg.solve(np.eye(network.size) - network.sent_back(across, back, responses), coming[:, :, None])[
        :, :, 0
    ]
    for nodes, p, W in responses:
        into = [(arriving[:, ends] / network.z0[ends // 2]).sum(axis=1) for ends in (network.ends[k] for k in nodes)]
        efforts[:, nodes] += (W @ (p * np.stack(into, axis=1))[:, :, None])[:, :, 0]
    return arriving, efforts
