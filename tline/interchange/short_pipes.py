"""Pipes so short beside a network that they may be longer: a time step is no longer than the shortest takes."""

from collections.abc import Collection
from dataclasses import replace

from tline.interchange.water_network import WaterNetwork, listed

ADDED = 1e-4  # of the length of all pipes
LONGEST = 3.0  # m, that a pipe is made
WORTH = 1.5  # times the length of the shortest; by less nothing is gained


def least_length(lengths: Collection[float]) -> float:
    """The length to which shorter pipes are brought for ADDED of all length, m; at most LONGEST.

    Examples
    --------
    >>> least_length([0.1, 5000.0, 5000.0]), least_length([0.1, 50.0, 50.0])
    (1.1, 0.11)
    """
    rising, budget, total = sorted(lengths), ADDED * sum(lengths), 0.0
    for k, length in enumerate(rising):
        if k * length - total > budget:
            break
        total += length
    else:
        k = len(rising)
    return min(float(f"{(budget + total) / max(k, 1):.3g}"), LONGEST)


def without_short_pipes(network: WaterNetwork) -> WaterNetwork:
    """The network with very short pipes made longer, with friction over the length that they had; a note names them."""
    least = least_length([pipe.length for pipe in network.pipes.values()])
    short = {name: pipe for name, pipe in network.pipes.items() if pipe.length < least}
    if not short or least < WORTH * min(pipe.length for pipe in short.values()):
        return network
    longer = {name: replace(pipe, length=least) for name, pipe in short.items()}
    added = sum(least - pipe.length for pipe in short.values()) / sum(pipe.length for pipe in network.pipes.values())
    why = f"taken as long as that, which adds {added:.1g} of the network's length, and lose no more"
    note = f"pipes shorter than {least:g} m: {why}: {listed(short)}"
    return replace(network, pipes={**network.pipes, **longer}, notes=(*network.notes, note))
