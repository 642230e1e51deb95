"""Problem 3: from a passive load to a passive input port, each step proved or compared by the program."""

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tline.exercises.answer import Found, Step

if TYPE_CHECKING:
    from passivity import Derivation

# the load in the figures: 25 ohm before 100 ohm beside 4 pF, at the end of 50 ohm and 0.1 ns
Z0, DELAY, SERIES, RESISTANCE, CAPACITANCE = 50.0, 1e-10, 25.0, 100.0, 4e-12
OMEGA = np.linspace(0.0, 1e11, 4000)


class Curves(NamedTuple):
    """Functions of the example's line on the imaginary axis."""

    g2: Any
    h2: Any
    h1: Any
    g1: Any


@cache
def _derivation() -> "Derivation":
    from passivity import derive

    return derive()


def _statement(letter: str, reason: str = "") -> Step:
    """Step of one of the four statements, as proved."""
    found = dict(_derivation().statements)[letter]
    text = found.statement if letter != "d" else "u1 ↦ y1 is positive real for all Z2 positive real, z0 > 0, T >= 0"
    return Step(text, f"{reason}{found.status}, {found.why}", found.proved)


def reflection() -> Found:
    """Answer 3a: bounded real reflection of a positive real load."""
    from passivity import reflection_identity

    steps = [Step(str(each), "G2 = x + iy", each.holds) for each in reflection_identity()]
    return _found("a", [*steps, _statement("a")], "G2", "H2")


def delayed() -> Found:
    """Answer 3b: bounded real reflection at the input of the line."""
    from passivity.calculus.derivation import is_equation

    chained = is_equation("let e = E; let A2 = e*A1; let B2 = H2*A2; e*B2/A1", "E^2*H2")
    steps = [
        Step("A2 = e^(-Ts) A1, B1 = e^(-Ts) B2", "both waves need the time T"),
        Step("B1/A1 = e^(-2Ts) H2", "put in B2 = H2 A2", chained),
    ]
    return _found("b", [*steps, _statement("b")], "H2", "H1")


def admittance() -> Found:
    """Answer 3c: positive real admittance at the input of the line."""
    from passivity import admittance_identity

    algebra = [Step(equation, what, holds) for what, equation, holds in _derivation().algebra]
    real_part = [Step(str(each), "H1 = a + ib", each.holds) for each in admittance_identity()]
    steps = [*algebra, *real_part, _statement("c")]
    return _found("c", steps, "H1", "G1")


def port() -> Found:
    """Answer 3d: passivity of the port for any passive load."""
    reasons = {"a": "G2 = Z2/z0: ", "b": "the line: ", "c": "(11): ", "d": "all of it at once: "}
    return _found("d", [_statement(letter, reason) for letter, reason in reasons.items()], "G2", "G1")


def _found(letter: str, steps: list[Step], *curves: str) -> Found:
    status = dict(_derivation().statements)[letter].status
    return Found({"status": str(status)}, tuple(steps), draw=("draw_curves", curves))


def example() -> Curves:
    """Functions G2, H2, H1 and G1 of the load in the figures."""
    s = 1j * OMEGA
    g2 = (SERIES + RESISTANCE / (1 + s * RESISTANCE * CAPACITANCE)) / Z0
    h2 = (g2 - 1) / (g2 + 1)
    h1 = np.exp(-2 * DELAY * s) * h2
    return Curves(g2, h2, h1, (1 - h1) / (1 + h1))


FOUND = {"3a": reflection, "3b": delayed, "3c": admittance, "3d": port}
