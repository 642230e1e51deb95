"""Writes the pictures of docs/exercise.md. Run: python -m docs.generate exercise."""

from pathlib import Path

import tline as tl
from tline.pictures.style import save_figure

PICTURES = Path(__file__).parent / "pictures"

if __name__ == "__main__":
    for letter in ("1d", "1e", "2a", "3c"):
        save_figure(tl.exercise(letter).plot(), PICTURES / f"exercise_{letter}.png")
