"""Effect of one per cent more of a parameter on poles and overshoots under unchanged controllers.

A simple pole moves by y'dA x/(y'x), with right and left eigenvectors x and y and dA by exact central differences. An
overshoot is stationary in the time of its peak, so that it moves as the response does there.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drives.control import Design
from drives.coupled import PARTS, CoupledDrives
from drives.feedback import CONTROLLED, closed_loop
from drives.number import written
from drives.state_space import StateSpace
from tline.presentation import Presentation, plain
from tline.words.aligned import aligned

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
