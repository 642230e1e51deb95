"""The kernel at work on one network: its structures are packed once, and then it is called by address."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.workspace import work_for
from tline.solver.kernel import blocks
from tline.solver.kernel.fronts.structures import DONE, FrontRun, Fronts, Sources
from tline.solver.kernel.network import NO_LOSSES, Network, Run, State
from tline.solver.kernel.units import units_of
from tline.structure import pack

PACKED_NO_LOSSES = pack(NO_LOSSES)


class Kernel:
    """A network, its state, and the units that advance it.

    Parameters
    ----------
    network : Network
    state : State
        Changed in place.
    fronts : Fronts, optional
        If slabs in pieces are to be advanced.
    """

    def __init__(self, network: Network, state: State, fronts: Fronts | None = None):
        self.state = state
        self._fronts: Any = None if fronts is None else pack(fronts)
        units = units_of(network, fronts=fronts is not None)
        work = work_for(network, state)
        if network.losses is NO_LOSSES:
            network = network._replace(losses=PACKED_NO_LOSSES)
        self._held = pack(network), pack(state), pack(units), pack(work)

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
        return pack(Run(*self._held, excitation, record))

    def blocks(self, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
        """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

        Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
        under way is not.
        """
        node = blocks.advance(self.run(excitation, record), 0, n_slabs, column)
        if node < 0 and not np.isfinite(self.state.waves).all():
            return len(self._held[0].values.first) - 1
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
