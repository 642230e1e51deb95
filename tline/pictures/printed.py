"""Reports as PDF: headings, paragraphs, tables and pictures of an HTML page from top to bottom."""

import base64
import io
from html.parser import HTMLParser
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.image import imread

from tline.style import INK, styled

WIDTH, HEIGHT, MARGIN = 8.27, 11.69, 0.75  # of A4, inches
POINT, LEADING = 1 / 72, 1.4  # inches; lines of text apart, of their size
LETTER = 0.56  # mean width of a letter, relative to its size
SIZES = {"h1": 17.0, "h2": 12.5, "p": 9.0, "li": 9.0}  # points
TABLE, LEAST = 8.0, 4.5  # points: of cells, and down to which they shrink
LONGEST, GAP = 44, 2  # letters: in a line of a cell, between columns
PICTURE = 4.4  # inches, largest height


class _Blocks(HTMLParser):
    """Parser of texts with the names of their elements, tables as rows of cells, some of them marked, and pictures."""

    def __init__(self):
        super().__init__()
        self.found: list[tuple[str, list]] = []
        self.inside: list[str] | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag in SIZES:
            self.inside = []
            self.found.append((tag, self.inside))
        elif tag == "table":
            self.found.append((tag, []))
        elif tag == "tr":
            self.found[-1][1].append((given.get("class") == "no", []))
        elif tag in ("td", "th"):
            self.inside = []
            self.found[-1][1][-1][1].append(self.inside)
        elif tag == "br" and self.inside is not None:
            self.inside.append("\n")
        elif tag == "img":
            data = (given.get("src") or "").partition("base64,")[2]
            self.found.append((tag, [imread(io.BytesIO(base64.b64decode(data)), "png")]))

    def handle_endtag(self, tag: str) -> None:
        if tag in (*SIZES, "td", "th"):
            self.inside = None

    def handle_data(self, data: str) -> None:
        if self.inside is not None:
            self.inside.append(data)


class _Paper:
    """Sheets of paper, filled from above."""

    def __init__(self, file: PdfPages):
        self.file, self.sheet, self.y = file, Figure(figsize=(WIDTH, HEIGHT)), MARGIN

    def end(self) -> None:
        self.file.savefig(self.sheet)

    def take(self, height: float, more: float = 0.0) -> float:
        """Reserve a height, on the next sheet if it, with more below it, does not fit; return where it begins."""
        if self.y + height + more > HEIGHT - MARGIN and self.y > MARGIN:
            self.end()
            self.sheet, self.y = Figure(figsize=(WIDTH, HEIGHT)), MARGIN
        self.y += height
        return self.y - height

    def write(self, x: float, y: float, text: str, size: float, **look: Any) -> None:
        self.sheet.text(x / WIDTH, 1 - y / HEIGHT, text, size=size, va="top", color=INK, parse_math=False, **look)

    def paragraph(self, tag: str, text: str, below: float) -> None:
        size, heading = SIZES[tag], tag.startswith("h")
        letters, height = int((WIDTH - 2 * MARGIN) / (LETTER * size * POINT)), LEADING * size * POINT
        self.take(height / 2)
        for line in (part for each in text.splitlines() for part in wrap(each.strip(), letters)):
            y = self.take(height, below if heading else 0.0)
            self.write(MARGIN, y, line, size, weight="bold" if heading else "normal")

    def table(self, rows: list[tuple[bool, list[str]]]) -> None:
        cells = [[wrap(cell, LONGEST) or [""] for cell in row] for _, row in rows]
        letters = np.array([max(len(line) for row in cells for line in row[k]) for k in range(len(cells[0]))]) + GAP
        room = (WIDTH - 2 * MARGIN) / POINT
        size = max(min(TABLE, room / (LETTER * letters.sum())), LEAST)
        right = MARGIN + letters.cumsum() * LETTER * size * POINT
        line = LEADING * size * POINT
        self.take(line / 2)
        for (marked, _), row in zip(rows, cells, strict=True):
            y = self.take(max(map(len, row)) * line)
            if marked:
                self.write(MARGIN - 0.12, y, "▸", size)
            for k, lines in enumerate(row):
                left = k in (0, len(row) - 1)
                x = right[k] - letters[k] * LETTER * size * POINT if left else right[k] - GAP * LETTER * size * POINT
                weight = "bold" if row is cells[0] else "normal"
                self.write(x, y, "\n".join(lines), size, weight=weight, ha="left" if left else "right")

    def picture(self, image: np.ndarray) -> None:
        tall, wide = image.shape[:2]
        width = min(WIDTH - 2 * MARGIN, PICTURE * wide / tall)
        height = width * tall / wide
        self.take(0.1)
        y = self.take(height)
        axes = self.sheet.add_axes((MARGIN / WIDTH, 1 - (y + height) / HEIGHT, width / WIDTH, height / HEIGHT))
        axes.imshow(image, aspect="auto", interpolation="none")
        axes.set_axis_off()


@styled
def print_page(text: str, path: Path) -> None:
    """Write a page of HTML, made by `tline.pictures.page`, as PDF."""
    blocks = _Blocks()
    blocks.feed(text)
    with PdfPages(path, metadata={"CreationDate": None}) as file:
        paper = _Paper(file)
        for (tag, held), (following, _) in zip(blocks.found, [*blocks.found[1:], ("", [])], strict=True):
            if tag == "img":
                paper.picture(held[0])
            elif tag == "table":
                paper.table([(marked, ["".join(cell) for cell in row]) for marked, row in held])
            else:
                paper.paragraph(tag, "• " * (tag == "li") + "".join(held), PICTURE if following == "img" else 1.0)
        paper.end()
