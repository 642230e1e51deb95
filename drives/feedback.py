"""The drives and their controllers as one linear loop, exact: continuous, or from look to look of a sampled controller.

With y = (w1, w2, tension), perhaps behind low-pass filters, and the controllers' integrals dq/dt = r - E y,

    tau = K (r - E y) + K/T_i q,   T = S tau + R y

where E y is (belt speed, tension), and S and R are the decoupler of unequal spools (see `drives.decoupling`).
"""

from fractions import Fraction
from typing import NamedTuple

import numpy as np
from flint import fmpq_mat
from numpy.typing import NDArray

from drives.by_hand import SEEN
from drives.control import Design
from drives.coupled import CoupledDrives
from drives.decoupling import decoupler
from drives.discretise import joined, step_matrix
from drives.number import positive, rational
from drives.state_space import StateSpace, floats
from drives.symbolic import OUTPUTS
from tline.errors import InputError, check_kind

CONTROLLED = ("belt_speed", "tension")
MOST_DELAYED = 100  # periods


class Feedback(NamedTuple):
    """Loop of drives with filters: x' = a x + b T, y = measured x, tau = gain (r - seen y) + integral q, T = torque tau
    + feedback y.
    """

    a: fmpq_mat
    b: fmpq_mat
    measured: fmpq_mat
    seen: fmpq_mat
    gain: fmpq_mat
    integral: fmpq_mat
    torque: fmpq_mat
    feedback: fmpq_mat


def feedback_of(design: Design, lag: Fraction, plant: CoupledDrives | None = None) -> Feedback:
    """The loop with filters of this time constant, none if 0, perhaps of other drives than were designed for."""
    drives, torque, feedback = design.drives, [], []
    for k, (one, sign) in enumerate(zip(decoupler(drives), (-1, 1), strict=True)):
        torque.append([rational(one.share * x / 2) for x in (sign, 1)])
        feedback.append([rational(x) for x in (*(one.per_speed * (k == i) for i in range(2)), one.per_tension)])
    seen = [[*(rational(spool.radius / 2) for spool in (drives.left, drives.right)), 0], [0, 0, 1]]
    gains = [rational(one.gain) for one in (design.speed, design.tension)]
    rates = [rational(one.gain / one.integral_time) for one in (design.speed, design.tension)]
    model = (plant or drives).state_space(("w1", "w2", "tension"))
    a, b, y, n = model.a, model.b, model.c, len(model.states)
    if lag:
        each = rational(1 / lag)
        a = _blocks([[a, fmpq_mat(n, 3)], [y * each, _diagonal([-each] * 3)]])
        b, y = _blocks([[b], [fmpq_mat(3, 2)]]), _blocks([[fmpq_mat(3, n), _diagonal([1] * 3)]])
    controller = fmpq_mat(seen), _diagonal(gains), _diagonal(rates), fmpq_mat(torque), fmpq_mat(feedback)
    return Feedback(a, b, y, *controller)


def closed_loop(design: Design, filter_time: float = 0.0, plant: CoupledDrives | None = None) -> StateSpace:
    """The drives with their controllers, exact.

    Inputs are the set points of belt_speed and tension and disturbing torques d1 and d2, which act like T1 and T2;
    outputs those of the drives and the motors' T1 and T2. The free angle's 0 and the belts' hidden mode are among its
    poles.

    Parameters
    ----------
    design : Design
    filter_time : float, optional
        Time constant of a first-order low pass behind the measurements of w1, w2 and the tension [s], which are then
        states, too; none if 0.
    plant : CoupledDrives, optional
        Other drives than the controllers were designed for.

    Raises
    ------
    InputError
        A time that is less than 0.

    Examples
    --------
    >>> from drives import CoupledDrives, design
    >>> loop = closed_loop(design(CoupledDrives(), 20, 20))
    >>> [round(p.real, 3) for p in loop.poles]
    [-475.341, -100.0, -100.0, -100.0, -20.0, -19.306, -5.353, 0.0]
    """
    check_kind("design", design, Design)
    lag, drives = positive(filter_time, "filter_time", or_zero=True), plant or design.drives
    law, behind, p = feedback_of(design, lag, plant), SEEN if lag else (), len(OUTPUTS)
    n, on_references = law.a.nrows(), law.torque * law.gain
    on_states, on_integrals = (law.feedback - on_references * law.seen) * law.measured, law.torque * law.integral
    unit, none, outputs = _diagonal([1] * 2), fmpq_mat(2, 2), drives.state_space().c
    a = [[law.a + law.b * on_states, law.b * on_integrals], [-1 * law.seen * law.measured, none]]
    b = [[law.b * on_references, law.b], [unit, none]]
    c = [[outputs, fmpq_mat(p, n + 2 - outputs.ncols())], [on_states, on_integrals]]
    d = [[fmpq_mat(p, 4)], [_blocks([[on_references, none]])]]
    names = (
        (*drives.states, *behind, "q_speed", "q_tension"),
        (*(f"{name}_set" for name in CONTROLLED), "d1", "d2"),
        (*OUTPUTS, "T1", "T2"),
    )
    return StateSpace(_blocks(a), _blocks(b), _blocks(c), _blocks(d), *names)


