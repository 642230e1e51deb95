"""Names in SPICE netlists of what a scene names as it likes."""

import re

from tline.scene.scene import Scene


class Names:
    """Words of a netlist for the names of a scene: these where they are words, and numbered ones elsewhere."""

    def __init__(self, scene: Scene):
        joined = [*(line.nodes for line in scene.lines.values()), *(nodes for _, nodes in scene.between)]
        nodes = list(dict.fromkeys(at for each in joined for at in each))
        self.used = {"0", "gnd"}
        self.node = {at: self._word(at, f"n{k}") for k, at in enumerate(nodes, 1)}
        self.comments = [f"* node {word} is {at!r}" for at, word in self.node.items() if word != at]
        self.used = set()

    def element(self, letter: str, name: str) -> str:
        """A name for an element that begins with its letter, used for the first time."""
        return self._word(letter + re.sub(r"\W", "_", name, flags=re.ASCII), letter)

    def _word(self, wanted: str, other: str) -> str:
        """What is wanted if it is a word that is free; else the other, made free by a number."""
        word, k = (wanted if re.fullmatch(r"[A-Za-z_]\w*", wanted, re.ASCII) else other), 2
        free = word
        while free.lower() in self.used:
            free, k = f"{word}_{k}", k + 1
        self.used.add(free.lower())
        return free
