"""Modes hidden between a torque and an output: which, how often, and why."""

from dataclasses import dataclass

from flint import fmpq_poly

from drives.coupled import CoupledDrives
from drives.number import rational
from drives.roots import roots

ANGLE = ("free angle", "where the spools stand changes nothing: no force depends on it, and only the angles show it")
SPEED = ("common speed", "both spools slow down at the same rate B/J, so the tension never feels it")
BELTS = ("belts against each other", "both carry the same tension and relax at the same rate K/B: nothing drives it")
TENSION = ("tension", "spools alike to the belt share it with opposite signs, so their mean speed never sees it")
ALIKE = (
    "spools and belts alike",
    "B/J = K/B with these numbers: both die out at the same rate and the tension stays 0",
)
CHANCE = ("coincidence", "with these numbers the mode is not reached or not seen")


@dataclass(frozen=True)
class HiddenMode:
    """An irreducible factor of det(sI - A) that is cancelled in a transfer function.

    Attributes
    ----------
    poles : tuple of complex
        Its roots, rad/s.
    times : int
        How often it is cancelled.
    names, reasons : tuple of str
        Moving quantity and why it is hidden, one for each time.
    uncontrollable, unobservable : int
        How often it is uncontrollable from the torque, and how often unobservable from the output.
    """

    poles: tuple[complex, ...]
    times: int
    names: tuple[str, ...]
    reasons: tuple[str, ...]
    uncontrollable: int
    unobservable: int


def hidden_modes(drives: CoupledDrives, output: str, source: str) -> list[HiddenMode]:
    """Modes of the full model that the transfer function from a torque to an output does not have.

    Parameters
    ----------
    drives : CoupledDrives
    output, source : str
        Of ``OUTPUTS`` and ``INPUTS``.

    Raises
    ------
    InputError
        An unknown name.

    Examples
    --------
    >>> for mode in hidden_modes(CoupledDrives(), "x_k", "T1"):
    ...     print([p.real for p in mode.poles], mode.names)
    [0.0] ('free angle',)
    [-100.0] ('common speed', 'belts against each other', 'spools and belts alike')
    """
    full = drives.state_space((output,), (source,))
    reached, seen = full.reached(), full.dual().reached()
    cancelled = full.modes // full.minimal().modes
    known = _structure(drives, output)
    left_over = TENSION if output == "belt_speed" and drives.symmetric else None
    found = []
    for factor, times in cancelled.factor()[1]:
        names = [name for polynomial, name in known if polynomial % factor == 0][:times]
        rest = left_over or (ALIKE if names and _of_spools_alike(drives, factor) else CHANCE)
        names += [rest] * (times - len(names))
        unreached, unseen = (_times(factor, full.modes // part.modes) for part in (reached, seen))
        told = tuple(name for name, _ in names), tuple(why for _, why in names)
        found.append(HiddenMode(tuple(roots(factor)), times, *told, unreached, unseen))
    return sorted(found, key=lambda mode: -mode.poles[0].real)


def _structure(drives: CoupledDrives, output: str) -> list[tuple[fmpq_poly, tuple[str, str]]]:
    """The modes that can be hidden for a reason that lies in the mechanism."""
    spools = [fmpq_poly([rational(x.friction), rational(x.inertia)]) for x in (drives.left, drives.right)]
    belts = [fmpq_poly([rational(x.stiffness), rational(x.damping)]) for x in (drives.left_belt, drives.right_belt)]
    found = []
    if not output.startswith("phi"):
        found.append((fmpq_poly([0, 1]), ANGLE))
    if output in ("x_k", "tension") and spools[0].gcd(spools[1]).degree() == 1:
        found.append((spools[0], SPEED))
    if belts[0].gcd(belts[1]).degree() == 1:
        found.append((belts[0], BELTS))
    return found


def _of_spools_alike(drives: CoupledDrives, factor: fmpq_poly) -> bool:
    """Whether both spools, on their own, have this mode."""
    return all(
        fmpq_poly([rational(x.friction), rational(x.inertia)]) % factor == 0 for x in (drives.left, drives.right)
    )


def _times(factor: fmpq_poly, polynomial: fmpq_poly) -> int:
    count = 0
    while polynomial.degree() > 0 and polynomial % factor == 0:
        polynomial, count = polynomial // factor, count + 1
    return count
