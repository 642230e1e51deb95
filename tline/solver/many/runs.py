"""Many runs of one scene: copies side by side in the kernel, slabs and loads' maps of their own for each copy."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.quantity import Role
from tline.solver.description.description import Description
from tline.solver.many.batches import ProbeOfCopies, run
from tline.solver.many.copies import Copies, copies_of
from tline.solver.many.period import breaks_of
from tline.solver.many.resolve import resolve

Floats = NDArray[np.float64]
TOLERANCE = Role("tolerance", "", at_least=1e-9, at_most=0.1)


class ManyRuns(NamedTuple):
    """A scene in copies, ready to run.

    Attributes
    ----------
    description : Description
    copies : Copies
    edges : ndarray, shape (slabs + 1, copies)
        Edges of the slabs in a period, the common measure of a copy's delays, as shares of it.
    order : int
        Points in a slab.
    estimate : float
        Largest difference to the next higher order, at any instant and in the extremes, relative to the amplitude, in
        a sample of the copies that holds the smallest and the largest of each number that varies.
    """

    description: Description
    copies: Copies
    edges: Floats
    order: int
    estimate: float

    def run(self, rows: NDArray, t: Floats) -> dict[str, ProbeOfCopies]:
        """Run the copies of some rows, and see them at instants t, s."""
        return run(self.description, self.copies, self.edges, self.order, rows, t)


def many_runs(description: Description, vary: Mapping[str, Floats], tol: float) -> ManyRuns:
    """Make a scene ready to run many times with other numbers, as finely as a tolerance takes.

    Parameters
    ----------
    description : Description
        Of a scene from rest; single lossless lines in any topology, whose delays are whole multiples of a common
        measure; sources; resistances, R, L and C in series or parallel, reservoirs, shorts, open and matched ends;
        probes at nodes.
    vary : mapping of str to ndarray, shape (copies,)
        Numbers in SI, one for each copy, by their place in the scene: ``lines.NAME.z0`` and ``lines.NAME.delay`` of
        lines that are given by them, ``sources.NAME.resistance``, and ``resistance``, ``inductance`` and
        ``capacitance`` of ``loads.NAME``. All are above zero. The delays of a copy keep their proportions.
    tol : float, 1e-9 to 0.1
        Largest error relative to the amplitude. Where no slabs reach it, the estimate says what was reached.

    Raises
    ------
    InputError
        The scene holds something else, or a number may not vary or is out of range.
    """
    TOLERANCE.parse(tol, "")
    copies, breaks = copies_of(description, vary), breaks_of(description)
    if not description.probes:
        raise InputError("probes", "there are none", "at least one, for many runs")
    return ManyRuns(description, copies, *resolve(description, vary, copies, breaks, tol))
