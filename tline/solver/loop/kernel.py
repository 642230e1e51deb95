"""The kernel at work on one network: its structures are packed once, and then it is called by address."""

from collections.abc import Hashable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.assembly.workspace import work_for
from tline.solver.description.laws import units_of_laws
from tline.solver.kernel import blocks
from tline.solver.kernel.fronts.structures import DONE, FrontRun, Fronts, Sources
from tline.solver.kernel.network import NO_LOSSES, Network, Run, State
from tline.solver.kernel.units import units_of

PACKED_NO_LOSSES = pack(NO_LOSSES)
NOTHING = np.empty((0, 0)), np.empty((0, 2, 0))
FEW = 1e5  # samples on the lines of a network that is kept


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
        self._shape = _shape(network, state, fronts)
        units = units_of(network, units_of_laws(network.laws), fronts=fronts is not None)
        work = pack(work_for(network, state))
        self._run = pack(Run(_packed(network), state, units, work, *NOTHING))
        self._fronts: Any = None if fronts is None else pack(fronts)

    def takes(self, network: Network, state: State, fronts: Fronts | None) -> bool:
        """Advance another network from now on, on the same grid, if it has the same shape."""
        if self._shape != _shape(network, state, fronts):
            return False
        run = self._run.values
        work = work_for(network, state) if len(network.laws.kind) else run.work
        self._run.write(run._replace(network=_packed(network), state=state, work=work))
        self._fronts = None if fronts is None else pack(fronts)
        return True

    def rest(self) -> bool:
        """Forget what the last run wrote; whether the rest is small enough to be kept."""
        self.run(*NOTHING)
        return self.state.waves.size <= FEW

    @cached_property
    def _advance_fronts(self) -> Any:
        from tline.solver.kernel.fronts.advance import advance_fronts

        return advance_fronts

    def load(self) -> None:
        """Compile the loops that will be needed, or load them."""
        blocks.advance.address  # noqa: B018
        if self._fronts is not None:
            self._advance_fronts.address  # noqa: B018

    @property
    def state(self) -> State:
        """The waves under way."""
        return self._run.values.state

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
            return len(self._run.values.network.first) - 1
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


def _packed(network: Network) -> Network:
    return network._replace(losses=PACKED_NO_LOSSES) if network.losses is NO_LOSSES else network


def _shape(network: Network, state: State, fronts: Fronts | None) -> Hashable:
    """What units and the size of their workspace depend on, beside the grid."""
    laws = network.laws
    arrays = network.group, network.load_at, network.step_states, laws.first, laws.kind, network.diamonds.cell
    return fronts is None, state.before.shape, *(array.tobytes() for array in arrays)


def advance(network: Network, state: State, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
    """Advance a network once; see `Kernel.blocks`."""
    return Kernel(network, state).blocks(n_slabs, excitation, record, column)
