"""The kernel at work on one network: its structures are packed once, and then it is called by address."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.assembly.workspace import renew, work_for
from tline.solver.description.laws import units_of_laws
from tline.solver.kernel import blocks
from tline.solver.kernel.fronts.structures import DONE, FrontRun, Fronts, Sources
from tline.solver.kernel.network import Network, Run, State
from tline.solver.kernel.units import units_of

NOTHING = np.empty((0, 0)), np.empty((0, 2, 0))


class Kernel:
    """A network, its state, and the units that advance it."""

    def __init__(self, network: Network, state: State, fronts: Fronts | None = None):
        self.network, self.state = network, state
        units = units_of(network, units_of_laws(network.laws), fronts=fronts is not None)
        self._work = work_for(network, state)
        self._run = pack(Run(network, state, units, pack(self._work), *NOTHING))
        self._fronts: Any = None if fronts is None else pack(fronts)

    def takes(self, network: Network, state: State, fronts: Fronts | None) -> bool:
        """Begin another run of the same network in its state, if that needs the same units."""
        if network is not self.network or state is not self.state or (fronts is None) != (self._fronts is None):
            return False
        renew(self._work, network, state.before.shape[1])
        self._fronts = None if fronts is None else pack(fronts)
        return True

    def rest(self) -> None:
        """Forget what the last run wrote."""
        self.run(*NOTHING)

    @cached_property
    def _advance_fronts(self) -> Any:
        from tline.solver.kernel.fronts.advance import advance_fronts

        return advance_fronts

    def load(self) -> None:
        """Compile the loops that will be needed, or load them."""
        blocks.advance.address  # noqa: B018
        if self._fronts is not None:
            self._advance_fronts.address  # noqa: B018

    def run(self, excitation: NDArray, record: NDArray) -> Any:
        """What units get, packed."""
        now = self._run.values
        if excitation is not now.excitation or record is not now.record:
            self._run.write(now._replace(excitation=excitation, record=record))
        return self._run

    def blocks(self, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
        """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

        Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
        under way is not.
        """
        node = blocks.advance(self.run(excitation, record), 0, n_slabs, column)
        if node < 0 and not np.isfinite(self.state.waves).all():
            return len(self.network.first) - 1
        return node

    def fronts(
        self, sources: Sources, excitation: NDArray, first_slab: int, n_slabs: int, record: NDArray
    ) -> tuple[int, int]:
        """Advance all nodes slab by slab with fronts as breakpoints, until none is left or the log is full.

        Returns -1, or the number of a node whose effort, or that of another in its group, is no longer finite; and the
        number of slabs done.
        """
        job = pack(FrontRun(self.run(excitation, record), self._fronts, sources))
        node = self._advance_fronts(job, first_slab, n_slabs)
        return node, int(self._fronts.values.counts[DONE])


def advance(network: Network, state: State, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
    """Advance a network once; see `Kernel.blocks`."""
    return Kernel(network, state).blocks(n_slabs, excitation, record, column)
