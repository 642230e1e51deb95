"""Progress on stderr, for work that takes more than two seconds; until then not even the bar is imported."""

import time
from typing import Any, Self

DELAY = 2.0  # s before a bar appears


class Progress:
    """A progress bar that appears after two seconds; use it as a context manager, or call `close`.

    Parameters
    ----------
    total : int
        Units of work.
    unit : str
        Name of the units.
    shown : bool
        Whether there is a bar at all.
    task : str
        Text in front of it.
    """

    def __init__(self, total: int, unit: str, shown: bool, task: str = ""):
        self._options = {"total": total, "unit": unit, "desc": task or None, "unit_scale": total >= 1000}
        self._shown, self._started, self._done = shown, time.time(), 0
        self._bar: Any = None

    def update(self, done: int = 1) -> None:
        """Count units as done."""
        if not self._shown:
            return
        self._done += done
        if self._bar is None and time.time() > self._started + DELAY:
            from tqdm import tqdm

            self._bar, done = tqdm(**self._options, delay=DELAY), self._done
            self._bar.start_t = self._started
        if self._bar is not None:
            self._bar.update(done)

    def close(self) -> None:
        """Leave the bar, if there is one, as it is."""
        if self._bar is not None:
            self._bar.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