def sampled_poles(
    design: Design, period: float, delay: float = 0.0, filter_time: float = 0.0
) -> NDArray[np.complex128]:
    """Eigenvalues of the loop from one look of a sampled controller to the next, largest first; stable within 1.

    One of them is 1: the free angle.

    Parameters
    ----------
    design : Design
    period, delay, filter_time : float
        As of `simulate_control` [s].

    Raises
    ------
    InputError
        A period that is not more than 0, a delay or time that is less, or a delay of more than 100 periods.

    Examples
    --------
    >>> from drives import CoupledDrives, design
    >>> loop = design(CoupledDrives(), 20, 20)
    >>> [round(float(abs(sampled_poles(loop, period)[0])), 3) for period in (0.001, 0.08)]
    [1.0, 1.183]
    """
    h, late = looks_of(period, delay)
    law = feedback_of(design, positive(filter_time, "filter_time", or_zero=True))
    n, before = law.a.nrows(), int(late / h)
    rest, both = late - before * h, joined(law.a, law.b)
    first, whole, last = (step_matrix(both, length)[:n] + np.eye(n, n + 4) for length in (rest, h, h - rest))
    size = n + 2 * (before + 2)  # states, integrals, torques of looks before
    now = np.zeros((before + 2, 2, size))  # torques asked for at this look and those before
    now[0, :, :n] = floats((law.feedback - law.torque * law.gain * law.seen) * law.measured)
    now[0, :, n : n + 2] = floats(law.torque * law.integral)
    now[1:].reshape(-1, size)[:, n + 2 :] = np.eye(size - n - 2)
    step = np.zeros((size, size))
    step[:n, :n] = whole[:, :n]
    step[:n] += last[:, :n] @ first[:, n : n + 2] @ now[before + 1] + last[:, n : n + 2] @ now[before]
    step[n : n + 2, : n + 2] = np.hstack([-h * floats(law.seen * law.measured), np.eye(2)])
    step[n + 2 :] = now[:-1].reshape(-1, size)
    poles = np.linalg.eigvals(step).astype(complex)
    return poles[np.argsort(-np.abs(poles))]


def looks_of(period: float, delay: float) -> tuple[float, float]:
    """Period and delay of a sampled controller, s."""
    h, late = float(positive(period, "period")), float(positive(delay, "delay", or_zero=True))
    if late > MOST_DELAYED * h:
        raise InputError("delay", "too long", f"at most {MOST_DELAYED} periods", f"{late:g} s")
    return h, late


def _diagonal(entries: list) -> fmpq_mat:
    n = len(entries)
    return fmpq_mat(n, n, [entries[i] if i == k else 0 for i in range(n) for k in range(n)])


def _blocks(blocks: list[list[fmpq_mat]]) -> fmpq_mat:
    """Join blocks to one matrix."""
    rows = []
    for across in blocks:
        lists = [block.tolist() for block in across]
        rows += [[x for part in parts for x in part] for parts in zip(*lists, strict=True)]
    return fmpq_mat(rows)
