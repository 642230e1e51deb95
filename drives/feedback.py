"""The drives and their controllers as one linear loop, exact: continuous, or from look to look of a sampled controller.

With y = (w1, w2, tension), perhaps behind low-pass filters, and the controllers' integrals dq/dt = r - E y,

    tau = K (r - E y) + K/T_i q,   T = S tau + R y

where E y is (belt speed, tension), and S and R are the decoupler of unequal spools (see `drives.decoupling`).
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from flint import fmpq_mat
from numpy.typing import NDArray

from drives.by_hand import SEEN
from drives.control import Design
from drives.coupled import PARTS, CoupledDrives
from drives.decoupling import decoupler
from drives.discretise import joined, step_matrix
from drives.number import positive, rational, written
from drives.state_space import StateSpace, floats
from drives.symbolic import OUTPUTS
from tline.errors import InputError, check_kind
from tline.presentation import Presentation, plain
from tline.words.wording import aligned

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


PARAMETER_STEP = Fraction(1, 10**5)  # relative change of a parameter
SMALLEST_CHANGE = 1e-9  # of an overshoot, and of the motion of a pole
APART = 1e-6  # relative distance of poles that count as one
SETTLED, SAMPLES, LOOKS = 30.0, 2000, 8  # time constants of a response, its samples, steps of Newton's method


@dataclass(frozen=True, repr=False)
class Sensitivities(Presentation):
    """Changes for one per cent more of each parameter.

    Attributes
    ----------
    parameters : tuple of str
        Such as left.inertia; those that are 0 are left out.
    poles : list of complex
        Simple poles of the loop, one of each pair, without the free angle's, slowest first [rad/s].
    of_poles : ndarray, shape (parameters, poles)
        By how much each moves [rad/s].
    overshoots : ndarray, shape (2,)
        Of belt speed and tension when their set points step, as shares of the value that they settle at.
    of_overshoots : ndarray, shape (parameters, 2)
        By how much each grows, dimensionless.
    multiple : list of complex
        Poles that coincide, which have no derivative [rad/s].
    """

    parameters: tuple[str, ...]
    poles: list[complex]
    of_poles: NDArray[np.complex128]
    overshoots: NDArray[np.float64]
    of_overshoots: NDArray[np.float64]
    multiple: list[complex]

    def text_lines(self) -> Iterator[str]:
        """A row for each parameter."""
        yield "what 1 % more of a parameter does to poles [rad/s] and to overshoots [% of the final value]:"
        heads = [f"{name} {100 * x:.3g} %" for name, x in zip(CONTROLLED, self.overshoots, strict=True)]
        rows = [["parameter", *map(written, self.poles), *heads]]
        for name, moves, grows in zip(self.parameters, self.of_poles, self.of_overshoots, strict=True):
            told = [f"{move.real:+.3g}" + (f"{move.imag:+.3g}j" if move.imag else "") for move in moves]
            rows.append([name, *told, *(f"{100 * x:+.3g}" for x in grows)])
        yield from aligned(rows, 1)
        if self.multiple:
            yield f"poles that coincide have no derivative: {', '.join(map(written, self.multiple))} rad/s"

    def to_dict(self) -> dict[str, Any]:
        """All fields as plain values."""
        return {each.name: plain(getattr(self, each.name)) for each in fields(self)}


def sensitivities(design: Design, filter_time: float = 0.0) -> Sensitivities:
    """How poles and overshoots under control depend on the parameters of the drives.

    Parameters
    ----------
    design : Design
        Whose controllers and decoupler stay as they are.
    filter_time : float, optional
        As of `simulate_control` [s].

    Examples
    --------
    >>> from drives import CoupledDrives, design, sensitivities
    >>> found = sensitivities(design(CoupledDrives(), 20, 20))
    >>> row = found.parameters.index("left.inertia")
    >>> found.poles[0].real < 0, bool(abs(found.of_overshoots[row, 1]) < 0.01)
    (True, True)
    """
    from scipy.linalg import eig

    here, drives = closed_loop(design, filter_time), design.drives
    found: Any = eig(here.A, left=True)
    values, left, right = found
    scale = 1.0 / np.einsum("ij,ij->j", left.conj(), right)
    apart = np.abs(values[:, None] - values) + np.diag(np.full(len(values), np.inf))
    alone = apart.min(axis=0) > APART * np.abs(values)
    chosen = [k for k in np.argsort(np.abs(values)) if alone[k] and values[k].imag >= 0 and abs(values[k]) > 0]
    names, of_poles, of_overshoots, per_cent = list[str](), [], [], float(200 * PARAMETER_STEP)
    for name, *others in _changed(drives):
        more, less = (closed_loop(design, filter_time, other) for other in others)
        change = (more.A - less.A) / per_cent
        names.append(name)
        moves = np.array([scale[k] * (left[:, k].conj() @ change @ right[:, k]) for k in chosen])
        of_poles.append(np.where(np.abs(moves) > SMALLEST_CHANGE * np.abs(values[chosen]) / 100.0, moves, 0.0))
        of_overshoots.append((_overshoots(more) - _overshoots(less)) / per_cent)
    poles, multiple = ([complex(values[k]) for k in those] for those in (chosen, np.flatnonzero(~alone)))
    return Sensitivities(tuple(names), poles, np.array(of_poles), _overshoots(here), np.array(of_overshoots), multiple)


def _changed(drives: CoupledDrives) -> Iterator[tuple[str, CoupledDrives, CoupledDrives]]:
    """Each parameter that is not 0, and drives with a little more and a little less of it."""
    for part in PARTS:
        old = getattr(drives, part)
        given = {each.name: getattr(old, each.name) for each in fields(old) if each.init}
        for name, value in given.items():
            if value:
                more, less = (
                    type(old)(**given | {name: type(value)(value * x)})
                    for x in (1 + PARAMETER_STEP, 1 - PARAMETER_STEP)
                )
                yield f"{part}.{name}", replace(drives, **{part: more}), replace(drives, **{part: less})


def _overshoots(loop: StateSpace) -> NDArray[np.float64]:
    """Overshoots of belt speed and tension, relative to their final values, after steps of their set points."""
    from scipy.linalg import expm

    slow = min(-z.real for z in loop.poles if z.real)
    n, length, found = len(loop.states), SETTLED / slow / SAMPLES, []
    for k, name in enumerate(CONTROLLED):
        motion = np.zeros((n + 1, n + 1))
        motion[:n, :n], motion[:n, n] = loop.A, loop.B[:, k]
        seen, step, ways = np.append(loop.C[loop.outputs.index(name)], 0.0), expm(motion * length), [np.eye(n + 1)[n]]
        for _ in range(SAMPLES):
            ways.append(step @ ways[-1])
        z = ways[int(np.argmax(np.array(ways) @ seen))]
        last = float(seen @ ways[-1])
        for _ in range(LOOKS if float(seen @ z) / last - 1.0 > SMALLEST_CHANGE else 0):
            rate = motion @ z
            z = expm(motion * -float(seen @ rate / (seen @ motion @ rate))) @ z
        over = float(seen @ z) / last - 1.0
        found.append(over if over > SMALLEST_CHANGE else 0.0)
    return np.array(found)
