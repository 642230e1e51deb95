"""State space of a scene with a Padé approximation of every delay."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, import_extra
from tline.scene.refuse import refuse_losses
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import node_of_end, weights_of

if TYPE_CHECKING:
    from control import StateSpace

HIGHEST = 12  # order; the coefficients of higher ones are too far apart for floats


def pade_state_space(scene: Scene, probe: str, quantity: str, order: int) -> "StateSpace":
    """State space from a source of final level 1, all others being silent, to u, y, a or b at a probe.

    Raises InputError: the order is out of range, or the scene has no state space with Padé delays.
    """
    control = import_extra("control", "python-control", "control", "state space")
    from scipy.linalg import block_diag

    if type(order) is not int or not 1 <= order <= HIGHEST:
        raise InputError("order", "not an order", f"a whole number from 1 to {HIGHEST}", f"{order}")
    refuse_losses(scene, "no state space with Padé delays")
    description = describe(scene)
    description.check_linear("a state space")
    description.refuse_coupled("a state space")
    groups, named = description.grouped()
    lines, nodes = list(scene.lines.values()), list(named.values())
    delays = np.array([line.parameters.delay or 0.0 for line in lines])
    z0, second = np.array([line.parameters.z0 for line in lines]), float(delays.min())
    name = scene.probed_line(probe)
    k, share = (
        (0, 0.0) if name is None else (list(scene.lines).index(name), scene.probes[probe].fraction(scene.lines[name]))
    )

    # each end's sent wave is delayed by its line; those of the probe's line also on their way to a probe inside
    fed_by = [*range(2 * len(lines)), 2 * k, 2 * k + 1]
    chains = [_delay(t, order) for t in [*np.repeat(delays / second, 2), share * delays[k] / second]]
    chains.append(_delay((1 - share) * delays[k] / second, order))
    A, b, c, d = (np.array(block_diag(*parts)) for parts in zip(*chains, strict=True))
    n = len(A)

    # rows over the states of delays, those of loads, and the source
    systems = [group.circuit(np.inf).system for group in groups]
    own, into, out, through = (
        np.array(block_diag(*parts))
        for parts in zip(*((s.A * second, s.b * second, s.c, s.d) for s in systems), strict=True)
    )
    m = len(own)
    arriving = np.zeros((2 * len(lines), n + m + 1))
    arriving[:, :n] = c[[e ^ 1 for e in range(2 * len(lines))]]
    thevenin = np.array([weights_of([node], z0) @ arriving[node.ends] for node in nodes])
    thevenin[:, -1] = [
        sum(f * float(w.value(np.array(1.0), np.array(1.0))) for w, f in node.excitations) for node in nodes
    ]
    states = np.eye(n + m + 1)[n : n + m]
    efforts = through @ thevenin + out @ states
    sent = 2 * efforts[node_of_end(nodes)] - arriving

    rates = np.vstack([b @ sent[fed_by], own @ states + into @ thevenin])
    rates[:n, :n] += A
    wave_a, wave_b = c[-2:] @ np.eye(n, n + m + 1) + d[-2:] @ sent[fed_by]
    if name is None:
        wave_a = wave_b = efforts[list(named).index(scene.probes[probe].at or "")]
    row = {"a": wave_a, "b": wave_b, "u": (wave_a + wave_b) / 2, "y": (wave_a - wave_b) / (2 * z0[k])}[quantity][None]
    return control.StateSpace(rates[:, :-1] / second, rates[:, -1:] / second, row[:, :-1], row[:, -1:])


def _delay(t: float, order: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Matrices A, b, c, d of the Padé approximation of exp(-ts), numerator of one degree less; no states for t = 0."""
    control = import_extra("control", "python-control", "control", "state space")

    if t == 0:
        return np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1))
    up, down = control.pade(1.0, order, order - 1)
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -np.array(down[:0:-1]) / down[0]
    c = np.array(up[::-1]) / down[0]
    b = np.zeros((order, 1))
    b[-1] = 1.0
    return A / t, b / t, c[None], np.zeros((1, 1))
