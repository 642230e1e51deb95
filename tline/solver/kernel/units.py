"""Which compiled units a network needs: those of its elements, its losses and its delays, and no others."""

from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.solver.kernel.blocks import advance
from tline.solver.kernel.network import REMEMBERED, Network, Units
from tline.solver.kernel.scatter import scatter_block

KERNEL = "tline.solver.kernel"
OF_KIND = (  # in order of the kinds of elements
    "laws.quadratic.quadratic", "laws.pump.pump", "laws.relief.relief", "laws.outflow.leak", "laws.outflow.demand",
    "laws.diode.diode", "laws.table.table", "stores.gas.gas", "stores.tank.tank", "stores.rotor.rotor",
    "stores.vapour.vapour", "stores.air.air", "laws.user_defined.user_defined",
)  # fmt: skip


@cache
def unit_at(path: str) -> Any:
    """A unit by its module in the kernel and its name."""
    module, _, name = path.rpartition(".")
    return getattr(import_module(f"{KERNEL}.{module}"), name)


def law_addresses(kind: NDArray) -> NDArray:
    """Addresses of the units of elements of these kinds."""
    found = {int(k): unit_at(OF_KIND[k]).address for k in np.unique(kind)}
    return np.array([found[int(k)] for k in kind], np.int64)


def units_of(network: Network, *, fronts: bool) -> Units:
    """Addresses of what a network needs beside the loop, and of what that needs with fronts."""

    def address(path: str, needed: Any) -> int:
        return unit_at(path).address if needed else 0

    kind, losses, segments = network.laws.kind, network.losses.kind, len(network.segments.line)
    diamonds = len(network.diamonds.line)
    laws, mapped = np.diff(network.laws.first) > 0, network.load_at >= 0
    constant = address("losses.dissipation.dissipation", len(losses) and (losses < REMEMBERED).any())
    remembered = address("losses.memory.memory", len(losses) and (losses == REMEMBERED).any())
    return Units(
        advance=advance.address,
        scatter=scatter_block.address,
        laws=address("laws.passing.pass_block", laws.any()),
        delay=address("delay.delay_rest", (network.shift_row >= 0).any()),
        crossing=address("laws.crossing.crossing", (laws & ~mapped).any()),
        circuit=address("laws.circuit.circuit", (laws & mapped).any()),
        govern=address("laws.govern.govern", network.laws.governed.any()),
        law=law_addresses(kind) if len(kind) else np.zeros(0, np.int64),
        loss=np.where(losses == REMEMBERED, remembered, constant),
        segments=address("losses.segments.pass_segments", segments),
        diamonds=address("diamonds.full.pass_diamonds", diamonds),
        halves=address("diamonds.half.pass_halves", diamonds),
        diamonds_in_pieces=address("diamonds.pieces.pass_diamonds_in_pieces", fronts and diamonds),
        halves_in_pieces=address("diamonds.half_pieces.scatter_half_pieces", fronts and diamonds),
        pieces=address("fronts.pieces.scatter_pieces", fronts),
        respond=address("fronts.respond.respond_by_map", fronts and (mapped & ~laws).any()),
        respond_with_laws=address("fronts.respond.respond_with_laws", fronts and (mapped & laws).any()),
        collapse_at_losses=address("fronts.collapse.collapse_at_losses", fronts and len(losses)),
        collapse_group=address("fronts.collapse.collapse_group", fronts and segments),
    )
