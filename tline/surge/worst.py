"""The worst of a run at nodes: how far pressures rose and fell, when, and the class of pipes this requires."""

from collections.abc import Iterator, Sequence
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.interchange.water_network import listed
from tline.scene.connected import connected
from tline.scene.heights import weight_at
from tline.scene.load import linked_pairs
from tline.scene.scene import Scene
from tline.solver.result.result import Result
from tline.solver.result.states import drained, emptied

CLASSES = (6e5, 1e6, 1.6e6, 2e6, 2.5e6, 4e6, 6.3e6, 1e7)  # Pa, of EN 1333
BOILS = 2339.0 - 101_325.0  # Pa gauge, of water at 20 °C
BESIDE_PIPES = 1e3  # Pa, by which pressures at nodes without pipes must fall lower, since their errors are unknown
FAINT = 1e-6  # of the largest change: a node that moves by less does not
LAST = 0.01  # of a run: an extreme so near its end may be exceeded later
OUTLETS = {"check valve", "demand", "leak", "relief valve"}  # kinds of loads that let water out alone
CAVITIES = {"cavity", "vapour cavity"}  # kinds of loads that follow a column that separates

SEPARATES = "water boils, and what the columns do that separate there is not computed"
STOOD = "water boils in the network itself, before anything is operated"
BEYOND = "water would boil where no pipe ends"
EMPTIES = "a vessel runs empty, and gas in the pipe is not computed"
DRAINS = "pipes drain through an air valve, and are computed as full"
ALONE = "there was time for one number of places for cavities alone"
RISES = "the highest pressure comes at the end of the run and may be higher later"


class Extreme(NamedTuple):
    """Extremes of a node; pressures are gauge pressures, Pa, and instants s."""

    node: str
    # before, lowest, lowest_at, lowest_error, highest, highest_at, highest_error: errors are estimated, and not a
    # number where there is no finer run
    before: float
    lowest: float
    lowest_at: float
    lowest_error: float
    highest: float
    highest_at: float
    highest_error: float

    @property
    def rise(self) -> float:
        """Largest rise of the pressure, Pa."""
        return self.highest - self.before

    @property
    def fall(self) -> float:
        """Largest fall of the pressure, Pa."""
        return self.before - self.lowest


class Worst(NamedTuple):
    """The nodes that a surge hit hardest."""

    risen: Sequence[Extreme]  # risen, fallen: the largest change first; what does not move is not among them
    fallen: Sequence[Extreme]
    boiling: Sequence[Extreme]  # where water of 20 °C boils and no cavity follows that, the lowest pressure first
    highest: Extreme  # the highest pressure of all
    needed: float | None  # the class that bears it, Pa; None if there is none in EN 1333, or none can be told
    untold: str  # reason why no class is named; empty if one is
    spread: float  # how far slabs, and places of cavities, may move the highest pressure, Pa; in `needed`
    # nodes of the highest and the lowest pressure of all that have it at the end of the run
    unfinished: Sequence[Extreme]


def extremes(result: Result) -> list[Extreme]:
    """Return the extremes of every node."""
    seen = result.envelope
    if seen is None:
        raise InputError("envelope", "is missing", "a run with envelope=True")
    weight = np.nan_to_num(seen.weight)
    low = seen.lowest - weight, seen.lowest_at, seen.lowest_error
    high = seen.highest - weight, seen.highest_at, seen.highest_error
    columns = seen.start - weight, *low, *high
    return [Extreme(*row) for row in zip(seen.nodes, *(column.tolist() for column in columns), strict=True)]


def _alone(result: Result) -> Iterator[Extreme]:
    """Extremes of nodes at which no pipe ends."""
    assert result.envelope is not None
    weight = weight_at(result.scene)
    for node, (start, low, low_at, high, high_at) in result.envelope.alone.items():
        known = weight.get(node, 0.0)
        yield Extreme(node, start - known, low - known, low_at, nan, high - known, high_at, nan)


def behind_outlets(scene: Scene) -> set[str]:
    """Nodes at which no pipe ends that links connect with an outlet; shut in, they have any pressure below that of air.

    Such an outlet lets nothing in, so that no equation has a lower bound of the pressure before it.
    """
    piped = {node for line in scene.lines.values() for node in line.nodes}
    outlets = {load.at for load in scene.loads.values() if load.kind in OUTLETS} - piped
    return connected(outlets, linked_pairs(scene), {node for pair in linked_pairs(scene) for node in pair} - piped)


def boils(node: Extreme) -> bool:
    """Whether water of 20 °C may boil there, as far as errors tell."""
    return node.lowest - (0.0 if isnan(node.lowest_error) else node.lowest_error) < BOILS


def worst(result: Result, most: int = 5, spread: float = 0.0, untold: str = "") -> Worst:
    """Return the worst nodes; the highest pressure may be higher by `spread`, Pa, and `untold` forbids a class."""
    nodes = extremes(result)
    largest = max(max(node.rise, node.fall) for node in nodes)
    risen = sorted((node for node in nodes if node.rise > FAINT * largest), key=lambda node: -node.rise)
    fallen = sorted((node for node in nodes if node.fall > FAINT * largest), key=lambda node: -node.fall)
    followed = {load.at for load in result.scene.loads.values() if load.kind in CAVITIES}
    boiling = sorted((node for node in nodes if boils(node) and node.node not in followed), key=lambda n: n.lowest)
    lowest = min(nodes, key=lambda node: node.lowest)
    alone = list(_alone(result))
    beyond = [one.node for one in alone if one.before >= BOILS > one.lowest + BESIDE_PIPES]
    beyond = [*{*beyond} - behind_outlets(result.scene)]
    highest = max([*nodes, *alone], key=lambda node: node.highest)
    late = (1 - LAST) * result.scene.t_end
    rising = [highest] * (highest.highest_at > late and highest.rise > FAINT * largest)
    falling = [lowest] * (lowest.lowest_at > late and lowest.fall > FAINT * largest)
    boils_by = STOOD if all(node.before < BOILS for node in boiling) else SEPARATES
    boils_by = boils_by if boiling else f"{BEYOND}: {listed(beyond)}" if beyond else ""
    emptied_by = EMPTIES if emptied(result) else DRAINS if drained(result) else ""
    untold = boils_by or emptied_by or untold or (RISES if rising else "")
    bound = max(node.highest + float(np.nan_to_num(node.highest_error)) for node in nodes)
    spread = max(spread, bound - highest.highest)
    needed = None if untold else class_of(highest.highest + spread)
    return Worst(risen[:most], fallen[:most], boiling, highest, needed, untold, spread, [*rising, *falling])


def is_decided(result: Result) -> bool:
    """Whether the largest error of all nodes leaves one class, and nothing boils: no finer run is needed for that."""
    nodes, found = extremes(result), worst(result)
    error = max(error for node in nodes for error in (node.lowest_error, node.highest_error))
    lowest, highest = min(node.lowest for node in nodes), found.highest.highest
    one = class_of(highest - error) == class_of(highest + error)
    return one and not found.untold and lowest - error >= BOILS


def class_of(pressure: float) -> float | None:
    """The class that bears a pressure, Pa; None if none does."""
    return next((one for one in CLASSES if one >= pressure), None)
