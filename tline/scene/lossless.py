"""What is not known, or not right, on lines with losses is refused by name."""

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.words.wording import place


def refuse_losses(scene: Scene, what: str) -> None:
    """Refuse a scene in which a line has losses.

    Parameters
    ----------
    scene : Scene
    what : str
        What is not to be had then.

    Examples
    --------
    >>> cable = {"nodes": ["a", "b"], "z0": 50, "delay": "5 ns", "length": "1 m", "resistance": "2 ohm/m"}
    >>> scene = Scene(medium="electrical", t_end=1, lines={"cable": cable}, probes={"p": {"at": "a"}})
    >>> refuse_losses(scene, "no bounce diagram")
    Traceback (most recent call last):
    tline.errors.InputError: lines.cable: it has losses: no bounce diagram, expected lossless lines
    """
    for name, line in scene.lines.items():
        if line.losses is not None:
            raise InputError(place("lines", name), f"it has losses: {what}", "lossless lines")
