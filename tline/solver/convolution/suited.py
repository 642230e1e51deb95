"""Which scenes are convolutions: asked of every scene, so that others import nothing else of this room."""

from tline.solver.convolution.families import changes_of
from tline.solver.description.description import Description

CLOSEST = 1e-11  # smallest tolerance; transforms are accurate to some 1e-13
LONG = 1e4  # delays of the longest line


def suits(description: Description) -> bool:
    """Whether lines lose linearly, not all of them in diamonds, and the rest but laws and switches is constant."""
    return bool(description.dispersive or description.mixed) and _stays(description)


def is_slow(description: Description) -> bool:
    """Whether a linear scene is long for its lines, and nothing that drives it jumps."""
    longest = max(line.delay for line in description.lines.values())
    moving = description.elements or description.switched or description.own
    if description.t_end < LONG * longest or moving or description.scene.solver.slab or not _stays(description):
        return False
    waveforms = description.waveforms.values()
    changes = [changes_of(each, description.steady, description.t_end) for each in waveforms]
    return not any(each.jump.any() for each in changes)


def _stays(description: Description) -> bool:
    losses = [line.losses for line in description.lines.values() if line.losses is not None]
    if not all(each.linear for each in losses):
        return False
    moving = any(element.governor is not None or element.kind.breaks for element in description.elements)
    lifted = description.heights and not description.steady
    return not (moving or lifted or description.active)
