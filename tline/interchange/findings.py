"""What is found in a file of another program: mistakes, told all at once, and notes on what is left out."""

from collections.abc import Iterator
from contextlib import contextmanager

from tline.errors import InputError, SceneError
from tline.scene.mistakes import limited


class Findings:
    """Mistakes and notes of one file, in the order of their discovery.

    Examples
    --------
    >>> found = Findings()
    >>> with found.gathered():
    ...     raise InputError("c.cir, line 3, Q1", "a transistor")
    >>> found.note("c.cir, line 4, .options", "skipped")
    >>> found.notes, len(found.mistakes)
    (['c.cir, line 4, .options: skipped'], 1)
    """

    def __init__(self):
        self.mistakes: list[InputError] = []
        self.notes: list[str] = []

    def note(self, where: str, text: str) -> None:
        """Add a sentence on something that is left out or read in a certain sense, once."""
        sentence = f"{where}: {text}"
        if sentence not in self.notes:
            self.notes.append(sentence)

    @contextmanager
    def gathered(self) -> Iterator[None]:
        """Keep a mistake made inside, and go on behind the block."""
        try:
            yield
        except SceneError as error:
            self.mistakes += error.mistakes
        except InputError as error:
            self.mistakes.append(error)

    def check(self) -> None:
        """Raise all mistakes, if there are any."""
        distinct = list({str(mistake): mistake for mistake in self.mistakes}.values())
        if distinct:
            raise SceneError(limited(distinct, 0))
