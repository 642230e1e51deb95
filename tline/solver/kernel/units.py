"""Which compiled units a network needs: those of its elements, its losses and its delays, and no others."""

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.solver.kernel.blocks import advance, scatter_block
from tline.solver.kernel.network import Network, Units

KERNEL = "tline.solver.kernel"


@cache
def unit_at(path: str) -> Any:
    """A unit by its module in the kernel and its name."""
    module, _, name = path.rpartition(".")
    return getattr(import_module(f"{KERNEL}.{module}"), name)


def law_addresses(units: Sequence[str]) -> NDArray:
    """Addresses of the units of elements, each by its module in the kernel and its name."""
    return np.array([unit_at(unit).address for unit in units], np.int64)


def units_of(network: Network, kinds: Sequence[str], *, fronts: bool) -> Units:
    """Addresses of the units that a network needs beside the loop: for its laws, and for fronts."""

    def address(path: str, needed: Any) -> int:
        return unit_at(path).address if needed else 0

    diamonds = len(network.diamonds.line)
    whole = diamonds and network.diamonds.cell.any()  # cells that do not touch nodes
    halves = diamonds and not whole
    in_pieces = "pass_cells_in_pieces" if whole else "pass_diamonds_in_pieces"
    laws, mapped = np.diff(network.laws.first) > 0, network.load_at >= 0
    return Units(
        advance=advance.address,
        scatter=scatter_block.address,
        laws=address("laws.crossing.pass_block", laws.any()),
        delay=address("blocks.delay_rest", (network.shift_row >= 0).any()),
        crossing=address("laws.crossing.crossing", (laws & ~mapped).any()),
        circuit=address("laws.circuit.circuit", (laws & mapped).any()),
        hold=address("laws.pockets.hold", network.laws.pockets.any()),
        govern=address("laws.govern.govern", network.laws.governed.any()),
        law=law_addresses(kinds),
        diamonds=address("diamonds.cells.pass_cells" if whole else "diamonds.full.pass_diamonds", diamonds),
        halves=address("diamonds.half.pass_halves", halves),
        settle=address("diamonds.half.settle_without_gain", halves),
        answer=address("diamonds.half.respond", halves),
        diamonds_in_pieces=address(f"diamonds.pieces.{in_pieces}", fronts and diamonds),
        halves_in_pieces=address("diamonds.half_pieces.scatter_half_pieces", fronts and halves),
        answer_in_piece=address("diamonds.half_pieces.respond_in_piece", fronts and halves),
        constants=address("diamonds.cells.pass_constants", whole and len(network.diamonds.weight) == 1),
        rectangle=address("diamonds.full.pass_rectangle", diamonds),
        remember=address("diamonds.cells.remember", len(network.diamonds.memory.sign)),
        pieces=address("fronts.advance.scatter_pieces", fronts),
        arrive=address("fronts.advance.arrive", fronts),
        depart=address("fronts.advance.depart", fronts),
        respond=address("fronts.respond.respond_by_map", fronts and (mapped & ~laws).any()),
        respond_with_laws=address("fronts.respond.respond_with_laws", fronts and (mapped & laws).any()),
    )
